// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/explicit_ptx.h"

namespace graze::cuda {
namespace {

constexpr const char* kFma[] = {
#include "cuda/generated/explicit_fma.inc"
};
constexpr const char* kNofma[] = {
#include "cuda/generated/explicit_nofma.inc"
};
constexpr const char* kFmaWrong[] = {
#include "cuda/generated/explicit_fma_wrong.inc"
};

template <class Pieces>
std::string joined(const Pieces& pieces) {
  std::string text;
  for (const char* piece : pieces) text += piece;
  return text;
}

}  // namespace

std::string explicit_ptx(bool contracted, bool wrong_rule) {
  return !contracted ? joined(kNofma) : wrong_rule ? joined(kFmaWrong) : joined(kFma);
}

}  // namespace graze::cuda
