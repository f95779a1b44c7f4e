// SPDX-License-Identifier: Apache-2.0
#include "subjects/source_build.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"
#include "core/stop.h"
#include "core/text.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCudaHost = "#include <graze/cuda_host.h>\n";
// Headers that are written below include/ in the cache folder. On the host, a CUDA source includes the headers in cuda/
// instead of the toolkit's.
constexpr std::pair<std::string_view, std::string_view> kHeaders[] = {
#include "subjects/headers.inc"
    {"cuda/cuda.h", kCudaHost},
    {"cuda/cuda_runtime.h", kCudaHost},
    {"cuda/cuda_runtime_api.h", kCudaHost},
    {"cuda/device_launch_parameters.h", kCudaHost},
    {"cuda/vector_types.h", kCudaHost},
    {"cuda/vector_functions.h", kCudaHost}};

// The compiled file includes the source and describes the function.
constexpr std::string_view kCpp = R"(#include SOURCE
#include <graze/subject.h>
namespace {
template <class Number>
constexpr bool graze_takes = requires(const Number* p) { static_cast<int>(FUNCTION(p, p)); };
template <class Number>
constexpr auto graze_function() -> int (*)(const Number*, const Number*) {
  if constexpr (graze_takes<Number>) {
    return [](const Number* a, const Number* b) { return static_cast<int>(FUNCTION(a, b)); };
  } else {
    return nullptr;
  }
}
}  // namespace
static_assert(graze_takes<float> || graze_takes<double>, EXPECTED);
GRAZE_SUBJECT(graze_subject) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, graze_function<float>(), graze_function<double>(), nullptr, nullptr};
)";
constexpr std::string_view kC = R"(#include SOURCE
#include <graze/subject.h>
enum {
  graze_f32 = _Generic(&FUNCTION, int (*)(const float*, const float*): 1, _Bool (*)(const float*, const float*): 1, default: 0),
  graze_f64 = _Generic(&FUNCTION, int (*)(const double*, const double*): 1, _Bool (*)(const double*, const double*): 1, default: 0)
};
_Static_assert(graze_f32 || graze_f64, EXPECTED);
static int graze_of_f32(const float* a, const float* b) { return FUNCTION((const void*)a, (const void*)b); }
static int graze_of_f64(const double* a, const double* b) { return FUNCTION((const void*)a, (const void*)b); }
GRAZE_SUBJECT(graze_subject) = {.abi = GRAZE_SUBJECT_ABI, .f32 = graze_f32 ? graze_of_f32 : 0, .f64 = graze_f64 ? graze_of_f64 : 0};
)";

// The compiled file for HIP. A C++ source does not mark functions as __device__, so all also become device code.
constexpr std::string_view kHip = R"(#include <hip/hip_runtime.h>
#ifdef GRAZE_SAYS_WHERE
#include SOURCE
#endif
#pragma clang force_cuda_host_device begin
#ifndef GRAZE_SAYS_WHERE
#include SOURCE
#endif
template <class Number>
constexpr bool graze_takes = requires(const Number* p) { static_cast<int>(FUNCTION(p, p)); };
template <class Number>
int graze_answer(const Number* p) {
  if constexpr (graze_takes<Number>) return static_cast<int>(FUNCTION(p, p + 9));
  return 0;
}
#pragma clang force_cuda_host_device end
static_assert(graze_takes<float> || graze_takes<double>, EXPECTED);
extern "C" __attribute__((global)) void graze_f32(const float* p, int* answer) { *answer = graze_answer(p); }
extern "C" __attribute__((global)) void graze_f64(const double* p, int* answer) { *answer = graze_answer(p); }
)";

std::string text_of(const fs::path& file) {
  std::string text = code_in(file);
  if (text.empty()) throw std::runtime_error("there is no code in " + file.string());
  return text;
}

void write(const fs::path& file, std::string_view text) {
  std::ofstream out(file, std::ios::binary);
  if (!(out << text << std::flush)) throw std::runtime_error(cannot("write", file, errno));
}

std::string first_error(const std::string& output) {
  const std::string line = line_with(output, {"error", "undefined"});
  return line.empty() ? "the compiler failed without output" : line;
}

// The compiler with all flags.
std::string command_with(const Recipe& recipe, const std::vector<std::string>& flags) {
  std::string command = recipe.compiler + ' ' + recipe.fixed;
  if (!recipe.flags.empty()) command += ' ' + recipe.flags;
  for (const std::string& flag : flags) command += ' ' + shell_word(flag);
  return command;
}

