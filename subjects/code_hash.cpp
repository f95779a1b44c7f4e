// SPDX-License-Identifier: Apache-2.0
#include "subjects/code_hash.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/programs/run_program.h"
#include "core/stop.h"
#include "core/text.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// Splits the command into words as a shell does, without expanding variables or patterns. Files that the command writes
// to (> FILE) go into `written` instead.
std::vector<std::string> words_of(const std::string& command, std::set<std::string>& written) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  bool writes = false;
  const auto end_word = [&] {
    if (word.empty()) return;
    writes ? void(written.insert(word)) : words.push_back(word);
    writes = false;
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
      writes = c == '>' ? i == 0 || command[i - 1] != '<' : writes && c != '&' && c != ';' && c != '\n';
    } else {
      word.push_back(c);
    }
  }
  end_word();
  return words;
}

// The parts of the text that these characters separate.
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

FileState state_of(const fs::path& file) {
  struct stat now {};
  if (stat(file.c_str(), &now) != 0) return {};
  return {static_cast<std::int64_t>(now.st_dev),
          static_cast<std::int64_t>(now.st_ino),
          now.st_size,
          now.st_mtim.tv_sec,
          now.st_mtim.tv_nsec,
          now.st_ctim.tv_sec,
          now.st_ctim.tv_nsec};
}

bool is_file(const fs::path& file) {
  std::error_code none;
  return fs::is_regular_file(file, none);
}

std::string code_in(const fs::path& file) {
  const StopSignals stops;
  std::string why;
  if (auto text = plain_file(file, why)) return *text;
  throw std::runtime_error(fmt::format("--subject: cannot read the code in {}: {}", shown_path(file.string()), why));
}

std::uint64_t hash_of_file(const fs::path& file) { return fnv1a(code_in(file)); }

void expect_unchanged(const std::vector<HashedFile>& files) {
  for (const HashedFile& file : files) {
    if (const fs::path now = file.program.empty() ? fs::path() : on_path(file.program);
        !now.empty() && fs::absolute(now) != file.file) {
      throw std::runtime_error(fmt::format(
          "--subject: the PATH now finds {}, but found {} when the command that names it started. The verdicts may "
          "come from either code and are not recorded; restore the PATH's folders to resume, or start again with "
          "another "
          "--out",
          shown_path(now.string()), shown_path(file.file.string())));
    }
    if (state_of(file.file) == file.state || (is_file(file.file) && hash_of_file(file.file) == file.hash)) continue;
    throw std::runtime_error(fmt::format(
        "--subject: {} changed while the command that names it ran. The verdicts may come from either code and are not "
        "recorded; restore the file to resume, or start again with another --out. A file that the program itself "
        "writes "
        "must be named after '>' or in a variable",
        shown_path(file.file.string())));
  }
}

namespace {

// Describes the code that a command's hash does not cover. The hash covers the command's own code if the command is a
// program, by itself or with a file as its first argument, and if the shell changes no folder, name or program.
std::string not_covered_of(const std::string& command, std::vector<std::string> words, const fs::path& program) {
  if (program.empty() || command.find_first_of(";|&<>()$`*?[~{}!#\n") != command.npos ||
      command.find("PATH=") != command.npos)
    return "the code that it runs and what that code loads, because only the shell knows its files";
  if (words.size() == 1 || is_file(words[1])) return "what its files load";
  return fmt::format("the code that it runs (except '{}' itself) and what its files load", printable(words[0]));
}

}  // namespace

