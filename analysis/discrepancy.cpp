// SPDX-License-Identifier: Apache-2.0
#include "analysis/discrepancy.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "analysis/over_threads.h"
#include "analysis/sweep.h"
#include "backends/backends.h"
#include "core/discrepancy/count.h"
#include "core/error.h"
#include "core/lanes/verdicts.h"
#include "cuda/engine/discrepancy.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kPairsCompared = 256;  // pairs in a block

struct CountingSink {
  DiscrepancyCounts& to;
  void add(int index) { ++to.counts[static_cast<std::size_t>(index)]; }
  void most(int question, int which, double size) {
    std::uint64_t& kept = to.maxima[static_cast<std::size_t>(question * band_maxima::kFields + which)];
    kept = std::max(kept, std::bit_cast<std::uint64_t>(size));
  }
};

// Calls f with the triangles of the pair in the lane's scalar.
template <class Real, class F>
void in_scalar(const Pair& pair, const F& f) {
  decide_widened<Real>(pair, [&](const auto& a, const auto& b) {
    f(a, b);
    return Verdict::declined;
  });
}
template <class Real, class F>
void in_scalar(const DoublePair& pair, const F& f) {
  f(pair.a, pair.b);
}

template <class Algorithm, class Real, class Coordinate>
void compare_block(std::span<const BasicPair<Coordinate>> pairs, const Records& first, const Records& second,
                   const std::uint8_t* degrees, Axis axis, DiscrepancyCounts& to) {
  CountingSink sink{to};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!is_finite(pairs[i])) continue;
    const auto run = [i](const Records& of) {
      return Run<Real>{{static_cast<const Real*>(of.values) + i, of.stride}, of.paths[i]};
    };
    in_scalar<Real>(pairs[i], [&](const auto& a, const auto& b) {
      compare_runs<Algorithm>(a, b, run(first), run(second), degrees, axis, sink);
    });
  }
}

// Calls f<Algorithm, Real>() for the lane's algorithm and scalar.   Requires: a lane in double if Coordinate is double.
template <class Coordinate, class F>
void for_lane(const Lane& lane, const F& f) {
  const auto call = [&]<class... Algorithm>(const std::tuple<Algorithm...>*) {
    int algorithm = 0;
    const auto in = [&]<class Own>() {
      if (algorithm++ != lane.algorithm) return;
      lane.scalar == Scalar::f64 ? f.template operator()<Own, double>() : f.template operator()<Own, Coordinate>();
    };
    (in.template operator()<Algorithm>(), ...);
  };
  call(static_cast<const Algorithms*>(nullptr));
}

void record(const Lane& lane, std::span<const Pair> pairs, const Records& to) {
  record_on_host(lane)(pairs.data(), pairs.size(), to);
}
// Requires: a lane in double.
void record(const Lane& lane, std::span<const DoublePair> pairs, const Records& to) {
  const RecordFunction<DoublePair> own = host_record_of_doubles(lane);
  (own ? own : cuda::record_row(lane).doubles.record)(pairs.data(), pairs.size(), to);
}

// The records of one lane on a block of pairs.
struct Kept {
  std::vector<double> values;  // room for doubles or floats
  std::vector<RecordedPath> paths;
  Records records;

  template <class Coordinate>
  Kept(const Lane& lane, std::span<const BasicPair<Coordinate>> pairs)
      : values(2 * questions_of(lane.algorithm).size() * pairs.size()),
        paths(pairs.size()),
        records{values.data(), pairs.size(), paths.data()} {
    record(lane, pairs, records);
  }
};

// The number of pairs on which the lane's own verdict differs from the recorded one.
template <class Coordinate>
std::uint64_t unlike(const Lane& lane, std::span<const BasicPair<Coordinate>> pairs, const Kept& kept) {
  const std::vector<Verdict> verdicts = verdicts_of(backends::on_host(lane), pairs);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    count += is_finite(pairs[i]) && verdicts[i] != recorded_verdict(kept.paths[i].path);
  return count;
}

template <class Coordinate>
void count_block(const LanesCompared& lanes, std::span<const BasicPair<Coordinate>> pairs, Axis axis,
                 DiscrepancyCounts& to) {
  const Lane& lane = *lanes.first;
  const Kept first(lane, pairs), second(*lanes.second, pairs);
  const std::vector<std::uint8_t> degrees = degrees_of(lane.algorithm);
  for_lane<Coordinate>(lane, [&]<class Algorithm, class Real>() {
    compare_block<Algorithm, Real>(pairs, first.records, second.records, degrees.data(), axis, to);
  });
  to.unlike[0] += unlike(*lanes.first, pairs, first);
  to.unlike[1] += unlike(*lanes.second, pairs, second);
}