// Throws: std::runtime_error if the compiler made no file, as with a flag such as --version.
void expect_made(const fs::path& file, const std::string& name, const Recipe& recipe,
                 const std::vector<std::string>& flags) {
  if (!fs::exists(file))
    throw std::runtime_error(
        cannot("compile", name,
               fmt::format("the compiler reported no error and made no object file: {}", command_with(recipe, flags))));
}

// The flags that belong to the compiler's name, as in CXX='c++ -Og', and the environment variables that name its parts.
std::vector<std::string> further_flags(const std::string& compiler) {
  std::vector<std::string> flags;
  std::istringstream words(compiler);
  for (std::string word; words >> word;) {
    if (word.starts_with('-')) flags.push_back(word);
  }
  for (const char* name : {"COMPILER_PATH", "GCC_EXEC_PREFIX"}) {
    if (const char* value = std::getenv(name); value && *value) flags.push_back(fmt::format("{}={}", name, value));
  }
  return flags;
}

// Whether a preprocessed source may have assembler code that includes files.
bool may_include_by_assembler(std::string preprocessed) {
  for (char& c : preprocessed) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return preprocessed.find("incbin") != preprocessed.npos || preprocessed.find(".include") != preprocessed.npos;
}

// Whether the assembler can list the files that it reads: GNU's assembler can, clang's cannot. With -flto, code is
// assembled at link time, without a list.
bool assembler_lists_files(const std::string& compiler, const std::vector<std::string>& flags, const Scratch& scratch) {
  if (std::any_of(flags.begin(), flags.end(), [](const std::string& flag) { return flag.starts_with("-flto"); }))
    return false;
  static std::map<std::string, bool> known;
  const auto found = known.find(compiler);
  if (found != known.end()) return found->second;
  const std::string list = (scratch.path() / "probe.d").string();
  int status = 0;
  shell_output(fmt::format("{} -x assembler -c /dev/null -o {} -Wa,--MD,{}", compiler,
                           shell_word((scratch.path() / "probe.o").string()), shell_word(list)),
               scratch.path(), status);
  return known[compiler] = status == 0 && fs::exists(list);
}

// The files in a list that the assembler or the preprocessor wrote, one per line. Omits files in the folder `own`, and
// names that are not files.
std::string listed_files(const fs::path& list, const fs::path& own) {
  std::string text = text_of(list), file, files;
  text = text.substr(std::min(text.find(": "), text.size())) + ' ';
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] != '\n') {
      file.push_back(text[++i]);
    } else if (text[i] == '$' && text[i + 1] == '$') {
      file.push_back(text[++i]);
    } else if (text[i] != ' ' && text[i] != '\n' && text[i] != '\\') {
      file.push_back(text[i]);
    } else {
      if (!file.starts_with(own.string() + '/') && fs::is_regular_file(file)) files += file + '\n';
      file.clear();
    }
  }
  return files;
}

// The device, inode, size and times of these files, as text.
std::string states_of_listed(const std::string& files) {
  std::istringstream lines(files);
  std::string states;
  for (std::string file; std::getline(lines, file);)
    states += fmt::format("{} {}\n", file, fmt::join(state_of(file), " "));
  return states;
}

// Continues the hash with the names and contents of files that an assembler has read.   Throws: std::runtime_error.
std::uint64_t hash_of_listed(const std::string& files, std::uint64_t hash) {
  std::istringstream lines(files);
  for (std::string file; std::getline(lines, file);)
    hash = fnv1a(fmt::format("{}\n{:016x}\n", file, hash_of_file(file)), hash);
  return hash;
}

constexpr std::string_view kObject = ".so", kProgram = ".program";
constexpr int kMostBuilds = 4;  // attempts to build code that keeps changing

// The state of a build's inputs when they were read.
struct Reading {
  std::uint64_t hash = 0;
  std::string states;       // states of the files after reading; they reveal a change that was later undone
  std::string not_covered;  // inputs that the hash does not cover, in words
  bool is_whole = false;    // whether the preprocessor found all files
  bool operator==(const Reading&) const = default;
};

}  // namespace