CodeHash hash_of_command(const std::string& command) {
  std::set<std::string> written;
  const std::vector<std::string> all = words_of(command, written);
  std::vector<std::string> words = all;
  const auto is_setting = [](const std::string& word) { return word.find('=') != word.npos; };  // NAME=VALUE
  words.erase(words.begin(), std::find_if_not(words.begin(), words.end(), is_setting));
  if (words.size() > 1 && words[0] == "exec") words.erase(words.begin());
  const fs::path program = words.empty()                         ? fs::path()
                           : words[0].find('/') == words[0].npos ? on_path(words[0])
                           : is_file(words[0])                   ? fs::path(words[0])
                                                                 : fs::path();
  CodeHash code{fnv1a(command), not_covered_of(command, words, program)};
  const auto add = [&](const fs::path& file, const std::string& name = "") {
    const auto state = state_of(file);
    code.files.push_back({fs::absolute(file), hash_of_file(file), state, name});
    code.hash = add_number(code.files.back().hash, code.hash);
  };
  if (!program.empty() && words[0].find('/') == words[0].npos) add(program, words[0]);
  // Also finds files that are named within words: sh -c "exec python3 s.py", SCRIPT=./s.py.
  std::set<std::string> files = parts_of(command, " \t\n;|&<>()'\"`=:,{}[]$\\");
  for (const std::string& file : written) files.erase(file);
  files.insert(all.begin(), all.end());
  for (const std::string& file : files) {
    if (!is_file(file)) continue;
    code.hash = fnv1a(file, code.hash);
    add(file);
  }
  return code;
}

namespace {

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view beginning) { return text.starts_with(beginning); });
}

// Whether the file is a relocatable object or an archive. Unlike linker scripts, these name no other files.
bool is_object(const fs::path& file) {
  std::string bytes = beginning_of(file, 18);
  bytes.resize(18);
  return bytes.starts_with("!<arch>\n") || (bytes.starts_with("\x7f"
                                                              "ELF") &&
                                            bytes[16] + bytes[17] == 1);  // ET_REL
}

// Whether the hash covers the flag's effect: every file that the flag adds shows in the preprocessor's output.
bool is_covered(const std::string& flag) {
  const std::size_t equals = flag.find('=');
  const std::string value = equals == flag.npos ? "" : flag.substr(equals + 1);
  const bool names_a_file = value.find('/') != value.npos || is_file(value);
  if (flag == "-include" || starts_with_any(flag, {"-D", "-U", "-I", "-isystem", "-iquote", "-idirafter", "-O", "-w",
                                                   "-pedantic", "-pipe", "-pthread", "-ansi", "-nostdinc"}))
    return true;
  if (starts_with_any(flag, {"-Wl,", "-Wa,", "-Wp,", "-fprofile", "-fauto-profile", "-fbranch-prob", "-fplugin",
                             "-fpass", "-fuse-ld", "-fmodule", "-mllvm"}))
    return false;
  if (starts_with_any(flag, {"-W", "-f", "-m", "-std=", "-g0", "-g1", "-g2", "-g3", "-ggdb", "-gdwarf"}) ||
      flag == "-g")
    return !names_a_file;
  return !flag.starts_with('-') && is_object(flag);
}

}  // namespace

CodeHash hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash) {
  CodeHash code{hash, ""};
  std::set<std::string> uncovered;
  bool takes_next = false;  // whether the next word is the value of this preprocessor flag, as after -I
  for (const std::string& flag : flags) {
    code.hash = fnv1a(flag + '\n', code.hash);
    // A part of a word may also be a file name: -Wl,FILE, -Wl,--script=FILE, @FILE.
    std::set<std::string> files = parts_of(flag, ",=@");
    files.insert(flag);
    for (const std::string& file : files) {
      if (is_file(file)) code.hash = add_number(hash_of_file(file), code.hash);
    }
    if (starts_with_any(flag, {"-l", "-Wl,", "-Xlinker", "@"})) {
      uncovered.insert("the libraries that its flags link");
    } else if (!takes_next && !is_covered(flag)) {
      uncovered.insert("what " + printable(flag) + " brings in");
    }
    takes_next = !takes_next && (flag == "-D" || flag == "-U" || flag == "-I" || flag == "-isystem" ||
                                 flag == "-iquote" || flag == "-idirafter" || flag == "-include");
  }
  for (const std::string& what : uncovered) code.not_covered += (code.not_covered.empty() ? "" : ", ") + what;
  return code;
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
