// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/twin.h"

#include <cstdio>

#include "cuda/twin/twin_table.h"

namespace graze::cuda {
namespace {

// A row of cuda/twin/generator/proofs.h: two kernels by their hashes, and what a record in cuda/proofs says of them.
struct ProofRow {
  std::string_view hash, trace_hash;
  TwinProof proof;
};

constexpr ProofRow kProofs[] = {
#include "cuda/generated/twin_proofs.inc"
    {}};

// A variant's tables: for processors with FMA instructions, and for others. Null without a twin.
struct TwinTables {
  const TwinTable *table = nullptr, *portable = nullptr, *policies = nullptr;
};

#define GRAZE_TABLES_no_twin_rounded(name) \
  {}
#define GRAZE_TABLES_no_twin_contracted(name) \
  {}
#define GRAZE_TABLES_no_twin_fast(name) \
  {}
#define GRAZE_TABLES_no_twin_flushed(name) \
  {}
#define GRAZE_TABLES_no_twin_exact(name) \
  {}
#ifdef GRAZE_WITHOUT_POLICY_TWINS  // cuda/CMakeLists.txt says when
#define GRAZE_POLICIES(name) nullptr
constexpr bool kHasPolicyTwins = false;
#else
constexpr bool kHasPolicyTwins = true;
#define GRAZE_POLICIES(name) &policy_twin_##name::kTwinTable
#endif
#define GRAZE_TABLES_twin_rounded(name) \
  { &twin_##name::kTwinTable, &twin_##name::kTwinTable, GRAZE_POLICIES(name) }
#ifdef __wasm__  // which has no FMA instructions: one table
#define GRAZE_TABLES_twin_contracted(name) \
  { nullptr, &twin_##name##_portable::kTwinTable, GRAZE_POLICIES(name) }
#elif defined(GRAZE_WITHOUT_PORTABLE_TWINS)
#define GRAZE_TABLES_twin_contracted(name) \
  { &twin_##name::kTwinTable, nullptr, GRAZE_POLICIES(name) }
#else
#define GRAZE_TABLES_twin_contracted(name) \
  { &twin_##name::kTwinTable, &twin_##name##_portable::kTwinTable, GRAZE_POLICIES(name) }
#endif
#define GRAZE_VARIANT(name, id, runs_on, arithmetic, twin, ...) GRAZE_TABLES_##twin##_##arithmetic(name),
constexpr TwinTables kTables[] = {
#include "core/variants.inc"
};
#undef GRAZE_VARIANT

const TwinTable* twin_table(Variant variant) {
#if defined(__x86_64__)
  static const bool has_fma = __builtin_cpu_supports("fma");
#else
  constexpr bool has_fma = false;
#endif
  const TwinTables& tables = kTables[static_cast<int>(variant)];
  return has_fma ? tables.table : tables.portable;
}

const TwinRow& row_of(const TwinTable& table, const Lane& lane) {
  return table.rows.at(static_cast<std::size_t>(lane.algorithm)).at(static_cast<std::size_t>(lane.scalar));
}

// Whether ptxas contracts the lane's kernel otherwise than the twin does. For this one kernel of forty it fuses 411
// products where the rule fuses 414, and an H200 gave other verdicts on some hundreds of 60,007 pairs. Why it does so
// is not known; KernelsUnderTolerances compares the machine code of all forty.
bool contracts_otherwise(const Lane& lane) {
  return lane.info->id == "interval_overlap" && lane.scalar == Scalar::f32 && lane.under->epsilons.any_relative() &&
         info_of(lane.variant).arithmetic == Arithmetic::contracted;
}

// The twin of a lane under tolerances; null under other policies, and without a twin that is right.
DecideBlock policy_twin(const Lane& lane) {
  const TwinTable* table = kTables[static_cast<int>(lane.variant)].policies;
  if (!table || lane.under->kind != Policy::Kind::tolerances || contracts_otherwise(lane)) return nullptr;
  const TwinRow& row = row_of(*table, lane);
  return {lane.under->epsilons.any_relative() ? row.relative : row.absolute, lane.under->epsilons};
}

}  // namespace

const TwinRow& twin_row(const Lane& lane) {
  static const TwinRow kNone;
  const TwinTable* table = twin_table(lane.variant);
  return table && lane.algorithm >= 0 && !lane.under ? row_of(*table, lane) : kNone;
}

DecideBlock::Function twin_block(const Lane& lane) { return twin_row(lane).decide; }

DecideBlock block_on_host(const Lane& lane) {
  if (lane.decide) return lane.decide;
  if (lane.foreign) return nullptr;
  if (lane.under) return policy_twin(lane);
  if (!lane.exact) return twin_block(lane);
  const Lane* on_cpu = counterpart(lane, Variant::cpu);
  return on_cpu ? on_cpu->decide : nullptr;
}

bool has_policy_twins() { return kHasPolicyTwins; }

TraceBlock twin_trace(const Lane& lane) { return twin_row(lane).trace; }
const char* twin_hash(const Lane& lane) { return twin_row(lane).hash; }
const char* twin_trace_hash(const Lane& lane) { return twin_row(lane).trace_hash; }

const char* twin_toolkit() {
  for (const VariantInfo& row : kVariants) {
    if (const TwinTable* table = twin_table(row.variant)) return table->toolkit;
  }
  return "";
}

std::string evidence(const TwinProof& proof) {
  const auto count = [](double pairs) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", pairs);
    return std::string(digits);
  };
  std::string words = "twin, verified on " + std::string(proof.device) + ", nvcc " + std::string(proof.toolkit) +
                      ": GPU and twin agree on " + count(proof.twin_pairs) + " pairs";
  if (proof.pairs > 0) words += ", the GPU's default build and explicit PTX on " + count(proof.pairs);
  return words;
}

std::string twin_evidence(const Lane& lane) {
  const TwinRow& row = twin_row(lane);
  for (const auto& [hash, trace_hash, proof] : kProofs) {
    if (row.decide && hash == row.hash && trace_hash == row.trace_hash) return evidence(proof);
  }
  return "twin";
}

}  // namespace graze::cuda
