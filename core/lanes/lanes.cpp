// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/lanes.h"

#include <fnmatch.h>

#include <algorithm>
#include <bit>
#include <exception>
#include <iterator>
#include <stdexcept>

#include "core/error.h"
#include "core/exact_blocks/decide.h"
#include "core/lanes/host_blocks.h"
#include "core/lanes/vector_blocks.h"

namespace graze {
namespace {

constexpr std::size_t kMostLanes = 1024;  // reserved at the start, because lanes must not move

constexpr AlgorithmInfo kExactInfo{"exact",
                                   "Guigue and Devillers 2003, and separating axes, on exact numbers",
                                   "exact",
                                   "exact: segments and points",
                                   "does not depend on it",
                                   true,
                                   true};

void decide_exactly(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  exact::decide(reinterpret_cast<const float*>(pairs), count, intersects, declined);
}

#ifdef GRAZE_FLOAT32_ALONE  // for graze.wasm, which most reports contain
constexpr DecideFunction<DoublePair> decide_doubles_exactly = nullptr;
#else
void decide_doubles_exactly(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                            std::uint64_t* declined) {
  exact::decide(reinterpret_cast<const double*>(pairs), count, intersects, declined);
}
#endif

template <class... Algorithm>
std::vector<const AlgorithmInfo*> infos(const std::tuple<Algorithm...>*) {
  return {&Algorithm::kInfo...};
}

// The block functions of a variant; null for a device variant.
struct Tables {
  const HostBlocks* blocks = nullptr;
  const HostDoubleBlocks* of_doubles = nullptr;
  const HostPolicyBlocks* policies = nullptr;
  const HostDoublePolicyBlocks* policies_of_doubles = nullptr;
};

const Tables& tables_of(Variant variant) {
#define GRAZE_BLOCKS_host(name) \
  Tables { &name::kHostBlocks, &name::kHostDoubleBlocks, &name::kHostPolicyBlocks, &name::kHostDoublePolicyBlocks }
#define GRAZE_BLOCKS_device(name) \
  Tables {}
#define GRAZE_BLOCKS_program(name) \
  Tables {}
#define GRAZE_VARIANT(name, id, runs_on, ...) GRAZE_BLOCKS_##runs_on(name),
  static constexpr Tables kTables[] = {
#include "core/variants.inc"
  };
#undef GRAZE_VARIANT
#undef GRAZE_BLOCKS_host
#undef GRAZE_BLOCKS_device
#undef GRAZE_BLOCKS_program
  return kTables[static_cast<int>(variant)];
}

// The entry for a lane's algorithm and scalar type.
template <class Table>
const auto& of_lane(const Table& table, const Lane& lane) {
  return table.at(static_cast<std::size_t>(lane.algorithm)).at(static_cast<std::size_t>(lane.scalar));
}

template <class AnyPair>
DecideFunctions<AnyPair> functions_under(const Policy& policy, const PolicyFunctions<AnyPair>& blocks,
                                         DecideFunction<AnyPair> exactly) {
  if (policy.kind == Policy::Kind::tolerances)
    return {.within = policy.epsilons.any_relative() ? blocks.relative : blocks.absolute};
  return {blocks.bound, policy.kind == Policy::Kind::filtered && blocks.bound ? exactly : nullptr};
}

DecideBlock block_under(const Policy& policy, const Tables& tables, const Lane& lane) {
  DecideBlock::Doubles doubles;
  if (lane.scalar == Scalar::f64)
    doubles = functions_under(policy, tables.policies_of_doubles->at(static_cast<std::size_t>(lane.algorithm)),
                              decide_doubles_exactly);
  return {functions_under(policy, of_lane(*tables.policies, lane), decide_exactly), doubles, policy.epsilons};
}

Lane lane_of(const AlgorithmInfo* info, Scalar scalar, Variant variant) {
  Lane lane{"", info, scalar, variant, "", {}, -1, nullptr, false, false, false, 0, ""};
  lane.id = id_of(lane.lane_name());
  return lane;
}

std::vector<Lane> make_lanes() {
  std::vector<Lane> table;
  table.reserve(kMostLanes);
  int algorithm = 0;
  for (const AlgorithmInfo* info : infos(static_cast<const Algorithms*>(nullptr))) {
    for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
      for (const VariantInfo& row : kVariants) {
        if (!builds_published(row)) continue;
        Lane& lane = table.emplace_back(lane_of(info, scalar, row.variant));
        lane.algorithm = algorithm;
        lane.explainable = row.arithmetic != Arithmetic::fast;
        const Tables& tables = tables_of(row.variant);
        if (!tables.blocks) continue;
        DecideBlock::Floats floats{of_lane(*tables.blocks, lane)};
        DecideBlock::Doubles doubles;
        const DecideBlock::Function vectors = row.variant == Variant::cpu ? vector_block(info->id, scalar) : nullptr;
        if (vectors) floats.function = vectors;
        if (scalar == Scalar::f64) doubles.function = tables.of_doubles->at(static_cast<std::size_t>(algorithm));
        lane.decide = {floats, doubles};
      }
    }
    ++algorithm;
  }
  for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
    for (const Variant variant : {Variant::cpu, Variant::cuda}) {
      Lane& lane = table.emplace_back(lane_of(&kExactInfo, scalar, variant));
      lane.exact = true;
      if (lane.is_cuda()) continue;
      lane.decide = {{decide_exactly}, {scalar == Scalar::f64 ? decide_doubles_exactly : nullptr}};
    }
  }
  return table;
}

