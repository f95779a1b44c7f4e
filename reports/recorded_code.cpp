// SPDX-License-Identifier: Apache-2.0
#include "reports/recorded_code.h"

#include <fmt/format.h>

#include "reports/discrepancy_reading.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;

Json code_json(const Json& recorded) {
  Json code;
  for (const Json& row : recorded)
    code.push_back({{"name", row.at("name")}, {"what", row.at("what")}, {"hash", row.at("hash")}});
  return code;
}

std::vector<std::string> code_differences(const Json& before, const Json& after) {
  std::vector<std::string> sentences;
  const auto words = [](const Json& of) {
    return fmt::format("{} (hash {})", text_at(of, "what"), text_at(of, "hash"));
  };
  for (const Json& old : before.value("subjects", Json::array())) {
    for (const Json& now : after.value("subjects", Json::array())) {
      if (old.at("name") == now.at("name") && old.at("hash") != now.at("hash"))
        sentences.push_back(fmt::format("They differ in the code of {}: {} before, {} after.", text_at(old, "name"),
                                        words(old), words(now)));
    }
  }
  return sentences;
}

}  // namespace graze::reports
