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

bool is_too_deep(const std::string& text) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\') ++i;
    if (c == '"') in_text = !in_text;
    if (in_text) continue;
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (depth > kDeepest) return true;
  }
  return false;
}

std::string checksum_of(const Json& json) {
  return fmt::format("{:016x}", fnv1a(json.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

}  // namespace

Json parse_shallow(const std::string& text) {
  // The parser would treat a zero byte, which no JSON text has, as the end of the text.
  if (is_too_deep(text) || text.find('\0') != text.npos) return Json(Json::value_t::discarded);
  std::vector<std::set<std::string>> keys;  // of the enclosing objects
  bool twice = false;
  Json json = Json::parse(
      text,
      [&](int, Json::parse_event_t event, const Json& parsed) {
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::key) twice |= !keys.back().insert(parsed.get<std::string>()).second;
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        return true;
      },
      false);
  return twice ? Json(Json::value_t::discarded) : json;
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
