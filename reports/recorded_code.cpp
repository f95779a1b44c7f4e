// SPDX-License-Identifier: Apache-2.0
#include "reports/recorded_code.h"

#include <fmt/format.h>

#include "core/text.h"
#include "reports/discrepancy_reading.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;

Json code_json(const Json& recorded) {
  Json code;
  for (const Json& row : recorded) {
    code.push_back({{"name", row.at("name")}, {"what", row.at("what")}, {"hash", row.at("hash")}});
    for (const char* key : {"source_hash", "compiler", "flags", "environment"}) {
      if (row.contains(key) && !row[key].empty()) code.back()[key] = row[key];
    }
    for (const Json& toolchain : row.value("toolchains", Json::array())) {
      if (toolchain.contains("contraction"))
        code.back()["contraction"][toolchain.at("name").get<std::string>()] = toolchain["contraction"];
    }
  }
  return code;
}

std::string code_words(const Json& of) {
  std::string text = fmt::format("{} (hash {}", text_at(of, "what"), text_at(of, "hash"));
  if (of.contains("compiler")) text += ", by " + text_at(of, "compiler");
  const Json flags = of.value("flags", Json::array()), environment = of.value("environment", Json::object());
  for (const Json& flag : flags) text += ' ' + printable(flag.get<std::string>());
  for (const auto& [name, value] : environment.items())
    text += fmt::format(", {}={}", printable(name), printable(value.get<std::string>()));
  return text + ')';
}

std::vector<std::string> code_differences(const Json& before, const Json& after) {
  std::vector<std::string> sentences;
  for (const Json& old : before.value("subjects", Json::array())) {
    for (const Json& now : after.value("subjects", Json::array())) {
      if (old.at("name") == now.at("name") && old.at("hash") != now.at("hash"))
        sentences.push_back(fmt::format("The code of {} differs: {} before, {} after.", text_at(old, "name"),
                                        code_words(old), code_words(now)));
    }
  }
  return sentences;
}

}  // namespace graze::reports
