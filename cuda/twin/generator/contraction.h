// SPDX-License-Identifier: Apache-2.0
// The contraction pass: rewrites a kernel so that no floating-point operation is left for ptxas to contract, with
// the contractions that ptxas makes written out. Its rule was measured; see the table in contraction.cpp.
#pragma once

#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

enum class Rule {
  ptxas,        // what ptxas does at -O1 and above
  none,         // nothing but the front end's fma.rn
  right_first,  // wrong on purpose: of two products the right one. Tests show that the checks see it.
};

// An operation with one rounding where the source has two.
struct Site {
  bool by_ptxas = false;  // otherwise the front end wrote fma.rn
  int line = 0;           // of the addition or fma in the PTX file
  Source source = {};
};

struct Contracted {
  Kernel kernel;  // every mul, add, sub of floating point says .rn; each fma that is a contraction has its site
  std::vector<Site> sites;
};

// Throws: PtxError for a rounding mode or an operation that cannot be written out.
Contracted contract(const Module& module, const Kernel& kernel, Rule rule = Rule::ptxas);

}  // namespace graze::cuda::twin
