// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/minimised_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "backends/backends.h"
#include "core/relation_of.h"
#include "fuzz/campaign/result_files.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

bool is_result(const corpus::Entry& entry) { return is_minimised(entry) || corpus::text_of(entry, "kind") == "worst"; }

// The cases to minimise, in order.
std::vector<const corpus::Entry*> originals(const std::vector<corpus::Entry>& entries) {
  const bool only_results = std::all_of(entries.begin(), entries.end(), is_result);
  std::vector<const corpus::Entry*> found;
  for (const corpus::Entry& entry : entries) {
    if (only_results || !is_result(entry)) found.push_back(&entry);
  }
  return found;
}

std::string name_of(const corpus::Entry& entry) {
  const std::string *from = corpus::field(entry, "from"), *name = corpus::field(entry, "name");
  return corpus::numbers_of(entry).value_or(from ? *from : name ? *name : "");
}

bool is_of_algorithm(const std::string& key, const Failure& failure) {
  return key.find(fmt::format("/{}:", failure.lanes.front()->info->id)) != std::string::npos;
}

corpus::Entry result_entry(const MinimisedCase& result, const AnyPair& pair, const char* kind,
                           const std::string& from) {
  corpus::Entry entry = corpus::entry_of(pair, {{"kind", kind}});
  if (!from.empty()) entry.fields.push_back({"from", from});
  for (auto& part : truth_fields(oracle::truth(pair))) entry.fields.push_back(std::move(part));
  entry.fields.push_back({"signature", analysis::key(signature_of(result.failure, pair))});
  return entry;
}

}  // namespace

bool is_minimised(const corpus::Entry& entry) { return corpus::text_of(entry, "kind") == "minimised"; }

std::vector<corpus::Entry> checked_cases(const SelectedLanes& under_test, const Json& spec,
                                         const std::filesystem::path& directory, const Json& row) {
  const auto& ran = spec.at("lanes");
  std::vector<corpus::Entry> entries = read_cases(directory, spec, row);
  for (const corpus::Entry& entry : entries) {
    const auto signature = analysis::parse_signature(corpus::text_of(entry, "signature")).value();
    const AnyPair pair = corpus::pair_of(entry);
    const Verdict truth = visit(pair, [](const auto& own) { return relation_of(own).verdict; });
    for (const Lane* lane : under_test.lanes) {
      if (lane->info->id != signature.subject || lane->foreign) continue;
      if (std::find(ran.begin(), ran.end(), lane->id) == ran.end()) continue;
      if (!backends::on_host(*lane)) continue;
      const char recorded = signature.mark_of(lane->lane_name().within_subject());
      // A result may cover only some lanes.
      if (recorded == analysis::mark(analysis::decide_lane(*lane, pair), truth) ||
          (is_result(entry) && recorded == '.'))
        continue;
      throw wrong_cases(
          directory, row,
          fmt::format(
              "in line {} the verdict of {} differs: the file is not from this campaign, or the lane has changed",
              entry.line, lane->id));
    }
  }
  return entries;
}

