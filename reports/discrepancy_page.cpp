// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/tuning.h"
#include "core/discrepancy/questions.h"
#include "core/lanes/lanes.h"
#include "reports/findings.h"
#include "reports/plain_figures.h"
#include "reports/snippet.h"
#include "reports/svg.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLinesShown = 10;
constexpr std::size_t kFewBars = 6;  // which have room for their counts

constexpr const char* kDiscrepancyStyle = R"(td.code { font-family: ui-monospace, monospace; white-space: pre; }
svg { width: 100%; height: auto; max-width: 56rem; }
summary { font-weight: bold; cursor: pointer; }
@media print { details { break-inside: avoid; } body { font-size: 11px; } }
)";

std::uint64_t number(const Json& json, const char* key) { return json.at(key).get<std::uint64_t>(); }
std::string text_of(const Json& json, const char* key) { return json.at(key).get<std::string>(); }

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string cell(const std::string& text, const char* kind = "number") {
  return fmt::format("<td class=\"{}\">{}</td>", kind, html(text));
}

// The exponent of a bucket's name, "2^-3".
int exponent(const std::string& bucket) { return std::stoi(bucket.substr(2)); }

// Adds up a histogram over all values of all questions.
std::map<std::string, std::uint64_t> summed(const Json& of, const char* histogram) {
  std::map<std::string, std::uint64_t> sums;
  for (const Json& question : of.at("questions")) {
    for (const Json& value : question.at("values")) {
      for (const auto& [bucket, count] : value.at(histogram).items()) sums[bucket] += count.get<std::uint64_t>();
    }
  }
  return sums;
}

std::uint64_t summed_number(const Json& of, const char* key) {
  std::uint64_t sum = 0;
  for (const Json& question : of.at("questions")) {
    for (const Json& value : question.at("values")) sum += number(value, key);
  }
  return sum;
}

// The comparisons in which some value differs.
std::vector<const Json*> differing(const Json& json) {
  std::vector<const Json*> lanes;
  for (const Json& of : json.at("lanes")) {
    if (number(of.at("total"), "differs") > 0) lanes.push_back(&of);
  }
  return lanes;
}

// "1 in 3,330 (moller_1997/f32/cpu and cuda-fma)"
std::string extreme(const std::vector<const Json*>& lanes, const char* count, bool most) {
  const auto rate = [&](const Json* of) {
    return share(number(of->at("total"), count), number(of->at("total"), "pairs"));
  };
  const auto less = [&](const Json* l, const Json* r) { return rate(l) < rate(r); };
  const Json* of =
      most ? *std::max_element(lanes.begin(), lanes.end(), less) : *std::min_element(lanes.begin(), lanes.end(), less);
  return fmt::format("{} ({})", rate_words(rate(of)), text_of(*of, "second"));
}

std::string shares_sentence(const std::vector<const Json*>& lanes, std::uint64_t same) {
  if (lanes.empty()) return "In every pair of lanes, all values that a comparison sees have the same bits.";
  if (lanes.size() == 1 && same == 0) {
    const Json& total = lanes[0]->at("total");
    const std::uint64_t pairs = number(total, "pairs");
    return fmt::format("Some value differs on {} of the pairs, some sign on {}, and the verdict on {}.",
                       rate_words(share(number(total, "differs"), pairs)),
                       rate_words(share(number(total, "sign"), pairs)),
                       rate_words(share(number(total, "verdict"), pairs)));
  }
  return fmt::format(
      "Of {} pairs of lanes, {} have the same bits in every value. In the others some value differs on {} to {} of the "
      "pairs of triangles, and the verdict on {} to {}.",
      lanes.size() + same, same, extreme(lanes, "differs", false), extreme(lanes, "differs", true),
      extreme(lanes, "verdict", false), extreme(lanes, "verdict", true));
}

// "core/vec3.h:48 within core/algorithms/plane.h:30"
std::string place_of(const Json& line) {
  const std::string within = text_of(line, "within");
  return text_of(line, "line") + (within.empty() ? "" : " within " + within);
}

