// SPDX-License-Identifier: Apache-2.0
#include "fuzz/regression/found_failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "analysis/lane_trace.h"
#include "analysis/signature.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "core/whole.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimised_cases.h"

namespace graze::fuzz {
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

// The signature without its lanes: only the pair's properties and the subject remain.
std::optional<analysis::Signature> without_lanes(const std::string& key) {
  std::optional<analysis::Signature> signature = analysis::parse_signature(key);
  if (signature) signature->wrong_lanes.clear();
  return signature;
}

// The pair's signatures, one for each subject, including subjects that are right.
std::vector<analysis::Signature> signatures_of(const AnyPair& pair, const Replay& seen) {
  const analysis::Signature blank = visit(pair, [&](const auto& own) -> analysis::Signature {
    return {seen.truth.contact,
            seen.truth.hulls,
            analysis::nesting_of(own, seen.truth),
            oracle::margin_bucket(own, seen.truth.verdict),
            "",
            {}};
  });
  std::vector<analysis::Signature> result;
  for (const Lane& lane : lanes()) {  // in table order
    if (analysis::is_never_wrong(lane, pair)) continue;
    const auto mark = seen.marks.find(lane.id);
    if (mark == seen.marks.end()) continue;
    const LaneName name = lane.lane_name();
    if (result.empty() || result.back().subject != name.subject) {
      result.push_back(blank);
      result.back().subject = name.subject;
    }
    if (mark->second != '.') result.back().wrong_lanes.push_back({name.within_subject(), mark->second});
  }
  return result;
}

}  // namespace

std::vector<FoundFailure> found_in_campaign(const std::filesystem::path& directory,
                                            const std::vector<std::string>& globs, std::size_t most) {
  const std::filesystem::path file = directory / "summary.json";
  const Json summary = checked_summary(directory);
  std::vector<FoundFailure> failures;
  try {
    if (!summary.at("complete").get<bool>())
      throw UsageError(cannot("add", directory, "its campaign is not finished; finish it with `graze fuzz`"));
    const std::string seen = seen_by(summary.at("build"), "campaign", summary.at("spec").dump());
    for (const std::string& glob : globs) {
      const auto matches = [&](const Json& row) { return matches_any({glob}, row.at("key").get<std::string>()); };
      if (std::none_of(summary.at("signatures").begin(), summary.at("signatures").end(), matches))
        throw std::runtime_error(cannot("add", directory, fmt::format("no signature matches '{}'", printable(glob))));
    }
    std::map<std::string, std::size_t> taken;           // number of signatures taken, by subject
    for (const Json& row : summary.at("signatures")) {  // most frequent first
      const std::string signature = row.at("key");
      if (!matches_any(globs, signature) || taken[analysis::subject_of(signature)]++ >= most) continue;
      failures.push_back({signature, read_cases(directory, summary["spec"], row).front(), row.at("count"), seen,
                          case_file(directory, row).string()});
    }
  } catch (const Json::exception&) {
    throw corpus::FormatError(cannot("use", file, "it is not the summary of a campaign"));
  }
  return failures;
}

std::vector<FoundFailure> found_in_cases(const std::vector<corpus::Entry>& entries, const Json& build,
                                         std::span<const Lane* const> run, const DecideLanes& decide) {
  std::vector<FoundFailure> failures;
  std::set<std::string> taken;
  const auto take = [&](const std::string& signature, const corpus::Entry& entry) {
    if (!taken.insert(signature).second) return;
    failures.push_back({signature, entry, 1, seen_by(build, "case", pair_text(corpus::pair_of(entry)) + '\n')});
  };
  const bool minimised = std::any_of(entries.begin(), entries.end(), is_minimised);
  for (const corpus::Entry& entry : entries) {
    if (minimised && !is_minimised(entry)) continue;
    if (const std::string* signature = corpus::field(entry, "signature")) {
      take(*signature, entry);
      continue;
    }
    const AnyPair pair = corpus::pair_of(entry);
    const Replay now = replay(pair, run, decide);
    if (now.truth.verdict == Verdict::declined) continue;
    for (const analysis::Signature& s : signatures_of(pair, now)) {
      if (s.wrong()) take(analysis::key(s), entry);
    }
  }
  return failures;
}

Added add(RegressionCorpus& corpus, const FoundFailure& failure, std::span<const Lane* const> run,
          const DecideLanes& decide) {
  const auto known = corpus.find(failure.signature);
  if (known != corpus.end() && known->second.last == failure.seen) return Added::known;
  const auto signature = analysis::parse_signature(failure.signature);
  const auto was_wrong = [&](const Lane* lane) {
    return lane->info->id == signature->subject && signature->mark_of(lane->lane_name().within_subject()) != '.';
  };
  if (signature && std::none_of(run.begin(), run.end(), was_wrong)) return Added::not_run;

  const AnyPair pair = corpus::pair_of(failure.entry);
  const Replay now = replay(pair, run, decide);
  const std::string algorithm = analysis::subject_of(failure.signature);
  const CaseState state = state_after(CaseState::failing, failure.signature, now.marks);
  if (known != corpus.end()) {
    RegressionCase& c = known->second;
    c.count = std::min(c.count + failure.count, kMostWhole);
    c.last = failure.seen;
    if (c.state != CaseState::fixed || state == CaseState::fixed) return Added::seen_again;
  }
  std::string found = "none";
  if (now.truth.verdict != Verdict::declined) {
    for (const analysis::Signature& s : signatures_of(pair, now)) {
      if (s.subject == algorithm) found = analysis::key(s);
    }
  }
  // A minimised pair has a different margin, so its entry records its own signature.
  const std::string* own = corpus::field(failure.entry, "signature");
  const std::string& recorded = own ? *own : failure.signature;
  if (!without_lanes(found) || without_lanes(found) != without_lanes(recorded)) {
    throw std::runtime_error(
        fmt::format("the pair does not fail as recorded: its signature is {}, not {}", found, recorded));
  }

  RegressionCase c{case_name(failure.signature),
                   pair,
                   std::string(name(now.truth.verdict)),
                   std::string(name(now.truth.contact)),
                   state,
                   failure.count,
                   now.marks,
                   failure.seen,
                   failure.seen};
  c.other = other_fields(failure.entry);
  if (known == corpus.end()) {
    corpus.emplace(failure.signature, std::move(c));
    return Added::as_new;
  }
  c.count = known->second.count;
  c.first = known->second.first;
  known->second = std::move(c);
  return Added::seen_again;
}

}  // namespace graze::fuzz
