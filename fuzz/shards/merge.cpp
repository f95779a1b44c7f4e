// SPDX-License-Identifier: Apache-2.0
#include "fuzz/shards/merge.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/lane_costs.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/campaign/sums.h"
#include "fuzz/hunt/hunt_rounds.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// Combines the words of two executors, as in "device; twin, verified on …".
std::string common_words(const std::string& one, const std::string& other) {
  std::set<std::string> words;
  for (const std::string& text : {one, other}) {
    for (std::size_t begin = 0, end; begin < text.size(); begin = end + 2) {
      end = std::min(text.find("; ", begin), text.size());
      words.insert(text.substr(begin, end - begin));
    }
  }
  return fmt::format("{}", fmt::join(words, "; "));
}

// Reads each part's record; all parts must belong to one campaign.
std::vector<StoreSpec> read_records(const std::vector<fs::path>& parts) {
  std::vector<StoreSpec> stores;
  for (const fs::path& part : parts) {
    stores.push_back(recorded_store(part));
    if (stores.back().spec == stores.front().spec) continue;
    throw std::runtime_error(fmt::format(
        "cannot merge {} and {}: they are parts of different campaigns: {}; leave one out",
        stores.front().directory.string(), part.string(), first_difference(stores.front().spec, stores.back().spec)));
  }
  return stores;
}

std::string named(const StoreSpec& store) {
  return store.directory.string() + (store.shard.whole() ? "" : ", shard " + store.shard.name());
}

// The folder for a missing shard, beside the other shards: a new folder, or one that holds some of the shard's results.
fs::path place_for(const Shard& shard, const StoreSpec& beside, const fs::path& out) {
  const auto fits = [&](const fs::path& place) {
    if (place.lexically_normal() == out.lexically_normal()) return false;
    if (!fs::exists(fs::symlink_status(place))) return true;
    try {
      const StoreSpec found = recorded_store(place);
      return found.spec == beside.spec && found.shard == shard;
    } catch (const std::exception&) {  // it holds something else
      return false;
    }
  };
  const std::string name = (beside.directory.parent_path() / fmt::format("shard-{}", shard.number)).string();
  fs::path place = name;
  for (int n = 1; !fits(place); ++n) place = fmt::format("{}.{}", name, n);
  return place;
}

// Throws: std::runtime_error if pairs are missing; the message names the command to run.
void expect_no_gaps(const std::vector<StoreSpec>& stores, const Sums& sums, const fs::path& out) {
  const std::vector<PairRange> gaps = sums.gaps();
  if (gaps.empty()) return;
  const Json& spec = stores.front().spec;
  const std::vector<strata::PairSource>& sources = stores.front().sources;
  std::uint64_t missing = 0;
  for (const PairRange& gap : gaps) missing += gap.pairs;
  std::vector<const StoreSpec*> undone;
  for (const StoreSpec& store : stores) {
    const auto is_undone = [&](const strata::PairSource& source) {
      const auto s = static_cast<int>(&source - sources.data());
      return !sums.gaps(share_of(store.shard, s, source.pairs)).empty();
    };
    if (!store.shard.whole() && std::any_of(sources.begin(), sources.end(), is_undone)) undone.push_back(&store);
  }
  if (!undone.empty()) {
    throw std::runtime_error(
        fmt::format("cannot merge {}: it {} not done; to resume, run: {}", named(*undone.front()),
                    undone.size() == 1 ? "is" : fmt::format("and {} other shards are", undone.size() - 1),
                    command_of(spec, undone.front()->shard, undone.front()->directory)));
  }
  const std::uint64_t of = stores.front().shard.of;
  const bool alike =
      of > 1 && std::all_of(stores.begin(), stores.end(), [&](auto& store) { return store.shard.of == of; });
  if (!alike) {
    throw std::runtime_error(fmt::format(
        "cannot merge: {} pairs are missing in these directories; merge these with --partial into {}, then run: {}",
        missing, out.string(), command_of(spec, {}, out)));
  }
  std::set<std::uint64_t> lacking;
  for (std::uint64_t k = 1; k <= of; ++k) lacking.insert(k);
  for (const StoreSpec& store : stores) lacking.erase(store.shard.number);
  std::erase_if(lacking, [&](std::uint64_t k) {  // shards without pairs are not missing
    return std::all_of(sources.begin(), sources.end(), [&](const strata::PairSource& source) {
      return share_of({k, of}, 0, source.pairs).pairs == 0;
    });
  });
  const Shard first{*lacking.begin(), of};
  const std::string command = command_of(spec, first, place_for(first, stores.front(), out));
  throw std::runtime_error(
      lacking.size() == 1
          ? fmt::format("cannot merge: shard {}/{} is missing; to run it: {}", *lacking.begin(), of, command)
          : fmt::format("cannot merge: shards {} of {} are missing; to run the first: {}", fmt::join(lacking, ", "), of,
                        command));
}