// Collects the values of both runs, and the certified values.
template <class Real>
struct Beside {
  const Run<Real>& first;
  const Run<Real>& second;
  std::vector<ValueBeside>& values;

  void add(int question, int which, int site, const Unrounded& unrounded) {
    ValueBeside value{question, which, first.value(question, which), {}, false, unrounded};
    if (second.path.asked >> question & 1) value.second = second.value(question, which);
    value.compared = have_both(first.path, second.path, question, site);
    values.push_back(value);
  }
  void one(int question, int site, const Unrounded& value) { add(question, 0, site, value); }
  void two(int question, int site, const Unrounded& left, const Unrounded& right, bool) {
    add(question, 0, site, left);
    add(question, 1, site, right);
  }
};

template <class Algorithm, class Real, class Coordinate>
void values_beside(const BasicPair<Coordinate>& pair, const Records& first, const Records& second,
                   std::vector<ValueBeside>& values) {
  const auto run = [](const Records& of) {
    return Run<Real>{{static_cast<const Real*>(of.values), of.stride}, *of.paths};
  };
  const Run<Real> l = run(first), r = run(second);
  Beside<Real> beside{l, r, values};
  in_scalar<Real>(pair, [&](const auto& a, const auto& b) { run_led<Algorithm>(a, b, l.values, l.path, beside); });
  for (int question = 0; question < kMostQuestions; ++question) {
    if ((r.path.asked & ~l.path.asked) >> question & 1) {
      for (int which = 0; which < 2; ++which)
        values.push_back({question, which, {}, r.value(question, which), false, {}});
    }
  }
}

template <class Coordinate>
RunsBeside runs_of_both(const LanesCompared& lanes, const BasicPair<Coordinate>& pair) {
  const Lane& lane = *lanes.first;
  const std::span<const BasicPair<Coordinate>> one(&pair, 1);
  const Kept first(lane, one), second(*lanes.second, one);
  RunsBeside runs{{}, first.paths[0], second.paths[0]};
  for_lane<Coordinate>(lane, [&]<class Algorithm, class Real>() {
    values_beside<Algorithm, Real>(pair, first.records, second.records, runs.values);
  });
  return runs;
}

}  // namespace

RunsBeside runs_beside(const LanesCompared& lanes, const AnyPair& pair) {
  RunsBeside runs = visit(pair, [&](const auto& own) { return runs_of_both(lanes, own); });
  const std::vector<Question>& questions = questions_of(lanes.first->algorithm);
  std::erase_if(runs.values, [&](const ValueBeside& value) {  // some questions have only one value
    return static_cast<std::size_t>(value.which) >= questions[static_cast<std::size_t>(value.question)].of.size();
  });
  return runs;
}

std::string error_bucket_name(int bucket) {
  using namespace value_counts;
  if (bucket == kErrorNotFinite) return "not finite";
  if (bucket == kErrorUnknown) return "unknown";
  return bucket == 0 ? "0" : bucket == 1 ? "1/2" : fmt::format("2^{}", bucket - 2);
}

std::string error_bucket_of(Scalar scalar, double value, const Certified& exact) {
  return error_bucket_name(scalar == Scalar::f32 ? error_bucket(static_cast<float>(value), exact)
                                                 : error_bucket(value, exact));
}

std::uint64_t ulps_apart(Scalar scalar, double first, double second) {
  return scalar == Scalar::f32 ? apart(static_cast<float>(first), static_cast<float>(second)) : apart(first, second);
}

DiscrepancyCounts::DiscrepancyCounts(int algorithm) {
  const std::size_t questions = questions_of(algorithm).size();
  counts.resize(static_cast<std::size_t>(counts_of(static_cast<int>(questions))));
  maxima.resize(questions * band_maxima::kFields);
}

DiscrepancyCounts& DiscrepancyCounts::operator+=(const DiscrepancyCounts& other) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
  for (std::size_t i = 0; i < maxima.size(); ++i) maxima[i] = std::max(maxima[i], other.maxima[i]);
  for (int lane = 0; lane < 2; ++lane) unlike[lane] += other.unlike[lane];
  return *this;
}

RecordBlock record_on_host(const Lane& lane) {
  const RecordBlock own = host_record(lane);
  return own ? own : cuda::record_row(lane).record;
}

