// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/proofs.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

void write_proofs(std::ostream& out, const std::vector<std::string>& records) {
  for (const std::string& path : records) {
    try {
      std::ifstream in(path);
      const nlohmann::json record = nlohmann::json::parse(in);
      for (const auto& lane : record.at("lanes")) {
        if (lane.at("differences") != 0 || lane.at("twin_differences") != 0 || lane.at("pairs") == 0 ||
            lane.at("twin_pairs") == 0)
          continue;
        out << fmt::format("{{\"{}\", \"{}\", {{\"{}\", \"{}\", {}.0, {}.0}}}},\n", lane.at("hash").get<std::string>(),
                           lane.at("trace_hash").get<std::string>(), record.at("device").get<std::string>(),
                           record.at("toolkit").get<std::string>(), lane.at("pairs").get<std::uint64_t>(),
                           lane.at("twin_pairs").get<std::uint64_t>());
      }
    } catch (const nlohmann::json::exception& error) {
      throw PtxError(path + ":1: expected a proof record: " + error.what());
    }
  }
}

}  // namespace graze::cuda::twin
