// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/wrapper.h"

#include <fmt/format.h>

#include <regex>

#include "core/error.h"
#include "cuda/subject/nvrtc.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

constexpr char kWrapper[] = R"(
#line 1 "graze"
namespace graze_subject_wrapper {{
__device__ inline signed char answer(bool is) {{ return is; }}
__device__ inline signed char answer(int said) {{ return said < 0 ? -1 : said != 0; }}
}}
extern "C" __global__ void graze_subject_kernel(const {0}* coordinates, unsigned stride, unsigned count,
                                                signed char* answers) {{
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  {0} a[9], b[9];
  for (unsigned k = 0; k < 9; ++k) {{
    a[k] = coordinates[(unsigned long long)k * stride + i];
    b[k] = coordinates[(unsigned long long)(k + 9) * stride + i];
  }}
  const {0} (&p)[9] = a, (&q)[9] = b;
  answers[i] = graze_subject_wrapper::answer({1}(p, q));
}}
)";

// The first error in the compiler's log, as "FILE:LINE: message".
std::string first_error(const std::string& log) {
  static const std::regex kError(R"(([^\n]*?)\((\d+)\): (?:catastrophic )?error: ([^\n]*))"),
      kOther("[^\n]*error[^\n]*");
  std::smatch match;
  if (std::regex_search(log, match, kError))
    return fmt::format("{}:{}: {}", match[1].str(), match[2].str(), match[3].str());
  if (std::regex_search(log, match, kOther)) return match[0];
  return log.substr(0, log.find('\n'));
}

std::string with_lines(const std::string& text, const fs::path& source) {
  return fmt::format("#line 1 \"{}\"\n{}", source.string(), text);
}

}  // namespace

std::string wrapped(const std::string& text, const fs::path& source, const std::string& function, Scalar scalar) {
  return with_lines(text, source) + fmt::format(kWrapper, scalar == Scalar::f32 ? "float" : "double", function);
}

Scalar scalar_of(const std::string& text, const fs::path& source, const std::string& function,
                 const std::function<std::string(const std::string& whole)>& compile) {
  if (!std::regex_match(function, std::regex("(::)?[A-Za-z_]\\w*(::[A-Za-z_]\\w*)*")))
    throw UsageError(fmt::format("{}: expected the name of a function, found '{}'", source.string(), function));
  std::string log;
  for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
    try {
      compile(wrapped(text, source, function, scalar));
      return scalar;
    } catch (const CompileError& error) {
      if (log.empty()) log = error.what();
    }
  }
  const std::string expected =
      fmt::format("{}: expected __device__ bool {}(const float a[9], const float b[9]), or int, or with double",
                  source.string(), function);
  try {
    compile(with_lines(text, source));
  } catch (const CompileError& error) {
    throw UsageError(first_error(error.what()));
  }
  try {  // the error message about an undefined template names the function's type
    compile(with_lines(text, source) + fmt::format("\ntemplate <class T> struct graze_found;\n"
                                                   "graze_found<decltype(&{})> graze_type;\n",
                                                   function));
  } catch (const CompileError& error) {
    static const std::regex kType("incomplete type \"?graze_found<(.*?)>\"? ");
    const std::string said = error.what();
    std::smatch match;
    if (said.find("is undefined") != said.npos || said.find("has no member") != said.npos)
      throw UsageError(expected + "; found no function of that name");
    if (std::regex_search(said, match, kType))
      throw UsageError(
          fmt::format("{}; found {}", expected, std::regex_replace(match[1].str(), std::regex("__nv_bool"), "bool")));
    if (said.find("overloaded") != said.npos)
      throw UsageError(fmt::format("{}; found several functions of that name, none of that type", expected));
  }
  throw UsageError(fmt::format("{}; {}", expected, first_error(log)));
}

}  // namespace graze::cuda
