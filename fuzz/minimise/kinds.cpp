// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/kinds.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "analysis/explain.h"
#include "analysis/signature.h"
#include "backends/backends.h"
#include "core/simplify/simplicity.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/minimised_cases.h"
#include "subjects/subjects.h"

namespace graze::fuzz {
namespace {

// A signature's case file: its pairs, and the reasons why lanes are wrong on the pair shown to users.
struct Case {
  analysis::Signature signature;
  std::string file;
  std::uint64_t pairs;
  std::vector<corpus::Entry> entries;
  std::vector<LaneReason> reasons;

  const corpus::Entry& shown() const { return entries.front(); }
  AnyPair shown_pair() const { return corpus::pair_of(shown()); }
  bool intersects() const { return signature.contact != Contact::none; }
};

Case read_case(const SelectedLanes& under_test, const Json& spec, const std::filesystem::path& directory,
               const Json& row) {
  const auto signature = analysis::parse_signature(row.at("key").get<std::string>());
  if (!signature)
    throw corpus::FormatError((directory / "summary.json").string() + ": expected the key of a signature, found " +
                              row.at("key").dump());
  Case c{*signature, row.at("case"), row.at("count"), {}, {}};
  c.entries = checked_cases(under_test, spec, directory, row);
  for (corpus::Entry& entry : c.entries) entry.written.clear();  // to save memory
  c.reasons = reasons_of(under_test, c.signature.subject, c.shown_pair(), truth_of(c.shown()));
  return c;
}

struct Kind {
  std::string key, subject, cause, line;
  std::string_view shape;
  std::uint64_t pairs = 0, intersecting = 0;  // intersecting: those on which a wrong verdict is a false negative
  std::array<std::uint64_t, 2> settled{};     // [0] settled reasons, [1] audited reasons

