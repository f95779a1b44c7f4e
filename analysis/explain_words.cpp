// SPDX-License-Identifier: Apache-2.0
// Writes explanations in words, and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/convention.h"
#include "analysis/explain.h"
#include "analysis/signature.h"

namespace graze::analysis {
namespace {

// "the triangles meet in a segment inside b, 0.5 deep", "b lies inside a, coplanar".
std::string phrase(const AnyPair& pair, const oracle::Truth& truth) {
  if (truth.contact == Contact::none)
    return fmt::format("the triangles are {} apart ({} ulps of the largest coordinate)",
                       oracle::margin_words(truth.margin), oracle::margin_words(truth.margin_ulps));
  const Nesting nesting = nesting_of(pair, truth);
  const char inner = nesting == Nesting::b_in_a ? 'b' : 'a', outer = nesting == Nesting::b_in_a ? 'a' : 'b';
  if (truth.hulls.coplanar && nesting == Nesting::same) return "a and b cover the same points";
  if (truth.hulls.coplanar && nesting != Nesting::none) return fmt::format("{} lies inside {}, coplanar", inner, outer);
  const std::string inside = nesting == Nesting::none ? "" : fmt::format(" inside {}", outer);
  const std::string deep = truth.margin < 0 ? fmt::format(", {} deep", oracle::margin_words(-truth.margin)) : "";
  switch (truth.contact) {
    case Contact::point:
      return "the triangles meet in a point" + deep;
    case Contact::segment:
      return "the triangles meet in a segment" + inside + deep;
    default:
      return "the triangles overlap in their common plane";
  }
}

std::string words(const cuda::ContractionSite& site) {
  // The user's own files are shown without their folders.
  const auto text = [](const cuda::SourceLine& line) {
    const std::string_view file = line.file;
    return fmt::format("{}:{}", file.starts_with('/') ? file.substr(file.rfind('/') + 1) : file, line.line);
  };
  const std::string_view from = site.from.file;
  const bool inlined = site.from.line > 0 && (from.starts_with("core/") || from.starts_with('/'));
  return inlined ? fmt::format("{} (inlined at {})", text(site.at), text(site.from)) : text(site.at);
}

// Names the compared value by its site. If the comparison has no site and compares with 0, uses the site of the first
// equal value that was passed to the policy.
std::string_view what(const LaneExplanation& lane, const Step& told) {
  const auto in_words = [](std::string_view site) -> std::string_view {
    return site == "plane_distance" ? "a signed distance"
           : site == "parallel"     ? "a component of the normals' cross product"
           : site == "orientation"  ? "an orientation"
                                    : "the gap between two interval ends";
  };
  if (!told.site.empty()) return in_words(told.site);
  for (const Step& step : lane.steps) {
    if (&step == &told) break;
    if (step.relation.empty() && step.left.lane == told.left.lane && step.left.decimal == told.left.decimal &&
        told.right.decimal == "0")
      return in_words(step.site);
  }
  return told.right.decimal == "0" && told.right.lane == 0 ? "a number" : "the difference of two numbers";
}

// "A", "A and B", "A, B and 3 more"; duplicates appear once.
std::string list(const std::vector<std::string>& all) {
  std::vector<std::string> names;
  for (const std::string& name : all) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  constexpr std::size_t kMost = 3;
  const std::size_t more = names.size() > kMost ? names.size() - kMost : 0;
  std::string result = names.front();
  for (std::size_t i = 1; i < names.size() - more; ++i) {
    result += (more == 0 && i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return more == 0 ? result : fmt::format("{} and {} more", result, more);
}

std::string words(double x) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x < 0 ? "-infinity" : "infinity";
  return fmt::format("{:.6g}", x + 0.0);  // no -0
}

std::string exact_words(const oracle::Beside& value) { return std::isnan(value.exact) ? "NaN" : value.decimal; }

// "a signed distance of exactly 0 into 1.2e-09": the difference of the compared numbers, though the lane does not
// compute it. If that is not finite, both numbers: "two interval ends of exactly 3 and 4 into infinity and 4".
std::string turned(const LaneExplanation& lane, const Step& told) {
  if (told.is_undefined())
    return fmt::format("a division by exactly zero, after which no number is defined, into {} and {}",
                       words(told.left.lane), words(told.right.lane));
  const bool with_zero = told.right.decimal == "0" && told.right.lane == 0;
  if (with_zero || (std::isfinite(told.difference.lane) && std::isfinite(told.difference.exact)))
    return fmt::format("{} of exactly {} into {}", what(lane, told), exact_words(told.difference),
                       words(told.difference.lane));
  return fmt::format("two {} of exactly {} and {} into {} and {}",
                     told.site == "separation" ? "interval ends" : "numbers", exact_words(told.left),
                     exact_words(told.right), words(told.left.lane), words(told.right.lane));
}

// ", which turns a signed distance of exactly 0 into 1.2e-09, so that the comparison at … goes the wrong way".
// replayed: words for how this is known; may be empty.
std::string effect(const LaneExplanation& lane, std::string_view replayed) {
  const Step* told = lane.told();
  if (!told) return "";
  std::string text;
  if (lane.deciding.front().by_cause) {
    text = fmt::format("{} {}turns {}, so that the comparison at {} goes {} way",
                       lane.cause == Cause::rounding ? "" : ", which", replayed, turned(lane, *told), told->line,
                       told->is_undefined() ? "another" : "the wrong");
  } else {
    text = fmt::format("; {}the comparison at {}, which decides, goes {} way without that too", replayed, told->line,
                       told->is_undefined() ? "another" : "the wrong");
  }
  std::vector<std::string> then;
  for (const Step& step : lane.then) then.push_back(step.line);
  if (!then.empty())
    text += fmt::format(" and, {} right, {} at {}", then.size() == 1 ? "were it" : "were each in turn",
                        then.size() == 1 ? "a later one" : "later ones", list(then));
  return text;
}

std::string list(const std::vector<cuda::ContractionSite>& sites) {
  std::vector<std::string> names;
  for (const cuda::ContractionSite& site : sites) names.push_back(words(site));
  return list(names);
}

std::string fused(const LaneExplanation& lane) {
  const std::vector<cuda::ContractionSite>& sites = lane.contractions.sites;
  if (sites.empty() && lane.lane->variant == Variant::toolchain && !lane.line.empty())
    return fmt::format("{} fuses products into additions at {}", lane.lane->toolchain, lane.line);
  if (sites.empty()) return "the compiler fuses products into additions";
  const std::string_view plural = sites.size() > 1 ? "s" : "";
  return fmt::format("nvcc fuses the product{} into the addition{} at {}", plural, plural, list(sites));
}

// Explains why the cause is not settled; empty if it is settled, or if reason() already explains it.
std::string doubt(const LaneExplanation& lane) {
  switch (lane.settled) {
    case Settled::not_without:
      return "; not settled: without that, something else still makes it wrong";
    case Settled::not_alone:
      return "; not settled: that alone, with all else exact, does not make it wrong";
    case Settled::not_by_few:
      return fmt::format("; not settled: it takes more than {} corrected comparisons to make it right", kMostDeciding);
    case Settled::unknown:
      return lane.cause == Cause::fast_math ? "" : "; not settled: what it computed is not known";
    default:
      return "";
  }
}

std::string reason(const LaneExplanation& lane) {
  const std::string then = effect(lane, lane.evidence <= Evidence::hash ? "" : "in a replay with the same verdict ");
  const std::string_view scalar = lane.lane->scalar == Scalar::f32 ? "float32" : "float64";
  switch (lane.cause) {
    case Cause::logic:
      return "the algorithm itself is wrong here, for in exact arithmetic it says the same";
    case Cause::contraction:
      return fused(lane) + then;
    case Cause::fast_math:
      return "the compiler may rewrite or approximate operations here, and what it computed is not known";
    case Cause::overflow:
      return fmt::format("an intermediate result is too large for {}{}", scalar, then);
    case Cause::underflow:
      return fmt::format("an intermediate result is too small for {}{}", scalar, then);
    default:
      return "rounding" + then;
  }
}

// Requires: the cause is no logic.
std::string remedy(const LaneExplanation& lane) {
  if (lane.cause == Cause::contraction) return "without contraction it is right";
  if (lane.cause == Cause::fast_math) return "with every operation rounded as written it is right";
  const std::string bits = lane.bits_needed == 0
                               ? fmt::format("no mantissa of up to {} bits is known to be enough", oracle::kMostBits)
                               : fmt::format("{} mantissa bits would be enough", lane.bits_needed);
  if (lane.cause == Cause::rounding)
    return bits + (lane.bits_needed == 0 || lane.bits_alone ? "" : " with unlimited exponents");
  if (lane.settled != Settled::not_without) return "with unlimited exponents it is right";
  if (lane.bits_needed == (lane.lane->scalar == Scalar::f32 ? 24 : 53))
    return std::string("with unlimited exponents") +
           (lane.rule == Contraction::none ? "" : ", and without contraction,") + " it is right";
  return bits + (lane.bits_needed == 0 ? ", even with" : " with") + " unlimited exponents";
}

// "cuda-fma", "cpu/rel:8".
std::string variant_of(const Lane& lane) {
  return std::string(lane.variant_name()) + (lane.policy.empty() ? "" : "/" + lane.policy);
}

// The cause that experiments found, and their evidence.
std::string reason_by_experiment(const LaneExplanation& lane) {
  const auto words = [&]() -> std::string {
    switch (lane.cause) {
      case Cause::contraction:
        return fused(lane);
      case Cause::fast_math:
        return "the compiler may rewrite or approximate operations";
      case Cause::overflow:
        return "a number becomes too large";
      case Cause::underflow:
        return "a number becomes too small";
      case Cause::logic:
        return "the code itself is wrong here, not its rounding";
      case Cause::absolute_epsilon:
        return "an absolute epsilon decides, or another number that does not grow and shrink with the triangles";
      case Cause::relative_epsilon:
        return "a relative epsilon decides";
      case Cause::uninitialised:
        return "it reads a variable that has no value";
      case Cause::excess_precision:
        return fmt::format("{} keeps results with more digits than {} has", lane.lane->toolchain,
                           lane.lane->scalar == Scalar::f32 ? "float" : "double");
      case Cause::order_dependent:
        return "the code itself is wrong here: its verdict depends on the order of the vertices or triangles";
      case Cause::degenerate_input:
        return "the code itself is wrong here, where a triangle is a segment or a point";
      case Cause::crash:
        return "the code crashes";
      case Cause::no_answer:
        return "the code does not return";
      case Cause::unstable:
        return "its verdict changes";
      case Cause::policy:
        return "the policy";
      case Cause::stored:
        return lane.beyond ? "float32 cannot store the pair" : "float32 stores another pair, for which that is right";
      default:
        return "rounding";
    }
  };
  return fmt::format("{}{} ({})", lane.settled == Settled::yes ? "" : "not settled: perhaps ", words(),
                     lane.experiment);
}

// Whether one sentence can describe both lanes.
bool alike(const LaneExplanation& l, const LaneExplanation& r) {
  const auto line = [](const LaneExplanation& lane) { return lane.told() ? lane.told()->line : ""; };
  return l.lane->scalar == r.lane->scalar && l.lane->policy == r.lane->policy && l.verdict == r.verdict &&
         l.cause == r.cause && l.settled == r.settled && line(l) == line(r) &&
         l.contractions.sites.empty() == r.contractions.sites.empty();
}

// The lane that the sentence about a subject describes. Prefers a lane whose values are known to be its own, and then a
// toolchain's lane whose contraction is at a known line. Null if no lane of the subject is wrong.
const LaneExplanation* representative(const Explanation& explanation, const AlgorithmInfo* subject) {
  const auto rank = [](const LaneExplanation& lane) {
    return lane.evidence <= Evidence::hash ? 2 : lane.line.empty() ? 0 : 1;
  };
  const LaneExplanation* first = nullptr;
  for (const LaneExplanation& lane : explanation.lanes) {
    if (lane.lane->info == subject && (!first || rank(lane) > rank(*first))) first = &lane;
  }
  return first;
}

nlohmann::ordered_json number(double x) {
  if (std::isfinite(x)) return x;
  return std::isnan(x) ? "nan" : x < 0 ? "-inf" : "inf";
}

nlohmann::ordered_json to_json(const oracle::Beside& beside) {
  return {{"lane", number(beside.lane)}, {"exact", beside.decimal}, {"ulps", number(beside.ulps)}};
}

nlohmann::ordered_json to_json(const Step& step) {
  nlohmann::ordered_json json{{"line", step.line}, {"site", step.site}};
  if (step.relation.empty()) {
    json["value"] = to_json(step.left);
    return json;
  }
  json["left"] = to_json(step.left);
  json["relation"] = step.relation;
  json["right"] = to_json(step.right);
  json["difference"] = to_json(step.difference);
  json["held"] = step.held;
  json["holds"] = step.holds;
  return json;
}

nlohmann::ordered_json to_json(const cuda::SourceLine& line) {
  return line.line > 0 ? nlohmann::ordered_json(fmt::format("{}:{}", line.file, line.line)) : nullptr;
}

nlohmann::ordered_json to_json(const WrongOf& count) { return {{"wrong", count.wrong}, {"of", count.of}}; }

}  // namespace

std::string sentence(const Explanation& explanation, const AlgorithmInfo* subject) {
  const LaneExplanation* first = representative(explanation, subject);
  if (!first) return "";
  std::string same, others;
  for (const LaneExplanation& lane : explanation.lanes) {
    if (lane.lane->info != subject) continue;
    const std::string variant = variant_of(*lane.lane);
    if (alike(*first, lane)) {
      same += fmt::format("{}{}", same.empty() ? "" : ", ", variant);
    } else {
      others += fmt::format("{}{}/{} ({}{})", others.empty() ? "" : ", ", name(lane.lane->scalar), variant,
                            lane.settled == Settled::yes ? "" : "perhaps ", name(lane.cause));
    }
  }
  const Lane& lane = *first->lane;
  const bool stored = decides_stored(lane, explanation.pair) && first->cause != Cause::stored;
  const std::string also = others.empty() ? "" : "; also wrong: " + others,
                    last = first->cause == Cause::logic ? "" : "; " + remedy(*first),
                    why = first->by_experiment() ? reason_by_experiment(*first) : reason(*first) + doubt(*first) + last;
  return fmt::format("{}/{} ({}) says {}, but {}: {}{}{}.", lane.info->id, name(lane.scalar), same,
                     name(first->verdict), phrase(explanation.pair, explanation.truth),
                     stored ? "on the pair as float32 stores it, " : "", why, also);
}

namespace {

// Adds what the sentence about a subject omits: other lines at which toolchains fuse products, and other flags that
// prevent this. Returns one sentence for each scalar, line and flag.
std::vector<std::string> by_toolchain(const Explanation& explanation, const AlgorithmInfo* subject) {
  using Account = std::tuple<Scalar, std::string, std::string>;
  const auto account = [](const LaneExplanation& lane) {
    return Account(lane.lane->scalar, lane.line, lane.experiment);
  };
  const LaneExplanation* first = representative(explanation, subject);
  std::vector<std::pair<const LaneExplanation*, std::string>> accounts;  // the first lane, and the names of all
  for (const LaneExplanation& lane : explanation.lanes) {
    if (lane.lane->info != subject || lane.lane->toolchain.empty() || lane.cause != Cause::contraction ||
        account(lane) == account(*first))
      continue;
    const auto same = std::find_if(accounts.begin(), accounts.end(),
                                   [&](const auto& other) { return account(*other.first) == account(lane); });
    if (same == accounts.end())
      accounts.emplace_back(&lane, variant_of(*lane.lane));
    else
      same->second += ", " + variant_of(*lane.lane);
  }
  std::vector<std::string> result;
  for (const auto& [lane, names] : accounts)
    result.push_back(
        fmt::format("{}/{} ({}): {}.", subject->id, name(lane->lane->scalar), names, reason_by_experiment(*lane)));
  return result;
}

constexpr std::string_view kDiffersFromCpu = " differs from cpu by contraction at ";

// Names the lines whose products make a user's CUDA code differ from the same code on the CPU; empty if not known.
std::string difference_from_cpu(const LaneExplanation& lane, Verdict of_cpu) {
  const std::vector<cuda::ContractionSite>& sites = lane.contractions.sites;
  if (!lane.cpu_is_right || !lane.contractions.lines_decide || sites.empty()) return "";
  const std::string lines = list(sites);
  if (lines.ends_with(" more")) return "";  // not all lines can be named
  return fmt::format("{}{}{}: with the products there rounded it says {}, as cpu does. Build with -fmad=false.",
                     lane.lane->id, kDiffersFromCpu, lines, name(of_cpu));
}

}  // namespace

bool tells_difference_from_cpu(std::string_view sentence) { return sentence.find(kDiffersFromCpu) != sentence.npos; }

std::vector<std::string> sentences(const Explanation& explanation) {
  std::vector<std::string> result;
  const AlgorithmInfo* last = nullptr;
  for (const LaneExplanation& lane : explanation.lanes) {
    if (lane.lane->info == last) continue;
    last = lane.lane->info;
    result.push_back(sentence(explanation, last));
    for (std::string& text : by_toolchain(explanation, last)) result.push_back(std::move(text));
    for (const LaneExplanation& other : explanation.lanes) {
      if (other.lane->info != last) continue;
      if (const std::string text = difference_from_cpu(other, explanation.truth.verdict); !text.empty()) {
        result.push_back(text);
        break;  // one lane of the source is enough
      }
    }
  }
  std::map<std::string, std::string> lanes_outside;  // by subject: the names of its lanes within the subject
  for (const Lane* lane : explanation.outside) {
    std::string& list = lanes_outside[std::string(lane->info->id)];
    list += (list.empty() ? "" : ", ") + lane->lane_name().within_subject();
  }
  for (const auto& [subject, list] : lanes_outside) {
    const auto lane = std::find_if(explanation.outside.begin(), explanation.outside.end(),
                                   [&](const Lane* l) { return l->info->id == subject; });
    result.push_back(
        fmt::format("{} ({}) says otherwise, and is not wrong: the pair is not in its contract, which "
                    "leaves out {}.",
                    subject, list, outside_in_words((*lane)->outside)));
  }
  return result;
}

nlohmann::ordered_json to_json(const LaneExplanation& lane) {
  nlohmann::ordered_json json{{"lane", lane.lane->id},
                              {"verdict", name(lane.verdict)},
                              {"cause", name(lane.cause)},
                              {"settled", name(lane.settled)},
                              {"exactly", name(lane.exactly.verdict)},
                              {"exactly_settled", lane.exactly.settled},
                              {"evidence", name(lane.evidence)},
                              {"contracted", name(lane.rule)}};
  json["decisive"] = lane.decisive < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(lane.decisive);
  json["then"] = nlohmann::ordered_json::array();
  for (const Step& s : lane.then) json["then"].push_back(to_json(s));
  json["deciding"] = nlohmann::ordered_json::array();
  for (const Decider& decider : lane.deciding) json["deciding"].push_back(decider.before.size());
  json["steps"] = nlohmann::ordered_json::array();
  for (const Step& s : lane.steps) json["steps"].push_back(to_json(s));
  json["contractions"] = nlohmann::ordered_json::array();
  for (const cuda::ContractionSite& site : lane.contractions.sites) {
    json["contractions"].push_back(
        {{"at", to_json(site.at)}, {"from", to_json(site.from)}, {"by", site.by_ptxas ? "ptxas" : "front end"}});
  }
  json["contractions_smallest"] = lane.contractions.smallest;
  json["bits_needed"] = lane.bits_needed == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(lane.bits_needed);
  json["matters"] = lane.matters;
  json["orders"] = to_json(lane.orders);
  json["mirrored"] = to_json(lane.mirrored);
  json["scalings"] = to_json(lane.scalings);
  if (lane.by_experiment()) json["experiment"] = lane.experiment;
  return json;
}

nlohmann::ordered_json to_json(const Explanation& explanation) {
  const oracle::Truth& truth = explanation.truth;
  nlohmann::ordered_json json{{"truth",
                               {{"verdict", name(truth.verdict)},
                                {"contact", name(truth.contact)},
                                {"margin", number(truth.margin)},
                                {"margin_ulps", number(truth.margin_ulps)}}},
                              {"sentences", sentences(explanation)},
                              {"lanes", nlohmann::ordered_json::array()}};
  for (const LaneExplanation& lane : explanation.lanes) json["lanes"].push_back(to_json(lane));
  return json;
}

}  // namespace graze::analysis
