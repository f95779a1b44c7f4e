// SPDX-License-Identifier: Apache-2.0
#include "subjects/portable.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "core/text.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

fs::path normal(const fs::path& file) { return fs::absolute(file).lexically_normal(); }

bool is_within(const fs::path& file, const fs::path& folder) {
  const fs::path relative = file.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// A compiler flag. A flag that names a folder or a file for the preprocessor has a name and a value: "-I", "dir".
struct PathFlag {
  std::string name, value;  // any other flag: no name, and its text in `value`
  bool is_joined = true;    // name and value are one word; false: two words
};

std::vector<PathFlag> parse_flags(const std::vector<std::string>& words) {
  std::vector<PathFlag> flags;
  for (std::size_t w = 0; w < words.size(); ++w) {
    PathFlag flag{"", words[w]};
    for (const char* name : {"-isystem", "-iquote", "-idirafter", "-include", "-I"}) {
      if (!words[w].starts_with(name)) continue;
      flag = {name, words[w].substr(std::string_view(name).size())};
      if (flag.value.empty() && w + 1 < words.size()) flag = {name, words[++w], false};
      break;
    }
    flags.push_back(flag);
  }
  return flags;
}

// Adds the file, and all files that it includes from its own folder or from these folders.
void add_includes(const fs::path& file, const std::vector<fs::path>& folders, SourceFiles& all) {
  if (!all.files.insert(file).second) return;
  static const std::regex include(R"re(^\s*#\s*(?:include|include_next|import)\s*([<"])([^>"]+)[>"])re");
  std::istringstream lines(code_in(file));
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > 4096 || !std::regex_search(line, found, include)) continue;
    std::vector<fs::path> within = folders;
    if (found[1] == "\"") within.insert(within.begin(), file.parent_path());
    const auto folder = std::find_if(within.begin(), within.end(),
                                     [&](const fs::path& each) { return is_file(normal(each / found[2].str())); });
    if (folder != within.end())
      add_includes(normal(*folder / found[2].str()), folders, all);
    else if (found[1] == "\"")
      all.whole = false;
  }
}

// The innermost folder that contains all these files.
fs::path common_folder(const std::set<fs::path>& files) {
  fs::path folder = files.begin()->parent_path();
  for (const fs::path& file : files) {
    while (!is_within(file, folder)) folder = folder.parent_path();
  }
  return folder;
}

Portable of_source(const Opened& subject, const std::string& folder) {
  const std::vector<PathFlag> flags = parse_flags(subject.wanted.flags);
  const std::set<fs::path> files = source_files(subject).files;
  const auto names_files = [&](const PathFlag& flag) {
    return std::any_of(files.begin(), files.end(), [&](const fs::path& file) {
      return file == normal(flag.value) || (!flag.name.empty() && is_within(file, normal(flag.value)));
    });
  };
  std::set<fs::path> rooted = files;  // plus a file in each folder that the flags name, for common_folder
  for (const PathFlag& flag : flags) {
    if (!flag.name.empty() && flag.name != "-include" && names_files(flag)) rooted.insert(normal(flag.value) / "any");
  }
  const fs::path common = common_folder(rooted);
  const auto packed = [&](const fs::path& file) { return (folder / normal(file).lexically_relative(common)).string(); };
  Portable made;
  for (const fs::path& file : files) made.files.emplace_back(packed(file), file);
  made.what = packed(subject.file) + (subject.function.empty() ? "" : ':' + subject.function);
  for (const PathFlag& flag : flags) {
    const std::string value = names_files(flag) ? packed(flag.value) : flag.value;
    if (flag.is_joined) {
      made.flags.push_back(flag.name + value);
    } else {
      made.flags.insert(made.flags.end(), {flag.name, value});
    }
  }
  return made;
}

void replace_all(std::string& text, const std::string& old, const std::string& now) {
  for (std::size_t at = text.find(old); at != text.npos; at = text.find(old, at + now.size()))
    text.replace(at, old.size(), now);
}

// System folders, whose files are not packed.
constexpr const char* kOfSystem[] = {"/usr/",   "/bin/", "/sbin/", "/lib/", "/lib32/",
                                     "/lib64/", "/opt/", "/etc/",  "/dev/", "/proc/"};

Portable of_command(const Opened& subject, const std::string& folder) {
  Portable made{{}, subject.wanted.what, subject.wanted.flags, {}};
  const fs::path here = fs::current_path();
  for (const HashedFile& file : subject.code.files) {
    const std::string absolute = normal(file.file).string();
    const bool of_system = std::any_of(std::begin(kOfSystem), std::end(kOfSystem),
                                       [&](const char* start) { return absolute.starts_with(start); });
    if (!file.program.empty() || of_system) {
      const std::string program = file.program.empty() ? absolute : file.program;
      made.missing.push_back(fmt::format("{}: the pack does not contain {}, which must exist where the pack runs.",
                                         subject.wanted.name, printable(program)));
      continue;
    }
    // A file below the current folder keeps its relative name, because the command runs in the folder that gets the
    // files.
    const fs::path relative = fs::path(absolute).lexically_relative(here);
    const std::string name =
        is_within(absolute, here) ? relative.string() : (fs::path(folder) / file.file.filename()).string();
    replace_all(made.what, absolute, name);
    if (!is_within(absolute, here)) replace_all(made.what, relative.string(), name);
    made.files.emplace_back(name, absolute);
  }
  return made;
}

}  // namespace

SourceFiles source_files(const Opened& subject) {
  const std::vector<PathFlag> flags = parse_flags(subject.wanted.flags);
  std::vector<fs::path> folders;
  for (const PathFlag& flag : flags) {
    if (!flag.name.empty() && flag.name != "-include") folders.push_back(normal(flag.value));
  }
  SourceFiles all;
  add_includes(normal(subject.file), folders, all);
  for (const PathFlag& flag : flags) {
    const bool is_input = flag.name == "-include" || (flag.name.empty() && !flag.value.starts_with('-'));
    if (is_input && is_file(flag.value)) add_includes(normal(flag.value), folders, all);
  }
  return all;
}

Portable portable(const Opened& subject) {
  const std::string folder = "subjects/" + subject.wanted.name;
  Portable made;
  if (subject.kind == "command") {
    made = of_command(subject, folder);
  } else if (subject.kind != "library") {
    made = of_source(subject, folder);
  } else {
    const std::string name = folder + '/' + subject.file.filename().string();
    made = {{{name, subject.file}},
            name + (subject.function.empty() ? "" : ':' + subject.function),
            subject.wanted.flags,
            {}};
  }
  if (!subject.code.not_covered.empty())
    made.missing.push_back(
        fmt::format("{}: the pack does not contain {}.", subject.wanted.name, subject.code.not_covered));
  return made;
}

}  // namespace graze::subjects