std::string start_sentence(const std::vector<const Json*>& lanes) {
  std::map<std::string, std::uint64_t> starts;
  std::uint64_t all = 0, fixed = 0, changed = 0;
  std::string top_line;
  for (const Json* of : lanes) {
    const Json& origins = of->at("origins");
    if (origins.is_null()) continue;
    changed += number(origins, "verdicts");
    for (const Json& start : origins.at("starts")) {
      for (const auto& [line, count] : start.at("by_line").items()) {
        starts[place_of(origins.at("lines").at(static_cast<std::size_t>(std::stoul(line))))] +=
            count.get<std::uint64_t>();
        all += count.get<std::uint64_t>();
      }
      all += number(start, "by_several_lines");
    }
    for (const Json& line : origins.at("lines")) {
      if (number(line, "verdicts_fixed") > fixed) {
        fixed = number(line, "verdicts_fixed");
        top_line = fmt::format("{} of {}", place_of(line), text_of(*of, "second"));
      }
    }
  }
  if (all == 0) return "Where differences start is not known: no pair of lanes has contractions that can be traced.";
  const auto top =
      std::max_element(starts.begin(), starts.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
  return fmt::format("{} of the {} differing values that were traced first differ at {}.{}",
                     rate_words(share(top->second, all)), grouped(all), top->first,
                     changed == 0
                         ? " No traced verdict changes."
                         : fmt::format(" Not fusing the products of {} alone gives back {} of its verdicts that "
                                       "contraction changes, the most of all lines.",
                                       top_line, grouped(fixed)));
}

std::string nearer_sentence(const std::vector<const Json*>& lanes) {
  std::uint64_t first = 0, second = 0, equal = 0, unknown = 0;
  for (const Json* of : lanes) {
    const auto sums = summed(of->at("total"), "nearer");
    const auto at = [&](const char* key) { return sums.contains(key) ? sums.at(key) : 0; };
    first += at("first"), second += at("second"), equal += at("equal"), unknown += at("unknown");
  }
  const std::uint64_t all = first + second + equal + unknown;
  if (all == 0) return "No lane is nearer to the exact values: none differ.";
  return fmt::format(
      "Of {} values that differ, the second lane's is nearer to the exact one in {}, the first lane's in {}; {} are "
      "equally near, and for {} the certified bounds do not tell.",
      grouped(all), rate_words(share(second, all)), rate_words(share(first, all)), grouped(equal), grouped(unknown));
}

// "3.2"; rounded up.
std::string up(double x) {
  std::string text = fmt::format("{:.2g}", x);
  if (std::stod(text) < x) text = fmt::format("{:.2g}", x * 1.1);
  return text;
}

std::string band_sentence(const std::vector<const Json*>& lanes) {
  double widest = 0;
  std::uint64_t asked = 0, beyond_range = 0;
  std::string where;
  for (const Json* of : lanes) {
    for (const Json& question : of->at("total").at("questions")) {
      asked += number(question, "asked");
      if (question.at("band").contains("unknown"))
        beyond_range += question.at("band").at("unknown").get<std::uint64_t>();
      if (const double band = question.at("largest_in_bounds"); band > widest) {
        widest = band;
        where = fmt::format("{} of {}", text_of(question, "question"), text_of(*of, "second"));
      }
    }
  }
  if (widest == 0) return "No sign differs.";
  return fmt::format(
      "A sign differs only where both sizes are at most {} bounds of the value's rounding error ({}). In {} "
      "comparisons "
      "none was farther from zero{}; at 95 % confidence such comparisons are rarer than {}.",
      up(widest), where, grouped(asked),
      beyond_range == 0
          ? ""
          : fmt::format(", except for {} beyond the exponent range, which have no bound", grouped(beyond_range)),
      up(analysis::upper_bound(0, asked)));
}

std::string mending_sentence(const Json& json) {
  std::uint64_t values = 0, pairs = 0, lanes = 0, others = 0;
  for (const Json& of : json.at("lanes")) {
    if (!text_of(of, "second").ends_with("/cuda-nofma") && !text_of(of, "first").ends_with("/cuda-nofma")) continue;
    ++lanes;
    values += summed_number(of.at("total"), "compared");
    pairs += number(of.at("total"), "pairs");
    others += number(of.at("total"), "differs");
  }
  if (lanes == 0)
    return "No remedy was measured here: compare cpu with cuda-nofma (-fmad=false), and see `graze tune --agree`.";
  if (others > 0)
    return fmt::format("-fmad=false does not mend it: {} of {} pairs still differ.", grouped(others), grouped(pairs));
  return fmt::format(
      "-fmad=false mends it: cpu and cuda-nofma have the same bits in all {} values on {} pairs of triangles, in {} "
      "pairs of "
      "lanes. `graze bench` and docs/measurements.md have its cost, and that of the exact lane.",
      grouped(values), grouped(pairs), lanes);
}

// A bar chart of counts on a logarithmic scale, one series up and, if given, one down.
std::string mirrored_bars(const std::string& title, const std::vector<std::string>& labels,
                          const std::vector<std::uint64_t>& up_counts, const std::vector<std::uint64_t>& down_counts,
                          const std::string& up_name, const std::string& down_name) {
  constexpr double kLeft = 60, kRight = 880, kMiddle = 220, kHeight = 145;
  std::uint64_t most = 1;
  for (const auto* counts : {&up_counts, &down_counts}) {
    for (const std::uint64_t count : *counts) most = std::max(most, count);
  }
  const double logs = std::log10(static_cast<double>(most)) + 0.3;
  const auto height = [&](std::uint64_t count) {
    return count == 0 ? 0 : kHeight * (std::log10(static_cast<double>(count)) + 0.3) / logs;
  };
  std::string svg = svg_begin(html(title)) + svg_text(kLeft, 24, "start", html(title), " font-size=\"15\"") +
                    svg_text(kLeft, 44, "start", "up: " + html(up_name), fmt::format(" fill=\"{}\"", kSvgColours[1])) +
                    (down_counts.empty() ? ""
                                         : svg_text(kLeft + 380, 44, "start", "down: " + html(down_name),
                                                    fmt::format(" fill=\"{}\"", kSvgColours[0])));
  const double base = down_counts.empty() ? kMiddle + kHeight : kMiddle;
  const double step = (kRight - kLeft) / static_cast<double>(std::max<std::size_t>(labels.size(), 1));
  svg += svg_level(kLeft, kRight, base);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double x = kLeft + step * static_cast<double>(i);
    const auto bar = [&](std::uint64_t count, bool down) {
      if (count == 0) return std::string();
      const double high = height(count) * (down_counts.empty() ? 2 : 1);
      return fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"><title>{}: "
          "{}</title></rect>\n",
          x + 1, down ? base : base - high, std::max(step - 2, 1.0), high, kSvgColours[down ? 0 : 1], html(labels[i]),
          grouped(count));
    };
    svg += bar(up_counts[i], false);
    if (!down_counts.empty()) svg += bar(down_counts[i], true);
    if (labels.size() <= kFewBars)
      svg += svg_text(x + step / 2, base - 2 * height(up_counts[i]) - 6, "middle", grouped(up_counts[i]));
    const std::size_t every = (labels.size() + 15) / 16;
    if (i % every == 0) svg += svg_text(x + step / 2, 392, "middle", html(labels[i]));
  }
  return svg + svg_text(kRight, 412, "end", "bars: logarithm of the count") + "</svg>\n";
}

