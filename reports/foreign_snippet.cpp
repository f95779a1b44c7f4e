// SPDX-License-Identifier: Apache-2.0
#include "reports/foreign_snippet.h"

#include <fmt/format.h>

#include <cmath>
#include <regex>

#include "analysis/lane_trace.h"
#include "backends/backends.h"
#include "core/pattern.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/minimise/kinds.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::reports {
namespace {

std::string cpp_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < ' ') {
      result += fmt::format("\\{:03o}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

// Calls the code through a graze_subject, which has a function for one pair or for blocks. subject: its address in C.
std::string by_description(std::string_view real, std::string_view scalar, std::string_view subject) {
  return fmt::format(R"(static int decide(const {0}* a, const {0}* b) {{
  const struct graze_subject* subject = {2};
  if (subject->{1}) return subject->{1}(a, b);
  {0} pair[18];
  std::memcpy(pair, a, sizeof pair / 2);
  std::memcpy(pair + 9, b, sizeof pair / 2);
  signed char answer = -1;
  subject->block_{1}(pair, 1, &answer);
  return answer;
}}
)",
                     real, scalar, subject);
}

// The layout of graze_subject, as in graze/subject.h.
constexpr std::string_view kLayout = R"(#include <dlfcn.h>
#include <cstdint>
struct graze_subject {  // as in graze/subject.h
  std::uint32_t abi, outside;
  const char *version, *source, *convention;
  int (*f32)(const float*, const float*);
  int (*f64)(const double*, const double*);
  void (*block_f32)(const float*, std::size_t, signed char*);
  void (*block_f64)(const double*, std::size_t, signed char*);
};
static const graze_subject* described() {
  void* library = dlopen(LIBRARY, RTLD_NOW);
  void* found = library ? dlsym(library, SYMBOL) : nullptr;
  if (!found) {
    std::puts(dlerror());
    std::exit(2);
  }
  return static_cast<const graze_subject*>(found);
}
)";

std::string calling(std::string_view real, std::string_view function) {
  return fmt::format("static int decide(const {0}* a, const {0}* b) {{ return static_cast<int>({1}(a, b)); }}\n", real,
                     function);
}

// Whether the C function returns bool. If so, the declaration in the calling program must say bool, too.
bool returns_bool(const std::filesystem::path& source, const std::string& function) {
  std::string why;
  const std::string text = plain_file(source, why).value_or("");
  return contains(text, std::regex("\\b(_Bool|bool)\\s+" + function + "\\s*\\("));
}

// The flags of the lane's variant and the user's flags, each with a leading space.
std::string flags_of(const Lane& lane, const subjects::Opened& opened) {
  std::string text;
  if (const std::string_view own = info_of(lane.variant).flags; !own.empty()) text += ' ' + std::string(own);
  for (const std::string& flag :
       backends::language_of(lane) == backends::Language::cuda ? opened.wanted.flags : subjects::host_flags(opened))
    text += ' ' + shell_word(flag);
  return text;
}

std::string hex_line(const AnyPair& pair) {
  std::string line;
  for (int i = 0; i < kCoordinates; ++i) line += (i > 0 ? " " : "") + corpus::hex_float(coordinates(pair.doubles)[i]);
  return line;
}

// Calls the lane through the graze command. CUDA lanes need this because, without a device, only Graze can replay them.
// A toolchain's lanes need it because Graze compiles the source with the toolchain.
std::string by_graze(const Lane& lane, const AnyPair& pair, const subjects::Opened& opened, std::string_view real) {
  std::string command = fmt::format("echo '{}' | graze check - --json --lanes {}", fuzz::pair_text(pair), lane.id);
  if (opened.kind != "published")
    command += fmt::format(" --subject {} --subject-timeout {}",
                           shell_word(opened.wanted.name + '=' + opened.wanted.what), opened.wanted.timeout);
  if (const subjects::Toolchain* toolchain = subjects::toolchain_of(lane); toolchain && opened.kind != "opencl")
    command += " --toolchains " + shell_word(subjects::list_of({*toolchain}));
  if (!opened.wanted.flags.empty())
    command += " --flags=" + shell_word(fmt::format("{}", fmt::join(opened.wanted.flags, " ")));
  return fmt::format(R"(#include <string>

{3}static int decide(const {0}*, const {0}*) {{
  FILE* graze = popen({1},
                      "r");
  std::string said;
  for (int c; graze && (c = std::fgetc(graze)) != EOF;) said += static_cast<char>(c);
  if (graze) pclose(graze);
  std::fputs(said.c_str(), stdout);
  const std::string lane = {2};
  const std::size_t at = said.find(lane);
  if (at == said.npos) {{
    std::puts("graze gave no answer; it must be on the PATH");
    std::exit(1);
  }}
  const std::string verdict = said.substr(at + lane.size());
  return verdict.find("intersects\"") == 0 ? 1 : verdict.find("disjoint\"") == 0 ? 0 : -1;
}}
)",
                     real, cpp_string(command), cpp_string('"' + lane.id + "\":\""),
                     backends::language_of(lane) == backends::Language::cuda
                         ? "// Graze builds the current source and runs it on a CUDA device, or replays it on the CPU "
                           "if there is no device. The\n// field \"cuda\" of its answer says which, and how well the "
                           "replay is verified.\n"
                         : "// Graze builds the current source with the lane's toolchain.\n");
}

}  // namespace