fs::path cache_folder() {
  const auto of = [](const char* name) {
    const char* value = std::getenv(name);
    return value && *value ? fs::path(value) : fs::path();
  };
  if (const fs::path cache = of("XDG_CACHE_HOME"); !cache.empty()) return cache / "graze";
  if (const fs::path home = of("HOME"); !home.empty()) return home / ".cache" / "graze";
  return fs::temp_directory_path() / fmt::format("graze-{}", getuid());
}

void write_atomically(const fs::path& file, std::string_view text) {
  fs::create_directories(file.parent_path());
  const fs::path part = file.string() + fmt::format(".{}", getpid());
  write(part, text);
  move_over(part, file);
}

void write_if_new(const fs::path& file, std::string_view text) {
  const StopSignals stops;
  std::string why;
  if (plain_file(file, why) != text) write_atomically(file, text);
}

std::string line_with(const std::string& output, std::initializer_list<std::string_view> words) {
  std::istringstream lines(output);
  std::string first;
  for (std::string line; std::getline(lines, line);) {
    if (std::any_of(words.begin(), words.end(), [&](std::string_view word) { return line.find(word) != line.npos; }))
      return line;
    if (first.empty()) first = line;
  }
  return first;
}

namespace {

bool is_c(const fs::path& source) { return source.extension() == ".c"; }
bool is_cuda(const fs::path& source) { return source.extension() == ".cu"; }

// The flag for our CUDA headers. This flag precedes the user's flags, which may name the toolkit's headers.
std::string headers_for(const fs::path& source) {
  return is_cuda(source) ? " -I" + shell_word((cache_folder() / "include/cuda").string()) : "";
}

}  // namespace

Recipe recipe_of(const VariantInfo& variant, const fs::path& source) {
  const bool c = is_c(source);
  const char* chosen = std::getenv(c ? "CC" : "CXX");
  const std::string compiler = chosen && *chosen ? chosen : c ? "cc" : "c++";
  return {compiler, (c ? "-std=gnu11 -O2 -fPIC -shared" : "-std=c++20 -O2 -fPIC -shared") + headers_for(source),
          std::string(variant.flags)};
}

// Uses the GNU dialects. In the ISO dialects, GCC does not contract C and, from version 13 on, keeps no excess
// precision in C++.
Recipe recipe_of(const Toolchain& toolchain, const fs::path& source) {
  const bool c = is_c(source);
  const std::string& compiler = c ? toolchain.cc : toolchain.cxx;
  if (compiler.empty())
    throw std::runtime_error(fmt::format("the toolchain {} has no compiler for {}", toolchain.name, c ? "C" : "C++"));
  return {compiler, (c ? "-std=gnu11" : "-std=gnu++20") + headers_for(source), "", true};
}

bool source_describes_itself(const fs::path& source) {
  return text_of(source).find("GRAZE_SUBJECT(") != std::string::npos;
}

namespace {

struct Wrapped {
  std::string command;   // compiles the file
  std::string expected;  // the compiler's message if the function has other types
};

// Writes the file to compile into `folder`.
Wrapped wrapped(const fs::path& source, const std::string& function, const Recipe& recipe,
                const std::vector<std::string>& flags, const fs::path& folder) {
  const bool c = is_c(source);
  const bool describes_itself = source_describes_itself(source);
  const std::string expected = fmt::format(
      "expected a function {} of two triangles, const float[9] or const double[9] each, that returns int or bool",
      function);
  for (const auto& [file, text] : kHeaders) write_if_new(cache_folder() / "include" / file, text);
  const fs::path whole = folder / (c ? "whole.c" : "whole.cpp");
  const bool says_where = is_cuda(source) || source.extension() == ".hip";
  const std::string_view of_gpu = recipe.is_kernel  ? says_where ? "#define GRAZE_SAYS_WHERE\n" : ""
                                  : is_cuda(source) ? kCudaHost
                                                    : std::string_view();
  // With an absolute path, the source finds includes in its own folder.
  write(whole, fmt::format("{}#define SOURCE \"{}\"\n#define FUNCTION {}\n#define EXPECTED \"{}\"\n{}{}", of_gpu,
                           fs::absolute(source).string(), function, expected,
                           recipe.is_kernel   ? kHip
                           : describes_itself ? "#include SOURCE\n"
                           : c                ? kC
                                              : kCpp,
                           recipe.is_program ? "#include <graze/program.h>\n" : ""));
  // With the real time, code that uses __TIME__ would get a different hash at each reading.
  return {fmt::format("SOURCE_DATE_EPOCH=${{SOURCE_DATE_EPOCH:-0}} {} -I{} {}", command_with(recipe, flags),
                      shell_word((cache_folder() / "include").string()), shell_word(whole.string())),
          expected};
}

}  // namespace

