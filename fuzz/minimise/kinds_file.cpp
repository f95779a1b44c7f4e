// SPDX-License-Identifier: Apache-2.0
// Reads and writes failures.json. A file that is read must agree with the summary and the cases beside it.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "analysis/lane_trace.h"
#include "analysis/signature.h"
#include "backends/backends.h"
#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/lanes/verdicts.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/sealed.h"
#include "subjects/subjects.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// Thrown if failures.json has an impossible entry; what() describes it.
struct Impossible : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void expect(bool possible, const std::string& found) {
  if (!possible) throw Impossible(found);
}

// A signature in the summary, and its case file, whose first pair determines the signature's kinds.
struct Case {
  std::string key, file;
  std::uint64_t pairs = 0;
  analysis::Signature signature, of_first;
  std::vector<corpus::Entry> entries;
};

Case read_case(const fs::path& directory, const Json& row) {
  Case c{row.at("key"),
         row.at("case"),
         row.at("count"),
         {},
         {},
         corpus::read_pairs(case_file(directory, row), PairTypes::both)};
  if (c.entries.empty()) throw wrong_cases(directory, row, "it has no case");
  for (corpus::Entry& entry : c.entries) entry.written.clear();  // to save memory
  const auto signature = analysis::parse_signature(c.key),
             of_first = analysis::parse_signature(corpus::text_of(c.entries.front(), "signature"));
  if (!signature || !of_first) throw wrong_cases(directory, row, "its first line has another signature");
  c.signature = *signature;
  c.of_first = *of_first;
  return c;
}

// The data against which kinds are checked.
struct Known {
  std::vector<Case> cases;          // by index in the summary
  std::set<std::string> lanes;      // lanes that were examined
  std::map<std::string, bool> own;  // lanes with a reason whenever they are wrong; true if audited
};

Known known_of(const fs::path& directory, const Json& summary, const Json& lanes) {
  Known known;
  const Json &rows = summary.at("signatures"), &ran = summary.at("spec").at("lanes");
  for (const std::string id : lanes) {
    expect(std::find(ran.begin(), ran.end(), id) != ran.end(), "the lane " + shown(id) + ", which the campaign lacks");
    expect(known.lanes.insert(id).second, "the lane " + id + " twice");
    const Lane* lane = find_lane(id);
    if (lane && !lane->foreign && !lane->exact && backends::on_host(*lane)) known.own[id] = lane->explainable;
  }
  known.cases.resize(rows.size());
  tbb::parallel_for(std::size_t{0}, rows.size(),
                    [&](std::size_t i) { known.cases[i] = read_case(directory, rows[i]); });
  return known;
}

// Throws: Json::exception if a kind lacks a field, or a field has the wrong type.
void expect_shape(const Json& kind) {
  using Texts = std::map<std::string, std::string>;
  for (const char* field : {"key", "subject", "cause", "line", "shape"}) kind.at(field).get_ref<const std::string&>();
  for (const char* field : {"pairs", "intersecting", "signatures"})
    kind.at(field).get_ref<const Json::number_unsigned_t&>();
  for (const char* field : {"strata", "margins"}) {
    for (const auto& [name, count] : kind.at(field).get_ref<const Json::object_t&>())
      count.get_ref<const Json::number_unsigned_t&>();
  }
  for (const char* field : {"places", "settled"}) {
    for (const Json& count : kind.at(field).get_ref<const Json::array_t&>())
      count.get_ref<const Json::number_unsigned_t&>();
  }
  kind.at("lanes").get<std::vector<std::string>>();
  for (const char* which : {"simplest", "worst"}) {
    for (const char* field : {"case", "pair", "from"}) kind.at(which).at(field).get_ref<const std::string&>();
  }
  for (const char* field : {"lanes", "sentences"}) kind.at("simplest").at(field).get<std::vector<std::string>>();
  kind.at("simplest").at("sentences").at(0);
  kind.at("simplest").at("verdicts").get<Texts>();
  kind.at("worst").at("margin_ulps").get<double>();
}

// Checks the kind's counts over its signatures, and the properties that the signatures share.
void expect_places(const Known& known, const Json& kind) {
  using Counts = std::map<std::string, std::uint64_t>;
  const auto places = kind.at("places").get<std::vector<std::uint64_t>>();
  expect(!places.empty() && places.back() < known.cases.size() &&
             std::adjacent_find(places.begin(), places.end(), std::greater_equal<>()) == places.end(),
         "places that are not the ascending indices of signatures");
  const std::string subject = kind.at("subject"), shape = kind.at("shape");
  std::uint64_t pairs = 0, intersecting = 0;
  Counts margins, strata;
  for (const std::uint64_t place : places) {
    const Case& c = known.cases[place];
    expect(c.signature.subject == subject && shape_name(c.signature) == shape,
           "a kind with a signature of another subject or shape: " + c.key);
    pairs += c.pairs;
    if (c.signature.contact != Contact::none) intersecting += c.pairs;
    margins[name_of_bucket(c.signature.bucket)] += c.pairs;
    for (const corpus::Entry& entry : c.entries) {
      if (const std::string* stratum = corpus::field(entry, "stratum")) ++strata[*stratum];
    }
  }
  expect(kind.at("pairs") == pairs, fmt::format("a kind with {} pairs instead of {}", kind["pairs"].dump(), pairs));
  expect(kind.at("intersecting") == intersecting,
         fmt::format("a kind with {} pairs that intersect instead of {}", kind["intersecting"].dump(), intersecting));
  expect(kind.at("signatures") == places.size(),
         fmt::format("a kind with {} signatures instead of {}", kind["signatures"].dump(), places.size()));
  expect(kind.at("margins").get<Counts>() == margins, "a kind whose margins are not those of its signatures");
  expect(kind.at("strata").get<Counts>() == strata, "a kind whose strata are not those of its cases");
  const LaneReason reason{nullptr, kind.at("cause"), kind.at("line"), false, false};
  expect(kind.at("key") == kind_key(subject, reason, shape), "a kind whose key differs from its fields");
}

