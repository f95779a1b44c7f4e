// SPDX-License-Identifier: Apache-2.0
// The twins replay CUDA lanes on the CPU, bit for bit, with C++ generated from the lanes' PTX. Twins need neither a GPU
// nor nvcc. The sign and the payload of a NaN are replayed only where a kernel reads its bits.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/any_pair.h"
#include "core/lanes/records.h"

namespace graze::cuda {

// The function that gives the lane's verdicts on the host: the lane's own function, or a CUDA lane's twin. For the
// exact CUDA lane, that is the exact CPU lane, which is built from the same source. Null if there is none.
DecideBlock block_on_host(const Lane& lane);

// Whether this build has twins of lanes under tolerances; builds by scripts/campaign have none.
bool has_policy_twins();

// The result of `graze prove-twin` for a lane; see LaneProof in prove.h.
struct TwinProof {
  std::string_view device, toolkit;
  double pairs, twin_pairs;
};

// "twin, verified on H100, nvcc 13.0: GPU and twin agree on 1e+08 pairs, the GPU's default build and explicit PTX on
// 1e+10".
std::string evidence(const TwinProof& proof);

// The evidence() for exactly this lane's kernel, from the records in cuda/proofs; "twin" without a record. of_doubles:
// for the kernel that decides pairs of doubles, if the lane has one.
std::string twin_evidence(const Lane& lane, bool of_doubles = false);

struct SourceLine {
  const char* file;  // path from the repository's root; empty: no line
  int line;
  friend bool operator==(const SourceLine& l, const SourceLine& r) {
    return l.line == r.line && std::string_view(l.file) == r.file;
  }
};

// An operation that a kernel rounds once although its source rounds twice.
struct ContractionSite {
  SourceLine at;    // line of the operation
  SourceLine from;  // line into which the function is inlined; PTX has no further levels
  bool by_ptxas;    // true: contracted by ptxas; false: by nvcc's front end
  int ptx_line;     // line of the addition in the PTX
};

// A comparison of numbers in a kernel.
struct ComparisonSite {
  SourceLine at, from;  // as in ContractionSite
  int ptx_line;
};

// A function that writes each pair's trace hash (see cuda/lanes/trace.h). The hash includes the verdict.
template <class AnyPair>
using TraceFunction = void (*)(const AnyPair* pairs, std::size_t count, std::uint64_t* hashes);

// The functions of the kernels for pairs of one coordinate type.
template <class AnyPair>
struct TwinFunctions {
  DecideFunction<AnyPair> decide = nullptr;
  DecideWithin<AnyPair> absolute = nullptr, relative = nullptr;  // only absolute tolerances; relative tolerances too
  TraceFunction<AnyPair> trace = nullptr;
  Verdict (*decide_fusing)(const AnyPair& pair, const std::uint64_t* fused) = nullptr;
  // The functions of the recording kernel, which is in a separate table, with its own `sites`. record_fusing, like
  // decide_fusing, fuses only the sites whose bit is set.
  RecordFunction<AnyPair> record = nullptr;
  void (*record_fusing)(const AnyPair* pairs, std::size_t count, const Records& to,
                        const std::uint64_t* fused) = nullptr;
  // Hashes of the kernels' PTX and contractions, for which a record in cuda/proofs is valid. Empty without a twin.
  const char* hash = "";
  const char* trace_hash = "";
  const char* symbol = "";  // name of the kernel that the twin replays
  const char* trace_symbol = "";
  std::span<const ContractionSite> sites = {};
};

struct TwinRow : TwinFunctions<Pair> {
  TwinFunctions<DoublePair> doubles;  // for lanes in double
};

// The row of a published CUDA lane for this processor. The row of a lane without a twin has no functions.
const TwinRow& twin_row(const Lane& lane);
// The row of the recording twin. It has no functions without a twin, and in builds by scripts/campaign.
const TwinRow& record_row(const Lane& lane);

// The contraction sites of a lane's twin, in program order; none if the lane has no twin or no contractions.
std::span<const ContractionSite> contraction_sites(const Lane& lane);
// The contraction sites of the kernel that decides pairs of this type.
std::span<const ContractionSite> contraction_sites(const Lane& lane, const AnyPair& pair);

// Loads the twin of a foreign CUDA lane: a library that cuda/subject has built. A verdict may take at most
// `most_seconds` seconds. Throws: as TwinLibrary.
void add_foreign_twin(const Lane& lane, const std::string& twin, double most_seconds);
double most_seconds(const Lane& lane);  // limit for one verdict.   Requires: a foreign lane with sites

// A lane's verdict if only the contraction sites whose bit is set are fused. The other sites round twice. Bit i % 64
// of word i / 64 belongs to site i. With no bit set, the verdict is that of cuda-nofma; with all bits set, it is the
// lane's. Foreign code runs in this process and may crash or not return. Requires: a lane with contraction sites;
// (sites + 63) / 64 words; a pair of doubles only for a lane in double or a foreign lane.
Verdict decide_fusing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused);

// The comparisons of numbers in a foreign CUDA lane with contraction sites, in program order. `min`, `max` and bit
// tests do not count as comparisons of numbers.
std::span<const ComparisonSite> comparison_sites(const Lane& lane);

struct Comparison {
  double left, right;  // the exact operands
  int ptx_line, outcome;
};

// Like decide_fusing, for a foreign lane with sites. `made` receives the first comparisons that the lane makes, as many
// as fit, and `count` receives the number of those.
Verdict decide_comparing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused,
                         std::span<Comparison> made, std::size_t& count);

}  // namespace graze::cuda
