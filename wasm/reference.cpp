// SPDX-License-Identifier: Apache-2.0
// Prints hashes of every lane's results in the native build, for blocks of pairs of every stratum. graze.test.mjs
// computes the same hashes with graze.wasm or graze_f64.wasm, and compares them.   Usage: reference PAIRS f32|f64
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "analysis/blame.h"
#include "analysis/lane_trace.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"
#include "cuda/twin/twin.h"
#include "wasm/either_type.h"

namespace graze {
namespace {

constexpr std::uint64_t kSeed = 20120131;
constexpr std::size_t kBlock = 1000;
constexpr const char* kPolicies[] = {"abs:0.001", "rel:24", "bound", "filtered"};

// 32-bit FNV-1a, which is fast in JavaScript too.
struct Hash {
  std::uint32_t value = 0x811c9dc5u;
  void add(const void* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) value = (value ^ static_cast<const unsigned char*>(bytes)[i]) * 0x01000193u;
  }
  template <class Value>
  void add_value(Value value_of) {
    add(&value_of, sizeof value_of);
  }
  void add_number(double x) { add_value(std::isnan(x) ? 0.25 : x); }  // the bits of NaN differ between platforms
};

void print(const char* what, const char* of, std::uint64_t block, Hash hash) {
  std::printf("%s %s %llu %u\n", what, of, static_cast<unsigned long long>(block), hash.value);
}

template <class OwnPair>
Hash verdicts(const Lane& lane, const DecideBlock& decide, const std::vector<OwnPair>& pairs) {
  Hash hash;
  for (const Verdict said : analysis::verdicts_seen_by(lane, decide, std::span(pairs)))
    hash.add_value(static_cast<std::uint8_t>(said));
  return hash;
}

template <class OwnPair>
Hash truths(const std::vector<OwnPair>& pairs) {
  Hash hash;
  for (const OwnPair& pair : pairs) {
    const Relation r = relation_of(pair);
    const MarginBounds bounds = r.margin_sign == 0 ? MarginBounds{} : wasm::bounds_of(pair, r.verdict);
    for (const std::int32_t x :
         {std::int32_t{r.intersects()}, static_cast<std::int32_t>(r.contact), r.margin_sign, r.hulls.dimension_a,
          r.hulls.dimension_b, std::int32_t{r.hulls.coplanar}, log2_ulp(pair)})
      hash.add_value(x);
    hash.add_number(bounds.lo);
    hash.add_number(bounds.hi);
  }
  return hash;
}

// Hashes one lane's steps. Compilers evaluate the arguments of a call in different orders, so the hash does not depend
// on the order of the steps.
template <class OwnPair>
Hash steps(const Lane& lane, const std::vector<OwnPair>& pairs) {
  Hash hash;
  for (const OwnPair& own : pairs) {
    const AnyPair pair = analysis::seen_by(lane, own);
    const analysis::Replay replay = analysis::replay(lane, pair);
    if (replay.evidence == analysis::Evidence::none) continue;
    std::uint32_t sum = 0;
    for (const Seen<double>& seen : replay.run.seen) {
      Hash step;
      step.add_value(static_cast<std::int32_t>(seen.where.line()));
      step.add_value(std::int32_t{seen.held});
      step.add_number(seen.left);
      step.add_number(seen.right);
      sum += step.value;
    }
    hash.add_value(sum);
    if (cuda::contraction_sites(lane, pair).empty()) continue;
    for (const cuda::ContractionSite& site : analysis::blame(lane, pair).sites)
      hash.add_value(std::int32_t{site.at.line});
  }
  return hash;
}

template <class OwnPair>
void print_block(const std::string& of, std::uint64_t block, const std::vector<OwnPair>& pairs) {
  Hash drawn;
  drawn.add(pairs.data(), pairs.size() * sizeof(OwnPair));
  print("pairs", of.c_str(), block, drawn);
  print("truth", of.c_str(), block, truths(pairs));
  const std::vector<OwnPair> few(pairs.begin(),
                                 pairs.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, pairs.size())));
  for (const Lane& lane : lanes()) {
    const DecideBlock decide = backends::on_host(lane);
    if (!decide || lane.variant == Variant::cpu_fma || lane.variant == Variant::cpu_fast) continue;
    if (sizeof(OwnPair) == sizeof(Pair) && lane.exact && lane.scalar == Scalar::f64) continue;  // see wasm/module.cpp
    print(lane.id.c_str(), of.c_str(), block, verdicts(lane, decide, pairs));
    if (cuda::twin_row(lane).trace) {
      Hash hash;
      for (const OwnPair& pair : pairs) hash.add_value(wasm::trace_of(lane, pair));
      print(("trace:" + lane.id).c_str(), of.c_str(), block, hash);
    }
    if (block > 0) continue;  // the rest runs once for each stratum
    if (lane.algorithm >= 0) print(("steps:" + lane.id).c_str(), of.c_str(), block, steps(lane, few));
    for (const char* policy : kPolicies) {
      const bool by_bounds = policy[0] == 'b' || policy[0] == 'f';
      if (lane.exact || (by_bounds && !lane.info->right_without_rounding)) continue;
      if (const DecideBlock under = backends::on_host(lane_under(lane, policy)))
        print((lane.id + '/' + policy).c_str(), of.c_str(), block, verdicts(lane, under, pairs));
    }
  }
}

template <class OwnPair>
void print_all(std::span<const strata::StratumInfo> strata, std::uint64_t count) {
  const std::uint64_t each = (count + strata.size() - 1) / strata.size();
  for (const strata::StratumInfo& row : strata) {
    const std::string name = std::string(row.id) + (sizeof(OwnPair) > sizeof(Pair) ? "/f64" : "");
    for (std::uint64_t first = 0; first < each; first += kBlock) {
      std::vector<OwnPair> pairs(std::min(each - first, kBlock));
      for (std::uint64_t i = 0; i < pairs.size(); ++i) wasm::draw(pairs[i], kSeed, row.stratum, first + i);
      print_block(name, first / kBlock, pairs);
    }
  }
}

}  // namespace
}  // namespace graze

int main(int count, char** argv) {
  if (count != 3) return 2;
  const unsigned long long pairs = std::strtoull(argv[1], nullptr, 10);
  if (std::strcmp(argv[2], "f64") == 0) {
    graze::print_all<graze::DoublePair>(graze::strata::kDoubleStrata, pairs);
  } else {
    graze::print_all<graze::Pair>(graze::strata::kStrata, pairs);
  }
}
