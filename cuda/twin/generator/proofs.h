// SPDX-License-Identifier: Apache-2.0
// Converts proof records (cuda/proofs/*.json, by `graze prove-twin`) to rows of a C++ table for twin_evidence.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace graze::cuda::twin {

// Writes a row {"hash", "trace hash", {"device", "toolkit", pairs, twin_pairs}} for each recorded lane without
// differences.
// Throws: PtxError for a file that is not a proof record.
void write_proofs(std::ostream& out, const std::vector<std::string>& records);

}  // namespace graze::cuda::twin