// Throws: DamagedStore if the database has changed since the finished run sealed it.
void expect_sealed(const StoreSpec& store) {
  const Json status = read_status(store.directory);
  if (status.is_null() || status["state"] != "done" || !status.contains("hash")) return;
  if (const std::string found = file_hash(store.directory / kDatabase); found != status["hash"].get<std::string>())
    throw DamagedStore(
        cannot("merge", store.directory / kDatabase,
               fmt::format("it has changed since the run ended: its hash is {}, not {}; copy it again, or run", found,
                           printable(status["hash"].get<std::string>()))));
}

// Whether the folder already holds the whole campaign, for example because a merge into it has just ended.
bool holds_whole(const fs::path& out, const Json& spec) {
  try {
    const StoreSpec found = recorded_store(out);
    const Json summary = parse_shallow(read_whole(out / "summary.json"));
    return found.shard.whole() && found.spec == spec && summary.at("complete") == true;
  } catch (const std::exception&) {  // it holds something else
    return false;
  }
}

void expect_new(const fs::path& out, const Json& spec) {
  if (!fs::exists(out) || (fs::is_directory(out) && fs::is_empty(out))) return;
  const std::string why = holds_whole(out, spec) ? "it already holds this whole campaign" : "it holds other files";
  throw UsageError(cannot("use", out, why + "; choose a new or an empty directory as --out"));
}

// The folder that `out` names, after following links; at the end, the merged campaign is renamed to it.
// Throws: UsageError if the campaign cannot be renamed to this folder.
fs::path place_of(const fs::path& out, const Json& spec) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(behind_links(out), error);
  if (error) throw UsageError(cannot("use", out, error.message()));
  expect_new(out, spec);
  if (!place.has_filename()) place = place.parent_path();
  if (place == fs::current_path(error))
    throw UsageError(cannot("replace", out, "it is the working directory; run the command from another directory"));
  struct statx found {};
  if (statx(AT_FDCWD, place.c_str(), 0, STATX_TYPE, &found) == 0 && (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0)
    throw UsageError(
        cannot("replace", out,
               "it is a mount point; use a new directory in it: --out " + path_word((out / "campaign").string())));
  return place;
}

constexpr std::string_view kCampaignPart = "campaign.graze.part";

// The folder beside the target, in which kCampaignPart is built; a killed merge may have left it.
fs::path folder_beside(const fs::path& place) {
  std::error_code error;
  fs::path part = place;
  part += kPart;
  fs::create_directories(part, error);
  if (error) throw std::runtime_error(cannot("make the directory", part, error.message()));
  const auto is_ours = [](const fs::directory_entry& entry) { return entry.path().filename() == kCampaignPart; };
  if (fs::is_symlink(part) || !std::all_of(fs::directory_iterator(part), fs::directory_iterator(), is_ours))
    throw UsageError(cannot("use", part, "it was not left by a killed merge; remove it"));
  return part;
}

// Adds the part's runs to the other runs on the same machine.   Throws: the errors of expect_possible_run.
void add_timings(const StoreSpec& part, const Json& runs, std::size_t parts, std::map<std::string, Json>& by_machine) {
  std::map<std::string, std::uint64_t> sources;
  std::uint64_t share = 0;
  for (const strata::PairSource& source : part.sources) {
    share += share_of(part.shard, static_cast<int>(sources.size()), source.pairs).pairs;
    sources[source.id] = source.pairs;
  }
  for (const Json& of_part : runs) {
    expect_possible_run(of_part, part.spec.at("lanes"), sources, share);
    if (!of_part.contains("machine")) continue;
    const std::string machine = of_part["machine"];
    Json& run = by_machine[machine];
    if (run.is_null()) run = {{"merged", parts}, {"pairs", 0}, {"seconds", 0.0}, {"machine", machine}};
    run["pairs"] = run["pairs"].get<std::uint64_t>() + of_part.value("pairs", std::uint64_t{0});
    run["seconds"] = run["seconds"].get<double>() + of_part.value("seconds", 0.0);
    if (of_part.contains("costs")) run["costs"] = of_part["costs"];
  }
}

