// SPDX-License-Identifier: Apache-2.0
#include "subjects/toolchains/toolchains.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "core/cannot.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "core/programs/run_program.h"
#include "core/toml.h"
#include "core/variants.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<const char*, std::string_view> kBuiltIn[] = {
#include "subjects/toolchains/built_in.inc"
};

constexpr std::size_t kMostBytes = 1 << 20;
constexpr std::size_t kLongestName = 64;
constexpr std::string_view kRoundings[] = {"rounded", "contracted", "excess", "fast"};

[[noreturn]] void fail(const std::string& where, const std::string& expected, const std::string& found) {
  throw std::runtime_error(fmt::format("{}: expected {}, found {}", where, expected, found));
}

// The text columns, in the order of records.
constexpr std::pair<const char*, std::string Toolchain::*> kTexts[] = {
    {"name", &Toolchain::name},   {"cxx", &Toolchain::cxx},       {"cc", &Toolchain::cc},    {"run", &Toolchain::run},
    {"needs", &Toolchain::needs}, {"strict", &Toolchain::strict}, {"file", &Toolchain::file}};

std::optional<Rounding> rounding_of(const std::string& word) {
  const auto found = std::find(std::begin(kRoundings), std::end(kRoundings), word);
  if (found == std::end(kRoundings)) return std::nullopt;
  return static_cast<Rounding>(found - std::begin(kRoundings));
}

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  std::vector<Toolchain> toolchains(const toml::table& root) const {
    keys(root, {"toolchain"});
    const toml::array* rows = root["toolchain"].as_array();
    if (!rows || rows->empty()) fail(name_, "a table [[toolchain]]", "none");
    std::vector<Toolchain> result;
    for (const toml::node& row : *rows) {
      if (!row.is_table()) fail(at(row), "a table [[toolchain]]", found_text(row));
      result.push_back(toolchain(*row.as_table()));
      const auto same = [&](const Toolchain& t) { return t.name == result.back().name; };
      if (std::count_if(result.begin(), result.end(), same) > 1)
        fail(at(row), "another name", shown(result.back().name) + " again");
    }
    return result;
  }

 private:
  // of: a node or a key.
  std::string at(const auto& of) const { return fmt::format("{}:{}", name_, of.source().begin.line); }

  void keys(const toml::table& table, const std::vector<std::string>& known) const {
    for (const auto& [key, value] : table) {
      const std::string word(key.str());
      if (std::find(known.begin(), known.end(), word) == known.end())
        fail(at(key), fmt::format("{}", fmt::join(known, ", ")), shown(word) + did_you_mean(word, known));
    }
  }

  Toolchain toolchain(const toml::table& row) const {
    keys(row, {"name", "cxx", "cc", "run", "needs", "strict", "rounding"});
    Toolchain t;
    for (const auto& [key, text_of] : kTexts) {
      const toml::node* node = row.get(key);
      if (!node || text_of == &Toolchain::file) continue;
      const std::optional<std::string> text = node->value_exact<std::string>();
      if (!text || text->find_first_of(std::string_view("\n\0", 2)) != text->npos)
        fail(at(*node), "a text of one line", found_text(*node));
      t.*text_of = *text;
    }
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; };
    if (t.name.empty() || t.name.size() > kLongestName || !std::all_of(t.name.begin(), t.name.end(), fits))
      fail(at(row), "name = \"…\" of letters, digits, '-', '_' and '.'", shown(t.name));
    if (variant_of_name(t.name)) fail(at(row), "a name that no variant of Graze has", shown(t.name));
    if (t.cxx.empty() && t.cc.empty()) fail(at(row), "cxx or cc, the command of a compiler", "neither");
    if (const toml::node* node = row.get("rounding")) {
      const std::optional<Rounding> rounding = rounding_of(node->value_exact<std::string>().value_or(""));
      if (!rounding) fail(at(*node), fmt::format("{}", fmt::join(kRoundings, ", ")), found_text(*node));
      t.rounding = *rounding;
    }
    return t;
  }

  const std::string& name_;
};

// The program that a command starts: its first word that does not set a variable.
std::string program_of(std::string_view command) {
  for (std::size_t at = command.find_first_not_of(' '); at != command.npos; at = command.find_first_not_of(' ', at)) {
    const std::size_t end = std::min(command.find(' ', at), command.size());
    if (const std::string_view word = command.substr(at, end - at); word.find('=') == word.npos)
      return std::string(word);
    at = end;
  }
  return "";
}

}  // namespace

