// SPDX-License-Identifier: Apache-2.0
#include <graze/test.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <vector>

#include "core/error.h"
#include "core/lanes/convention.h"
#include "core/lanes/lanes.h"
#include "core/relation_of.h"
#include "core/simplify/moves.h"
#include "core/simplify/simplicity.h"
#include "core/text.h"
#include "strata/pair_source.h"

namespace graze {
namespace {

constexpr std::size_t kMostCalls = 50'000;  // to find the smallest pair: 1 s at 20 us per call
constexpr std::size_t kBlock = 4096;        // pairs per call

std::vector<strata::PairSource> sources_of(std::string_view names, std::uint64_t seed, std::uint64_t count) {
  std::vector<std::string> globs;
  for (std::string_view rest = names; !rest.empty();) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    globs.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  try {
    return strata::stratum_sources(seed, count, globs);
  } catch (const UsageError& error) {
    throw std::invalid_argument(error.what());
  }
}

// The kinds of pairs on which either answer is accepted.
unsigned outside_of(const TestOptions& options) {
  return (options.touching == either ? kOutsideTouching : 0u) | (options.coplanar == either ? kOutsideCoplanar : 0u) |
         (options.degenerate == either ? kOutsideDegenerate : 0u) | (options.shared == either ? kOutsideShared : 0u);
}

bool accepts(unsigned outside, Verdict verdict, const Pair& pair, const Relation& relation) {
  return verdict == relation.verdict ||
         (!is_failure(verdict) && verdict != Verdict::declined && is_outside(outside, pair, relation));
}

Verdict checked(Verdict said) { return said <= Verdict::unstable ? said : Verdict::crashed; }

struct Tested {
  const DecidePairs& decide_pairs;
  unsigned outside;

  void decide(const Pair* pairs, std::size_t count, Verdict* verdicts) const {
    decide_pairs(pairs, count, verdicts);
    std::transform(verdicts, verdicts + count, verdicts, checked);
  }
  Verdict decide(const Pair& pair) const {
    Verdict verdict = Verdict::declined;
    decide(&pair, 1, &verdict);
    return verdict;
  }
};

// Shrinks the pair as long as its relation and the wrong verdict stay the same.
Pair smallest_like(Pair pair, const Tested& tested) {
  const Relation relation = relation_of(pair);
  const Verdict verdict = tested.decide(pair);
  std::size_t calls = 0, moved = 0;
  const auto alike = [&](const Pair& candidate) {
    return relation_of(candidate) == relation && !accepts(tested.outside, verdict, candidate, relation) &&
           ++calls < kMostCalls && tested.decide(candidate) == verdict;
  };
  int in_vain = 0;
  for (int kind = 0; in_vain < kMoveKinds && calls < kMostCalls; kind = (kind + 1) % kMoveKinds) {
    const std::vector<Pair> simpler = simpler_moves(pair, kind, moved);
    const auto found = std::find_if(simpler.begin(), simpler.end(), alike);
    in_vain = found == simpler.end() ? in_vain + 1 : 0;
    if (found != simpler.end()) pair = *found;
  }
  return pair;
}

// The shortest decimal of this float32: "5" for 5.0. A literal with a point or an exponent ends with f: "1e30f".
std::string number(float value, bool literal) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  std::string shortest(text, end.ptr);
  return literal && shortest.find_first_of(".e") != shortest.npos ? shortest + 'f' : shortest;
}

std::string numbers(const float* nine, std::string_view between, bool literal) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += (i == 0 ? "" : std::string(between)) + number(nine[i], literal);
  return text;
}

