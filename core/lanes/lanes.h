// SPDX-License-Identifier: Apache-2.0
// The lane table: one row for each way to decide a pair. A name is `subject/scalar/variant`, plus `/policy` unless the
// policy is zero. A row describes the lane and what it can do; the order of the rows has no meaning.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/algorithms/algorithm.h"
#include "core/lanes/policies.h"
#include "core/pair.h"
#include "core/variants.h"

namespace graze {

enum class Scalar : std::uint8_t { f32, f64 };
std::string_view name(Scalar scalar);

// The parts of a lane's name. The lane need not exist here: the name may come from another build or machine.
struct LaneName {
  std::string subject, scalar, variant, policy;  // an empty policy is zero

  std::string within_subject() const;  // "f32/cpu", "f32/cpu/abs:1e-6"
  friend bool operator==(const LaneName&, const LaneName&) = default;
};

// "moller_1997/f32/cpu"; the inverse of parse_lane_name.
std::string id_of(const LaneName& name);

// Returns: nothing unless there are three or four nonempty parts. The fourth part may contain slashes.
std::optional<LaneName> parse_lane_name(std::string_view id);

// Code that is not ours (subjects/). If the code fails on a pair, both bits of the pair are set.
class ForeignCode {
 public:
  virtual ~ForeignCode() = default;
  virtual void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) = 0;
  // The kind of failure: crashed, timed_out or unstable.   Requires: the code failed on the pair.
  virtual Verdict failure(const Pair& pair) = 0;

  // The same functions for pairs of doubles, if the code takes such pairs.
  virtual bool decides_doubles() const { return false; }
  virtual void decide_doubles(const DoublePair*, std::size_t, std::uint64_t*, std::uint64_t*) { std::terminate(); }
  virtual Verdict failure_on_doubles(const DoublePair&) { std::terminate(); }
};

template <class AnyPair>
using DecideFunction = void (*)(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects,
                                std::uint64_t* declined);
template <class AnyPair>
using DecideWithin = void (*)(const Epsilons& epsilons, const AnyPair* pairs, std::size_t count,
                              std::uint64_t* intersects, std::uint64_t* declined);

// A lane's functions for pairs of one coordinate type; all null if the lane does not take such pairs.
template <class AnyPair>
struct DecideFunctions {
  DecideFunction<AnyPair> function = nullptr;
  DecideFunction<AnyPair> otherwise = nullptr;  // decides pairs that `function` declines
  DecideWithin<AnyPair> within = nullptr;       // used instead of `function`

  void decide(const Epsilons& epsilons, const AnyPair* pairs, std::size_t count, std::uint64_t* intersects,
              std::uint64_t* declined) const;
  bool operator==(const DecideFunctions&) const = default;
};

// The verdict that two bits encode for one of our lanes.
constexpr Verdict verdict_of_bits(bool intersects, bool declined) {
  return declined ? Verdict::declined : intersects ? Verdict::intersects : Verdict::disjoint;
}

// Decides pairs[0..count) and writes two arrays, `intersects` and `declined`. Pair i is bit i % 64 of word i / 64;
// unused bits become zero. Lanes in double take pairs of both coordinate types; other lanes take only float32.
// Requires: room for (count + 63) / 64 words in each of the two arrays.
class DecideBlock {
 public:
  using Function = DecideFunction<Pair>;
  using Floats = DecideFunctions<Pair>;
  using Doubles = DecideFunctions<DoublePair>;

  constexpr DecideBlock(Function function = nullptr) : floats_{function} {}
  DecideBlock(const Floats& floats, const Doubles& doubles, const Epsilons& epsilons = {})
      : floats_(floats), doubles_(doubles), epsilons_(epsilons) {}
  DecideBlock(ForeignCode& foreign) : foreign_(&foreign) {}

  void operator()(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) const;
  // Requires: decides_doubles().
  void operator()(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) const;
  bool decides_doubles() const { return foreign_ ? foreign_->decides_doubles() : doubles_.function || doubles_.within; }
  constexpr explicit operator bool() const { return floats_.function || floats_.within || foreign_; }
  bool operator==(const DecideBlock&) const = default;
  constexpr bool operator==(std::nullptr_t) const { return !*this; }