// Errors of both lanes, mirrored.
std::string errors_figure(const Json& of) {
  const auto first = summed(of.at("total"), "first_error"), second = summed(of.at("total"), "second_error");
  std::vector<std::string> labels = {"0", "1/2"};
  for (int k = 0; k < 36; ++k) labels.push_back(fmt::format("2^{}", k));
  const auto at = [](const auto& sums, const std::string& key) { return sums.contains(key) ? sums.at(key) : 0; };
  while (labels.size() > 4 && at(first, labels.back()) + at(second, labels.back()) == 0) labels.pop_back();
  labels.insert(labels.end(), {"not finite", "unknown"});
  std::vector<std::uint64_t> ups, downs;
  for (const std::string& label : labels) ups.push_back(at(first, label)), downs.push_back(at(second, label));
  return mirrored_bars("Error against the exact value, in ulps: at most", labels, ups, downs, text_of(of, "first"),
                       text_of(of, "second"));
}

std::string differences_figure(const Json& of) {
  const auto above = summed(of.at("total"), "above"), below = summed(of.at("total"), "below");
  int most = 0;
  for (const auto* sums : {&above, &below}) {
    for (const auto& [bucket, count] : *sums) most = std::max(most, exponent(bucket));
  }
  std::vector<std::string> labels;
  std::vector<std::uint64_t> ups, downs;
  for (int k = 0; k <= most; ++k) {
    labels.push_back(fmt::format("2^{}", k));
    ups.push_back(above.contains(labels.back()) ? above.at(labels.back()) : 0);
    downs.push_back(below.contains(labels.back()) ? below.at(labels.back()) : 0);
  }
  return mirrored_bars("Difference in ulps: at least", labels, ups, downs, text_of(of, "second") + " is higher",
                       "it is lower");
}

