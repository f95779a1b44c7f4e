// SPDX-License-Identifier: Apache-2.0
#include "reports/snippet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "backends/backends.h"
#include "corpus/pair_format.h"
#include "reports/foreign_snippet.h"

namespace graze::reports {
namespace {

struct Embedded {
  std::string_view path, text;
};
constexpr Embedded kEmbedded[] = {
#include "embedded.inc"
};

// The file's text; null if it is not embedded.
const std::string_view* find_embedded(std::string_view path) {
  const auto file = std::find_if(std::begin(kEmbedded), std::end(kEmbedded), [&](auto& f) { return f.path == path; });
  return file == std::end(kEmbedded) ? nullptr : &file->text;
}

// A header and everything that it includes, each file once, in the order in which a compiler would read them.
struct Amalgamation {
  std::set<std::string> seen, system;
  std::string text;

  void add(const std::string& path) {
    if (!seen.insert(path).second) return;
    std::string own;
    std::istringstream lines{std::string(embedded(path))};
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("#include \"")) {
        add(line.substr(10, line.size() - 11));
      } else if (line.starts_with("#include <")) {
        system.insert(line);
      } else if (line != "#pragma once" && !line.starts_with("// SPDX-")) {
        const bool doubled_gap = line.empty() && (own.empty() || own.ends_with("\n\n"));
        if (!doubled_gap) own += line + '\n';
      }
    }
    text += '\n' + own;
  }
};

std::string header_of(std::string_view algorithm_id) { return fmt::format("core/algorithms/{}.h", algorithm_id); }

// The name of the algorithm's struct, which is the one with kInfo.
std::string type_name(std::string_view algorithm_id) {
  const std::string_view text = embedded(header_of(algorithm_id));
  constexpr std::string_view kStruct = "struct ";
  const std::size_t info = text.find("AlgorithmInfo kInfo");
  const std::size_t at = info == text.npos ? info : text.rfind(kStruct, info);
  if (at == text.npos) throw std::logic_error(fmt::format("{}: expected a struct with kInfo", algorithm_id));
  const std::size_t first = at + kStruct.size();
  return std::string(text.substr(first, text.find(' ', first) - first));
}

// The flags of a variant, each with a trailing space. Flags for x86 are given only on x86.
std::string flags_of(Variant variant) {
  std::string text;
  std::istringstream flags{std::string(info_of(variant).flags)};
  for (std::string flag; flags >> flag;) {
#ifndef __x86_64__
    if (flag.starts_with("-m")) continue;
#endif
    if (flag != "-O3") text += flag + ' ';
  }
  return text;
}

#ifdef __clang__
constexpr std::string_view kCompiler = "clang++";
#else
constexpr std::string_view kCompiler = "g++";
#endif
constexpr std::string_view kTestLibraries = " -lgtest -lgtest_main -pthread";

// The command that compiles and runs the snippet, with the flags of the lane's build.
std::string command(SnippetKind kind, const Lane* lane) {
  const std::string flags = lane ? flags_of(lane->variant) : "";
  switch (kind) {
    case SnippetKind::cpp:
    case SnippetKind::gtest:
      return fmt::format("{} -std=c++20 -O3 {}case.cpp{} -o case && ./case", kCompiler, flags,
                         kind == SnippetKind::gtest ? kTestLibraries : "");
    case SnippetKind::cuda:
      return fmt::format("nvcc -std=c++20 -O3 -arch=native {}case.cu -o case && ./case", flags);
    case SnippetKind::cgal:
      return fmt::format("{} -std=c++20 case.cpp -lmpfr -lgmp -o case && ./case", kCompiler);
    case SnippetKind::python:
      return "python3 case.py";
    case SnippetKind::obj:
      break;
  }
  return "";
}

std::string_view file_of(SnippetKind kind) {
  constexpr std::string_view kFiles[] = {"lane.cpp.in", "lane.cu.in",  "truth.py.in",
                                         "pair.obj.in", "cgal.cpp.in", "gtest.cpp.in"};
  return kFiles[static_cast<std::size_t>(kind)];
}

