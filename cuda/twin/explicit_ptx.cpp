// SPDX-License-Identifier: Apache-2.0
#include <span>
#include <stdexcept>

#include "cuda/twin/prove.h"

namespace graze::cuda {
namespace {

struct Explicit {
  Variant variant;
  std::span<const char*const> pieces, wrong_rule;
};

// The build generates this file: the texts in pieces, and the table kExplicit, with a row for each variant with a twin.
#include "cuda/generated/explicit_ptx.inc"

}  // namespace

std::string explicit_ptx(Variant variant, bool wrong_rule) {
  for (const Explicit& row : kExplicit) {
    if (row.variant != variant) continue;
    std::string text;
    for (const char* piece : wrong_rule ? row.wrong_rule : row.pieces) text += piece;
    return text;
  }
  throw std::invalid_argument("the variant " + std::string(name(variant)) + " has no twin, so it has no explicit PTX");
}

}  // namespace graze::cuda