std::string with_commas(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string percent(double value, int digits) {
  char text[32];  // to_chars would enlarge the WebAssembly module by its tables
  std::snprintf(text, sizeof text, "%.*g %%", digits, value);
  return text;
}

std::string in_words(Verdict verdict, const Relation& relation) {
  const std::string said = verdict == Verdict::crashed ? "it throws" : "it says " + std::string(name(verdict));
  if (!relation.intersects()) return said + ", but the triangles are disjoint";
  return said + ", but the triangles meet in " + (relation.contact == Contact::area ? "an " : "a ") +
         std::string(name(relation.contact));
}

struct Row {
  std::string stratum;
  std::uint64_t pairs;
  Counts counts;
};

std::string counts_in_words(const Counts& counts) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + with_commas(count) + what;
  };
  add(counts.false_positive, " false positives");
  add(counts.false_negative, " false negatives");
  add(counts.crashed, " exceptions");
  return text;
}

std::string table(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    if (row.counts.wrong() == 0) continue;
    char line[80];
    std::snprintf(line, sizeof line, "  %-20s %9s of %9s\n", row.stratum.c_str(),
                  with_commas(row.counts.wrong()).c_str(), with_commas(row.pairs).c_str());
    text += line;
  }
  return text;
}

// Names the options that would accept either answer on this pair. Empty if there is none.
std::string conventions_of(const Pair& pair, const Relation& relation) {
  constexpr std::pair<Outside, const char*> kOptions[] = {{kOutsideTouching, ".touching"},
                                                          {kOutsideCoplanar, ".coplanar"},
                                                          {kOutsideDegenerate, ".degenerate"},
                                                          {kOutsideShared, ".shared"}};
  std::string text;
  for (const auto& [outside, option] : kOptions) {
    if (is_outside(outside, pair, relation)) text += (text.empty() ? "" : " or ") + std::string(option);
  }
  return text.empty() ? "" : "To accept either answer on such a pair, set " + text + " = graze::either.\n";
}

std::string pair_in_words(std::string_view name, const Pair& pair, const std::string& fault) {
  const float *a = &pair.a[0].x, *b = &pair.b[0].x;
  const Relation relation = relation_of(pair);
  const bool is_name = name.find_first_of(" ([{") == name.npos;  // not a lambda's text
  return "The smallest wrong pair that was found: " + fault + ".\n  const float a[9] = {" + numbers(a, ", ", true) +
         "},\n              b[9] = {" + numbers(b, ", ", true) +
         "};  // right: " + (relation.intersects() ? "true" : "false") + "\n" + conventions_of(pair, relation) +
         "Why: echo '" + numbers(a, " ", false) + "  " + numbers(b, " ", false) +
         "' > wrong.pairs; graze explain wrong.pairs --lanes 'own/*' --subject own=YOUR_FILE.cpp:" +
         (is_name ? std::string(name) : "YOUR_FUNCTION") + "\n";
}

// If the environment variable is set, replaces the number with its value.   Throws: std::invalid_argument.
void take_from_environment(const char* variable, std::uint64_t& number) {
  const char* text = std::getenv(variable);
  if (!text) return;
  const std::optional<std::uint64_t> wanted = parse_whole(text);
  if (!wanted) throw std::invalid_argument(std::string(variable) + ": '" + printable(text) + "' is not a whole number");
  number = *wanted;
}