std::vector<MinimisedCase> minimise_cases(const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries,
                                          const std::function<bool()>& stop) {
  std::vector<MinimisedCase> results;
  std::vector<std::vector<Minimised>> ended;  // for each result, its minimised originals
  for (const corpus::Entry* entry : originals(entries)) {
    if (stop()) return {};
    const AnyPair pair = corpus::pair_of(*entry);
    const std::string* recorded = corpus::field(*entry, "signature");
    for (const Failure& failure : failures_of(under_test, pair)) {
      if (recorded && !is_of_algorithm(*recorded, failure)) continue;
      const std::string from = name_of(*entry);
      const auto together = std::find_if(results.begin(), results.end(), [&](const MinimisedCase& other) {
        return recorded && other.recorded == *recorded && other.failure == failure;
      });
      if (together == results.end()) {
        const Minimised result = minimise(failure, pair);
        ended.push_back({result});
        results.push_back({failure, result, recorded ? *recorded : "", from, from, pair});
        continue;
      }
      if (reason_of(failure, pair).cause != together->result.reason.cause) continue;
      std::vector<Minimised>& known = ended[static_cast<std::size_t>(together - results.begin())];
      Minimised result = minimise(failure, pair, known);
      known.push_back(result);
      if (result.worst_ulps > together->result.worst_ulps) {
        together->worst_from = from;
      } else {
        result.worst = together->result.worst;
        result.worst_ulps = together->result.worst_ulps;
      }
      if (simplicity(result.pair) < simplicity(together->result.pair)) {
        together->result = result;
        together->from = from;
        together->original = pair;
      } else {
        together->result.worst = result.worst;
        together->result.worst_ulps = result.worst_ulps;
      }
    }
  }
  for (MinimisedCase& result : results) {
    try {
      confirm(under_test, result.failure, result.result.pair);
      confirm(under_test, result.failure, result.result.worst);
    } catch (const oracle::OracleMismatch&) {
      throw;
    } catch (const std::runtime_error&) {
      // If foreign code gives a different verdict the second time, for example because of timing, the original pair
      // becomes the result.
      if (!result.failure.lanes.front()->foreign) throw;
      result.result.pair = result.result.worst = result.original;
      result.result.one_minimal = false;
    }
  }
  return results;
}

std::string with_results(const std::string& text, const std::vector<corpus::Entry>& entries,
                         const std::vector<MinimisedCase>& results) {
  std::ostringstream out;
  const std::vector<const corpus::Entry*> cases = originals(entries);
  std::istringstream in(text);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto entry =
        std::find_if(entries.begin(), entries.end(), [&](const corpus::Entry& e) { return e.line == number; });
    const bool is_case = entry != entries.end() && std::find(cases.begin(), cases.end(), &*entry) != cases.end();
    if (is_case && &*entry == cases.front()) {
      for (const MinimisedCase& r : results) {
        corpus::Entry minimised = result_entry(r, r.result.pair, "minimised", r.from);
        std::string cause(analysis::name(r.result.reason.cause));
        std::replace(cause.begin(), cause.end(), ' ', '_');  // the field's value has no spaces
        minimised.fields.push_back({"cause", cause});
        if (r.result.one_minimal) {
          minimised.fields.push_back({"one_minimal", "yes"});
          minimised.fields.push_back({"moves_in_vain", std::to_string(r.result.single_moves)});
        } else {
          minimised.fields.push_back({"one_minimal", "unknown"});
          minimised.fields.push_back(
              {"stopped_after_moves", std::to_string(can_shrink(r.failure) ? most_moved(r.failure) : 0)});
        }
        corpus::write_entry(out, minimised);
        corpus::write_entry(out, result_entry(r, r.result.worst, "worst", r.worst_from));
      }
    }
    if (entry == entries.end() || is_case) out << line << '\n';
  }
  return out.str();
}

std::vector<MinimisedCase> minimise_file(const SelectedLanes& under_test, const std::filesystem::path& file,
                                         const std::vector<corpus::Entry>& entries) {
  std::vector<MinimisedCase> results = minimise_cases(under_test, entries);
  if (results.empty()) return results;
  const std::string text = read_whole(file), after = with_results(text, entries, results);
  if (after != text) write_whole(file, after);
  return results;
}

bool has_result(const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries) {
  const corpus::Entry &result = entries.front(), &first = *originals(entries).front();
  const std::string* recorded = corpus::field(result, "signature");
  if (!is_result(result) || is_result(first) || !recorded) return false;
  const std::vector<Failure> failures = failures_of(under_test, corpus::pair_of(first));
  const AnyPair minimised = corpus::pair_of(result);
  return std::any_of(failures.begin(), failures.end(), [&](const Failure& failure) {
    return fails_alike(failure, minimised) && key(signature_of(failure, minimised)) == *recorded;
  });
}

}  // namespace graze::fuzz
