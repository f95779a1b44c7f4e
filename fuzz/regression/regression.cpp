// SPDX-License-Identifier: Apache-2.0
#include "fuzz/regression/regression.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "analysis/lane_trace.h"
#include "analysis/signature.h"
#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "core/whole.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/files.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {
namespace {

constexpr CaseState kStates[] = {CaseState::failing, CaseState::fixed, CaseState::flaky};
constexpr std::string_view kOwnFields[] = {"name",      "truth", "contact", "state", "count",
                                           "signature", "lanes", "first",   "last",  "coordinates"};

constexpr std::string_view kMarks = ".+-?!@%~";

// "moller_1997:-f32/cpu.f64/cpu;projected_sat:.f32/cpu": each subject with its lanes, each preceded by its mark.
std::string text_of(const Marks& marks) {
  std::string text, last;
  for (const auto& [id, mark] : marks) {
    const LaneName name = parse_lane_name(id).value();
    if (name.subject != last) text += (text.empty() ? "" : ";") + name.subject + ':';
    text += mark + name.within_subject() + ',';
    last = name.subject;
  }
  return text;
}

// Reads the fields of one line of the file; each error names the line.
struct Line {
  const corpus::Entry& entry;
  std::string where;

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw corpus::FormatError(fmt::format("{}: expected {}, found {}", where, expected, found));
  }

  const std::string& text(std::string_view key) const {
    const std::string* value = corpus::field(entry, key);
    if (!value) fail(fmt::format("a field {}", key), "none");
    return *value;
  }

  CaseState state() const {
    const std::string& word = text("state");
    for (const CaseState state : kStates) {
      if (word == name(state)) return state;
    }
    fail("a state (failing, fixed or flaky)", '\'' + word + '\'');
  }

  std::uint64_t count() const {
    const std::string& word = text("count");
    const std::optional<std::uint64_t> value = parse_whole(word);
    if (!value || *value == 0 || *value > kMostWhole) fail("a positive whole number as count", '\'' + word + '\'');
    return *value;
  }

  // Lanes that the line does not name did not run. Lanes of other builds are kept.
  Marks marks() const {
    Marks marks;
    std::istringstream subjects(text("lanes"));
    for (std::string subject; std::getline(subjects, subject, ';');) {
      const std::string id = subject.substr(0, subject.find(':'));
      std::string_view rest = std::string_view(subject).substr(std::min(id.size() + 1, subject.size()));
      if (rest.empty()) fail("a subject and the marks of its lanes in the field lanes", '\'' + subject + '\'');
      while (!rest.empty()) {
        std::size_t end = rest.find(',');  // a lane ends at the end of the text, or at a comma before a mark
        while (end != rest.npos && end + 1 < rest.size() && kMarks.find(rest[end + 1]) == kMarks.npos)
          end = rest.find(',', end + 1);
        const std::string lane = id + '/' + std::string(rest.substr(1, end == rest.npos ? end : end - 1));
        if (kMarks.find(rest.front()) == kMarks.npos || end == rest.npos || !parse_lane_name(lane))
          fail("a mark and a lane of " + id + " in the field lanes", '\'' + std::string(rest) + '\'');
        if (!marks.emplace(lane, rest.front()).second) fail("each lane only once in lanes", "a second " + lane);
        rest.remove_prefix(end + 1);
      }
    }
    if (marks.empty()) fail("at least one marked lane in lanes", "none");
    return marks;
  }
};

std::string verdict_of_mark(char mark, std::string_view truth) {
  switch (mark) {
    case '.':
      return fmt::format("{} (right)", truth);
    case '+':
      return "intersects (wrong)";
    case '-':
      return "disjoint (wrong)";
    case '?':
      return "declined";
    case '!':
      return "crashed (wrong)";
    case '@':
      return "timed out (wrong)";
    case '%':
      return "unstable (wrong)";
    default:
      return "different in each replay";
  }
}

}  // namespace

std::string_view name(CaseState state) {
  constexpr std::string_view kNames[] = {"failing", "fixed", "flaky"};
  return kNames[static_cast<int>(state)];
}

std::vector<std::pair<std::string, std::string>> other_fields(const corpus::Entry& entry) {
  std::vector<std::pair<std::string, std::string>> others;
  for (const auto& own : entry.fields) {
    if (std::find(std::begin(kOwnFields), std::end(kOwnFields), own.first) == std::end(kOwnFields))
      others.push_back(own);
  }
  return others;
}

std::string case_name(const std::string& signature) {
  return fmt::format("{}_{:016x}", analysis::subject_of(signature), fnv1a(signature));
}

