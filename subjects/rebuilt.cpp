// SPDX-License-Identifier: Apache-2.0
#include "subjects/rebuilt.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <regex>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/pattern.h"
#include "core/stop.h"
#include "core/text.h"
#include "subjects/cuda_code.h"
#include "subjects/portable.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

const Opened& opened_of(const Lane& lane) {
  const Opened* found = opened(lane.lane_name().subject);
  if (!found) throw std::logic_error(lane.id + ": expected a lane of foreign code");
  return *found;
}

// The code for the changed source `copy`, built for the lane's variant. Runs on the device if the lane does.
Code cuda_code(const Lane& lane, const Opened& subject, const fs::path& copy, const std::vector<std::string>& flags) {
  for (const cuda::CudaBuild& build :
       cuda::build_cuda_subject(copy, function_of(subject), flags, cache_folder(), lane.variant)) {
    if (build.scalar != lane.scalar) continue;
    Code code = code_of(build, subject.wanted, lane.evidence == "device", twin_of(build));
    if (code.what.empty()) throw std::runtime_error(cannot("run", lane.id + " as changed", build.why_no_twin));
    return code;
  }
  throw std::runtime_error(
      cannot("run", lane.id + " as changed", "after the change, its function takes another type of number"));
}

SourceLanguage language_of(const Opened& subject) {
  return subject.file.extension() == ".c" ? SourceLanguage::c : SourceLanguage::cpp;
}

Recipe recipe_of_lane(const Lane& lane, const fs::path& source) {
  const Toolchain* toolchain = toolchain_of(lane);
  return toolchain ? recipe_of(*toolchain, source) : recipe_of(info_of(lane.variant), source);
}

Code code_of_build(const Lane& lane, const Opened& subject, const Built& built) {
  Code code{"library", built.file.string(), "", "any", subject.wanted.timeout, subject.wanted.memory};
  if (const Toolchain* toolchain = toolchain_of(lane)) {
    code.kind = "program";
    code.what = toolchain->run;
  }
  code.content = built.content;
  return code;
}

// The assembly of the lane's source, which each process compiles only once.   Throws: std::runtime_error; Stopped.
const std::string& assembly_of_lane(const Lane& lane) {
  static std::mutex mutex;
  static std::map<std::string, std::string> known;
  const std::lock_guard lock(mutex);
  std::string& text = known[lane.id];
  const Opened& subject = opened_of(lane);
  if (text.empty())
    text = assembly_of(subject.file, function_of(subject), recipe_of_lane(lane, subject.file), host_flags(subject));
  return text;
}

// The lane's code with this line's products rounded.   Throws: std::runtime_error if there is no such build; Stopped.
std::unique_ptr<ForeignProcesses> with_rounded(const Lane& lane, const FusedLine& line) {
  const Opened& subject = opened_of(lane);
  const auto text = with_rounded_products(assembly_of_lane(lane), subject.file.parent_path(), line);
  if (!text) throw std::runtime_error(cannot("round", line.place(), "it has an operation that cannot be split"));
  return std::make_unique<ForeignProcesses>(
      code_of_build(lane, subject, build_assembly(*text, recipe_of_lane(lane, subject.file), host_flags(subject))),
      lane.scalar);
}

// The source text of a host lane. Empty if the lane has no source, or if the source has been changed or removed since
// it was built.
std::string source_as_built(const Lane& lane) {
  const Opened* subject = opened(lane.lane_name().subject);
  if (!subject || lane.is_cuda() ||
      (subject->kind != "source" && subject->kind != "published" && subject->kind != "cuda"))
    return "";
  try {
    std::string text = code_in(subject->file);
    return fnv1a(text) == subject->hash ? text : "";
  } catch (const std::runtime_error&) {
    return "";
  }
}

// The builds that changed() has made, by lane and change.
struct Builds {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<ForeignProcesses>> built;  // never started; null if the source does not compile
  std::list<std::pair<std::string, std::unique_ptr<ForeignProcesses>>> idle;  // processes handed back, latest first
};

Builds& builds() {
  static Builds all;
  return all;
}

}  // namespace

