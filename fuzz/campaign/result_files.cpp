// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>

#include "analysis/signature.h"
#include "analysis/tally.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/rank_stores.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

std::string case_name(const std::string& key) { return fmt::format("cases/{:016x}.pairs", fnv1a(key)); }

std::string signature_line(const std::string& key, std::uint64_t count) {
  return fmt::format("# {}: {} pairs\n", key, count);
}

// Whether the entry's truth and signature match its pair.
bool has_its_truth(const corpus::Entry& entry, const analysis::Signature& signature) {
  const AnyPair pair = corpus::pair_of(entry);
  const oracle::Truth truth = oracle::truth(pair);
  for (const auto& [name, value] : truth_fields(truth)) {
    if (corpus::text_of(entry, name) != value) return false;
  }
  return truth.verdict != Verdict::declined && signature.contact == truth.contact && signature.hulls == truth.hulls &&
         signature.nesting == analysis::nesting_of(pair, truth) &&
         signature.bucket == visit(pair, [&](const auto& own) { return oracle::margin_bucket(own, truth.verdict); });
}

std::string case_text(const Campaign& campaign, const std::string& key, const SignatureCount& found) {
  std::ostringstream out;
  corpus::write_header(out);
  out << signature_line(key, found.count);
  for (const CaseKey& c : found.cases) {
    const strata::PairSource& source = campaign.sources[static_cast<std::size_t>(c.source)];
    const std::vector<std::pair<std::string, std::string>> numbers = {
        {"stratum", source.id}, {"seed", std::to_string(campaign.seed)}, {"index", std::to_string(c.index)}};
    corpus::Entry entry = corpus::entry_of(source.any_pair(c.index), numbers);
    if (campaign.spec.contains("scene"))
      entry.fields.emplace_back("scene", campaign.spec["scene"]["name"].get<std::string>());
    const oracle::Truth truth = oracle::truth(corpus::pair_of(entry));
    for (auto& part : truth_fields(truth)) entry.fields.push_back(std::move(part));
    if (analysis::parse_signature(key)) entry.fields.push_back({"signature", key});
    corpus::write_entry(out, entry);
  }
  return out.str();
}

// The cpu lane (rounded as written) of the same subject, scalar and policy.
std::string cpu_lane_of(const std::string& id) {
  LaneName name = parse_lane_name(id).value();
  name.variant = graze::name(Variant::cpu);
  return id_of(name);
}

// Sets differs_from_cpu to null where nothing was compared.
void leave_out_what_was_not_compared(Json& strata, const std::vector<std::string>& lanes) {
  for (const std::string& lane : lanes) {
    if (is_compared_with_cpu(lane, lanes)) continue;
    for (Json& row : strata) row["lanes"][lane]["differs_from_cpu"] = nullptr;
  }
}

}  // namespace

bool is_drawn(const corpus::Entry& entry) {
  const std::string id = corpus::text_of(entry, "stratum");
  const strata::StratumInfo* row = strata::stratum_info(id);
  const auto seed = parse_whole(corpus::text_of(entry, "seed")), index = parse_whole(corpus::text_of(entry, "index"));
  if (!row || corpus::field(entry, "scene")) return true;
  if (!seed || !index || bool(entry.doubles) != bool(strata::stratum_in_doubles(id))) return false;
  const auto same = [](const auto& drawn, const auto& pair) { return std::memcmp(&drawn, &pair, sizeof drawn) == 0; };
  return entry.doubles ? same(strata::generate_doubles(*seed, row->stratum, *index), *entry.doubles)
                       : same(strata::generate(*seed, row->stratum, *index), entry.pair);
}

bool is_compared_with_cpu(const std::string& lane, const std::vector<std::string>& lanes) {
  const std::string cpu = cpu_lane_of(lane);
  return cpu != lane && std::find(lanes.begin(), lanes.end(), cpu) != lanes.end();
}

std::vector<std::pair<std::string, std::string>> truth_fields(const oracle::Truth& t) {
  return {{"truth", std::string(name(t.verdict))},
          {"contact", std::string(name(t.contact))},
          {"margin", fmt::format("{}", t.margin)},
          {"margin_ulps", fmt::format("{}", t.margin_ulps)}};
}

