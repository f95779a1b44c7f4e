// SPDX-License-Identifier: Apache-2.0
// The twins: CUDA lanes replayed on the CPU, bit for bit, by C++ generated from the PTX of cuda/lanes/kernels.cu.
// Neither a GPU nor nvcc is needed. Of NaN values neither sign nor payload is replayed; verdicts do not show them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::cuda {

// The twin of a published CUDA lane; null where there is none.
DecideBlock::Function twin_block(const Lane& lane);

// What gives the lane's verdicts on the host: the lane itself, or the twin of a CUDA lane; that of the exact CUDA lane
// is the exact CPU lane, the same source. Null where there is none.
DecideBlock block_on_host(const Lane& lane);

// Writes each pair's trace hash (see cuda/lanes/trace.h), the verdict folded in.
using TraceBlock = void (*)(const Pair* pairs, std::size_t count, std::uint64_t* hashes);
TraceBlock twin_trace(const Lane& lane);

// Whether lanes under tolerances have twins; what scripts/campaign builds is without.
bool has_policy_twins();

// Toolkit whose PTX the twins replay: "13.0.88".
const char* twin_toolkit();

// Hash of the kernel's PTX and its contractions: what a record in cuda/proofs holds for. Empty where there is no twin.
const char* twin_hash(const Lane& lane);
const char* twin_trace_hash(const Lane& lane);

// What a record of `graze prove-twin` says of one lane; see LaneProof in prove.h.
struct TwinProof {
  std::string_view device, toolkit;
  double pairs, twin_pairs;
};

// "twin, verified on H100, nvcc 13.0: GPU and twin agree on 1e+08 pairs, the GPU's default build and explicit PTX on
// 1e+10".
std::string evidence(const TwinProof& proof);

// The words of `evidence` where a record in cuda/proofs holds for this very kernel, else "twin".
std::string twin_evidence(const Lane& lane);

struct SourceLine {
  const char* file;  // from the repository's root; empty when there is none
  int line;
};

// An operation of a kernel with one rounding where the source has two.
struct ContractionSite {
  SourceLine at;    // of the operation
  SourceLine from;  // into which the function with that line is inlined; what lies further out PTX does not say
  bool by_ptxas;    // otherwise by nvcc's front end
  int ptx_line;     // of the addition
};

// The contraction sites of a lane with a twin, in program order; none without a twin, or without contraction.
std::span<const ContractionSite> contraction_sites(const Lane& lane);

// Gives a foreign CUDA lane the sites of its twin, a library of cuda/subject; a verdict may take so many seconds.
// Throws: as TwinLibrary.
void add_foreign_twin(const Lane& lane, const std::string& twin, double most_seconds);
double most_seconds(const Lane& lane);  // of a verdict.   Requires: a foreign lane with sites

// The verdict of a lane that has contraction sites, with two roundings at every site whose bit is not set: none set is
// cuda-nofma, all set is the lane itself. Bit i % 64 of word i / 64 belongs to site i.   Requires: a word for each 64
// sites begun. Foreign code runs in this very process, and may crash or not come back.
Verdict decide_fusing(const Lane& lane, const Pair& pair, std::span<const std::uint64_t> fused);

}  // namespace graze::cuda
