// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "cuda/twin/generator/ptx_writer.h"
#include "cuda/twin/prove.h"

namespace graze::cuda {
namespace {

// The names and texts of the PTX files of the variants with a twin.
constexpr std::pair<const char*, const char*> kPtx[] = {
#include "cuda/generated/ptx.inc"
};

}  // namespace

std::string explicit_ptx(Variant variant, bool wrong_rule) {
  std::string wanted = std::string(name(variant)) + ".ptx";
  std::replace(wanted.begin(), wanted.end(), '-', '_');
  for (const auto& [file, text] : kPtx) {
    if (file != wanted) continue;
    std::istringstream in(text);
    std::ostringstream out;
    twin::write_explicit(out, twin::read_ptx(in, file), wrong_rule ? twin::Rule::right_first : twin::Rule::ptxas);
    return out.str();
  }
  throw std::invalid_argument("the variant " + std::string(name(variant)) + " has no twin, so it has no explicit PTX");
}

}  // namespace graze::cuda