bool is_host_device(const fs::path& source, const std::string& function, const Recipe& recipe,
                    const std::vector<std::string>& flags) {
  const Scratch scratch(cache_folder());
  int status = 0;
  std::string text = shell_output(fmt::format("{} -DGRAZE_KEEP_DECORATIONS -E -P 2>/dev/null",
                                              wrapped(source, function, recipe, flags, scratch.path()).command),
                                  scratch.path(), status);
  const bool is_whole = status == 0;
  if (!is_whole) text = text_of(source);
  const std::string_view host = is_whole ? "graze_host" : "__host__", device = is_whole ? "graze_device" : "__device__";
  std::string name = function.substr(0, function.find('<'));
  name = name.substr(name.rfind(':') + 1);
  const auto is_of_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
    const std::size_t behind = text.find_first_not_of(" \t\n", at + name.size());
    if (behind == text.npos || text[behind] != '(' || at == 0 || is_of_word(text[at - 1])) continue;
    const std::size_t end = text.find_last_of(";{}", at);  // the end of the code before the declaration
    const std::size_t begin = end == text.npos ? 0 : end + 1;
    const std::string_view declaration = std::string_view(text).substr(begin, at - begin);
    if (declaration.find(host) != declaration.npos && declaration.find(device) != declaration.npos) return true;
  }
  return false;
}

Built build_source(const fs::path& source, const std::string& function, const Recipe& recipe,
                   const std::vector<std::string>& flags) {
  const bool c = is_c(source);
  const std::string name = fs::absolute(source).string();
  const std::string& compiler = recipe.compiler;
  const fs::path folder = cache_folder();
  const Scratch scratch(folder);
  int status = 0;
  const std::string version = shell_output(compiler + " --version", scratch.path(), status);
  const std::string first_line = version.substr(0, version.find('\n'));  // the other lines contain paths
  std::string identity = first_line;
  if (status != 0)
    throw std::runtime_error(
        cannot("compile", name,
               status == 127  // a shell's status for a missing command
                   ? fmt::format("there is no compiler '{}'; install one{}", compiler,
                                 recipe.is_program ? "" : std::string(", or name it in ") + (c ? "CC" : "CXX"))
                   : fmt::format("'{} --version' ended with exit status {}", compiler, status)));
  // On another machine, the same compiler version may find other parts on the PATH, and the compiler may be a script.
  identity += shell_output(
      // Reads the name from a file: a pipe would also wait for processes that the compiler leaves behind.
      fmt::format("for part in as ld {1}; do {0} -print-prog-name=$part > {3} 2>/dev/null; read -r name < {3}; "
                  "file=$(command -v \"$name\") && cksum < \"$file\"; done; cksum < \"$(command -v {2})\"",
                  compiler, c ? "cc1" : "cc1plus", compiler.substr(0, compiler.find(' ')),
                  shell_word((scratch.path() / "part").string())),
      scratch.path(), status);
  // Hashes the preprocessor's output, because included files may change too.
  const auto [command, expected] = wrapped(source, function, recipe, flags, scratch.path());
  const fs::path object = scratch.path() / "whole.out", list = scratch.path() / "assembled.d";
  std::vector<std::string> all_flags = further_flags(compiler);
  all_flags.insert(all_flags.end(), flags.begin(), flags.end());
  const auto lists = [&] {
    return assembler_lists_files(compiler, flags, scratch);
  };  // called only if the answer matters
  const fs::path included = scratch.path() / "included.d";
  std::string assembled;  // the files that the assembler read in its last run
  const auto read = [&] {
    Reading reading;
    const std::string preprocessed = shell_output(
        fmt::format("{} -E -P -MD -MF {} 2>/dev/null", command, shell_word(included.string())), scratch.path(), status);
    reading.is_whole = status == 0;
    const CodeHash of_flags = hash_of_flags(all_flags, fnv1a(fmt::format("{}\n{}\n", identity, recipe.flags)));
    reading.hash = hash_of_listed(assembled, fnv1a(preprocessed, of_flags.hash));
    reading.not_covered = of_flags.not_covered;
    if (reading.not_covered.empty() && may_include_by_assembler(preprocessed) && !lists())
      reading.not_covered = "the files that its assembler code includes";
    reading.states = states_of_listed((fs::exists(included) ? listed_files(included, folder) : "") + assembled);
    return reading;
  };
  // The compiler reads the files again when it compiles. If the files were the same before and after, the compiler
  // compiled the code that was hashed.
  for (int builds = 0; builds < kMostBuilds; ++builds) {
    const Reading before = read();
    Built built{folder / fmt::format("{:016x}{}", before.hash, recipe.is_program ? kProgram : kObject),
                before.not_covered, nullptr, first_line};
    // If the assembler reads files, the object gets another name in the next round and is never loaded from the cache:
    // only another assembler run shows which files are read now.
    if (before.is_whole && before.not_covered.empty() && assembled.empty()) {
      if (const auto kept = kept_content(built.file)) {
        built.content = std::make_shared<SealedCopy>(built.file.filename().string(), *kept);
        return built;
      }
    }
    const std::string said =
        shell_output(fmt::format("{} {} -o {}{}", command, lists() ? "-Wa,--MD," + shell_word(list.string()) : "",
                                 shell_word(object.string()), recipe.is_program ? "" : " -Wl,-z,defs"),
                     scratch.path(), status);
    if (status != 0) {
      std::string error = first_error(said);
      if (error.find(expected) != error.npos) error = name + ": " + expected;
      // Messages from the linker, or about a full disk, do not name the source.
      if (error.find(source.filename().string()) == error.npos) error = cannot("compile", name, error);
      throw std::runtime_error(error);
    }
    expect_made(object, name, recipe, flags);
    assembled = lists() && fs::exists(list) ? listed_files(list, scratch.path()) : "";
    if (read() != before) continue;
    built.content = std::make_shared<SealedCopy>(built.file.filename().string(), code_in(object));
    keep_file(object, built.file);
    return built;
  }
  throw std::runtime_error(cannot(
      "compile", name,
      fmt::format("the source, a file that it includes or one that --flags names changed during each of {} builds; "
                  "run the command again when nothing writes them, without flags that write files",
                  kMostBuilds)));
}

