// SPDX-License-Identifier: Apache-2.0
#include "fuzz/regression/found_failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "analysis/signature.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "fuzz/minimise/minimised_cases.h"

namespace graze {
namespace {

std::string word(const Json& build, const char* key, const char* otherwise) {
  const Json value = build.value(key, Json());
  return value.is_string() ? value.get<std::string>() : otherwise;
}

std::string seen_by(const Json& build, std::string_view kind, const std::string& identity) {
  const bool by_twins = !build.value("executors", Json::object()).empty();
  return fmt::format("{}, {}, {}, {}; {} {:016x}", word(build, "commit", "unknown"), word(build, "compiler", "unknown"),
                     word(build, "cuda", "no nvcc"), word(build, "device", by_twins ? "twins" : "no device"), kind,
                     fnv1a(identity));
}

std::string without_marks(const std::string& signature) { return signature.substr(0, signature.rfind(':')); }

// The pair's signatures, one an algorithm, right or wrong.
std::vector<Signature> signatures_of(const Pair& pair, const Replay& seen) {
  const Shape hulls = shape(pair);
  const Bucket bucket = margin_bucket(pair, seen.truth.verdict);
  std::vector<Signature> result;
  for (std::size_t first = 0; first < seen.marks.size(); first += 2 * kTargetCount) {
    Signature s{seen.truth.contact, hulls, bucket, published_lanes()[first].algorithm, {}};
    for (std::size_t i = 0; i < s.marks.size(); ++i) s.marks[i] = seen.marks[first + i];
    result.push_back(s);
  }
  return result;
}

// Requires: the summary is whole; a missing part throws Json::exception.
std::vector<Sighting> sightings_of_summary(const std::filesystem::path& directory, const Json& summary,
                                           const std::vector<std::string>& globs, std::size_t most) {
  const std::string seen = seen_by(summary.at("build"), "campaign", summary.at("spec").dump());
  std::vector<Sighting> sightings;
  std::map<std::string, std::size_t> place, taken;    // of a signature in the list; signatures of an algorithm
  for (const Json& row : summary.at("signatures")) {  // the commonest first
    const std::string recorded = row.at("key");
    if (!matches_any(globs, recorded)) continue;
    const std::filesystem::path file = directory / row.at("case").get<std::string>();
    const std::vector<Entry> entries = read_pairs(file);
    if (entries.empty()) throw FormatError(file.string() + ": expected at least one case, found none");
    const std::string* own = field(entries.front(), "signature");
    const std::string& signature = own ? *own : recorded;
    const std::uint64_t count = row.at("count");
    if (const auto known = place.find(signature); known != place.end()) {
      sightings[known->second].count += count;
    } else if (taken[algorithm_of(signature)]++ < most) {
      place.emplace(signature, sightings.size());
      sightings.push_back({signature, entries.front(), count, seen});
    }
  }
  return sightings;
}

}  // namespace

std::vector<Sighting> sightings_of_campaign(const std::filesystem::path& directory,
                                            const std::vector<std::string>& globs, std::size_t most) {
  const std::filesystem::path file = directory / "summary.json";
  std::ifstream in(file);
  if (!in) throw UsageError(directory.string() + ": expected a campaign's directory, found no summary.json in it");
  try {
    const Json summary = Json::parse(in);
    if (!summary.at("complete").get<bool>())
      throw UsageError(directory.string() + ": expected a finished campaign, found one that was interrupted");
    return sightings_of_summary(directory, summary, globs, most);
  } catch (const Json::exception&) {
    throw FormatError(file.string() + ": expected a campaign's summary, found something else");
  }
}

std::vector<Sighting> sightings_of_cases(const std::vector<Entry>& entries, const Json& build,
                                         std::span<const Lane* const> run, const DecideLanes& decide) {
  std::vector<Sighting> sightings;
  std::set<std::string> taken;
  const auto take = [&](const std::string& signature, const Entry& entry) {
    if (!taken.insert(signature).second) return;
    std::ostringstream bits;
    write_entry(bits, {entry.pair});
    sightings.push_back({signature, entry, 1, seen_by(build, "case", bits.str())});
  };
  const bool minimised = std::any_of(entries.begin(), entries.end(), is_minimised);
  for (const Entry& entry : entries) {
    if (minimised && !is_minimised(entry)) continue;
    if (const std::string* signature = field(entry, "signature")) {
      take(*signature, entry);
      continue;
    }
    const Replay now = replay(entry.pair, run, decide);
    if (now.truth.verdict == Verdict::declined) continue;
    for (const Signature& s : signatures_of(entry.pair, now)) {
      if (s.wrong()) take(key(s), entry);
    }
  }
  return sightings;
}

Added add(RegressionCorpus& corpus, const Sighting& sighting, std::span<const Lane* const> run,
          const DecideLanes& decide) {
  const auto known = corpus.find(sighting.signature);
  if (known != corpus.end() && known->second.last == sighting.seen) return Added::known;

  const Replay now = replay(sighting.entry.pair, run, decide);
  const std::string algorithm = algorithm_of(sighting.signature);
  const CaseState state = state_after(CaseState::failing, sighting.signature, now.marks);
  if (known != corpus.end()) {
    RegressionCase& c = known->second;
    c.count += sighting.count;
    c.last = sighting.seen;
    if (c.state != CaseState::fixed || state == CaseState::fixed) return Added::seen_again;
  }
  std::string found = "none";
  if (now.truth.verdict != Verdict::declined) {
    for (const Signature& s : signatures_of(sighting.entry.pair, now)) {
      if (algorithm_of(key(s)) == algorithm) found = key(s);
    }
  }
  if (without_marks(found) != without_marks(sighting.signature)) {
    throw std::runtime_error(fmt::format("expected a pair with the signature {}, found {}", sighting.signature, found));
  }

  RegressionCase c{fmt::format("{}_{:016x}", algorithm, fnv1a(sighting.signature)),
                   sighting.entry.pair,
                   std::string(name(now.truth.verdict)),
                   std::string(name(now.truth.contact)),
                   state,
                   sighting.count,
                   now.marks,
                   sighting.seen,
                   sighting.seen};
  c.other = other_fields(sighting.entry);
  if (known == corpus.end()) {
    corpus.emplace(sighting.signature, std::move(c));
    return Added::as_new;
  }
  c.name = known->second.name;
  c.count = known->second.count;
  c.first = known->second.first;
  known->second = std::move(c);
  return Added::seen_again;
}

}  // namespace graze