ForeignCall kernel_call(const Lane& lane) {
  const subjects::Opened& opened = *subjects::opened(lane.info->id);
  ForeignCall call;
  call.seconds = 0;
  call.command = fmt::format("nvcc -arch=native{} -I{} case.cu -o case && ./case", flags_of(lane, opened),
                             shell_word(opened.file.parent_path().string()));
  call.decide = fmt::format("#include {}\n", cpp_string(opened.file.string()));
  call.function = function_of(opened);
  return call;
}

ForeignCall foreign_call(const Lane& lane, const AnyPair& pair, std::string_view compiler, std::string_view libraries) {
  const subjects::Opened& opened = *subjects::opened(lane.info->id);
  const std::string_view scalar = name(lane.scalar), real = lane.scalar == Scalar::f32 ? "float" : "double";
  ForeignCall call;
  call.seconds = static_cast<int>(std::ceil(opened.wanted.timeout)) + 1;
  const std::string plain = fmt::format("{} -std=c++20 case.cpp", compiler),
                    end = fmt::format("{} -o case && ./case", libraries);
  if (backends::language_of(lane) == backends::Language::cuda || subjects::toolchain_of(lane)) {
    call.command = plain + end;
    call.seconds += 100;  // for building the source
    call.decide = by_graze(lane, pair, opened, real);
    return call;
  }
  if (opened.kind == "command") {
    call.command = plain + end;
    call.decide = fmt::format(
        R"(// Gives the program this pair as a line of text, in the folder in which it was tested.
static int decide(const {}*, const {}*) {{
  FILE* program = popen({},
                        "r");
  int said = program ? std::fgetc(program) : EOF;
  while (program && std::fgetc(program) != EOF) {{  // reads its output to the end
  }}
  if (program) pclose(program);
  if (said != '0' && said != '1' && said != '?') {{
    std::puts("the program gave no answer");
    std::exit(1);
  }}
  return said == '?' ? -1 : said - '0';
}}
)",
        real, real,
        cpp_string("cd " + shell_word(std::filesystem::current_path().string()) + " && echo '" +
                   hex_line(analysis::seen_by(lane, pair)) + "' | (" + opened.wanted.what.substr(4) + "\n)"));
    return call;
  }
  const std::string file = opened.file.string();
  if (opened.kind == "library") {
    if (opened.description.describes_itself) {
      call.command = plain + end;
      call.decide = fmt::format("#define LIBRARY {}\n#define SYMBOL {}\n{}", cpp_string(file),
                                cpp_string(opened.description.symbol), kLayout) +
                    by_description(real, scalar, "described()");
      return call;
    }
    call.command = fmt::format("{} {} -Wl,-rpath,{}{}", plain, shell_word(file),
                               shell_word(opened.file.parent_path().string()), end);
    const bool mangled = opened.description.symbol.starts_with("_Z");
    const std::string function = mangled ? function_of(opened) : opened.description.symbol;
    call.decide =
        fmt::format("{0}int {1}(const {2}* a, const {2}* b);\n", mangled ? "" : "extern \"C\" ", function, real) +
        calling(real, function);
    return call;
  }
  const bool describes_itself = subjects::source_describes_itself(opened.file);
  std::string flags = flags_of(lane, opened);
  const bool is_cuda = opened.kind == "cuda";
  const std::string headers = (subjects::cache_folder() / "include").string();
  if (describes_itself || is_cuda) flags += " -I" + shell_word(headers);
  if (is_cuda) flags += " -I" + shell_word(headers + "/cuda");
  const std::string function = function_of(opened);
  if (opened.file.extension() == ".c") {
    call.command = fmt::format("cc -std=gnu11 -O2{} -c {} -o subject.o && {} -I{} subject.o{}", flags, shell_word(file),
                               plain, shell_word(headers), end);
    if (describes_itself) {
      call.decide = "#include <graze/subject.h>\nextern \"C\" const struct graze_subject graze_subject;\n" +
                    by_description(real, scalar, "&::graze_subject");
    } else {
      call.decide = fmt::format("extern \"C\" {} {}(const {}* a, const {}* b);\n",
                                returns_bool(opened.file, function) ? "bool" : "int", function, real, real) +
                    calling(real, function);
    }
    return call;
  }
  call.command = fmt::format("{} -std=c++20 -O2{} case.cpp{}", compiler, flags, end);
  call.decide = fmt::format("{}#include {}\n", is_cuda ? "#include <graze/cuda_host.h>\n" : "", cpp_string(file)) +
                (describes_itself ? by_description(real, scalar, "&::graze_subject") : calling(real, function));
  return call;
}

}  // namespace graze::reports