std::vector<Lane>& table() {
  static std::vector<Lane> all = make_lanes();
  return all;
}

void append(std::vector<Lane> added) {
  if (table().size() + added.size() > kMostLanes)
    throw std::runtime_error("expected at most " + std::to_string(kMostLanes) + " lanes, found more");
  std::move(added.begin(), added.end(), std::back_inserter(table()));
}

}  // namespace

std::string_view name(Scalar scalar) { return scalar == Scalar::f32 ? "f32" : "f64"; }

std::string LaneName::within_subject() const { return scalar + '/' + variant + (policy.empty() ? "" : '/' + policy); }

std::string id_of(const LaneName& name) { return name.subject + '/' + name.within_subject(); }

std::optional<LaneName> parse_lane_name(std::string_view id) {
  LaneName name;
  bool more = true;
  for (std::string* part : {&name.subject, &name.scalar, &name.variant}) {
    if (!more) return std::nullopt;
    const std::size_t end = id.find('/');
    *part = id.substr(0, end);
    if (part->empty()) return std::nullopt;
    more = end != id.npos;
    id.remove_prefix(more ? end + 1 : id.size());
  }
  name.policy = id;
  if (more && name.policy.empty()) return std::nullopt;
  return name;
}

LaneName Lane::lane_name() const {
  return {std::string(info->id), std::string(name(scalar)), std::string(variant_name()), policy};
}

std::span<const Lane> lanes() { return table(); }

void add_lanes(std::vector<Lane> foreign) {
  for (Lane& lane : foreign) {
    lane.foreign = true;
    lane.id = id_of(lane.lane_name());
  }
  append(std::move(foreign));
}

Lane lane_under(const Lane& lane, std::string_view policy) {
  Lane result = lane;
  result.policy = policy;
  result.id = id_of(result.lane_name());
  result.under = parse_policy(policy, *lane.info);
  if (info_of(lane.variant).arithmetic == Arithmetic::fast && result.under->kind != Policy::Kind::tolerances)
    throw UsageError("expected a policy other than " + result.policy + " for " + lane.id +
                     ": fast math invalidates error bounds");
  result.explainable = false;
  result.decide = lane.is_cuda() ? nullptr : block_under(*result.under, tables_of(lane.variant), lane);
  return result;
}

