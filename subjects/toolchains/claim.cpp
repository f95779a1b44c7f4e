// SPDX-License-Identifier: Apache-2.0
#include "subjects/toolchains/claim.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <vector>

namespace graze::subjects {
namespace {

// Flags that permit the compiler to rewrite or approximate operations, or to flush subnormal numbers, each with its
// opposite.
constexpr std::pair<std::string_view, std::string_view> kFast[] = {
    {"-ffast-math", "-fno-fast-math"},
    {"-funsafe-math-optimizations", "-fno-unsafe-math-optimizations"},
    {"-fassociative-math", "-fno-associative-math"},
    {"-freciprocal-math", "-fno-reciprocal-math"},
    {"-ffinite-math-only", "-fno-finite-math-only"},
    {"-fno-honor-nans", "-fhonor-nans"},
    {"-fno-honor-infinities", "-fhonor-infinities"},
    {"-fno-signed-zeros", "-fsigned-zeros"},
    {"-fapprox-func", "-fno-approx-func"},
    {"-mrecip", "-mno-recip"},
    {"-mdaz-ftz", "-mno-daz-ftz"},
};

std::map<std::string, std::string> values_of(std::string_view macros) {
  std::map<std::string, std::string> values;
  std::istringstream lines{std::string(macros)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string define, name, value;
    if (words >> define >> name && define == "#define") values[name] = (words >> value, value);
  }
  return values;
}

struct Flags {
  std::set<std::string> fast;
  std::string contract;  // off, on or fast; empty: not given
  std::string excess;    // standard or fast; empty: not given
  bool iso_c = false;    // -std=c11 or another ISO dialect of C
};

Flags flags_of(std::string_view command) {
  Flags flags;
  std::istringstream words{std::string(command)};
  for (std::string word; words >> word;) {
    for (const auto& [yes, no] : kFast) {
      if (word == yes) flags.fast.insert(word);
      if (word == no) flags.fast.erase(std::string(yes));
    }
    if (word.starts_with("-mrecip=") || word.starts_with("-fdenormal-fp-math")) flags.fast.insert(word);
    if (word.starts_with("-O") || word == "-fno-fast-math") flags.fast.erase("-Ofast");
    if (word == "-Ofast") flags.fast.insert(word);
    if (word == "-Ofast" || word == "-ffast-math") flags.contract.clear();  // clang's -ffast-math also sets contraction
    if (word.starts_with("-ffp-model=")) {
      flags.fast.erase("-ffast-math");
      if (word == "-ffp-model=fast" || word == "-ffp-model=aggressive") flags.fast.insert("-ffast-math");
      flags.contract = word == "-ffp-model=strict" ? "off" : "on";
    }
    const std::string value = word.substr(word.find('=') + 1);
    if (word.starts_with("-ffp-contract=")) flags.contract = value;
    if (word.starts_with("-fexcess-precision=")) flags.excess = value;
    if (word.starts_with("-std="))
      flags.iso_c = value.starts_with("iso9899") || (value.starts_with("c") && !value.starts_with("c++"));
  }
  return flags;
}

}  // namespace

std::optional<Claim> documented_claim(std::string_view command, std::string_view macros) {
  const std::map<std::string, std::string> values = values_of(macros);
  const auto has = [&](const char* name) { return values.contains(name); };
  const auto value_of = [&](const char* name) { return has(name) ? values.at(name) : ""; };
  // These compilers also define __GNUC__ or __clang__, but have other defaults.
  for (const char* other : {"__INTEL_LLVM_COMPILER", "__INTEL_COMPILER", "__NVCOMPILER", "__ibmxl__", "_MSC_VER"}) {
    if (has(other)) return std::nullopt;
  }
  if (!has("__GNUC__")) return std::nullopt;
  const Flags flags = flags_of(command);
  if (!flags.fast.empty()) {
    const bool off = flags.contract == "off";
    return Claim{
        Rounding::fast, true,
        fmt::format("{}{}", fmt::join(flags.fast, " "), off ? ", without contraction (-ffp-contract=off)" : ""), !off};
  }
  // With 0 and 16, operations on float and double have their type's precision. 0 and 16 differ only for _Float16.
  const std::string method = value_of("__FLT_EVAL_METHOD__");
  if (!method.empty() && method != "0" && method != "16") {
    // Annex F of C removes excess precision when a value is assigned or returned.
    const bool within = flags.excess.empty() ? flags.iso_c : flags.excess == "standard";
    return Claim{Rounding::excess, !within, "__FLT_EVAL_METHOD__ is " + method};
  }
  const bool is_x86 = has("__x86_64__") || has("__i386__");
  if ((is_x86 && !has("__FMA__") && !has("__FMA4__") && !has("__AVX512F__")) || has("__wasm__"))
    return Claim{Rounding::rounded, true, "the processor that it compiles for has no fused multiply-add"};
  const bool is_clang = has("__clang__"), is_iso_c = flags.iso_c && !is_clang;
  const std::string contract = !flags.contract.empty() ? flags.contract : is_clang ? "on" : is_iso_c ? "off" : "fast";
  const std::string because = !flags.contract.empty() ? "-ffp-contract=" + contract
                              : is_clang              ? "clang's default is -ffp-contract=on"
                              : is_iso_c              ? "GCC's default in ISO C is -ffp-contract=off"
                                                      : "GCC's default is -ffp-contract=fast";
  if (contract == "off") return Claim{Rounding::rounded, true, because};
  if (contract == "on" && !is_clang && std::atoi(value_of("__GNUC__").c_str()) < 14)
    return Claim{Rounding::rounded, true, "-ffp-contract=on, which GCC before 14 treats as off"};
  return Claim{Rounding::contracted, contract != "on", because};
}

}  // namespace graze::subjects