RegressionCorpus read_regressions(const std::filesystem::path& file) {
  if (const std::string text = read_whole(file); !text.empty() && text.back() != '\n')
    throw corpus::FormatError(cannot("use", file, "it is cut off: its last line does not end"));
  RegressionCorpus corpus;
  for (const corpus::Entry& entry : corpus::read_pairs(file, PairTypes::both)) {
    const Line line{entry, fmt::format("{}:{}", file.string(), entry.line)};
    RegressionCase c{line.text("name"), corpus::pair_of(entry), line.text("truth"), line.text("contact"), line.state(),
                     line.count(),      line.marks(),           line.text("first"), line.text("last")};
    c.other = other_fields(entry);
    const std::string& signature = line.text("signature");
    if (!analysis::parse_signature(signature)) line.fail("the signature of a failure", '\'' + signature + '\'');
    if (const std::string own = case_name(signature); c.name != own)
      line.fail(fmt::format("{}, the name that belongs to its signature", own), '\'' + c.name + '\'');
    if (!corpus.emplace(signature, std::move(c)).second) line.fail("each signature only once", "a second " + signature);
  }
  return corpus;
}

void write_regressions(const std::filesystem::path& file, const RegressionCorpus& corpus) {
  std::ostringstream out;
  corpus::write_header(out);
  out << "# Kept by `graze corpus`: one case for each signature, ordered by it. lanes: the marks of the last replay.\n";
  for (const auto& [signature, c] : corpus) {
    corpus::Entry entry = corpus::entry_of(c.pair, {{"name", c.name},
                                                    {"truth", c.truth},
                                                    {"contact", c.contact},
                                                    {"state", std::string(name(c.state))},
                                                    {"count", std::to_string(c.count)},
                                                    {"signature", signature},
                                                    {"lanes", text_of(c.marks)},
                                                    {"first", c.first},
                                                    {"last", c.last}});
    entry.fields.insert(entry.fields.end(), c.other.begin(), c.other.end());
    corpus::write_entry(out, entry);
  }
  write_whole(file, out.str());
}

Replay replay(const AnyPair& pair, std::span<const Lane* const> run, const DecideLanes& decide) {
  Replay result{oracle::truth(pair), {}};
  for (int r = 0; r < kReplays; ++r) {
    std::vector<const Lane*> apart;
    const std::vector<Verdict> verdicts = decide(pair, apart);
    for (std::size_t l = 0; l < run.size(); ++l) {
      if (!takes(*run[l], pair)) continue;
      const char now = analysis::mark(verdicts[l], result.truth.verdict);
      char& known = result.marks.emplace(run[l]->id, now).first->second;
      if (known != now) known = '~';
    }
    for (const Lane* lane : apart) {
      if (takes(*lane, pair)) result.marks[lane->id] = '~';
    }
  }
  return result;
}

CaseState state_after(CaseState before, const std::string& signature, const Marks& now) {
  const auto differed = [](const auto& lane) { return lane.second == '~'; };
  if (before == CaseState::flaky || std::any_of(now.begin(), now.end(), differed)) return CaseState::flaky;
  const std::optional<analysis::Signature> seen = analysis::parse_signature(signature);
  if (!seen) return before;
  bool ran = false;
  for (const auto& [id, mark] : now) {
    if (parse_lane_name(id)->subject != seen->subject) continue;
    if (mark != '.') return CaseState::failing;
    ran = true;
  }
  const bool all_ran = std::all_of(seen->wrong_lanes.begin(), seen->wrong_lanes.end(),
                                   [&](const auto& wrong) { return now.contains(seen->subject + '/' + wrong.lane); });
  return ran && all_ran ? CaseState::fixed : before;
}

Verified verify(RegressionCorpus& corpus, std::span<const Lane* const> run, const DecideLanes& decide) {
  Verified result;
  for (auto& [signature, c] : corpus) {
    const auto change = [&, &who = c.name](const std::string& what) { result.changes.push_back({who, what}); };
    Replay now = replay(c.pair, run, decide);
    const std::string truth_now(name(now.truth.verdict)), contact_now(name(now.truth.contact));
    if (c.truth != truth_now || c.contact != contact_now)
      change(fmt::format("truth: was {}, {}, is {}, {}", c.truth, c.contact, truth_now, contact_now));
    for (const Lane* lane : run) {
      if (!takes(*lane, c.pair)) continue;
      const char mark_now = now.marks.at(lane->id);
      const auto known = c.marks.find(lane->id);
      const bool recorded = known != c.marks.end(), never_wrong = analysis::is_never_wrong(*lane, c.pair);
      if (recorded && known->second == '~' && !never_wrong) continue;
      if (recorded || never_wrong) {  // without a record, a lane that is never wrong is compared with the truth
        ++result.compared;
        const std::string was = recorded ? verdict_of_mark(known->second, c.truth) : verdict_of_mark('.', truth_now);
        const std::string is = verdict_of_mark(mark_now, truth_now);
        if (was != is) change(fmt::format("{}: was {}, is {}", lane->id, was, is));
      }
      c.marks[lane->id] = mark_now;
    }
    c.truth = truth_now;
    c.contact = contact_now;
    const CaseState state = state_after(c.state, signature, now.marks);
    if (state != c.state) change(fmt::format("{} -> {}", name(c.state), name(state)));
    c.state = state;
  }
  return result;
}

}  // namespace graze::fuzz