std::string why_not_rebuilt(const Lane& lane) {
  const std::string& kind = opened_of(lane).kind;
  return kind == "library"   ? "it is a shared object, and its source is not known; give the source as the subject"
         : kind == "command" ? "it is a command, and only C, C++ and CUDA sources can be rebuilt"
                             : "";
}

TunableSource tunable_source(const Lane& lane, const std::string& name) {
  if (const std::string why = why_not_rebuilt(lane); !why.empty()) throw UsageError(cannot("tune", lane.id, why));
  const Opened& subject = opened_of(lane);
  TunableSource source{subject.file, code_in(subject.file), language_of(subject), {}};
  source.epsilon = epsilon_of(source.file, source.text, name);
  for (const std::string& flag : subject.wanted.flags) {
    if (flag == "-D" + source.epsilon.name || flag.starts_with("-D" + source.epsilon.name + '='))
      throw UsageError(cannot("tune", lane.id,
                              fmt::format("--flags={} sets {}, so the value in {} has no effect; leave that flag out",
                                          flag, source.epsilon.name, printable(source.file.filename().string()))));
  }
  return source;
}

std::unique_ptr<ForeignProcesses> rebuilt(const Lane& lane, const std::string& text, Scalar scalar,
                                          const std::vector<std::string>& more_flags) {
  const Opened& subject = opened_of(lane);
  // The folder's name depends only on the text and the file's path, so builds that contain their source's path can be
  // cached too.
  const fs::path copy = cache_folder() / fmt::format("changed-{:016x}", fnv1a(text, fnv1a(subject.file.string()))) /
                        subject.file.filename();
  write_atomically(copy, text);
  const bool by_nvrtc = subject.kind == "cuda" && lane.is_cuda();
  std::vector<std::string> flags = by_nvrtc ? subject.wanted.flags : host_flags(subject);
  const std::string folder = subject.file.parent_path().string();  // for files that the source includes
  flags.push_back((by_nvrtc ? "-I" : "-iquote") + folder);
  flags.insert(flags.end(), more_flags.begin(), more_flags.end());
  if (by_nvrtc) return std::make_unique<ForeignProcesses>(cuda_code(lane, subject, copy, flags), scalar);
  const Code code =
      code_of_build(lane, subject, build_source(copy, function_of(subject), recipe_of_lane(lane, copy), flags));
  if (!describe(code).has(scalar))
    throw std::runtime_error(
        cannot("run", lane.id + " as changed", "after the change, its function takes another type of number"));
  return std::make_unique<ForeignProcesses>(code, scalar);
}

std::vector<FusedLine> fused_lines_of(const Lane& lane) {
  if (source_as_built(lane).empty()) return {};
  const Opened& subject = opened_of(lane);
  const StopSignals stops;
  try {
    return fused_lines(assembly_of_lane(lane), subject.file.parent_path());
  } catch (const std::runtime_error&) {  // the compiler writes no assembly
    return {};
  }
}

bool selects_by_build(const Lane& lane) {
  if (!has_source_as_built(lane)) return false;
  static const std::regex names(
      "__(FMA|AVX|SSE|FAST_MATH|FINITE_MATH|OPTIMIZE|ARM_FEATURE|FLT_EVAL)|FLT_EVAL_METHOD|FP_FAST|"
      "\\b(sizeof|is_same|_Generic|typeid|numeric_limits)");
  const Opened& subject = opened_of(lane);
  try {
    const SourceFiles all = source_files(subject);
    return (!all.whole && subject.kind != "published") ||  // Graze's own sources include from its root
           std::any_of(all.files.begin(), all.files.end(),
                       [](const fs::path& file) { return contains(code_in(file), names); });
  } catch (const std::runtime_error&) {  // a file is too large
    return true;
  }
}

bool has_source_as_built(const Lane& lane) { return !source_as_built(lane).empty(); }

std::string negligible_in_words(const std::vector<Epsilon>& numbers) {
  std::set<std::string> words;
  for (const Epsilon& number : numbers) words.insert(written_value(number, kNegligible));
  return words.size() == 1 ? *words.begin() : fmt::format("{:g}", kNegligible);
}

