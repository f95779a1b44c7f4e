// SPDX-License-Identifier: Apache-2.0
// The contraction pass writes out every contraction that ptxas would make. The rewritten kernel has no floating-point
// operation that ptxas may contract. The rule that ptxas follows was measured; see the table in contraction.cpp.
#pragma once

#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

enum class Rule {
  ptxas,        // the contractions of ptxas at -O1 and above
  none,         // no contraction except the front end's fma.rn
  right_first,  // deliberately wrong: fuses the right one of two products. Tests show that the checks detect it.
};

// A place where the code rounds once although the source has two operations.
struct Site {
  bool by_ptxas = false;  // false: the front end wrote fma.rn
  int line = 0;           // line of the addition or fma in the PTX file
  Source source = {};
};

struct Contracted {
  Kernel kernel;  // every floating-point mul, add, sub has .rn; each fma that is a contraction has its site
  std::vector<Site> sites;
};

// Throws: PtxError for an operation or a rounding mode that the pass cannot write out.
Contracted contract(const Module& module, const Kernel& kernel, Rule rule = Rule::ptxas);

}  // namespace graze::cuda::twin
