// SPDX-License-Identifier: Apache-2.0
#include "subjects/program_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/text.h"
#include "subjects/line_protocol.h"

namespace graze::subjects {

using Json = nlohmann::ordered_json;

void add_description(Description& description, const std::string& subject) {
  const std::string& said = description.said;
  if (said == kNoAnswer) {
    fmt::print(stderr,
               "graze: --subject {}: the program did not answer `describe` within 10 s; its version and convention "
               "are not known\n",
               subject);
    return;
  }
  if (said == kLongAnswer)
    throw std::runtime_error(fmt::format("--subject {}: its description is 8 KiB or longer", subject));
  const Json json = Json::parse(said, nullptr, false);
  if (!json.is_object()) return;
  static const std::pair<std::string_view, unsigned> kOutside[] = {{"touching", kOutsideTouching},
                                                                   {"coplanar", kOutsideCoplanar},
                                                                   {"degenerate", kOutsideDegenerate},
                                                                   {"shared", kOutsideShared}};
  for (const auto& [key, unused] : json.items()) {
    constexpr std::string_view kKeys[] = {"version", "source", "convention", "outside"};
    if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys))
      throw std::runtime_error(
          fmt::format("--subject {}: expected version, source, convention and \"outside\" in its description, found {}",
                      subject, shown(key)));
  }
  try {
    const auto text = [&](const char* key) {  // control characters become blanks
      std::string value = json.value(key, "");
      for (char& c : value) c = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
      return value;
    };
    description.version = text("version");
    description.source = text("source");
    description.convention = text("convention");
    for (const std::string& word : json.value("outside", Json::array()).get<std::vector<std::string>>()) {
      const auto found =
          std::find_if(std::begin(kOutside), std::end(kOutside), [&](auto& o) { return o.first == word; });
      if (found == std::end(kOutside))
        throw std::runtime_error(
            fmt::format("--subject {}: expected touching, coplanar, degenerate or shared in \"outside\", "
                        "found '{}'",
                        subject, printable(word)));
      description.outside |= found->second;
    }
  } catch (const Json::exception&) {
    throw std::runtime_error(
        fmt::format("--subject {}: expected texts in its description, and a list of them in \"outside\", "
                    "found {}",
                    subject, printable(said)));
  }
}

}  // namespace graze::subjects
