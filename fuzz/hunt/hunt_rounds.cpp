// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/hunt_rounds.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "fuzz/campaign/shard.h"
#include "fuzz/files.h"

namespace graze::fuzz {

namespace fs = std::filesystem;

void HuntRounds::add(const KeptRound& round) {
  all.pairs += round.pairs;
  all.units.insert(all.units.end(), round.units.begin(), round.units.end());
  all.kept.insert(round.kept.begin(), round.kept.end());
  coarse.insert(round.coarse.begin(), round.coarse.end());
  for (std::size_t m = 0; m < all.mutations.size(); ++m) {
    all.mutations[m].pairs += round.mutations[m].pairs;
    all.mutations[m].disagreements += round.mutations[m].disagreements;
    all.mutations[m].units += round.mutations[m].units;
  }
  for (const NewKind& kind : round.kinds) {
    if (kinds.insert(kind.key).second) all.kinds.push_back(kind);
  }
}

Json HuntRounds::told() const {
  Json mutations = Json::array(), in_order = Json::array();
  std::array<std::uint64_t, kMutationCount> kinds_of{};
  for (const NewKind& kind : all.kinds) {
    const auto m = static_cast<std::size_t>(kind.mutation);
    ++kinds_of[m];
    in_order.push_back({{"key", kind.key}, {"index", kind.index}, {"mutation", kMutationIds[m]}});
  }
  for (std::size_t m = 0; m < all.mutations.size(); ++m) {
    mutations.push_back({{"mutation", kMutationIds[m]},
                         {"pairs", all.mutations[m].pairs},
                         {"disagreements", all.mutations[m].disagreements},
                         {"units", all.mutations[m].units},
                         {"kinds", kinds_of[m]}});
  }
  return {{"pairs", all.pairs}, {"units", all.units.size()}, {"mutations", mutations}, {"kinds", in_order}};
}

strata::PairSource source_of_hunt(std::uint64_t pairs, bool in_doubles, std::shared_ptr<const HuntRounds> rounds) {
  strata::PairSource source{"hunt" + std::string(in_doubles ? strata::kInDoubles : ""), pairs, nullptr};
  const auto pair = [rounds](std::uint64_t index) { return rounds->all.kept.at(index).pair; };
  if (in_doubles) {
    source.double_pair = [pair](std::uint64_t index) { return pair(index).doubles; };
  } else {
    source.pair = [pair](std::uint64_t index) { return pair(index).floats.value(); };
  }
  return source;
}

fs::path rounds_folder(const fs::path& hunt) { return hunt / "hunt"; }
std::uint64_t round_pairs(std::uint64_t pairs) {
  return std::clamp(pairs / 32, std::uint64_t{256}, std::uint64_t{32768});
}

fs::path round_file(const fs::path& hunt, const PairRange& share, std::uint64_t first) {
  return rounds_folder(hunt) / fmt::format("{:06}.round", (first - share.first) / round_pairs(share.pairs));
}
fs::path merged_rounds_file(const fs::path& hunt) { return rounds_folder(hunt) / "merged.round"; }

std::uint64_t hunt_checksum(const Json& spec, const Json& build) { return fnv1a(spec.dump() + build.dump()); }

std::vector<KeptRound> read_rounds(const StoreSpec& hunt) {
  std::vector<KeptRound> rounds;
  const std::uint64_t pairs = hunt.spec.at("pairs");
  const PairRange share = share_of(hunt.shard, 0, pairs);
  std::error_code none;
  for (const auto& file : fs::directory_iterator(rounds_folder(hunt.directory), none)) {
    if (file.path().extension() != ".round") continue;
    auto round = parse_round(read_whole(file.path()), hunt_checksum(hunt.spec, hunt.build));
    if (!round) continue;
    const bool merged = file.path() == merged_rounds_file(hunt.directory) && round->pairs == pairs;
    if (merged || file.path() == round_file(hunt.directory, share, round->first)) rounds.push_back(std::move(*round));
  }
  std::sort(rounds.begin(), rounds.end(), [](const KeptRound& l, const KeptRound& r) { return l.first < r.first; });
  return rounds;
}

void expect_rounds_told(const StoreSpec& hunt) {
  HuntRounds found;
  for (const KeptRound& round : read_rounds(hunt)) found.add(round);
  const char* const again = "; remove it, and run the hunt's command again";
  if (found.all.pairs != hunt.spec.at("pairs").get<std::uint64_t>())
    throw std::runtime_error(
        cannot("use", rounds_folder(hunt.directory), std::string("a round is missing or damaged") + again));
  if (read_whole(hunt.directory / "hunt.json") != found.told().dump(1) + "\n")
    throw std::runtime_error(
        cannot("use", hunt.directory / "hunt.json", std::string("it does not match the rounds beside it") + again));
}

}  // namespace graze::fuzz
