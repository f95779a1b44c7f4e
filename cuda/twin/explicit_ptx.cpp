// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/explicit_ptx.h"

#include <span>
#include <stdexcept>

namespace graze::cuda {
namespace {

struct Explicit {
  Variant variant;
  std::span<const char*const> pieces, wrong_rule;
};

// The texts in pieces, and kExplicit, a row for each variant with a twin; written by the build.
#include "cuda/generated/explicit_ptx.inc"

}  // namespace

std::string explicit_ptx(Variant variant, bool wrong_rule) {
  for (const Explicit& row : kExplicit) {
    if (row.variant != variant) continue;
    std::string text;
    for (const char* piece : wrong_rule ? row.wrong_rule : row.pieces) text += piece;
    return text;
  }
  throw std::invalid_argument(std::string(name(variant)) + ": expected a variant with a twin");
}

}  // namespace graze::cuda
