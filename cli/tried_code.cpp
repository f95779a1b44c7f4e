// SPDX-License-Identifier: Apache-2.0
#include "cli/tried_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "cli/results.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/text.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

// Returns a name, such as "mine" for src/mine.cpp:meet. A published algorithm's name gets the prefix "my_".
std::string name_for(const fs::path& file) {
  std::string name = file.stem().string();
  while (!fs::path(name).extension().empty()) name = fs::path(name).stem().string();  // libmine.so.1
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  }
  if (name.empty()) return "mine";
  const auto is_taken = [&](const Lane& lane) { return lane.info->id == name; };
  return std::any_of(lanes().begin(), lanes().end(), is_taken) ? "my_" + name : name;
}

constexpr const char* kWritten =
    R"(# Written by graze try: answers lines of 18 numbers by a function of two triangles of three points each.
# python3 THIS_FILE FILE FUNCTION
)";
constexpr std::pair<const char*, std::string_view> kVerdictOfPython[] = {
#include "cli/verdict_py.inc"
};
constexpr const char* kCallsPython = R"(
import importlib.util, operator, os, sys

file, function = sys.argv[1:3]
answers, sys.stdout = sys.stdout, sys.stderr  # what the function prints is not an answer
sys.path.insert(0, os.path.dirname(os.path.abspath(file)))
found = importlib.util.spec_from_file_location(os.path.splitext(os.path.basename(file))[0], file)
module = importlib.util.module_from_spec(found)
found.loader.exec_module(module)
meet = operator.attrgetter(function)(module)
try:
    import numpy

    def triangle(x):
        return numpy.array(x).reshape(3, 3)
except ImportError:

    def triangle(x):
        return [x[0:3], x[3:6], x[6:9]]

for line in sys.stdin:
    if line.startswith("describe"):
        break
    x = [float.fromhex(word) for word in line.split()]
    answer = meet(triangle(x[:9]), triangle(x[9:]))
    try:
        print("01?"[verdict_of(answer, function)], file=answers, flush=True)
    except TypeError as error:
        print(error, file=sys.stderr, flush=True)
        os._exit(1)  # without Python's warnings of coroutines
)";

void expect_program(const std::string& file) {
  if (fs::is_regular_file(file)) return;
  throw std::runtime_error(
      cannot("read", file, fs::exists(file) ? "it is not a regular file" : "there is no such file"));
}

// For a Python function such as "mine.py:meet", writes, beside the folder `out`, a program that calls it.
TriedCode code_of_python(const std::string& file, const std::string& function, const std::string& out) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.' || c >= 0x80; };
  if (function.empty() || !std::all_of(function.begin(), function.end(), fits))
    throw UsageError(fmt::format("expected FILE.py:FUNCTION, found {}", shown(file + ':' + function)));
  const std::string wrapper = out + ".py";
  write_result(wrapper, std::string(kWritten).append(kVerdictOfPython[0].second) + kCallsPython);
  return {name_for(file), fmt::format("cmd:python3 {} {} {}", path_word(wrapper), path_word(file), function), true,
          wrapper};
}

}  // namespace

TriedCode code_of(const std::string& source, const std::string& out) {
  // The form NAME=SOURCE, as for --subject.
  const std::size_t equals = source.find('=');
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
  if (equals != source.npos && equals > 0 &&
      std::all_of(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(equals), fits)) {
    TriedCode code = code_of(source.substr(equals + 1), out);
    code.name = source.substr(0, equals);
    return code;
  }
  if (source.starts_with(kCommand)) {  // named after its last word that is a file, such as mine.py in "python3 mine.py"
    std::string file = "program";
    std::istringstream words(source.substr(kCommand.size()));
    for (std::string word; words >> word;) {
      if (fs::is_regular_file(word)) file = word;
    }
    return {name_for(fs::path(file).filename()), source, true};
  }
  constexpr std::string_view kPython = ".py:";
  if (const std::size_t at = source.rfind(kPython); at != source.npos) {
    const std::size_t colon = at + kPython.size() - 1;
    const std::string file = source.substr(0, colon);
    expect_program(file);
    return code_of_python(file, source.substr(colon + 1), out);
  }
  const std::string extension = fs::path(source).extension().string();
  for (const auto& [ending, program] : {std::pair(".py", "python3"), std::pair(".js", "node")}) {
    if (extension != ending) continue;
    expect_program(source);
    return {name_for(source), fmt::format("cmd:{} {}", program, path_word(source)), true};
  }
  const std::size_t slash = source.rfind('/') + 1, colon = source.find(':', slash);
  return {name_for(source.substr(slash, colon - slash)), source, false};
}

}  // namespace graze::cli
