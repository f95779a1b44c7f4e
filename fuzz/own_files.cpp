// SPDX-License-Identifier: Apache-2.0
#include "fuzz/own_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/cannot.h"
#include "core/error.h"
#include "fuzz/files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// The object's first keys, at most two.
std::vector<std::string> first_keys(const nlohmann::ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, unused] : object.items()) {
    keys.push_back(key);
    if (keys.size() == 2) break;
  }
  return keys;
}

// The text that marks files of the same kind as `text`. For a JSON object, the mark is the text up to the end of the
// first key; for a page, the start of the title; for a PNG, the start of the palette; for other files, the first line
// up to `>`, because the rest of an SVG's first line varies.
std::string mark_of(const std::string& text) {
  constexpr std::string_view kTitle = "<title>Graze: ", kPalette = "PLTE";
  constexpr std::size_t kColours = 24;  // bytes: the first eight colours, which all ulp maps share
  if (text.starts_with("\x89PNG"))
    return text.substr(std::min(text.find(kPalette), text.size()), kPalette.size() + kColours);
  const std::size_t key = text.find('"');
  if (text.starts_with('{') && key != text.npos) return text.substr(0, text.find('"', key + 1) + 1);
  if (text.find(kTitle) != text.npos) return std::string(kTitle);
  return text.substr(0, text.find_first_of(">\n"));
}

// Whether both texts are objects with the same first two keys; `there` may be damaged after the first key.
bool same_kind_of_object(const std::string& there, const std::string& text) {
  const auto theirs = nlohmann::ordered_json::parse(there, nullptr, false),
             ours = nlohmann::ordered_json::parse(text, nullptr, false);
  if (theirs.is_discarded()) return there.starts_with(mark_of(text));
  return theirs.is_object() && ours.is_object() && first_keys(theirs) == first_keys(ours);
}

// Whether the entry is left over from an interrupted write, or is a folder that holds only such entries.
bool is_nothing(const fs::path& entry) {
  if (is_left_over(entry)) return true;
  return fs::is_directory(fs::symlink_status(entry)) &&
         std::all_of(fs::directory_iterator(entry), fs::directory_iterator(),
                     [](const auto& e) { return is_nothing(e.path()); });
}

}  // namespace

bool may_replace(const fs::path& file, const std::string& text) {
  std::error_code none;
  if (!fs::is_regular_file(file, none)) return true;  // write_whole rejects folders
  const std::string there = read_whole(file);
  if (there.empty()) return true;
  if (text.starts_with('{')) return same_kind_of_object(there, text);
  const std::string mark = mark_of(text);
  const bool at_the_start = text.starts_with(mark);
  return !mark.empty() && (at_the_start ? there.starts_with(mark) : there.find(mark) != there.npos);
}

void expect_own(const fs::path& file, const std::string& text) {
  constexpr std::string_view kResults[] = {"summary.json",  "status.json", "timings.json",
                                           "failures.json", "hunt.json",   "margins.svg"};
  std::error_code none;
  const bool in_question =
      fs::is_symlink(fs::symlink_status(file, none)) || file.parent_path().filename() == "cases" ||
      std::find(std::begin(kResults), std::end(kResults), file.filename().string()) != std::end(kResults);
  if (may_replace_foreign || !in_question || !fs::is_regular_file(file, none) || fs::file_size(file, none) == 0) return;
  if (!read_whole(file).starts_with(mark_of(text)) && !may_replace(file, text))
    throw UsageError(cannot("replace", file, kForeign));
}

bool is_left_over(const fs::path& file) {
  return file.string().ends_with(kPart) && fs::is_regular_file(fs::symlink_status(file));
}

bool may_fill(const fs::path& folder, std::initializer_list<const char*> own) {
  std::error_code none;
  if (!fs::is_directory(folder, none)) return true;  // if it is a file, creating the folder reports that
  const auto has_own = [&] {
    return std::any_of(own.begin(), own.end(), [&](const char* name) { return fs::exists(folder / name); });
  };
  // Checked again at the end, because another Graze process may have written there meanwhile.
  return has_own() ||
         std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const auto& e) { return is_nothing(e.path()); }) ||
         has_own();
}

}  // namespace graze::fuzz