std::string missing_program(std::string_view command) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./~@:,%";
  const std::string program = program_of(command);
  if (program.empty() || program.find_first_not_of(kPlain) != program.npos) return "";
  const bool found = std::system(("command -v -- " + program + " > /dev/null 2>&1").c_str()) == 0;
  return found ? "" : program;
}

std::string_view name(Rounding rounding) { return kRoundings[static_cast<int>(rounding)]; }

nlohmann::ordered_json to_json(const Toolchain& toolchain) {
  nlohmann::ordered_json row;
  for (const auto& [key, text] : kTexts) {
    if (!(toolchain.*text).empty()) row[key] = toolchain.*text;
  }
  row["rounding"] = name(toolchain.rounding);
  return row;
}

Toolchain toolchain_of_json(const nlohmann::ordered_json& row) {
  Toolchain toolchain;
  for (const auto& [key, text] : kTexts) toolchain.*text = row.value(key, "");
  const std::string word = row.at("rounding");
  const std::optional<Rounding> rounding = rounding_of(word);
  if (!rounding) throw std::runtime_error(fmt::format("expected a toolchain's rounding, found {}", shown(word)));
  toolchain.rounding = *rounding;
  return toolchain;
}

const std::vector<Toolchain>& built_in_toolchains() {
  static const std::vector<Toolchain> all = parse_toolchains(kBuiltIn[0].first, kBuiltIn[0].second);
  return all;
}

std::vector<Toolchain> parse_toolchains(const std::string& name, std::string_view text) {
  if (text.size() > kMostBytes) fail(name, fmt::format("at most {} bytes", kMostBytes), std::to_string(text.size()));
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed)
    fail(fmt::format("{}:{}", name, parsed.error().source().begin.line), "TOML",
         printable(parsed.error().description()));
  return Reader(name).toolchains(parsed.table());
}

std::string list_of(const std::vector<Toolchain>& toolchains) {
  std::vector<std::string> words;
  for (const Toolchain& toolchain : toolchains) {
    const std::string& word = toolchain.file.empty() ? toolchain.name : toolchain.file;
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  }
  return fmt::format("{}", fmt::join(words, ","));
}

std::vector<Toolchain> selected_toolchains(const std::string& list) {
  std::vector<Toolchain> known = built_in_toolchains(), selected;
  std::vector<std::string> patterns;
  const auto put = [](std::vector<Toolchain>& to, const Toolchain& t) {
    const auto same = std::find_if(to.begin(), to.end(), [&](const Toolchain& other) { return other.name == t.name; });
    if (same == to.end()) {
      to.push_back(t);
    } else {
      *same = t;
    }
  };
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word = list.substr(begin, end - begin);
    begin = end + 1;
    if (!word.ends_with(".toml")) {
      patterns.push_back(word == "all" ? "*" : word);
      continue;
    }
    std::string why;
    const std::optional<std::string> text = plain_file(word, why);
    if (!text) throw std::runtime_error(cannot("read", word, why));
    for (Toolchain& t : parse_toolchains(word, *text)) {
      t.file = fs::absolute(word).lexically_normal().string();
      put(known, t);
      patterns.push_back(t.name);
    }
  }
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (const Toolchain& t : known) {
      if (fnmatch(pattern.c_str(), t.name.c_str(), 0) != 0) continue;
      put(selected, t);
      any = true;
    }
    if (any) continue;
    std::vector<std::string> names;
    for (const Toolchain& t : known) names.push_back(t.name);
    throw UsageError(fmt::format("--toolchains: expected all, FILE.toml or some of {}, found {}",
                                 fmt::join(names, ", "), shown(pattern) + did_you_mean(pattern, names)));
  }
  return selected;
}

std::string why_not_here(const Toolchain& toolchain) {
  for (const std::string& command : {toolchain.cxx.empty() ? toolchain.cc : toolchain.cxx, toolchain.run}) {
    const std::string program = missing_program(command);
    if (program.empty()) continue;
    return fmt::format("no {}{}", program,
                       toolchain.needs.empty() ? "" : fmt::format(" (install {})", toolchain.needs));
  }
  return "";
}

}  // namespace graze::subjects