TestResult tested_with(std::string_view name, const Tested& tested, const std::vector<strata::PairSource>& sources,
                       double max_wrong) {
  TestResult result;
  std::vector<Row> rows;
  std::vector<Pair> pairs;
  std::vector<Verdict> verdicts;
  std::optional<std::pair<Pair, Simplicity>> simplest;
  for (const strata::PairSource& source : sources) {
    Row row{source.id, source.pairs, {}};
    for (std::uint64_t done = 0; done < source.pairs; done += pairs.size()) {
      pairs.resize(std::min<std::uint64_t>(kBlock, source.pairs - done));
      verdicts.assign(pairs.size(), Verdict::declined);
      for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = source.pair(done + i);
      tested.decide(pairs.data(), pairs.size(), verdicts.data());
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Pair& pair = pairs[i];
        const Relation relation = relation_of(pair);
        if (verdicts[i] == relation.verdict) continue;
        if (accepts(tested.outside, verdicts[i], pair, relation)) {
          ++row.counts.by_convention;
          continue;
        }
        ++row.counts.of(verdicts[i]);
        if (verdicts[i] == Verdict::declined) continue;
        if (Simplicity how = simplicity(pair); !simplest || how < simplest->second) simplest = {pair, how};
      }
    }
    result.pairs += row.pairs;
    result.counts += row.counts;
    rows.push_back(std::move(row));
  }
  const std::uint64_t wrong = result.counts.wrong();
  if (result.pairs == 0 || result.counts.declined == result.pairs) {
    result.message = std::string(name) + (result.pairs == 0 ? ": no pairs requested\n" : " declines every pair\n");
    result.summary = result.message;
    return result;
  }
  result.passed = static_cast<double>(wrong) <= max_wrong * static_cast<double>(result.pairs);
  if (result.passed) return result;
  result.smallest = smallest_like(simplest->first, tested);
  result.fault = in_words(tested.decide(*result.smallest), relation_of(*result.smallest));
  result.summary = std::string(name) + " is wrong on " + with_commas(wrong) + " of " + with_commas(result.pairs) +
                   " pairs (" + percent(100.0 * static_cast<double>(wrong) / static_cast<double>(result.pairs), 3) +
                   (max_wrong > 0 ? "; " + percent(100 * max_wrong, 6) + " are accepted" : "") +
                   "): " + counts_in_words(result.counts) + ".\n" + table(rows);
  result.message = result.summary + pair_in_words(name, *result.smallest, result.fault);
  return result;
}

}  // namespace

void for_each_pair(std::string_view strata, std::uint64_t seed, std::uint64_t count,
                   const std::function<void(const Pair&)>& f) {
  for (const strata::PairSource& source : sources_of(strata, seed, count)) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) f(source.pair(i));
  }
}

Relation truth(const Pair& pair) { return relation_or_declined(pair); }

TestResult test_pairs(std::string_view name, const DecidePairs& decide, const TestOptions& options) {
  TestOptions used = options;
  std::vector<strata::PairSource> sources;
  try {
    take_from_environment("GRAZE_PAIRS", used.pairs);
    take_from_environment("GRAZE_SEED", used.seed);
    if (!(used.max_wrong >= 0 && used.max_wrong <= 1)) throw std::invalid_argument("max_wrong must be between 0 and 1");
    sources = sources_of(used.strata, used.seed, used.pairs);
  } catch (const std::invalid_argument& error) {
    TestResult result;
    result.message = result.summary = std::string(error.what()) + "\n";
    return result;
  }
  return tested_with(name, {decide, outside_of(used)}, sources, used.max_wrong);
}

TestResult test_overlap(std::string_view name, const std::function<int(const float*, const float*)>& overlap,
                        const TestOptions& options) {
  const auto decide = [&](const Pair* pairs, std::size_t count, Verdict* verdicts) {
    for (std::size_t i = 0; i < count; ++i) {
      try {
        const int answer = overlap(&pairs[i].a[0].x, &pairs[i].b[0].x);
        verdicts[i] = answer < 0 ? Verdict::declined : answer > 0 ? Verdict::intersects : Verdict::disjoint;
      } catch (...) {
        verdicts[i] = Verdict::crashed;
      }
    }
  };
  return test_pairs(name, decide, options);
}

std::string fault_of(const Pair& pair, Verdict said, const TestOptions& options) {
  const Verdict verdict = checked(said);
  const Relation relation = truth(pair);
  if (verdict == relation.verdict || verdict == Verdict::declined) return "";
  if (relation.verdict == Verdict::declined) return "";  // a coordinate is not finite, so no answer is wrong
  return accepts(outside_of(options), verdict, pair, relation) ? "" : in_words(verdict, relation);
}

}  // namespace graze
