// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "analysis/signature.h"
#include "analysis/tally.h"
#include "core/fnv1a.h"
#include "corpus/pair_format.h"
#include "fuzz/minimise/minimised_cases.h"

namespace graze::fuzz {
namespace {

// A name for the signature's file.
std::string case_name(const std::string& key) { return fmt::format("cases/{:016x}.pairs", fnv1a(key)); }

std::string case_text(const Campaign& campaign, const std::string& key, const SignatureCount& found) {
  std::ostringstream out;
  corpus::write_header(out);
  out << "# " << key << ": " << found.count << " pairs\n";
  for (const CaseKey& c : found.cases) {
    const strata::PairSource& source = campaign.sources[static_cast<std::size_t>(c.source)];
    const Pair pair = source.pair(c.index);
    corpus::Entry entry{
        pair, {{"stratum", source.id}, {"seed", std::to_string(campaign.seed)}, {"index", std::to_string(c.index)}}, 0};
    if (campaign.spec.contains("scene")) entry.fields.emplace_back("scene", campaign.spec["scene"]["name"].get<std::string>());
    for (auto& part : truth_fields(oracle::truth(pair))) entry.fields.push_back(std::move(part));
    if (analysis::parse_signature(key)) entry.fields.push_back({"signature", key});
    corpus::write_entry(out, entry);
  }
  return out.str();
}

// differs_from_cpu is null for the cpu lanes, and for lanes that ran without theirs.
void leave_out_what_was_not_compared(Json& strata, const std::vector<const Lane*>& lanes) {
  const std::vector<int> cpu = analysis::cpu_twins(lanes);
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (cpu[l] >= 0 && cpu[l] != static_cast<int>(l)) continue;
    for (Json& row : strata) row["lanes"][lanes[l]->id]["differs_from_cpu"] = nullptr;
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> truth_fields(const oracle::Truth& t) {
  return {{"truth", std::string(name(t.verdict))},
          {"contact", std::string(name(t.contact))},
          {"margin", fmt::format("{}", t.margin)},
          {"margin_ulps", fmt::format("{}", t.margin_ulps)}};
}

Json write_summary(const Campaign& campaign, const Store& store, bool complete) {
  Json results = store.results();
  leave_out_what_was_not_compared(results["strata"], campaign.under_test->lanes);
  const auto row_of = [&](const std::string& key, const SignatureCount& found) {
    const std::string file = case_name(key), text = case_text(campaign, key, found);
    if (!is_minimised_from(read_whole(campaign.directory / file), text)) write_whole(campaign.directory / file, text);
    return file;
  };
  std::vector<const std::pair<const std::string, SignatureCount>*> by_count;
  for (const auto& row : store.signatures()) by_count.push_back(&row);
  std::stable_sort(by_count.begin(), by_count.end(),
                   [](auto* l, auto* r) { return l->second.count > r->second.count; });
  Json signatures = Json::array();
  for (const auto* row : by_count) {
    signatures.push_back(
        {{"key", row->first}, {"count", row->second.count}, {"case", row_of(row->first, row->second)}});
  }
  Json summary = {{"spec", campaign.spec},
                  {"build", campaign.build},
                  {"complete", complete},
                  {"strata", results["strata"]},
                  {"disagreements", results["disagreements"]},
                  {"signatures", signatures}};
  // Pairs on which a device and its twin differ: nobody's failure.
  for (const auto& [lane, found] : store.executors_apart())
    summary["executors_apart"].push_back({{"lane", lane}, {"count", found.count}, {"case", row_of(lane, found)}});
  write_whole(campaign.directory / "summary.json", summary.dump(1) + "\n");
  return summary;
}

Json shard_summary(const Shard& shard, const Store& store, bool complete, std::uint64_t pairs) {
  return {{"shard", shard.name()},
          {"complete", complete},
          {"pairs", pairs},
          {"disagreements", store.disagreements()},
          {"signatures", store.signatures().size()}};
}

std::filesystem::path case_file(const std::filesystem::path& directory, const Json& row) {
  const std::filesystem::path file = row.at("case").get<std::string>();
  if (file.parent_path() != "cases" || file.extension() != ".pairs")
    throw std::runtime_error(fmt::format("{}: expected cases of the form cases/NAME.pairs, found '{}'",
                                         (directory / "summary.json").string(), file.string()));
  return directory / file;
}

void append_timing(const std::filesystem::path& directory, const Json& run, const Json& oracle) {
  const std::filesystem::path file = directory / "timings.json";
  Json timings = Json::parse(read_whole(file), nullptr, false);
  if (!timings.is_object() || !timings["runs"].is_array()) timings = {{"runs", Json::array()}};
  timings["runs"].push_back(run);
  if (!oracle.is_null()) timings["oracle"] = oracle;
  write_whole(file, timings.dump(1) + "\n");
}

}  // namespace graze::fuzz
