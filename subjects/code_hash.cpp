// SPDX-License-Identifier: Apache-2.0
#include "subjects/code_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/fnv1a.h"
#include "core/text.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// Splits the command into words as a shell does, without expanding variables and patterns.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(std::move(word));
    word.clear();
  };
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (quote) {
      c == quote ? void(quote = 0) : word.push_back(c);
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '\\' && i + 1 < command.size()) {
      word.push_back(command[++i]);
    } else if (std::string_view(" \t\n;|&<>()").find(c) != std::string_view::npos) {
      end_word();
    } else {
      word.push_back(c);
    }
  }
  end_word();
  return words;
}

bool is_file(const fs::path& file) {
  std::error_code none;
  return fs::is_regular_file(file, none);
}

// The program's file on the PATH; empty when there is none.
fs::path on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (is_file(fs::path(folder) / program)) return fs::path(folder) / program;
  }
  return {};
}

// The parts of the text between these characters.
std::set<std::string> parts_of(const std::string& text, std::string_view ends) {
  std::set<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends, begin), text.size());
    if (end > begin) parts.insert(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::uint64_t add_number(std::uint64_t number, std::uint64_t hash) {
  return fnv1a({reinterpret_cast<const char*>(&number), sizeof number}, hash);
}

}  // namespace

std::uint64_t hash_of_file(const fs::path& file) {
  std::error_code why;
  const bool regular = fs::is_regular_file(file, why);
  std::ifstream in;
  if (regular) in.open(file, std::ios::binary);  // opening a pipe without a writer would block
  std::ostringstream text;
  if (!regular || !(text << in.rdbuf())) {
    throw std::runtime_error(fmt::format("--subject: cannot read the code in {}: {}", shown_path(file.string()),
                                         why       ? why.message()
                                         : regular ? std::strerror(errno)
                                                   : "not a file"));
  }
  return fnv1a(text.str());
}

CodeHash hash_of_library(const fs::path& file) { return {hash_of_file(file), "the libraries that it loads"}; }

CodeHash hash_of_command(const std::string& command) {
  const bool is_expanded = command.find_first_of("$`*?[~{") != command.npos;
  CodeHash code{fnv1a(command), is_expanded ? "the files that the shell puts in for $, `, *, ?, [, ~ or {, or of what "
                                              "its files load"
                                            : "what its files load"};
  const std::vector<std::string> words = words_of(command);
  const auto is_setting = [](const std::string& word) { return word.find('=') != word.npos; };  // NAME=VALUE
  const auto program = std::find_if_not(words.begin(), words.end(), is_setting);
  if (program != words.end() && program->find('/') == program->npos) {
    if (const fs::path file = on_path(*program); !file.empty()) code.hash = add_number(hash_of_file(file), code.hash);
  }
  // Also files named within words: sh -c "exec python3 s.py", SCRIPT=./s.py.
  std::set<std::string> files = parts_of(command, " \t\n;|&<>()'\"`=:,{}[]$\\");
  files.insert(words.begin(), words.end());
  for (const std::string& file : files) {
    if (is_file(file)) code.hash = add_number(hash_of_file(file), fnv1a(file, code.hash));
  }
  return code;
}

std::uint64_t hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash) {
  for (const std::string& flag : flags) {
    hash = fnv1a(flag + '\n', hash);
    // Also files named within words: -Wl,FILE and -Wl,--script=FILE, @FILE.
    std::set<std::string> files = parts_of(flag, ",=@");
    files.insert(flag);
    for (const std::string& file : files) {
      if (is_file(file)) hash = add_number(hash_of_file(file), hash);
    }
  }
  return hash;
}

CodeHash hash_of_builds(const std::vector<Built>& built) {
  CodeHash code{fnv1a(""), built.empty() ? "" : built.front().not_covered};
  for (const Built& build : built) code.hash = fnv1a(build.file.stem().string(), code.hash);
  return code;
}

CodeHash hash_of_ptx(const std::vector<std::string_view>& variants) {
  CodeHash code{fnv1a(""), ""};
  for (const std::string_view ptx : variants) {
    std::istringstream lines{std::string(ptx)};
    for (std::string line; std::getline(lines, line);) {
      const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
      const bool place = line.compare(first, 4, ".loc") == 0 || line.compare(first, 5, ".file") == 0;
      if (!place) code.hash = fnv1a(line, code.hash);
    }
  }
  return code;
}

}  // namespace graze::subjects
