// SPDX-License-Identifier: Apache-2.0
// The exported functions of graze.wasm, for pairs of float32, and of graze_f64.wasm, for pairs of doubles. They read
// and write the module's own buffers. graze.js calls them.
#include <algorithm>
#include <vector>

#include "analysis/blame.h"
#include "analysis/lane_trace.h"
#include "backends/backends.h"
#include "core/exact/exact.h"
#include "core/lanes/lanes.h"
#include "core/relation_of.h"
#include "core/text.h"
#include "cuda/twin/twin.h"
#include "wasm/drawing.h"
#include "wasm/either_type.h"
#include "wasm/quad.h"

#define GRAZE_EXPORT(name) extern "C" [[clang::export_name(#name)]]

namespace graze::wasm {
namespace {

constexpr std::size_t kRoom = 1024;   // the largest number of pairs in a call
constexpr std::size_t kText = 65536;  // size of the text buffer in bytes

#ifdef GRAZE_FLOAT32_ALONE
using Coordinate = float;
constexpr const auto& kModuleStrata = strata::kStrata;
#else
using Coordinate = double;
constexpr const auto& kModuleStrata = strata::kDoubleStrata;
#endif
using OwnPair = BasicPair<Coordinate>;

OwnPair pairs_in[kRoom];
OwnPair map_centre;
char text_in[kText];
std::uint8_t verdicts_out[kRoom];
std::uint64_t hashes_out[kRoom];

struct TruthOut {
  std::int32_t verdict, contact, margin_sign, dimension_a, dimension_b, coplanar, log2_ulp, unused;
  double least, most;  // certified bounds of |margin|
} truth_out;

struct StepOut {
  const char* file;
  std::int32_t line, site, compared, relation, held, holds, result;
  double left, right, exact_left, exact_right;
};
std::vector<StepOut> steps_out;
int steps_evidence = 0;
Verdict verdict_of_quads = Verdict::declined;
Drawing drawing_out;

struct SiteOut {
  const char *file, *from_file;
  std::int32_t line, from_line;
};
std::vector<SiteOut> sites_out;

// A lane that the module can run, and the lane's function under the current policy.
struct Decider {
  const Lane* lane;
  DecideBlock decide;
};

std::vector<Decider>& deciders() {
  static std::vector<Decider> all = [] {
    std::vector<Decider> found;
    for (const Lane& lane : lanes()) {
      const DecideBlock block = backends::on_host(lane);
      const bool takes_pairs = std::is_same_v<Coordinate, float>
                                   ? !lane.exact || lane.scalar == Scalar::f32
                                   : lane.scalar == Scalar::f32 || block.decides_doubles();
      if (block && takes_pairs) found.push_back({&lane, block});
    }
    return found;
  }();
  return all;
}

// The lane's function under the policy; null if the lane cannot have the policy. Exact lanes ignore the policy.
DecideBlock block_under(const Lane& lane, std::string_view policy) {
  if (policy.empty() || lane.exact) return backends::on_host(lane);
  const bool by_bounds = policy == "bound" || policy == "filtered";
  if (by_bounds && !lane.info->right_without_rounding) return nullptr;
  return backends::on_host(lane_under(lane, policy));
}

Verdict truth_of(const OwnPair& pair) {
  return !is_finite(pair)                                ? Verdict::declined
         : exact::intersects(&pair.a[0].x, &pair.b[0].x) ? Verdict::intersects
                                                         : Verdict::disjoint;
}

double shown(const Quad& x) { return std::abs(x.value) <= x.error ? 0 : static_cast<double>(x.value); }

void nudge_in(OwnPair& pair, int coordinate, int ulps) {
  Coordinate& x = coordinates(pair)[coordinate];
  if (ulps != 0) x = strata::nudged(x, ulps);  // zero steps would turn -0 into +0
}

std::optional<float> number_in(const char* text, float) { return parse_float32(text); }
std::optional<double> number_in(const char* text, double) { return parse_float64(text); }

}  // namespace

GRAZE_EXPORT(room) int room() { return kRoom; }
GRAZE_EXPORT(coordinate_bytes) int coordinate_bytes() { return sizeof(Coordinate); }
GRAZE_EXPORT(pairs) OwnPair* pairs() { return pairs_in; }
GRAZE_EXPORT(text) char* text() { return text_in; }
GRAZE_EXPORT(verdicts) std::uint8_t* verdicts() { return verdicts_out; }
GRAZE_EXPORT(hashes) std::uint64_t* hashes() { return hashes_out; }

GRAZE_EXPORT(lane_count) int lane_count() { return static_cast<int>(deciders().size()); }
GRAZE_EXPORT(lane_id) const char* lane_id(int lane) { return deciders()[lane].lane->id.c_str(); }

GRAZE_EXPORT(stratum_count) int stratum_count() { return static_cast<int>(std::size(kModuleStrata)); }
GRAZE_EXPORT(stratum_id) const char* stratum_id(int stratum) { return kModuleStrata[stratum].id.data(); }

// Generates `count` pairs, starting with index `first`.
GRAZE_EXPORT(generate) void generate(int stratum, std::uint64_t seed, std::uint64_t first, int count) {
  for (int i = 0; i < count; ++i)
    draw(pairs_in[i], seed, kModuleStrata[stratum].stratum, first + static_cast<std::uint64_t>(i));
}

// Parses the text as a number, rounded once to the type of coordinates, into the first coordinate of the first pair.
// Returns: whether the text is a number.
GRAZE_EXPORT(parse) int parse() {
  const std::optional<Coordinate> value = number_in(text_in, Coordinate{});
  if (value) coordinates(pairs_in[0])[0] = *value;
  return value.has_value();
}

// Sets the policy of all lanes to the policy in the text, until the next call of this function. Requires: abs:E, rel:K,
// bound, filtered, or an empty text for no policy.
GRAZE_EXPORT(set_policy) void set_policy() {
  for (Decider& decider : deciders()) decider.decide = block_under(*decider.lane, text_in);
}

// Writes the lane's verdicts on the pairs.   Returns: false if the lane cannot have the policy.
GRAZE_EXPORT(decide) int decide(int lane, int count) {
  const Decider& decider = deciders()[lane];
  if (!decider.decide) return 0;
  const std::vector<Verdict> said =
      analysis::verdicts_seen_by(*decider.lane, decider.decide, std::span<const OwnPair>(pairs_in, pairs_in + count));
  std::transform(said.begin(), said.end(), verdicts_out, [](Verdict one) { return static_cast<std::uint8_t>(one); });
  return 1;
}

// Writes the exact verdicts of the pairs.
GRAZE_EXPORT(decide_truth) void decide_truth(int count) {
  for (int i = 0; i < count; ++i) verdicts_out[i] = static_cast<std::uint8_t>(truth_of(pairs_in[i]));
}

// Writes the lane's trace hashes (cuda/lanes/trace.h) of the pairs.   Returns: false if the lane has none.
GRAZE_EXPORT(trace) int trace(int lane, int count) {
  const Lane& of = *deciders()[lane].lane;
  if (!cuda::twin_row(of).trace) return false;
  for (int i = 0; i < count; ++i) hashes_out[i] = trace_of(of, pairs_in[i]);
  return true;
}

// x * y + z, rounded once, as in the twins. Only the test uses this function.
GRAZE_EXPORT(fused) float fused(float x, float y, float z) { return __builtin_fmaf(x, y, z); }

// The truth of the first pair. It is exact, except that bounds are given for a margin other than 0.
GRAZE_EXPORT(truth) const TruthOut* truth() {
  const OwnPair& pair = pairs_in[0];
  truth_out = {};
  truth_out.verdict = static_cast<std::int32_t>(truth_of(pair));
  if (!is_finite(pair)) return &truth_out;
  const Relation r = relation_of(pair);
  const MarginBounds bounds = r.margin_sign == 0 ? MarginBounds{} : bounds_of(pair, r.verdict);
  truth_out = {r.intersects(),      static_cast<std::int32_t>(r.contact),
               r.margin_sign,       r.hulls.dimension_a,
               r.hulls.dimension_b, r.hulls.coplanar,
               log2_ulp(pair),      0,
               bounds.lo,           bounds.hi};
  return &truth_out;
}

// Raises the first coordinate of the first pair by this many ulps.
GRAZE_EXPORT(nudge) void nudge(int ulps) { nudge_in(pairs_in[0], 0, ulps); }

// Writes the pairs of one row of an ulp map (analysis/ulp_map.h) around the pair in `centre`. Coordinate x rises by
// `step` ulps from pair to pair. Coordinate y is `up` ulps above the centre's.
GRAZE_EXPORT(centre) OwnPair* centre() { return &map_centre; }
GRAZE_EXPORT(map_row) void map_row(int x, int y, int up, int columns, int step) {
  for (int i = 0; i < columns; ++i) {
    pairs_in[i] = map_centre;
    nudge_in(pairs_in[i], x, (i - columns / 2) * step);
    nudge_in(pairs_in[i], y, up);
  }
}

// Computes the lane's steps on the first pair: the comparisons, the values passed to the lane's policy, and the same
// path with 113 bits. A float lane first rounds the pair to float32. Returns: the number of steps, or -1 if there is no
// evidence that they are the lane's own.
GRAZE_EXPORT(steps) int steps(int lane) {
  const Lane& of = *deciders()[lane].lane;
  steps_out.clear();
  if (of.algorithm < 0) return -1;
  const AnyPair seen_pair = analysis::seen_by(of, pairs_in[0]);
  const analysis::Replay replay = analysis::replay(of, seen_pair);
  if (replay.evidence == analysis::Evidence::none) return -1;
  steps_evidence = static_cast<int>(replay.evidence);
  verdict_of_quads = run_traced<Quad>(of.algorithm, seen_pair.doubles).verdict;
  const Trace<Quad> exact = run_traced<Quad>(of.algorithm, seen_pair.doubles, path_of(replay.run));
  for (std::size_t i = 0; i < replay.run.seen.size(); ++i) {
    const Seen<double>& seen = replay.run.seen[i];
    const Seen<Quad>& right = exact.seen[i];
    const bool alike = compare_numbers(right.left, right.right) == 0;
    steps_out.push_back({seen.where.file_name(), static_cast<std::int32_t>(seen.where.line()),
                         seen.site ? static_cast<std::int32_t>(*seen.site) : -1, seen.compared,
                         static_cast<std::int32_t>(seen.comparison), seen.held, right.held, seen.left_result, seen.left,
                         seen.right, shown(right.left), alike ? shown(right.left) : shown(right.right)});
  }
  return static_cast<int>(steps_out.size());
}
// The evidence that the steps are the lane's own, as in analysis::Evidence.
GRAZE_EXPORT(evidence) int evidence() { return steps_evidence; }
// The algorithm's verdict with 113 bits in every operation; its path may differ from the lane's.
GRAZE_EXPORT(with_113_bits) int with_113_bits() { return static_cast<int>(verdict_of_quads); }
GRAZE_EXPORT(steps_at) const StepOut* steps_at() { return steps_out.data(); }

// Finds the contractions that make the lane's verdict on the first pair differ from the same source's verdict without
// contraction; see analysis/blame.h.   Returns: the number of contractions.
GRAZE_EXPORT(contractions) int contractions(int lane) {
  sites_out.clear();
  const Lane& of = *deciders()[lane].lane;
  const AnyPair seen = analysis::seen_by(of, pairs_in[0]);
  if (cuda::contraction_sites(of, seen).empty()) return 0;
  for (const cuda::ContractionSite& site : analysis::blame(of, seen).sites)
    sites_out.push_back({site.at.file, site.from.file, site.at.line, site.from.line});
  return static_cast<int>(sites_out.size());
}
GRAZE_EXPORT(contractions_at) const SiteOut* contractions_at() { return sites_out.data(); }

// Computes the drawing of the first pair.
GRAZE_EXPORT(draw) const Drawing* drawing() {
  drawing_out = drawing_of(AnyPair(pairs_in[0]).doubles, relation_of(pairs_in[0]));
  return &drawing_out;
}

}  // namespace graze::wasm
