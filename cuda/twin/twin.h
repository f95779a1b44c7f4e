// SPDX-License-Identifier: Apache-2.0
// The twins: CUDA lanes replayed on the CPU, bit for bit, by C++ generated from the PTX of cuda/lanes/kernels.cu. They
// need neither a GPU nor nvcc. Sign and payload of a NaN are not replayed; they do not affect verdicts.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/any_pair.h"
#include "core/lanes/records.h"

namespace graze::cuda {

// The twin of a published CUDA lane; null when there is none.
DecideBlock::Function twin_block(const Lane& lane);

// The function that gives the lane's verdicts on the host: the lane's own, or the twin of a CUDA lane. For the exact
// CUDA lane it is the exact CPU lane, which is built from the same source. Null when there is none.
DecideBlock block_on_host(const Lane& lane);

// Writes each pair's trace hash (see cuda/lanes/trace.h), which includes the verdict.
template <class AnyPair>
using TraceFunction = void (*)(const AnyPair* pairs, std::size_t count, std::uint64_t* hashes);
using TraceBlock = TraceFunction<Pair>;
TraceBlock twin_trace(const Lane& lane);
TraceFunction<DoublePair> twin_trace_of_doubles(const Lane& lane);

// The twin's records; null when there is none, and in builds of scripts/campaign.
RecordBlock twin_record(const Lane& lane);
RecordFunction<DoublePair> twin_record_of_doubles(const Lane& lane);  // of a lane in double

// Whether lanes with tolerances have twins; they have none in builds of scripts/campaign.
bool has_policy_twins();

// The result of `graze prove-twin` for one lane; see LaneProof in prove.h.
struct TwinProof {
  std::string_view device, toolkit;
  double pairs, twin_pairs;
};

// "twin, verified on H100, nvcc 13.0: GPU and twin agree on 1e+08 pairs, the GPU's default build and explicit PTX on
// 1e+10".
std::string evidence(const TwinProof& proof);

// evidence() of the record in cuda/proofs for exactly this kernel; "twin" if there is none. of_doubles: for the kernel
// that decides pairs of doubles, if the lane has one.
std::string twin_evidence(const Lane& lane, bool of_doubles = false);

struct SourceLine {
  const char* file;  // from the repository's root; empty when there is none
  int line;
  friend bool operator==(const SourceLine& l, const SourceLine& r) {
    return l.line == r.line && std::string_view(l.file) == r.file;
  }
};

// An operation that a kernel rounds once and its source rounds twice.
struct ContractionSite {
  SourceLine at;    // line of the operation
  SourceLine from;  // line into which that function is inlined; PTX does not give further levels
  bool by_ptxas;    // contracted by ptxas; otherwise by nvcc's front end
  int ptx_line;     // line of the addition
};

// A comparison of numbers in a kernel.
struct ComparisonSite {
  SourceLine at, from;  // as in ContractionSite
  int ptx_line;
};

// The contraction sites of a lane's twin, in program order. Empty without a twin or without contractions.
std::span<const ContractionSite> contraction_sites(const Lane& lane);
// The sites of the kernel that decides this pair.
std::span<const ContractionSite> contraction_sites(const Lane& lane, const AnyPair& pair);

// Gives a foreign CUDA lane the sites of its twin, a library of cuda/subject. A verdict may take `most_seconds`
// seconds.
// Throws: as TwinLibrary.
void add_foreign_twin(const Lane& lane, const std::string& twin, double most_seconds);
double most_seconds(const Lane& lane);  // for one verdict.   Requires: a foreign lane with sites

// The verdict of a lane with contraction sites when sites whose bit is not set round twice. No bit set gives
// cuda-nofma; all bits set give the lane itself. Bit i % 64 of word i / 64 belongs to site i. Foreign code runs in this
// process and may crash or not return.
// Requires: (sites + 63) / 64 words; a pair of doubles only for a lane in double, or a foreign one.
Verdict decide_fusing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused);

// The comparisons of numbers in a foreign CUDA lane with contraction sites, in program order. `min`, `max` and tests of
// bits do not count.
std::span<const ComparisonSite> comparison_sites(const Lane& lane);

struct Comparison {
  double left, right;  // exactly the operands
  int ptx_line, outcome;
};

// decide_fusing for such a lane. `made` receives its first comparisons, as many as fit, and `count` how many these
// are.
Verdict decide_comparing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused,
                         std::span<Comparison> made, std::size_t& count);

// The contraction sites of the twin that records, and its records when sites whose bit is not set round twice; see
// decide_fusing.
std::span<const ContractionSite> record_sites(const Lane& lane);
std::span<const ContractionSite> record_sites_of_doubles(const Lane& lane);
void record_fusing(const Lane& lane, std::span<const Pair> pairs, const Records& to,
                   std::span<const std::uint64_t> fused);
// Requires: a lane in double.
void record_fusing(const Lane& lane, std::span<const DoublePair> pairs, const Records& to,
                   std::span<const std::uint64_t> fused);

}  // namespace graze::cuda