// The vertices of one triangle in the kind's language; C++ shows decimals beside the exact values.
template <class Real>
std::string vertices(SnippetKind kind, const Vec3<Real> (&triangle)[3], char label) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    const Vec3<Real>& v = triangle[i];
    const std::string x = corpus::hex_float(v.x), y = corpus::hex_float(v.y), z = corpus::hex_float(v.z);
    // These digits identify a float32, even if they are read as a double first, and a double.
    constexpr int kDigits = std::numeric_limits<Real>::max_digits10;
    const std::string decimals = fmt::format("{0:.{3}g} {1:.{3}g} {2:.{3}g}", v.x, v.y, v.z, kDigits);
    if (kind == SnippetKind::python) {
      text += fmt::format("{}\"{} {} {}\"", i > 0 ? ",\n     " : "", x, y, z);
    } else if (kind == SnippetKind::obj) {
      text += fmt::format("# {} {} {}\nv {}\n", x, y, z, decimals);
    } else {
      const char* suffix = std::is_same_v<Real, float> ? "f" : "";
      text += fmt::format("    {0}{6}, {1}{6}, {2}{6},  // {3}[{4}]: {5}\n", x, y, z, label, i, decimals, suffix);
    }
  }
  return text;
}

// Replaces characters that could end the comment around the name, because names come from files.
std::string in_comment(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

// The call that decides a and b, and the text that must precede the call.
struct Call {
  std::string call, before;
};

Call call_of(const Lane& lane, std::string_view algorithm) {
  if (!lane.under) return {fmt::format("{}::decide(a, b)", algorithm), ""};
  const Epsilons& epsilons = lane.under->epsilons;
  const std::string_view real = lane.scalar == Scalar::f32 ? "float" : "double";
  return {fmt::format("graze::decide_within<{}, {}>(a, b, graze::Tolerances<{}>(graze::Epsilons{{{{{}}}, {{{}}}}}))",
                      algorithm, epsilons.any_relative() ? fmt::format("graze::WithMagnitude<{}>", real) : real, real,
                      fmt::join(epsilons.absolute, ", "), fmt::join(epsilons.relative, ", ")),
          fmt::format(
              "// The policy {}: absolute and relative tolerances at plane distances, parallel planes, orientations "
              "and separations.\n",
              lane.policy)};
}

// Fills in the file's template: replaces each @name@ with its value.
std::string filled(std::string_view file, const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string text;
  std::string_view rest = embedded(fmt::format("reports/snippets/{}", file));
  for (std::size_t at; (at = rest.find('@')) != rest.npos;) {
    text += rest.substr(0, at);
    rest.remove_prefix(at + 1);
    const std::string_view key = rest.substr(0, rest.find('@'));
    const auto value = std::find_if(values.begin(), values.end(), [&](auto& v) { return v.first == key; });
    if (value == values.end()) throw std::logic_error(fmt::format("{}: no value for '{}'", file, key));
    text += value->second;
    rest.remove_prefix(key.size() + 1);
  }
  return text.append(rest);
}

}  // namespace

std::string_view embedded(std::string_view path) {
  if (const std::string_view* text = find_embedded(path)) return *text;
  throw std::logic_error(fmt::format("{}: expected an embedded file", path));
}

bool shows_lanes(SnippetKind kind) {
  return kind == SnippetKind::cpp || kind == SnippetKind::cuda || kind == SnippetKind::gtest;
}

bool shows(SnippetKind kind, const Lane& lane) {
  const bool is_cuda = backends::language_of(lane) == backends::Language::cuda;
  if (lane.foreign) return kind == SnippetKind::gtest || kind == (is_cuda ? SnippetKind::cuda : SnippetKind::cpp);
  if (lane.under && lane.under->kind != Policy::Kind::tolerances) return false;  // such a lane is never wrong
  if (lane.exact) return false;  // its verdict is right for the stored pair
  return shows_lanes(kind) && is_cuda == (kind == SnippetKind::cuda);
}

std::string source_line(const std::string& place) {
  const std::size_t colon = place.rfind(':');
  const std::string_view* file = colon == place.npos ? nullptr : find_embedded(place.substr(0, colon));
  if (!file) return "";
  std::istringstream lines{std::string(*file)};
  std::string line;
  for (int n = std::stoi(place.substr(colon + 1)); n > 0 && std::getline(lines, line); --n) {
  }
  return line.substr(std::min(line.find_first_not_of(' '), line.size()));
}

