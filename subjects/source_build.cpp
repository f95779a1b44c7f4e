// SPDX-License-Identifier: Apache-2.0
#include "subjects/source_build.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/text.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

constexpr unsigned char kHeaderBytes[] = {
#include "subjects/subject_h.inc"
};
const std::string kHeader(std::begin(kHeaderBytes), std::end(kHeaderBytes));

// What is compiled in place of the source: it includes the source, and describes the function.
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

std::string text_of(const fs::path& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || (!(text << in.rdbuf()) && errno != 0)) throw std::runtime_error(cannot("read", file, errno));
  if (!text) throw std::runtime_error("there is no code in " + file.string());
  return text.str();
}

void write(const fs::path& file, std::string_view text) {
  std::ofstream out(file, std::ios::binary);
  if (!(out << text << std::flush)) throw std::runtime_error(cannot("write", file, errno));
}

// Returns: what the command wrote; its exit status in `status`.
std::string output_of(const std::string& command, int& status) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error(cannot("start a shell for", command, errno));
  char bytes[4096];
  for (std::size_t count; (count = fread(bytes, 1, sizeof bytes, pipe)) > 0;) text.append(bytes, count);
  status = pclose(pipe);
  return text;
}

std::string first_error(const std::string& text) {
  std::istringstream lines(text);
  std::string first, line;
  while (std::getline(lines, line)) {
    if (line.find("error") != line.npos || line.find("undefined") != line.npos) return line;
    if (first.empty()) first = line;
  }
  return first.empty() ? "the compiler failed and said nothing" : first;
}

// What the build depends on beside the preprocessed source, the flags and the files that they name.
std::string not_covered(const std::string& preprocessed, const std::vector<std::string>& flags) {
  for (const std::string& flag : flags) {
    if (flag.starts_with("-l") || flag.starts_with("-Wl,") || flag.starts_with("-Xlinker") || flag.starts_with("@"))
      return "the libraries that its flags link";
  }
  std::string text = preprocessed;
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (text.find("incbin") != text.npos || text.find(".include") != text.npos)
    return "the files that its assembler code includes";
  return "";
}

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
  fs::rename(part, file);
}

bool source_describes_itself(const fs::path& source) {
  return text_of(source).find("GRAZE_SUBJECT(") != std::string::npos;
}

Built build_source(const fs::path& source, const std::string& function, const VariantInfo& variant,
                   const std::vector<std::string>& flags) {
  const bool c = source.extension() == ".c";
  const std::string text = text_of(source);
  // In the folder of the source its own includes are found.
  const std::string name = fs::absolute(source).string();
  const bool describes_itself = source_describes_itself(source);
  const char* chosen = std::getenv(c ? "CC" : "CXX");
  const std::string compiler = chosen && *chosen ? chosen : c ? "cc" : "c++";
  int status = 0;
  const std::string version = output_of(compiler + " --version 2>&1", status);
  const std::string identity = version.substr(0, version.find('\n'));  // below it are paths
  if (status != 0)
    throw std::runtime_error(cannot(
        "compile", name, "there is no compiler '" + compiler + "'; install one, or name it in " + (c ? "CC" : "CXX")));
  std::string command =
      fmt::format("{} {} -O2 -fPIC -shared {}", compiler, c ? "-std=gnu11" : "-std=c++20", variant.flags);
  for (const std::string& flag : flags) command += ' ' + shell_word(flag);
  const std::string wrapped =
      fmt::format("{}", describes_itself ? std::string("#include SOURCE\n") : std::string(c ? kC : kCpp));
  const std::string expected = fmt::format(
      "expected a function {} of two triangles, const float[9] or const double[9] each, "
      "that returns int or bool",
      function);
  const std::string defines =
      fmt::format("#define SOURCE \"{}\"\n#define FUNCTION {}\n#define EXPECTED \"{}\"\n", name, function, expected);
  // All that is included could change too: the preprocessor's output is what the result depends on.
  const fs::path folder = cache_folder();
  const fs::path header = folder / "include/graze/subject.h";
  if (!fs::exists(header) || text_of(header) != kHeader) write_atomically(header, kHeader);
  const fs::path part = folder / fmt::format("part-{}-{}{}", getpid(), variant.id, c ? ".c" : ".cpp");
  const fs::path object = fs::path(part).replace_extension(".so"), errors = fs::path(part).replace_extension(".txt");
  const auto clean = [&] {
    std::error_code ignored;
    for (const fs::path& file : {part, object, errors}) fs::remove(file, ignored);
  };
  write(part, defines + wrapped);
  command += fmt::format(" -I{} {}", shell_word((folder / "include").string()), shell_word(part.string()));
  const std::string preprocessed = output_of(command + " -E -P 2>/dev/null", status);
  const std::uint64_t of_flags = hash_of_flags(flags, fnv1a(fmt::format("{}\n{}\n", identity, variant.flags)));
  const Built kept{folder / fmt::format("{:016x}.so", fnv1a(preprocessed, of_flags)), not_covered(preprocessed, flags)};
  if (status == 0 && kept.not_covered.empty() && fs::exists(kept.file)) {
    clean();
    return kept;
  }
  const std::string said =
      output_of(fmt::format("{} -o {} -Wl,-z,defs 2>&1", command, shell_word(object.string())), status);
  if (status != 0) {
    clean();
    std::string error = first_error(said);
    if (error.find(expected) != error.npos) error = name + ": " + expected;
    throw std::runtime_error(error);
  }
  fs::rename(object, kept.file);
  clean();
  return kept;
}

}  // namespace graze::subjects
