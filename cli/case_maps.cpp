// SPDX-License-Identifier: Apache-2.0
#include "cli/case_maps.h"

#include <algorithm>

#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/sealed.h"
#include "reports/ulp_map_picture.h"

namespace graze::cli {

using fuzz::Json;
namespace {

// Returns the maps in the file, or null if they are missing or damaged; the caller then draws new maps.
Json stored(const std::filesystem::path& file) {
  try {
    return fuzz::read_sealed(file, "");
  } catch (const corpus::FormatError&) {
    return nullptr;
  }
}

// Whether the stored maps belong to this pair and these lanes.
bool is_current(const Json& maps, const AnyPair& pair, const std::vector<const Lane*>& lanes) {
  std::vector<std::string> ids;
  for (const Lane* lane : lanes) ids.push_back(lane->id);
  if (!reports::is_map_of(maps, pair, ids) || maps["panels"].size() != lanes.size() + 1) return false;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (maps["panels"][l + 1]["name"] != ids[l]) return false;
  }
  return true;
}

}  // namespace

bool map_case(const fuzz::SelectedLanes& under_test, const std::filesystem::path& case_file, const std::string& subject,
              bool again) {
  const std::filesystem::path file = std::filesystem::path(case_file).replace_extension(".maps.json");
  const AnyPair pair = corpus::pair_of(corpus::read_pairs(case_file, PairTypes::both).at(0));
  std::vector<const Lane*> lanes;
  std::copy_if(under_test.lanes.begin(), under_test.lanes.end(), std::back_inserter(lanes),
               [&](const Lane* lane) { return lane->info->id == subject; });
  if (!again && is_current(stored(file), pair, lanes)) return false;
  const analysis::UlpMap map = analysis::ulp_map(pair, lanes, analysis::liveliest_coordinates(pair, lanes));
  fuzz::write_whole(file, fuzz::sealed(reports::to_json(map)).dump(1) + "\n");
  return true;
}

}  // namespace graze::cli