  bool is_rarer(const Case& c) const {  // whether the case's truth is the rarer one among the kind's pairs
    return c.intersects() ? 2 * intersecting < pairs : 2 * intersecting > pairs;
  }
  std::vector<std::size_t> places;
};

std::vector<Kind> grouped(const std::vector<Case>& cases) {
  std::map<std::string, Kind> kinds;
  for (std::size_t place = 0; place < cases.size(); ++place) {
    const Case& c = cases[place];
    for (const LaneReason& reason : c.reasons) {
      const std::string key = kind_key(c.signature.subject, reason, shape_name(c.signature));
      Kind& kind =
          kinds
              .try_emplace(
                  key, Kind{key, c.signature.subject, reason.cause, reason.line, shape_name(c.signature), 0, 0, {}, {}})
              .first->second;
      kind.settled[0] += reason.audited && reason.settled;
      kind.settled[1] += reason.audited;
      if (!kind.places.empty() && kind.places.back() == place) continue;
      kind.places.push_back(place);
      kind.pairs += c.pairs;
      if (c.intersects()) kind.intersecting += c.pairs;
    }
  }
  std::vector<Kind> result;
  for (auto& [key, kind] : kinds) result.push_back(std::move(kind));
  std::stable_sort(result.begin(), result.end(), [](const Kind& l, const Kind& r) { return l.pairs > r.pairs; });
  return result;
}

bool is_of(const Kind& kind, const Case& c, const LaneReason& reason) {
  return kind_key(c.signature.subject, reason, shape_name(c.signature)) == kind.key;
}

// The index of the case whose pair shows the kind best. The criteria, in order of priority: no lane is wrong on it for
// another reason; it has the kind's commoner error; its reasons are settled; no earlier kind shows it; it is simplest.
std::size_t simplest_of(const Kind& kind, const std::vector<Case>& cases, std::set<std::string>& shown) {
  const auto rank = [&](std::size_t place) {
    const Case& c = cases[place];
    const AnyPair pair = c.shown_pair();
    const bool mixed = !std::all_of(c.reasons.begin(), c.reasons.end(),
                                    [&](const LaneReason& reason) { return is_of(kind, c, reason); });
    const bool open = std::any_of(c.reasons.begin(), c.reasons.end(),
                                  [&](const LaneReason& reason) { return is_of(kind, c, reason) && !reason.settled; });
    return std::tuple(mixed, kind.is_rarer(c), open, shown.contains(pair_text(pair)), simplicity(pair));
  };
  const std::size_t best = *std::min_element(kind.places.begin(), kind.places.end(),
                                             [&](std::size_t l, std::size_t r) { return rank(l) < rank(r); });
  shown.insert(pair_text(cases[best].shown_pair()));
  return best;
}

double ulps_of(const corpus::Entry& entry) {
  const std::string text = corpus::text_of(entry, "margin_ulps");
  return text.empty() ? 0 : std::abs(std::strtod(text.c_str(), nullptr));
}

// The pair shown to users, with all lanes' verdicts and the reasons why the kind's lanes are wrong.
Json simplest_pair(const SelectedLanes& under_test, const Kind& kind, const Case& c) {
  std::vector<const Lane*> apart;
  const std::vector<Verdict> verdicts = decide(under_test, c.shown_pair(), apart);
  if (!apart.empty()) throw std::runtime_error(apart.front()->id + ": the verdicts of the device and the twin differ");
  Json result = {{"case", c.file},         {"pair", pair_text(c.shown_pair())}, {"from", corpus::origin_of(c.shown())},
                 {"lanes", Json::array()}, {"verdicts", Json::object()},        {"sentences", Json::array()}};
  std::vector<const Lane*> own, others;
  for (const LaneReason& reason : c.reasons) {
    const bool is_own = is_of(kind, c, reason);
    (is_own ? own : others).push_back(reason.lane);
    if (is_own) result["lanes"].push_back(reason.lane->id);
  }
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l)
    result["verdicts"][under_test.lanes[l]->id] = name(verdicts[l]);
  Json& sentences = result["sentences"];
  const auto tell = [&](const std::vector<const Lane*>& some) {
    for (const std::string& text : analysis::sentences(analysis::explain(c.shown_pair(), some)))
      sentences.push_back(text);
  };
  tell(own);
  if (sentences.empty())
    sentences.push_back(fmt::format(
        "{} failed on this pair, but not when it was run again: its verdicts change from one call to the next.",
        kind.subject));
  tell(others);
  return result;
}

Json worst_pair(const SelectedLanes& under_test, const Kind& kind, const std::vector<Case>& cases,
                const Case& simplest) {
  struct Candidate {
    const Case* of;
    const corpus::Entry* entry;
    double ulps;
  };
  std::vector<Candidate> candidates;
  for (const std::size_t place : kind.places) {
    for (const corpus::Entry& entry : cases[place].entries)
      candidates.push_back({&cases[place], &entry, ulps_of(entry)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& l, const Candidate& r) { return l.ulps > r.ulps; });
  candidates.resize(std::min(candidates.size(), kMostLookedAt));
  candidates.push_back({&simplest, &simplest.shown(), ulps_of(simplest.shown())});
  // The last candidate, the simplest pair, is known to belong to the kind. It is not examined again, because code whose
  // verdicts change between calls could give another result.
  const auto worst = std::find_if(candidates.begin(), candidates.end() - 1, [&](const Candidate& candidate) {
    const std::vector<LaneReason> reasons =
        reasons_of(under_test, kind.subject, corpus::pair_of(*candidate.entry), truth_of(*candidate.entry));
    return std::any_of(reasons.begin(), reasons.end(), [&](const auto& r) { return is_of(kind, *candidate.of, r); });
  });
  return {{"case", worst->of->file},
          {"pair", pair_text(corpus::pair_of(*worst->entry))},
          {"from", corpus::origin_of(*worst->entry)},
          {"margin_ulps", std::strtod(corpus::text_of(*worst->entry, "margin_ulps").c_str(), nullptr)}};
}

Json row_of(const SelectedLanes& under_test, const Kind& kind, const std::vector<Case>& cases, std::size_t simplest) {
  std::set<const Lane*> lanes;
  std::map<std::string, std::uint64_t> strata;
  std::map<Bucket, std::uint64_t> margins;
  for (const std::size_t place : kind.places) {
    const Case& c = cases[place];
    margins[c.signature.bucket] += c.pairs;
    for (const LaneReason& reason : c.reasons) {
      if (is_of(kind, c, reason)) lanes.insert(reason.lane);
    }
    for (const corpus::Entry& entry : c.entries) {
      if (const std::string* stratum = corpus::field(entry, "stratum")) ++strata[*stratum];
    }
  }
  Json ids = Json::array(), margin_rows = Json::object();
  for (const Lane* lane : under_test.lanes) {
    if (lanes.contains(lane)) ids.push_back(lane->id);
  }
  for (const auto& [bucket, pairs] : margins) margin_rows[name_of_bucket(bucket)] = pairs;
  return {{"key", kind.key},
          {"subject", kind.subject},
          {"cause", kind.cause},
          {"line", kind.line},
          {"shape", kind.shape},
          {"pairs", kind.pairs},
          {"intersecting", kind.intersecting},
          {"signatures", kind.places.size()},
          {"lanes", ids},
          {"settled", kind.settled},
          {"strata", strata},
          {"margins", margin_rows},
          {"places", kind.places},
          {"simplest", simplest_pair(under_test, kind, cases[simplest])},
          {"worst", worst_pair(under_test, kind, cases, cases[simplest])}};
}

}  // namespace

Verdict truth_of(const corpus::Entry& entry) {
  return corpus::text_of(entry, "truth") == name(Verdict::intersects) ? Verdict::intersects : Verdict::disjoint;
}

std::vector<LaneReason> reasons_of(const SelectedLanes& under_test, std::string_view subject, const AnyPair& pair,
                                   Verdict truth) {
  std::vector<const Lane*> lanes;
  std::copy_if(under_test.lanes.begin(), under_test.lanes.end(), std::back_inserter(lanes),
               [&](const Lane* lane) { return lane->info->id == subject && backends::on_host(*lane); });
  const std::vector<analysis::LaneExplanation> accounts = analysis::accounts(pair, truth, lanes);
  std::vector<LaneReason> result;
  for (const analysis::LaneExplanation& account : accounts) {
    const analysis::LaneExplanation* told = &account;
    if (account.evidence == analysis::Evidence::none && !account.lane->foreign &&
        account.cause != analysis::Cause::fast_math) {
      const Lane* source = counterpart(*account.lane, rounded_variant(account.lane->variant));
      const auto found = std::find_if(accounts.begin(), accounts.end(), [&](const auto& other) {
        return other.lane == source && other.verdict == account.verdict;
      });
      if (found != accounts.end()) told = &*found;
    }
    result.push_back({account.lane, std::string(analysis::name(told->cause)),
                      told->told() ? told->told()->line : account.line, account.settled == analysis::Settled::yes,
                      account.lane->explainable || account.lane->foreign});
  }
  return result;
}

std::string pair_text(const AnyPair& pair) {
  std::ostringstream out;
  corpus::write_entry(out, corpus::entry_of(pair, {}));
  const std::string line = out.str();
  return line.substr(0, line.find('\n'));
}

std::string_view shape_name(const Hulls& hulls, Nesting nesting) {
  if (hulls.dimension_a < 2 || hulls.dimension_b < 2) return "degenerate";
  if (!hulls.coplanar) return "general";
  return nesting == Nesting::none ? "coplanar" : "contained";
}

std::string_view shape_name(const analysis::Signature& signature) {
  return shape_name(signature.hulls, signature.nesting);
}

std::string kind_key(std::string_view subject, const LaneReason& reason, std::string_view shape) {
  std::string cause = reason.cause;
  std::replace(cause.begin(), cause.end(), ' ', '_');
  const std::string file = reason.line.substr(reason.line.rfind('/') + 1);
  return fmt::format("{}/{}/{}/{}", subject, cause, file.empty() ? "-" : file, shape);
}

Json find_kinds(const SelectedLanes& under_test, const std::filesystem::path& directory, const Json& summary,
                const std::function<bool()>& stop) {
  const Json& rows = summary.at("signatures");
  std::vector<Case> cases(rows.size());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    if (!stop()) cases[i] = read_case(under_test, summary.at("spec"), directory, rows[i]);
  });
  if (stop()) return nullptr;
  const std::vector<Kind> kinds = grouped(cases);
  std::set<std::string> shown;
  std::vector<std::size_t> simplest;
  for (const Kind& kind : kinds) simplest.push_back(simplest_of(kind, cases, shown));
  std::vector<Json> found(kinds.size());
  tbb::parallel_for(std::size_t{0}, kinds.size(), [&](std::size_t i) {
    if (!stop()) found[i] = row_of(under_test, kinds[i], cases, simplest[i]);
  });
  if (stop()) return nullptr;
  return Json(std::move(found));
}

}  // namespace graze::fuzz