std::string assembly_of(const fs::path& source, const std::string& function, const Recipe& recipe,
                        const std::vector<std::string>& flags) {
  const Scratch scratch(cache_folder());
  const fs::path assembly = scratch.path() / "whole.s";
  int status = 0;
  const std::string said =
      shell_output(fmt::format("{} -g1 -S -o {}", wrapped(source, function, recipe, flags, scratch.path()).command,
                               shell_word(assembly.string())),
                   scratch.path(), status);
  if (status != 0) throw std::runtime_error(cannot("compile", source, first_error(said)));
  expect_made(assembly, source.string(), recipe, flags);
  return text_of(assembly);
}

Built build_assembly(std::string_view assembly, const Recipe& recipe, const std::vector<std::string>& flags) {
  const Scratch scratch(cache_folder());
  const fs::path file = scratch.path() / "whole.s", object = scratch.path() / "whole.out";
  write(file, assembly);
  int status = 0;
  const std::string said = shell_output(
      fmt::format("{} {} -o {}", command_with(recipe, flags), shell_word(file.string()), shell_word(object.string())),
      scratch.path(), status);
  if (status != 0) throw std::runtime_error(cannot("assemble", file, first_error(said)));
  return {object.filename(), "", std::make_shared<SealedCopy>("assembled", code_in(object)), ""};
}

Built kept_build(const std::string& name, bool is_program) {
  const fs::path file = cache_folder() / (name + std::string(is_program ? kProgram : kObject));
  const std::optional<std::string> kept = is_hash(name) ? kept_content(file) : std::nullopt;
  if (!kept) throw std::runtime_error(fmt::format("the build {} is no longer in the cache", shown(name)));
  return {file, "", std::make_shared<SealedCopy>(file.filename().string(), *kept)};
}

std::map<std::string, std::string> compiler_environment(const fs::path& source) {
  const bool c = is_c(source);
  std::map<std::string, std::string> set;
  for (const char* name :
       {c ? "CC" : "CXX", "CPATH", c ? "C_INCLUDE_PATH" : "CPLUS_INCLUDE_PATH", "SOURCE_DATE_EPOCH"}) {
    if (const char* value = std::getenv(name); value && *value) set[name] = value;
  }
  return set;
}

}  // namespace graze::subjects
