// SPDX-License-Identifier: Apache-2.0
#include "fuzz/regression/regression.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "analysis/signature.h"
#include "fuzz/campaign/result_files.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kLanesOfAlgorithm = 2 * kTargetCount;
constexpr CaseState kStates[] = {CaseState::failing, CaseState::fixed, CaseState::flaky};
constexpr std::string_view kOwnFields[] = {"name",      "truth", "contact", "state", "count",
                                           "signature", "lanes", "first",   "last"};

// "projected_sat:........,interval_overlap:--..--..": the marks by algorithm.
std::string text_of(const Marks& marks) {
  std::string text;
  for (std::size_t first = 0; first < marks.size(); first += kLanesOfAlgorithm) {
    text += fmt::format("{}{}:{}", first > 0 ? "," : "", published_lanes()[first].info->id,
                        marks.substr(first, kLanesOfAlgorithm));
  }
  return text;
}

// What a line of the file must hold, or an error that names it.
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
    const std::optional<std::uint64_t> value = corpus::parse_whole(word);
    if (!value) fail("a whole number as count", '\'' + word + '\'');
    return *value;
  }

  // An algorithm that the text does not name did not run; one that is none any more is an error.
  Marks marks() const {
    Marks marks(published_lanes().size(), '_');
    std::istringstream parts(text("lanes"));
    for (std::string part; std::getline(parts, part, ',');) {
      const std::string id = part.substr(0, part.find(':')), own = part.substr(std::min(id.size() + 1, part.size()));
      const auto lane = std::find_if(published_lanes().begin(), published_lanes().end(),
                                     [&](const Lane& l) { return l.info->id == id; });
      if (lane == published_lanes().end()) fail("an algorithm in lanes", '\'' + id + '\'');
      if (own.size() != kLanesOfAlgorithm || own.find_first_not_of(".+-?_~") != own.npos)
        fail(fmt::format("{} marks of {} in lanes", kLanesOfAlgorithm, id), '\'' + own + '\'');
      marks.replace(static_cast<std::size_t>(lane->index), kLanesOfAlgorithm, own);
    }
    return marks;
  }
};

// The lane's mark; null for an exact lane, which has none.
char* mark_of(Marks& marks, const Lane& lane) {
  return lane.is_exact() ? nullptr : &marks[static_cast<std::size_t>(lane.index)];
}

std::string verdict_of_mark(char mark, std::string_view truth) {
  switch (mark) {
    case '.':
      return fmt::format("{} (right)", truth);
    case '+':
      return "intersects (wrong)";
    case '-':
      return "disjoint (wrong)";
    case '?':
      return "declined (wrong)";
    default:
      return "another from replay to replay";
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

RegressionCorpus read_regressions(const std::filesystem::path& file) {
  RegressionCorpus corpus;
  for (const corpus::Entry& entry : corpus::read_pairs(file)) {
    const Line line{entry, fmt::format("{}:{}", file.string(), entry.line)};
    RegressionCase c{line.text("name"), entry.pair,   line.text("truth"), line.text("contact"), line.state(),
                     line.count(),      line.marks(), line.text("first"), line.text("last")};
    c.other = other_fields(entry);
    const std::string& signature = line.text("signature");
    if (std::none_of(published_lanes().begin(), published_lanes().end(),
                     [&](auto& l) { return l.info->id == analysis::algorithm_of(signature); }))
      line.fail("the signature of an algorithm's failure", '\'' + signature + '\'');
    if (!corpus.emplace(signature, std::move(c)).second) line.fail("every signature once", "a second " + signature);
  }
  return corpus;
}

void write_regressions(const std::filesystem::path& file, const RegressionCorpus& corpus) {
  std::ostringstream out;
  corpus::write_header(out);
  out << "# Kept by `graze corpus`: a case a signature, ordered by it. lanes: the marks of the last replay.\n";
  for (const auto& [signature, c] : corpus) {
    corpus::Entry entry{c.pair,
                        {{"name", c.name},
                         {"truth", c.truth},
                         {"contact", c.contact},
                         {"state", std::string(name(c.state))},
                         {"count", std::to_string(c.count)},
                         {"signature", signature},
                         {"lanes", text_of(c.marks)},
                         {"first", c.first},
                         {"last", c.last}},
                        0};
    entry.fields.insert(entry.fields.end(), c.other.begin(), c.other.end());
    corpus::write_entry(out, entry);
  }
  write_whole(file, out.str());
}

Replay replay(const Pair& pair, std::span<const Lane* const> run, const DecideLanes& decide) {
  Replay result{oracle::truth(pair), Marks(published_lanes().size(), '_')};
  for (int r = 0; r < kReplays; ++r) {
    std::vector<const Lane*> apart;
    const std::vector<Verdict> verdicts = decide(pair, apart);
    for (std::size_t l = 0; l < run.size(); ++l) {
      const char now = analysis::mark(verdicts[l], result.truth.verdict);
      if (char* known = mark_of(result.marks, *run[l])) *known = r == 0 || *known == now ? now : '~';
    }
    for (const Lane* lane : apart) {
      if (char* known = mark_of(result.marks, *lane)) *known = '~';
    }
  }
  return result;
}

CaseState state_after(CaseState before, const std::string& signature, const Marks& now) {
  if (before == CaseState::flaky || now.find('~') != now.npos) return CaseState::flaky;
  const std::string id = analysis::algorithm_of(signature), seen = signature.substr(signature.rfind(':') + 1);
  bool all_right = true;
  for (const Lane& lane : published_lanes()) {
    const char m = now[static_cast<std::size_t>(lane.index)];
    if (lane.info->id != id) continue;
    if (m != '.' && m != '_') return CaseState::failing;
    const std::size_t at = static_cast<std::size_t>(lane.scalar) * kTargetCount + static_cast<std::size_t>(lane.target);
    if (m == '_' && at < seen.size() && seen[at] != '.' && seen[at] != '_') all_right = false;
  }
  return all_right ? CaseState::fixed : before;
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
      char *known = mark_of(c.marks, *lane), *mark_now = mark_of(now.marks, *lane);
      if (!known || *known == '~') continue;
      if (*known != '_') {
        ++result.compared;
        const std::string was = verdict_of_mark(*known, c.truth), is = verdict_of_mark(*mark_now, truth_now);
        if (was != is) change(fmt::format("{}: was {}, is {}", lane->id, was, is));
      }
      *known = *mark_now;
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