std::string amalgamated_source(std::string_view algorithm_id, bool with_policy) {
  Amalgamation all;
  all.add(header_of(algorithm_id));
  if (with_policy) all.add("core/lanes/decide_under.h");
  std::string text = "// SPDX-License-Identifier: Apache-2.0\n";
  for (const std::string& line : all.system) text += line + '\n';
  return text + all.text;
}

std::string snippet(SnippetKind kind, const SnippetCase& found) {
  const bool foreign = shows_lanes(kind) && found.lane->foreign;
  std::vector<std::pair<std::string_view, std::string>> values = {
      {"command", foreign ? "" : command(kind, found.lane)},
      {"case", in_comment(found.name)},
      {"truth", std::string(name(found.truth))},
      {"intersects", found.truth == Verdict::intersects ? "true" : "false"},
      {"vertices_a", visit(found.pair, [&](const auto& pair) { return vertices(kind, pair.a, 'a'); })},
      {"vertices_b", visit(found.pair, [&](const auto& pair) { return vertices(kind, pair.b, 'b'); })},
      {"stored", found.pair.floats ? "float" : "double"},
      {"type_of_number", found.pair.floats ? "float32" : "double"}};
  values.emplace_back("coordinates", values[4].second + values[5].second);
  if (foreign) {
    const bool test = kind == SnippetKind::gtest;
    ForeignCall call = kind == SnippetKind::cuda
                           ? kernel_call(*found.lane)
                           : foreign_call(*found.lane, found.pair, kCompiler, test ? kTestLibraries : "");
    std::string name_of_test;
    for (const char c : found.lane->info->id) {
      if (std::isalnum(static_cast<unsigned char>(c))) name_of_test += c;
    }
    values[0].second = std::move(call.command);
    values.insert(values.end(), {{"lane", found.lane->id},
                                 {"verdict", std::string(name(found.verdict))},
                                 {"real", found.lane->scalar == Scalar::f32 ? "float" : "double"},
                                 {"decide", std::move(call.decide)},
                                 {"function", std::move(call.function)},
                                 {"seconds", std::to_string(call.seconds)},
                                 {"code", found.truth == Verdict::intersects ? "1" : "0"},
                                 // An unstable verdict may show only after many calls.
                                 {"rounds", found.verdict == Verdict::unstable &&
                                                    backends::language_of(*found.lane) == backends::Language::cpp
                                                ? "1000"
                                                : "1"},
                                 {"test", "Subject" + name_of_test}});
    const bool ends = found.verdict == Verdict::crashed || found.verdict == Verdict::timed_out;
    if (test) values.emplace_back("calls", filled(ends ? "foreign_gtest_death.in" : "foreign_gtest_calls.in", values));
  } else if (shows_lanes(kind)) {
    const std::string_view id = found.lane->info->id;
    values.insert(
        values.end(),
        {{"lane", found.lane->id},
         {"verdict", std::string(name(found.verdict))},
         {"algorithm", std::string(id)},
         {"scalar", std::string(name(found.lane->scalar))},
         {"real", found.lane->scalar == Scalar::f32 ? "float" : "double"},
         {"type", type_name(id)},
         {"decide", call_of(*found.lane, kind == SnippetKind::cuda ? "graze::" + type_name(id) : "Algorithm").call},
         {"sources", amalgamated_source(id, found.lane->under.has_value())}});
    if (kind != SnippetKind::cuda) values.emplace_back("loop", filled("loop.in", values));
  }
  const std::string_view file = !foreign                    ? file_of(kind)
                                : kind == SnippetKind::cuda ? "foreign.cu.in"
                                : kind == SnippetKind::cpp  ? "foreign.cpp.in"
                                                            : "foreign_gtest.cpp.in";
  return filled(file, values);
}

std::string policy_header(const Lane& lane) {
  const std::string_view id = lane.info->id;
  const Call call = call_of(lane, "graze::" + type_name(id));
  return filled("policy.h.in", {{"lane", lane.id},
                                {"flags", flags_of(lane.variant)},
                                {"real", lane.scalar == Scalar::f32 ? "float" : "double"},
                                {"call", call.call},
                                {"before", call.before},
                                {"sources", amalgamated_source(id, lane.under.has_value())}});
}

}  // namespace graze::reports
