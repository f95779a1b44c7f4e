// SPDX-License-Identifier: Apache-2.0
// The contraction pass rewrites a kernel so that it has no floating-point operation that ptxas may contract. Every
// contraction that ptxas would make is written out. The rule was measured; see the table in contraction.cpp.
#pragma once

#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

enum class Rule {
  ptxas,        // what ptxas does at -O1 and above
  none,         // only the front end's fma.rn
  right_first,  // wrong on purpose: contracts the right one of two products. Tests show that the checks notice.
};

// An operation with one rounding where the source has two.
struct Site {
  bool by_ptxas = false;  // otherwise the front end wrote fma.rn
  int line = 0;           // line of the addition or fma in the PTX file
  Source source = {};
};

struct Contracted {
  Kernel kernel;  // every floating-point mul, add, sub has .rn; each fma that is a contraction has its site
  std::vector<Site> sites;
};

// Throws: PtxError for a rounding mode or an operation that the pass cannot write out.
Contracted contract(const Module& module, const Kernel& kernel, Rule rule = Rule::ptxas);

}  // namespace graze::cuda::twin