void expect_lanes(const Known& known, const Json& kind) {
  const Json& lanes = kind.at("lanes");
  for (const std::string id : lanes) {
    const auto name = parse_lane_name(id);
    expect(name && name->subject == kind.at("subject").get_ref<const std::string&>() && known.lanes.contains(id),
           "the lane " + shown(id) + ", which is not an examined lane of its subject");
  }
  const auto settled = kind.at("settled").get<std::array<std::uint64_t, 2>>();
  const std::uint64_t most = kind.at("signatures").get<std::uint64_t>() * lanes.size();
  expect(kind["settled"].size() == 2 && settled[0] <= settled[1] && settled[1] <= most,
         fmt::format("the counts {} of settled causes, for at most {} lanes", kind["settled"].dump(), most));
  const auto all = lanes.get<std::set<std::string>>(),
             own = kind.at("simplest").at("lanes").get<std::set<std::string>>();
  expect(all.size() == lanes.size() && !own.empty() && own.size() == kind["simplest"]["lanes"].size() &&
             std::includes(all.begin(), all.end(), own.begin(), own.end()),
         "a kind without lanes, with a lane twice, or with other lanes on its simplest pair");
}

// Checks that the subject's lanes have the verdicts of the case's first signature, and that exact lanes have the truth.
void expect_verdicts(const Known& known, const Json& verdicts, const Case& c) {
  expect(verdicts.size() == known.lanes.size(), "verdicts that are not those of the examined lanes");
  const corpus::Entry& first = c.entries.front();
  for (const auto& [id, said] : verdicts.items()) {
    expect(known.lanes.contains(id), "a verdict of the lane " + shown(id) + ", which was not examined");
    const std::optional<Verdict> verdict = verdict_named(said.get<std::string>());
    expect(verdict.has_value(), "no verdict of " + id);
    const LaneName lane = parse_lane_name(id).value();
    const char mark = c.of_first.mark_of(lane.within_subject());
    const bool told = known.own.contains(id) && lane.subject == c.of_first.subject &&
                      (mark != '.' || !corpus::field(first, "kind"));  // a result may cover only some lanes
    const Lane* row = find_lane(id);
    const bool is_truth = row && analysis::is_never_wrong(*row, corpus::pair_of(first));
    expect((!told || analysis::mark(*verdict, truth_of(first)) == mark) && (!is_truth || *verdict == truth_of(first)),
           "a different verdict of " + id + " on " + corpus::origin_of(first));
  }
}

// Checks that the simplest and the worst pair belong to cases of the kind.
void expect_pairs(const Known& known, const Json& kind) {
  const auto case_of = [&](const Json& shown) -> const Case& {
    for (const std::uint64_t place : kind.at("places")) {
      if (known.cases[place].file == shown.at("case").get_ref<const std::string&>()) return known.cases[place];
    }
    throw Impossible("the case " + graze::shown(shown.at("case").get<std::string>()) +
                     ", which belongs to none of the kind's signatures");
  };
  const auto is_shown = [](const Json& shown, const corpus::Entry& entry) {
    return pair_text(corpus::pair_of(entry)) == shown.at("pair").get<std::string>() &&
           corpus::origin_of(entry) == shown.at("from").get<std::string>();
  };
  const Case &simplest = case_of(kind.at("simplest")), &worst = case_of(kind.at("worst"));
  expect(is_shown(kind["simplest"], simplest.entries.front()), "a simplest pair that is not the first of its case");
  expect_verdicts(known, kind["simplest"].at("verdicts"), simplest);
  expect(std::any_of(worst.entries.begin(), worst.entries.end(),
                     [&](const corpus::Entry& entry) {
                       const double ulps = std::strtod(corpus::text_of(entry, "margin_ulps").c_str(), nullptr);
                       return is_shown(kind["worst"], entry) && kind["worst"].at("margin_ulps") == ulps;
                     }),
         "a worst pair that is not in its case file");
}