// Combines the parts' runs into one run for each machine, with the lane costs that one part measured.
// Throws: std::runtime_error that names the timings file.
std::map<std::string, Json> timings_of(const std::vector<StoreSpec>& stores) {
  std::map<std::string, Json> by_machine;
  for (const StoreSpec& store : stores) {
    const fs::path file = store.directory / "timings.json";
    const Json runs = read_timings(store.directory);
    try {
      add_timings(store, runs, stores.size(), by_machine);
    } catch (const Json::exception&) {
      throw std::runtime_error(cannot("use", file, "it does not hold a campaign's timings"));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(cannot("use", file, error.what()));
    }
  }
  return by_machine;
}

// Combines the rounds of a hunt's parts into the campaign's rounds, from which the campaign takes its cases.
// held: the number of pairs in each part.
void join_rounds(const std::vector<StoreSpec>& stores, const std::vector<std::uint64_t>& held, const Sums& sums,
                 Campaign& campaign) {
  std::vector<KeptRound> rounds;
  for (std::size_t i = 0; i < stores.size(); ++i) {
    const StoreSpec& store = stores[i];
    std::uint64_t kept = 0;
    for (KeptRound& round : read_rounds(store)) {
      kept += round.pairs;
      rounds.push_back(std::move(round));
    }
    if (kept != held[i])
      throw std::runtime_error(
          cannot("merge", rounds_folder(store.directory),
                 fmt::format("it has the rounds of {} pairs, but the database has {}; copy it again, or run: {}", kept,
                             held[i], command_of(store.spec, store.shard, store.directory))));
  }
  std::sort(rounds.begin(), rounds.end(), [](const KeptRound& l, const KeptRound& r) { return l.first < r.first; });
  auto found = std::make_shared<HuntRounds>();
  for (const KeptRound& round : rounds) found->add(round);
  std::set<std::uint64_t> cases;
  for (const auto& [key, signature] : sums.of_source(0).signatures) {
    for (const CaseKey& kept : signature.cases) cases.insert(kept.index);
  }
  std::erase_if(found->all.kept, [&](const auto& pair) { return !cases.contains(pair.first); });
  found->all.coarse.assign(found->coarse.begin(), found->coarse.end());
  fs::create_directories(rounds_folder(campaign.directory));
  write_whole(merged_rounds_file(campaign.directory),
              round_bytes(found->all, hunt_checksum(campaign.spec, campaign.build)));
  write_whole(campaign.directory / "hunt.json", found->told().dump(1) + "\n");
  const strata::PairSource& source = campaign.sources[0];
  campaign.sources = {source_of_hunt(source.pairs, strata::stratum_in_doubles(source.id).has_value(), found)};
}

Outcome write_results(const Campaign& campaign, Store& store, bool complete) {
  Outcome outcome{complete, write_summary(campaign, store, complete), store.oracle()};
  store.finish();
  return outcome;
}

// Writes a complete campaign from its sums.   Requires: no pairs are missing, and the directory has no store.
Outcome write_merged(const Campaign& campaign, const Sums& sums) {
  Store store(store_spec(campaign));
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    const PairRange all{static_cast<int>(s), 0, campaign.sources[s].pairs};
    if (all.pairs > 0) store.commit(all, sums.of_source(all.source));
  }
  return write_results(campaign, store, true);
}

}  // namespace

Json common_build(const Json& one, const Json& other, const fs::path& directory) {
  Json common = one, rest = other;
  for (Json* build : {&common, &rest}) {
    build->erase("device");
    build->erase("executors");
  }
  if (common != rest)
    throw std::runtime_error(cannot(
        "merge", directory, fmt::format("another build ran it: {}; leave it out", first_difference(common, rest))));
  common = one;
  const auto merge_words = [](Json& into, const Json& from) {
    if (from.is_null()) return;
    into = into.is_null() ? from : Json(common_words(into.get<std::string>(), from.get<std::string>()));
  };
  merge_words(common["device"], other["device"]);
  for (const auto& [lane, evidence] : other["executors"].items()) merge_words(common["executors"][lane], evidence);
  return common;
}