namespace {

// A pattern, split into a pattern for lanes without a policy, and a policy. The policy begins at the fourth part. If a
// star stands for several parts ("*/cpu/rel:8"), the policy is the last part, provided that it names a policy.
struct PolicyPattern {
  std::string zero, policy;
};

std::optional<PolicyPattern> split(std::string_view pattern) {
  if (std::optional<LaneName> wanted = parse_lane_name(pattern); wanted && !wanted->policy.empty()) {
    std::string policy = std::move(wanted->policy);
    wanted->policy.clear();
    return PolicyPattern{id_of(*wanted), std::move(policy)};
  }
  const std::size_t slash = pattern.rfind('/');
  if (slash == pattern.npos) return std::nullopt;
  const std::string_view last = pattern.substr(slash + 1);
  const bool is_named =
      std::find(std::begin(kNamedPolicies), std::end(kNamedPolicies), last) != std::end(kNamedPolicies);
  if (last.find(':') == last.npos && !is_named) return std::nullopt;
  return PolicyPattern{std::string(pattern.substr(0, slash)), std::string(last)};
}

}  // namespace

void add_policy_lanes(std::string_view pattern) {
  const std::optional<PolicyPattern> wanted = split(pattern);
  if (!wanted) return;
  std::vector<Lane> added;
  std::exception_ptr refused;
  bool any = false;
  for (const Lane& lane : published_lanes()) {
    if (!matches_any({wanted->zero}, lane.id)) continue;
    try {
      Lane under = lane_under(lane, wanted->policy);
      any = true;
      if (!find_lane(under.id)) added.push_back(std::move(under));
    } catch (const UsageError&) {
      refused = std::current_exception();
    }
  }
  if (!any && refused) std::rethrow_exception(refused);
  append(std::move(added));
}

std::span<const Lane> published_lanes() {
  const auto end = std::find_if(lanes().begin(), lanes().end(), [](const Lane& lane) { return lane.exact; });
  return {lanes().begin(), end};
}

const Lane* find_lane(std::string_view id) {
  const auto found = std::find_if(lanes().begin(), lanes().end(), [&](const Lane& lane) { return lane.id == id; });
  return found == lanes().end() ? nullptr : &*found;
}

const Lane* counterpart(const Lane& lane, Variant variant) {
  LaneName other = lane.lane_name();
  other.variant = name(variant);
  return find_lane(id_of(other));
}

template <class AnyPair>
void DecideFunctions<AnyPair>::decide(const Epsilons& epsilons, const AnyPair* pairs, std::size_t count,
                                      std::uint64_t* intersects, std::uint64_t* declined) const {
  if (within) return within(epsilons, pairs, count, intersects, declined);
  function(pairs, count, intersects, declined);
  if (!otherwise) return;
  for (std::size_t word = 0; word * 64 < count; ++word) {
    for (std::uint64_t left = declined[word]; left != 0; left &= left - 1) {
      const std::uint64_t bit = left & -left;
      std::uint64_t yes = 0, no_answer = 0;
      otherwise(pairs + word * 64 + std::countr_zero(left), 1, &yes, &no_answer);
      intersects[word] |= yes ? bit : 0;
      declined[word] &= no_answer ? ~std::uint64_t{0} : ~bit;
    }
  }
}

void DecideBlock::operator()(const Pair* pairs, std::size_t count, std::uint64_t* intersects,
                             std::uint64_t* declined) const {
  if (foreign_) return foreign_->decide(pairs, count, intersects, declined);
  floats_.decide(epsilons_, pairs, count, intersects, declined);
}

void DecideBlock::operator()(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                             std::uint64_t* declined) const {
  if (foreign_) return foreign_->decide_doubles(pairs, count, intersects, declined);
  doubles_.decide(epsilons_, pairs, count, intersects, declined);
}

bool runs_on_this_cpu(const Lane& lane) {
  if (lane.is_cuda()) return false;
#if defined(__x86_64__)
  const std::string_view needs = info_of(lane.variant).needs;
  if (needs == "fma") return __builtin_cpu_supports("fma");
  if (needs == "x86-64-v3")
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
#endif
  return true;
}

bool matches_any(const std::vector<std::string>& globs, std::string_view id) {
  const std::string text(id);
  bool any_wanted = false, matches = false;
  for (const std::string& glob : globs) {
    const bool leaves_out = glob.starts_with('!');
    const bool found = fnmatch(glob.c_str() + leaves_out, text.c_str(), 0) == 0;
    if (leaves_out && found) return false;
    any_wanted |= !leaves_out;
    matches |= !leaves_out && found;
  }
  return matches || !any_wanted;
}

}  // namespace graze