  // The verdict that a pair's two bits encode.
  template <class AnyPair>
  Verdict verdict_of(bool intersects, bool declined, const AnyPair& pair) const {
    if (foreign_ && intersects && declined) {
      if constexpr (sizeof pair == sizeof(Pair)) {
        return foreign_->failure(pair);
      } else {
        return foreign_->failure_on_doubles(pair);
      }
    }
    return verdict_of_bits(intersects, declined);
  }

 private:
  Floats floats_;
  Doubles doubles_;
  Epsilons epsilons_;
  ForeignCode* foreign_ = nullptr;
};

template <class Real>
Verdict decide_one(const DecideBlock& block, const BasicPair<Real>& pair) {
  std::uint64_t intersects = 0, declined = 0;
  block(&pair, 1, &intersects, &declined);
  return block.verdict_of(intersects & 1, declined & 1, pair);
}

// Kinds of pairs for which a subject does not promise the truth; see subjects/include/graze/subject.h.
enum Outside : unsigned { kOutsideTouching = 1, kOutsideCoplanar = 2, kOutsideDegenerate = 4, kOutsideShared = 8 };

struct Lane {
  std::string id;
  const AlgorithmInfo* info;  // of the lane's subject
  Scalar scalar;
  Variant variant;
  std::string policy;           // empty for the policy zero
  std::optional<Policy> under;  // the parsed policy; nothing for zero
  // Published algorithms: the index in Algorithms, which selects the code that is compiled for the algorithm.
  // Other subjects: -1.
  int algorithm;
  DecideBlock decide;  // decides on this processor; null for device lanes, see cuda/lanes/device.h
  bool exact;          // right on every finite pair of its scalar type, declines other pairs; see core/exact/exact.h
  bool explainable;    // runs on numbers that record every step; see core/algorithms/traced.h
  // Foreign code only:
  bool foreign = false;
  unsigned outside = 0;  // the kinds of pairs that its convention excludes: a sum of Outside
  std::string evidence;  // what runs a CUDA lane: "device", "twin, not yet verified"; or why nothing runs the lane
  std::string toolchain = {};  // for Variant::toolchain: the toolchain's name, which is the variant in the lane's name

  std::string_view variant_name() const { return toolchain.empty() ? name(variant) : toolchain; }
  bool is_cuda() const { return info_of(variant).runs_on == RunsOn::device; }
  LaneName lane_name() const;
};

// All lanes, subject by subject: f32 before f64, then in the order of the variants. The exact lanes come after the
// published algorithms, and lanes of foreign code come last.
std::span<const Lane> lanes();

// Adds a foreign subject's lanes for the rest of the process.   Requires: no other thread uses lanes meanwhile.
// Throws: std::runtime_error if there are too many lanes.
void add_lanes(std::vector<Lane> foreign);

// Returns the published lane under another policy, without adding it to the table.
// Throws: UsageError if the lane cannot have the policy.
Lane lane_under(const Lane& lane, std::string_view policy);

// Adds a lane under the pattern's policy for each published lane that the rest of the pattern matches. Example:
// "*/f32/cpu/rel:8" for all f32/cpu lanes. A lane is added only once. Nothing is added if the pattern has no policy.
// Requires: as add_lanes.   Throws: UsageError if no matching lane can have the policy.
void add_policy_lanes(std::string_view pattern);

// The lanes of published algorithms, without a policy.
std::span<const Lane> published_lanes();

// The lane with that name; null if there is none.
const Lane* find_lane(std::string_view id);

// The lane with the same subject, scalar and policy in another variant; null if there is none.
const Lane* counterpart(const Lane& lane, Variant variant);

// Whether this processor can run the host lane (cpu-fma needs FMA instructions).
bool runs_on_this_cpu(const Lane& lane);

// Whether the id matches a shell pattern (fnmatch) and no pattern after a `!`. If all patterns begin with `!`, or there
// are none, every id matches that no pattern excludes.
bool matches_any(const std::vector<std::string>& globs, std::string_view id);

}  // namespace graze