std::optional<bool> may_have_epsilon(const Lane& lane) {
  const Opened* subject = lane.foreign ? opened(lane.lane_name().subject) : nullptr;
  if (!subject || (subject->kind != "source" && subject->kind != "cuda")) return std::nullopt;
  try {
    const std::string text = code_in(subject->file);
    return !small_numbers_in(text).empty() ||  // throws for a large text
           contains(text, std::regex("#[ \t]*include[ \t]*\"|epsilon", std::regex::icase));
  } catch (const std::runtime_error&) {  // the file is missing or too large
    return std::nullopt;
  }
}

std::vector<Epsilon> small_numbers(const Lane& lane) {
  try {
    return small_numbers_in(source_as_built(lane));
  } catch (const std::runtime_error&) {  // the source is too large
    return {};
  }
}

void HandBack::operator()(ForeignProcesses* code) const {
  std::unique_ptr<ForeignProcesses> ends;  // outlives the lock, because its destructor waits for processes
  Builds& all = builds();
  const std::lock_guard lock(all.mutex);
  all.idle.emplace_front(key, code);
  if (all.idle.size() <= kMostIdle) return;
  ends = std::move(all.idle.back().second);
  all.idle.pop_back();
}

ChangedCode changed(const Lane& lane, const Change& change) {
  std::string text = source_as_built(lane), key = lane.id + (change.doubles ? " in doubles" : "");
  if (text.empty()) return nullptr;
  const SourceLanguage language = language_of(opened_of(lane));
  for (const Epsilon& number : change.negligible) key += '\n' + number.name;
  if (change.value != kNegligible) key += fmt::format("\nby {}", change.value);
  for (const std::string& flag : change.flags) key += '\n' + flag;
  if (change.rounded) key += "\nrounded at " + change.rounded->place();
  Builds& all = builds();
  const std::lock_guard lock(all.mutex);
  const auto idle = std::find_if(all.idle.begin(), all.idle.end(), [&](const auto& code) { return code.first == key; });
  if (idle != all.idle.end()) {
    ChangedCode code(idle->second.release(), {key});
    all.idle.erase(idle);
    return code;
  }
  auto found = all.built.find(key);
  if (found == all.built.end()) {
    text = with_value(text, change.negligible, change.value, language);
    if (change.doubles) text = in_doubles(text);
    std::unique_ptr<ForeignProcesses> made;
    const StopSignals stops;
    try {
      made = change.rounded ? with_rounded(lane, *change.rounded)
                            : rebuilt(lane, text, change.doubles ? Scalar::f64 : lane.scalar, change.flags);
    } catch (const std::runtime_error&) {  // the changed source does not compile
    }
    found = all.built.emplace(key, std::move(made)).first;
  }
  return found->second ? ChangedCode(found->second->anew().release(), {key}) : nullptr;
}

std::string in_doubles(std::string_view source) {
  std::size_t begin = 0;  // where the line after the last #include begins
  for (std::size_t at = 0; at < source.size();) {
    const std::size_t end = std::min(source.find('\n', at), source.size() - 1) + 1;
    const std::size_t first = std::min(source.find_first_not_of(" \t", at), end);
    if (source.substr(first).starts_with("#") && source.substr(at, end - at).find("include") != source.npos)
      begin = end;
    at = end;
  }
  std::string functions;  // macros for the functions of float, which would round
  for (const char* name :
       {"acos",      "asin",  "atan",      "atan2", "cbrt",  "ceil", "copysign", "cos",   "exp",  "exp2", "fabs",
        "fdim",      "floor", "fma",       "fmax",  "fmin",  "fmod", "hypot",    "ldexp", "log",  "log2", "nearbyint",
        "nextafter", "pow",   "remainder", "rint",  "round", "sin",  "sqrt",     "tan",   "trunc"})
    functions += fmt::format("#define {0}f {0}\n", name);
  return fmt::format("{}\n#define float double\n{}{}\n#undef float\n", source.substr(0, begin), functions,
                     source.substr(begin));
}

bool is_all_in_doubles(const Lane& lane) {
  const std::string text = source_as_built(lane);
  return !text.empty() && !contains(text, std::regex("#[ \t]*include[ \t]*\"|\\b_mm|\\bvector_size\\b"));
}

}  // namespace graze::subjects
