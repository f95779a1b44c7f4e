// SPDX-License-Identifier: Apache-2.0
#include "fuzz/sealed.h"

#include <fmt/format.h>

#include <set>
#include <vector>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "corpus/pair_format.h"

namespace graze::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kChecksum = "checksum";
constexpr int kDeepest = 64;  // levels; our files have at most ten

std::string checksum_of(const Json& json) {
  return fmt::format("{:016x}", fnv1a(json.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

}  // namespace

Json parse_shallow(const std::string& text) {
  // The parser would treat a zero byte, which no JSON text has, as the end of the text.
  if (text.find('\0') != text.npos) return Json(Json::value_t::discarded);
  struct Refused {};  // thrown to end the parsing at once
  using Event = Json::parse_event_t;
  std::vector<std::set<std::string>> keys;  // of the enclosing objects
  const auto check = [&](int enclosing, Event event, const Json& parsed) {
    if ((event == Event::object_start || event == Event::array_start) && enclosing >= kDeepest) throw Refused();
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second) throw Refused();
    if (event == Event::object_end) keys.pop_back();
    return true;
  };
  try {
    return Json::parse(text, check, false);
  } catch (const Refused&) {
    return Json(Json::value_t::discarded);
  }
}

Json sealed(Json json) {
  json.erase(kChecksum);
  json[kChecksum] = checksum_of(json);
  return json;
}

Json read_sealed(const std::filesystem::path& file, const std::string& remedy, NamedBy named_by) {
  if (!std::filesystem::exists(file)) return nullptr;
  const std::string text = read_whole(file, named_by);
  Json json = parse_shallow(text);
  const auto refused = [&](const char* found) {
    return corpus::FormatError(
        cannot("use", file, fmt::format("it has been changed or damaged since graze wrote it: {}; {}", found, remedy)));
  };
  if (!json.is_object()) throw refused("it is not a JSON object, or it repeats a key");
  if (!json.contains(kChecksum)) throw refused("its checksum is missing");
  const Json checksum = std::move(json[kChecksum]);
  json.erase(kChecksum);
  if (checksum != checksum_of(json)) throw refused("its checksum differs");
  return json;
}

}  // namespace graze::fuzz