Json summary_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source,
                const std::map<std::string, SignatureCount>& signatures,
                const std::map<std::string, SignatureCount>& executor_mismatches, bool complete) {
  Json results = results_of(spec, of_source);
  leave_out_what_was_not_compared(results["strata"], spec.lanes);
  std::vector<const std::pair<const std::string, SignatureCount>*> by_count;
  for (const auto& row : signatures) by_count.push_back(&row);
  std::stable_sort(by_count.begin(), by_count.end(),
                   [](auto* l, auto* r) { return l->second.count > r->second.count; });
  Json rows = Json::array();
  for (const auto* row : by_count)
    rows.push_back({{"key", row->first}, {"count", row->second.count}, {"case", case_name(row->first)}});
  Json summary = {{"spec", spec.spec},
                  {"build", spec.build},
                  {"complete", complete},
                  {"strata", results["strata"]},
                  {"disagreements", results["disagreements"]},
                  {"signatures", rows}};
  // A pair on which a device and its twin differ is not a failure of any subject.
  for (const auto& [lane, found] : executor_mismatches)
    summary["executor_mismatches"].push_back({{"lane", lane}, {"count", found.count}, {"case", case_name(lane)}});
  return summary;
}

Json write_summary(const Campaign& campaign, const Store& store, bool complete) {
  store.expect_in_place();
  for (const auto* cases : {&store.signatures(), &store.executor_mismatches()}) {
    for (const auto& [key, found] : *cases) {
      const std::filesystem::path file = campaign.directory / case_name(key);
      const std::string text = case_text(campaign, key, found);
      if (!is_minimised_from(read_whole(file), text)) write_whole(file, text);
    }
  }
  const Json summary =
      summary_of(store.spec(), store.of_source(), store.signatures(), store.executor_mismatches(), complete);
  write_whole(campaign.directory / "summary.json", summary.dump(1) + "\n");
  return summary;
}

Json write_own_summary(const Campaign& campaign, Store& store, bool complete, std::uint64_t pairs) {
  if (campaign.shard.whole() && !campaign.take) return write_summary(campaign, store, complete);
  if (complete) store.compact();  // keeps merging thousands of shards cheap
  return {{"shard", campaign.shard.name()},
          {"complete", complete},
          {"pairs", pairs},
          {"disagreements", store.disagreements()},
          {"signatures", store.signatures().size()}};
}

std::filesystem::path case_file(const std::filesystem::path& directory, const Json& row) {
  const std::filesystem::path file = row.at("case").get<std::string>();
  if (file.parent_path() != "cases" || file.extension() != ".pairs")
    throw std::runtime_error(fmt::format("{}: expected a case file cases/NAME.pairs, found '{}'",
                                         (directory / "summary.json").string(), file.string()));
  return directory / file;
}

corpus::FormatError wrong_cases(const std::filesystem::path& directory, const Json& row, const std::string& found) {
  const std::string again = has_database(directory)
                                ? "remove this file, then: " + command_of(recorded_spec(directory), {}, directory)
                                : "restore this file from a copy of the campaign";
  return corpus::FormatError(cannot("use", case_file(directory, row),
                                    fmt::format("{}; it should hold the cases of the signature {}; {}", found,
                                                row.at("key").get<std::string>(), again)));
}