std::string funnel_figure(const Json& of) {
  const Json& total = of.at("total");
  return mirrored_bars("From differing values to differing verdicts: pairs of triangles",
                       {"all", "a value differs", "a sign differs", "a comparison differs", "the verdict differs"},
                       {number(total, "pairs"), number(total, "differs"), number(total, "sign"),
                        number(total, "outcome"), number(total, "verdict")},
                       {}, "pairs", "");
}

std::string band_figure(const Json& of) {
  std::map<int, std::uint64_t> bands;
  for (const Json& question : of.at("total").at("questions")) {
    for (const auto& [bucket, count] : question.at("band").items()) {
      if (bucket != "unknown") bands[exponent(bucket)] += count.get<std::uint64_t>();
    }
  }
  if (bands.empty()) return "";
  std::vector<std::string> labels;
  std::vector<std::uint64_t> counts;
  for (int k = bands.begin()->first; k <= bands.rbegin()->first; ++k) {
    labels.push_back(fmt::format("2^{}", k));
    counts.push_back(bands.contains(k) ? bands[k] : 0);
  }
  return mirrored_bars("The critical band: size of values whose sign differs, in bounds of their rounding error",
                       labels, counts, {}, "signs that differ", "");
}

std::string questions_table(const Json& of) {
  std::string text =
      "<div class=\"wide\"><table><tr><th>question</th><th>asked</th><th>a value differs</th><th>sign</th><th>zero on "
      "one "
      "side</th><th>outcome</th><th>decides the verdict</th><th>band, in bounds</th><th>band, as a length</th></tr>\n";
  for (const Json& question : of.at("total").at("questions")) {
    const std::uint64_t asked = number(question, "asked");
    if (number(question, "differs") == 0) continue;
    text += "<tr>" + cell(text_of(question, "question"), "name") + cell(grouped(asked));
    for (const char* count : {"differs", "sign", "zero_on_one_side", "outcome"})
      text += cell(rate_words(share(number(question, count), asked)));
    text += cell(grouped(number(question, "verdict")));
    for (const char* largest : {"largest_in_bounds", "largest_length"}) {
      const double size = question.at(largest);
      text += cell(number(question, "sign") == 0 ? "-" : fmt::format("{:.3g}", size));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string strata_table(const Json& of) {
  std::string text =
      "<div class=\"wide\"><table><tr><th>stratum</th><th>pairs</th><th>a value differs</th><th>a sign</th><th>a "
      "comparison</th><th>the verdict</th></tr>\n";
  for (const auto& [stratum, counts] : of.at("strata").items()) {
    const std::uint64_t pairs = number(counts, "pairs");
    text += "<tr>" + cell(stratum, "name") + cell(grouped(pairs));
    for (const char* count : {"differs", "sign", "outcome", "verdict"})
      text += cell(rate_words(share(number(counts, count), pairs)));
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string lines_table(const Json& origins) {
  std::vector<const Json*> lines;
  for (const Json& line : origins.at("lines")) {
    if (number(line, "values") + number(line, "verdicts_fixed") > 0) lines.push_back(&line);
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Json* l, const Json* r) {
    return std::pair(number(*l, "verdicts_fixed"), number(*l, "values")) >
           std::pair(number(*r, "verdicts_fixed"), number(*r, "values"));
  });
  std::string text = fmt::format(
      "<p>Contraction changes {} verdicts of {} traced pairs. The source lines whose products are fused, by what they "
      "decide:</p>\n<div class=\"wide\"><table><tr><th>line</th><th>source</th><th>within</th><th>values that it "
      "changes "
      "alone</th><th>verdicts, alone</th><th>verdicts that return without it</th></tr>\n",
      grouped(number(origins, "verdicts")), grouped(number(origins, "pairs")));
  for (std::size_t l = 0; l < std::min(lines.size(), kMostLinesShown); ++l) {
    const Json& line = *lines[l];
    text += "<tr>" + cell(text_of(line, "line"), "name") + cell(source_line(text_of(line, "line")), "code") +
            cell(text_of(line, "within"), "name") + cell(grouped(number(line, "values"))) +
            cell(grouped(number(line, "verdicts_alone"))) + cell(grouped(number(line, "verdicts_fixed"))) + "</tr>\n";
  }
  text +=
      "</table></div>\n<p>A value starts to differ by one rounding at some line. The table shows how far it has moved "
      "when it is compared; it moves further where terms cancel:</p>\n<div "
      "class=\"wide\"><table><tr><th>value</th><th>first line, "
      "most often</th><th>median</th><th>99 %</th><th>largest</th></tr>\n";
  for (const Json& start : origins.at("starts")) {
    std::map<int, std::uint64_t> growth;
    std::uint64_t all = 0;
    for (const auto& [bucket, count] : start.at("growth").items())
      growth[exponent(bucket)] += count.get<std::uint64_t>(), all += count.get<std::uint64_t>();
    std::string line = "several lines together";
    std::uint64_t most = 0;
    for (const auto& [place, count] : start.at("by_line").items()) {
      if (count.get<std::uint64_t>() > most) {
        most = count.get<std::uint64_t>();
        line = text_of(origins.at("lines").at(static_cast<std::size_t>(std::stoul(place))), "line");
      }
    }
    const auto quantile = [&](double of_all) {
      std::uint64_t so_far = 0;
      for (const auto& [k, count] : growth) {
        so_far += count;
        if (static_cast<double>(so_far) >= of_all * static_cast<double>(all))
          return fmt::format("under 2^{} ulps", k + 1);
      }
      return std::string("-");
    };
    text += "<tr>" + cell(text_of(start, "value"), "name") + cell(line, "name") + cell(quantile(0.5)) +
            cell(quantile(0.99)) + cell(quantile(1)) + "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string comparison_section(const Json& of, bool open) {
  const Json& total = of.at("total");
  const std::string title = fmt::format("{} against {}", text_of(of, "first"), text_of(of, "second"));
  if (number(total, "differs") == 0) {
    return fmt::format("<p><b>{}</b>: the same bits in all {} values on {} pairs; {} verdicts differ.</p>\n",
                       html(title), grouped(summed_number(total, "compared")), grouped(number(total, "pairs")),
                       grouped(number(total, "verdict")));
  }
  std::string text = fmt::format("<details{}><summary>{}</summary>\n", open ? " open" : "", html(title));
  text += funnel_figure(of) + differences_figure(of) + errors_figure(of) + band_figure(of);
  text += "<h3>By question</h3>\n" + questions_table(of) + "<h3>By stratum</h3>\n" + strata_table(of);
  if (!of.at("origins").is_null())
    text += "<h3>Where it starts, and how it grows</h3>\n" + lines_table(of.at("origins"));
  return text + "</details>\n";
}

}  // namespace

std::vector<std::string> discrepancy_answer(const Json& json) {
  const std::vector<const Json*> lanes = differing(json);
  return {shares_sentence(lanes, json.at("lanes").size() - lanes.size()), start_sentence(lanes), nearer_sentence(lanes),
          band_sentence(lanes), mending_sentence(json)};
}

namespace {

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("impossible counts: " + what);
}

// Checks that the count of each key is at most that of the key before it.
void expect_falling(const Json& of, std::initializer_list<const char*> keys, const std::string& what) {
  const char* before = nullptr;
  for (const char* key : keys) {
    if (before) expect(number(of, key) <= number(of, before), what + ": more of " + key + " than of " + before);
    before = key;
  }
}

std::uint64_t sum_of(const Json& histogram) {
  std::uint64_t sum = 0;
  for (const auto& [bucket, count] : histogram.items()) sum += count.get<std::uint64_t>();
  return sum;
}

void expect_possible_counts(const Json& of, const std::vector<Question>& questions, const std::string& what) {
  expect_falling(of, {"pairs", "differs"}, what);
  expect_falling(of, {"pairs", "sign", "outcome", "verdict"}, what);
  expect_falling(of, {"outcome", "choice"}, what);
  expect(number(of, "sign") <= number(of, "differs") + number(of, "choice"),
         what + ": more signs differ than values and choices");
  for (const Json& unlike : of.at("unlike"))
    expect(unlike.get<std::uint64_t>() <= number(of, "pairs"), what + ": unlike");
  for (const auto& [site, counts] : of.at("sites").items()) {
    expect_falling(counts, {"asked", "differs", "sign"}, what + ", " + site);
    expect(number(counts, "asked") <= number(of, "pairs"), what + ": more pairs at " + site);
  }
  expect(of.at("questions").size() == questions.size(), what + ": its questions are not those of the algorithm");
  for (std::size_t q = 0; q < questions.size(); ++q) {
    const Json& question = of.at("questions").at(q);
    const std::string place = what + ", " + questions[q].name;
    expect(text_of(question, "question") == questions[q].name, place + " is not there");
    expect(number(question, "asked") <= number(of, "pairs"), place + ": asked of more pairs");
    expect_falling(question, {"asked", "differs", "sign", "outcome", "verdict"}, place);
    expect_falling(question, {"sign", "zero_on_one_side"}, place);
    expect(sum_of(question.at("band")) == number(question, "sign"), place + ": the counts of the band do not add up");
    for (const char* largest : {"largest_in_bounds", "largest_length"})
      expect(question.at(largest).get<double>() >= 0, place + ": " + largest);
    expect(question.at("values").size() == questions[q].of.size(), place + ": other values");
    for (const Json& value : question.at("values")) {
      const std::uint64_t compared = number(value, "compared"), equal = number(value, "equal");
      expect(compared == number(question, "asked"), place + ": compared is not asked");
      expect(equal + number(value, "zero_sign") + number(value, "not_finite") + sum_of(value.at("below")) +
                     sum_of(value.at("above")) ==
                 compared,
             place + ": the counts of differences do not add up");
      for (const char* errors : {"first_error", "second_error"})
        expect(sum_of(value.at(errors)) == compared, place + ": " + errors + " does not add up");
      expect(sum_of(value.at("nearer")) == compared - equal, place + ": the counts of nearer values do not add up");
    }
  }
}

// Adds the numbers of `some` to those at the same places of `to`. Fields named "largest…" keep the larger value.
void add(Json& to, const Json& some, const std::string& key = "") {
  if (some.is_number_float() || key.starts_with("largest")) {
    to = std::max(to.is_null() ? 0.0 : to.get<double>(), some.get<double>());
  } else if (some.is_number()) {
    to = (to.is_null() ? 0 : to.get<std::uint64_t>()) + some.get<std::uint64_t>();
  } else if (some.is_array()) {
    for (std::size_t i = 0; i < some.size(); ++i) add(to[i], some[i]);
  } else if (some.is_object()) {
    if (to.is_null()) to = Json::object();
    for (const auto& [name, part] : some.items()) add(to[name], part, name);
  } else {
    to = some;
  }
}

}  // namespace

void expect_possible_discrepancy(const Json& json) {
  expect(!json.at("lanes").empty(), "no lanes");
  for (const Json& of : json.at("lanes")) {
    const Lane* lanes[2] = {find_lane(text_of(of, "first")), find_lane(text_of(of, "second"))};
    expect(lanes[0] && lanes[1] && lanes[0]->algorithm >= 0 && lanes[0]->algorithm == lanes[1]->algorithm &&
               lanes[0]->scalar == lanes[1]->scalar,
           "not two lanes of one published algorithm and scalar");
    const std::vector<Question>& questions = questions_of(lanes[0]->algorithm);
    Json sum;
    for (const auto& [stratum, counts] : of.at("strata").items()) {
      expect_possible_counts(counts, questions, text_of(of, "second") + ", " + stratum);
      add(sum, counts);
    }
    expect(nlohmann::json(sum) == nlohmann::json(of.at("total")),
           text_of(of, "second") + ": the total is not that of the strata");
  }
}

std::string discrepancy_page(const Json& json) {
  std::string text = page_head("Graze: CPU against GPU, value by value", kDiscrepancyStyle);
  text += "<h1>CPU against GPU, value by value</h1>\n<ol>\n";
  for (const std::string& sentence : discrepancy_answer(json)) text += "<li>" + html(sentence) + "</li>\n";
  text += fmt::format(
      "</ol>\n<p>{} pairs of triangles for each pair of lanes, seed {}. All counts are in "
      "discrepancy.json and discrepancy.csv.</p>\n",
      grouped(number(json, "pairs")), number(json, "seed"));
  const std::vector<const Json*> lanes = differing(json);
  for (const Json& of : json.at("lanes")) text += comparison_section(of, lanes.size() == 1 && &of == lanes[0]);
  return text + "</body>\n</html>\n";
}

}  // namespace graze::reports