std::string why_not_compared(const Lane& l, const Lane& r) {
  if (l.algorithm < 0 || l.algorithm != r.algorithm || l.scalar != r.scalar)
    return fmt::format(
        "{} and {} cannot be compared value by value: they are not lanes of one published algorithm and "
        "scalar",
        l.id, r.id);
  for (const Lane* lane : {&l, &r}) {
    if (!record_on_host(*lane))
      return lane->id + " does not record its values: " +
             (lane->under ? "it has a policy" : "it has neither a host lane nor a twin in this build");
    if (info_of(lane->variant).arithmetic == Arithmetic::fast)
      return lane->id +
             " cannot be compared value by value: under fast math, code that records its values computes different "
             "ones; `graze fuzz` counts its verdicts";
    if (!backends::why_not_on_host(*lane).empty()) return lane->id + " does not run on this processor";
  }
  return "";
}

const Lane* fused_of(const Lane& l, const Lane& r) {
  const auto is = [](const Lane* lane, Arithmetic arithmetic) {
    return info_of(lane->variant).arithmetic == arithmetic;
  };
  for (const auto& [rounded, fused] : {std::pair(&l, &r), {&r, &l}}) {
    if (is(rounded, Arithmetic::rounded) && fused->variant == Variant::cuda_fma) return fused;
  }
  return nullptr;
}

LanesCompared::LanesCompared(const Lane& l, const Lane& r) : first(&l), second(&r) {
  if (const std::string why = why_not_compared(l, r); !why.empty()) throw UsageError(why);
}

void count_discrepancies(const LanesCompared& lanes, std::span<const Pair> pairs, Axis axis, DiscrepancyCounts& to) {
  count_block(lanes, pairs, axis, to);
}
void count_discrepancies(const LanesCompared& lanes, std::span<const DoublePair> pairs, Axis axis,
                         DiscrepancyCounts& to) {
  count_block(lanes, pairs, axis, to);
}

namespace {

bool is_rounded(const Lane& lane) { return info_of(lane.variant).arithmetic == Arithmetic::rounded; }

// Compares on a device.   Returns: false if no device can do so, or if the host's values differ from the device's.
bool compare_on_device(const LanesCompared& lanes, const strata::PairSource& source, DiscrepancyCounts& to) {
  const Lane &first = *lanes.first, &second = *lanes.second;
  if (!cuda::records_on_device(first) || !cuda::records_on_device(second)) return false;
  const bool has_first = backends::backend_of(first).has_device, has_second = backends::backend_of(second).has_device;
  if (is_rounded(first) && is_rounded(second) && has_first != has_second) {
    const Lane &host = has_first ? second : first, &device = has_first ? first : second;
    if (cuda::count_different_runs(host, device, source) > 0) return false;
  }
  cuda::count_discrepancies(first, second, source, {to.counts, to.maxima, to.unlike});
  return true;
}

}  // namespace

Discrepancies discrepancies(const DiscrepancySpec& spec) {
  const std::vector<SourceBlock> blocks = blocks_of(spec.sources, kPairsCompared);
  const auto nothing_yet = [&] {
    Discrepancies nothing;
    for (const LanesCompared& lanes : spec.lanes)
      nothing.emplace_back(spec.sources.size(), DiscrepancyCounts(lanes.first->algorithm));
    return nothing;
  };
  const tbb::global_control limit = thread_limit(spec.threads);  // also for the host's part of a run on a device
  Discrepancies on_device = nothing_yet();
  std::vector<std::vector<bool>> done(spec.lanes.size(), std::vector<bool>(spec.sources.size()));
  for (std::size_t l = 0; l < spec.lanes.size() && spec.on_device; ++l) {
    for (std::size_t s = 0; s < spec.sources.size(); ++s)
      done[l][s] = compare_on_device(spec.lanes[l], spec.sources[s], on_device[l][s]);
  }
  const auto count_block = [&](std::size_t b, Discrepancies& result) {
    const SourceBlock& block = blocks[b];
    const auto source = static_cast<std::size_t>(block.source);
    if (std::all_of(done.begin(), done.end(), [source](const auto& of) { return of[source]; })) return;
    const auto count = [&](const auto& pairs) {
      for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
        if (!done[l][source]) count_discrepancies(spec.lanes[l], pairs, spec.sources[source].axis, result[l][source]);
      }
    };
    const strata::PairBlock pairs = strata::pairs_of(spec.sources[source], block.first, block.count);
    pairs.in_doubles() ? count(pairs.doubles) : count(pairs.floats);
  };
  const auto add = [](Discrepancies& all, const Discrepancies& some) {
    for (std::size_t l = 0; l < all.size(); ++l) {
      for (std::size_t s = 0; s < all[l].size(); ++s) all[l][s] += some[l][s];
    }
  };
  Discrepancies all = sum_over_threads(blocks.size(), spec.threads, nothing_yet, count_block, add);
  add(all, on_device);
  return all;
}

}  // namespace graze::analysis