// Checks that each lane of `own` that is wrong on a signature's first pair is in a kind with that signature. Also
// checks that the kinds have at least as many audited reasons as there are wrong lanes on first pairs.
void expect_all_covered(const Known& known, const Json& kinds) {
  std::vector<std::set<std::string>> covered(known.cases.size());
  std::map<std::string, std::uint64_t> told, least;  // audited reasons, by subject
  for (const Json& kind : kinds) {
    told[kind.at("subject")] += kind.at("settled").at(1).get<std::uint64_t>();
    for (const std::uint64_t place : kind.at("places")) {
      for (const std::string lane : kind.at("lanes")) covered[place].insert(lane);
    }
  }
  for (std::size_t place = 0; place < known.cases.size(); ++place) {
    const analysis::Signature& first = known.cases[place].of_first;
    for (const analysis::WrongLane& wrong : first.wrong_lanes) {
      const std::string id = first.subject + '/' + wrong.lane;
      const auto own = known.own.find(id);
      if (own == known.own.end()) continue;
      expect(covered[place].contains(id), "no kind with " + id + " for the signature " + known.cases[place].key);
      least[first.subject] += own->second;
    }
  }
  for (const auto& [subject, lanes] : least)
    expect(told[subject] >= lanes,
           fmt::format("kinds of {} with {} wrong lanes instead of at least {}", subject, told[subject], lanes));
}

void expect_possible(const Known& known, const Json& kinds) {
  std::set<std::string> keys;
  const Json* before = nullptr;
  for (const Json& kind : kinds.get_ref<const Json::array_t&>()) {
    expect_shape(kind);
    expect_places(known, kind);
    expect_lanes(known, kind);
    expect_pairs(known, kind);
    expect(keys.insert(kind["key"]).second, "a kind twice: " + kind["key"].get<std::string>());
    expect(!before || (*before)["pairs"] > kind["pairs"] ||
               ((*before)["pairs"] == kind["pairs"] && (*before)["key"] < kind["key"]),
           "kinds that are not sorted by number of pairs");
    before = &kind;
  }
  expect_all_covered(known, kinds);
}

std::string hash_of_summary(const fs::path& directory) {
  return fmt::format("{:016x}", fnv1a(read_whole(directory / "summary.json")));
}

// The campaign's summary. If the file is not JSON, reading a field of it throws Json::exception.
Json summary_in(const fs::path& directory) { return parse_shallow(read_whole(directory / "summary.json")); }

// The hash of the current case files of all signatures.
std::string hash_of_cases(const fs::path& directory, const Json& summary) {
  std::uint64_t hash = fnv1a("");
  for (const Json& row : summary.at("signatures")) hash = fnv1a(read_whole(case_file(directory, row)), hash);
  return fmt::format("{:016x}", hash);
}

}  // namespace

Json read_kinds(const fs::path& directory) {
  const fs::path file = directory / "failures.json";
  const std::string remedy = "remove it, then run: graze minimize " + path_word(directory.string());
  const auto refused = [&](const std::string& why) {
    return corpus::FormatError(cannot("use", file, why + "; " + remedy));
  };
  const Json stored = read_sealed(file, remedy);
  if (stored.is_null()) return nullptr;
  try {
    const std::string of_summary = stored.at("summary"), of_cases = stored.at("cases");
    if (of_summary != hash_of_summary(directory)) return nullptr;
    const Json summary = summary_in(directory);
    if (of_cases != hash_of_cases(directory, summary)) return nullptr;
    expect_possible(known_of(directory, summary, stored.at("lanes").get_ref<const Json::array_t&>()),
                    stored.at("kinds"));
    return stored["kinds"];
  } catch (const Json::exception&) {
    throw refused("it is damaged");
  } catch (const Impossible& error) {
    throw refused(std::string("it contradicts the summary or the cases: it has ") + error.what());
  }
}

Json kinds_of(const fs::path& directory, const Json& summary, const std::function<bool()>& stop) {
  Json kinds = read_kinds(directory);
  if (!kinds.is_null()) return kinds;
  const auto lanes = summary.at("spec").at("lanes").get<std::vector<std::string>>();
  subjects::open_recorded(summary.at("spec"));
  const SelectedLanes under_test = select_lanes(lanes, Executor::twin);
  kinds = find_kinds(under_test, directory, summary, stop);
  try {
    if (!kinds.is_null()) write_kinds(directory, under_test, kinds);
  } catch (const std::runtime_error&) {  // if the folder is read-only, the kinds are found again each time
  }
  return kinds;
}

void write_kinds(const fs::path& directory, const SelectedLanes& under_test, const Json& kinds) {
  Json lanes = Json::array();
  for (const Lane* lane : under_test.lanes) lanes.push_back(lane->id);
  const Json stored = {{"summary", hash_of_summary(directory)},
                       {"cases", hash_of_cases(directory, summary_in(directory))},
                       {"lanes", lanes},
                       {"kinds", kinds}};
  write_whole(directory / "failures.json", sealed(stored).dump(1) + "\n");
}

std::size_t signatures_without_kind(const Json& summary, const Json& kinds) {
  std::set<std::size_t> places;
  for (const Json& kind : kinds) {
    for (const Json& place : kind.at("places")) places.insert(place.get<std::size_t>());
  }
  return summary.at("signatures").size() - places.size();
}

}  // namespace graze::fuzz