std::vector<corpus::Entry> read_cases(const std::filesystem::path& directory, const Json& spec, const Json& row) {
  const std::string key = row.at("key");
  const std::uint64_t count = row.at("count");
  const std::optional<analysis::Signature> recorded = analysis::parse_signature(key);
  const auto refuse = [&](const std::string& found) -> corpus::FormatError {
    return wrong_cases(directory, row, found);
  };
  if (!recorded || row.at("case") != case_name(key))
    throw corpus::FormatError(
        cannot("use", directory / "summary.json",
               fmt::format("{} is not the file of the signature {}", row.at("case").dump(), row.at("key").dump())));
  const std::filesystem::path file = case_file(directory, row);
  const std::string text = read_whole(file);
  if (text.empty()) throw refuse("it is missing or empty");
  std::vector<corpus::Entry> entries;
  try {
    entries = corpus::read_pairs(file, PairTypes::both);
  } catch (const corpus::FormatError& error) {
    throw refuse(std::string("it is not a file of pairs: ") + error.what());
  }
  const std::string head = signature_line(key, count);
  if (text.compare(text.find('\n') + 1, head.size(), head) != 0)
    throw refuse("its second line is not this signature's");
  std::size_t kept = 0;
  const std::set<std::string> strata = spec.at("strata");
  std::set<std::string> origins;
  const auto belongs = [&](const corpus::Entry& entry) {
    const auto seed = parse_whole(corpus::text_of(entry, "seed")), index = parse_whole(corpus::text_of(entry, "index"));
    return strata.contains(corpus::text_of(entry, "stratum")) && seed == spec.at("seed").get<std::uint64_t>() &&
           index && *index < spec.at("pairs").get<std::uint64_t>() && is_drawn(entry) &&
           origins.insert(corpus::origin_of(entry)).second;
  };
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const corpus::Entry& entry = entries[e];
    const bool result = corpus::field(entry, "kind") != nullptr;
    // The minimiser's results come first: minimised and worst pairs alternate.
    const char* const turn = e % 2 == 0 ? "minimised" : "worst";
    const bool in_order = result ? kept == 0 && corpus::text_of(entry, "kind") == turn : kept > 0 || e % 2 == 0;
    if (!in_order)
      throw refuse(fmt::format("line {} is out of order: the minimised and worst pairs come first", entry.line));
    const std::optional<analysis::Signature> own = analysis::parse_signature(corpus::text_of(entry, "signature"));
    kept += !result;
    if (!own || own->subject != recorded->subject || (!result && *own != *recorded))
      throw refuse(fmt::format("line {} has another signature", entry.line));
    if (!has_its_truth(entry, *own) || (!result && !belongs(entry)))
      throw refuse(fmt::format("line {} has a pair that does not belong to the campaign", entry.line));
  }
  const std::uint64_t due = std::min<std::uint64_t>(count, kKeptCases);
  if (kept != due) throw refuse(fmt::format("it has {} cases instead of {}", kept, due));
  return entries;
}

namespace {

// Whether this can be a run in timings.json: its values must be strings, nonnegative times, counts or booleans.
bool is_run(const Json& run) {
  if (!run.is_object()) return false;
  for (const auto& [name, value] : run.items()) {
    const bool is_text = name == "machine" || name == "engine", is_time = name.find("seconds") != name.npos;
    const bool checked_later = name == "pairs" || name == "seconds";  // expect_possible_run checks it
    const bool fits = checked_later      ? true
                      : name == "costs"  ? value.is_object()
                      : is_text          ? value.is_string()
                      : name == "merged" ? value.is_boolean() || value.is_number_unsigned()
                      : is_time          ? value.is_number() && value >= 0
                                         : value.is_number_unsigned();
    if (!fits) return false;
  }
  return true;
}

Json timings_in(const std::filesystem::path& file) {
  Json timings = read_sealed(file, "remove it; only times are lost");
  if (timings.is_null()) return {{"runs", Json::array()}};
  const Json runs = timings.value("runs", Json()), oracle = timings.value("oracle", Json::object());
  const bool fits =
      runs.is_array() && std::all_of(runs.begin(), runs.end(), is_run) && oracle.is_object() &&
      std::all_of(oracle.begin(), oracle.end(), [](const Json& count) { return count.is_number_unsigned(); });
  if (!fits) throw corpus::FormatError(cannot("use", file, "it does not hold a campaign's timings; remove it"));
  return timings;
}

}  // namespace

Json read_timings(const std::filesystem::path& directory) { return timings_in(directory / "timings.json")["runs"]; }

void append_timing(const std::filesystem::path& directory, const Json& run, const Json& oracle) {
  const std::filesystem::path file = directory / "timings.json";
  Json timings = timings_in(file);
  timings["runs"].push_back(run);
  if (!oracle.is_null()) timings["oracle"] = oracle;
  write_whole(file, sealed(std::move(timings)).dump(1) + "\n");
}

void expect_usable_records(const std::filesystem::path& directory) {
  read_timings(directory);
  remove_damaged_status(directory);
}

bool is_minimised_from(const std::string& text, const std::string& fresh) {
  const std::size_t head = fresh.find('\n', fresh.find('\n') + 1) + 1;  // the version line and the signature's line
  return text.size() >= fresh.size() && text.starts_with(fresh.substr(0, head)) && text.ends_with(fresh.substr(head));
}

bool may_hold_campaign(const std::filesystem::path& folder) {
  const auto begins = [&](const char* name, const char* with) { return read_whole(folder / name).starts_with(with); };
  return may_fill(folder, {kDatabase}) || begins("summary.json", "{\n \"spec\"") ||
         begins("status.json", "{\n \"state\"") || !rank_directories(folder).empty();
}

}  // namespace graze::fuzz