Outcome merge(const MergeOptions& options) {
  if (options.parts.empty()) throw UsageError("graze merge needs the directories of shards");
  std::vector<StoreSpec> stores = read_records(options.parts);
  Campaign campaign;
  campaign.spec = stores.front().spec;
  campaign.seed = campaign.spec.at("seed");
  campaign.sources = recorded_sources(campaign.spec);
  const bool hunt = campaign.spec.contains("hunt");
  if (hunt && options.partial)
    throw UsageError("--partial does not work for a hunt; merge its parts when all are done");
  campaign.build = stores.front().build;
  for (StoreSpec& store : stores) {
    campaign.build = common_build(campaign.build, store.build, store.directory);
    store.sources = campaign.sources;
  }
  // Merging draws the cases' pairs again, so it must run in the build that ran the campaign.
  if (const Json here = build_info({}); campaign.build.at("commit") != here["commit"])
    throw std::runtime_error(
        cannot("merge", stores.front().directory,
               fmt::format("it was run by a build of commit {}, but this build is of commit {}; use that build",
                           printable(campaign.build["commit"].get<std::string>()), here["commit"].get<std::string>())));
  const SelectedLanes under_test = recorded_lanes(campaign.spec);
  campaign.under_test = &under_test;
  const std::map<std::string, Json> timings = timings_of(stores);
  const fs::path place = place_of(options.out, campaign.spec), beside = folder_beside(place);
  const FolderLock alone(beside, FolderLock::WhenTaken::refuse);  // until the end; no other merge may empty it
  campaign.directory = beside / kCampaignPart;

  Sums sums(campaign.sources, static_cast<int>(under_test.lanes.size()));
  std::vector<std::uint64_t> held(stores.size());
  std::optional<Store> partial;
  std::error_code unimportant;
  try {
    expect_new(options.out, campaign.spec);  // again, because another merge may have just finished
    fs::remove_all(campaign.directory);
    fs::create_directory(campaign.directory);
    if (options.partial) partial.emplace(store_spec(campaign));
    for (std::size_t i = 0; i < stores.size(); ++i) {
      try {
        expect_sealed(stores[i]);
        for_each_row(stores[i], [&](const PairRange& range, const StoredCounts& counts) {
          sums.add(range, counts, i);
          held[i] += range.pairs;
          if (partial) partial->commit(range, counts);
        });
      } catch (const DamagedStore& error) {
        const std::string again = command_of(campaign.spec, stores[i].shard, stores[i].directory);
        const std::string what = error.what();
        throw std::runtime_error(hunt ? what.substr(0, what.rfind("; ")) +
                                            "; copy it again, or remove it and run: " + again
                                      : what + ": " + again + " --discard-damaged");
      } catch (const Sums::Overlap& overlap) {
        throw std::runtime_error(
            fmt::format("cannot merge {} and {}: both have {} pairs of {}, from index {} on; leave one out",
                        named(stores[overlap.before]), named(stores[overlap.now]), overlap.pairs.pairs,
                        campaign.sources[static_cast<std::size_t>(overlap.pairs.source)].id, overlap.pairs.first));
      }
    }
    if (!partial) expect_no_gaps(stores, sums, options.out);
    if (hunt) join_rounds(stores, held, sums, campaign);
    Outcome outcome = partial ? write_results(campaign, *partial, sums.gaps().empty()) : write_merged(campaign, sums);
    partial.reset();
    for (const auto& [machine, run] : timings) append_timing(campaign.directory, run, outcome.oracle);
    std::error_code error;
    fs::rename(campaign.directory, place, error);  // may replace an empty folder
    if (error) throw std::runtime_error(cannot("put the campaign into", options.out, error.message()));
    fs::remove(beside, unimportant);
    return outcome;
  } catch (...) {
    partial.reset();
    fs::remove_all(campaign.directory, unimportant);
    fs::remove(beside, unimportant);
    throw;
  }
}

}  // namespace graze::fuzz
