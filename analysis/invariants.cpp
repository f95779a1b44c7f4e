// SPDX-License-Identifier: Apache-2.0
#include "analysis/invariants.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "analysis/explain.h"
#include "analysis/neighbours.h"
#include "analysis/over_threads.h"
#include "analysis/scales.h"
#include "core/lanes/convention.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kBlock = 32;  // pairs; they have about 2,300 images

// Why rounding cannot break the claimed invariants: changing signs, scaling by a power of two, and exchanging the
// operands of an operation do not change how it rounds.
//   scale      in every sum and comparison, all terms have the same degree in the coordinates. This is not so in the
//              thesis's two algorithms, which add a distance to one that is multiplied by the normal's length.
//   mirror     both sides of a comparison keep their values, or both change sign. This is not so in
//              guigue_devillers_2003, which chooses its determinants by the triangles' orientation.
//   translate  coordinates are used only in differences, which do not change.
//   swap       the axes of both triangles are tried either way; the axes of two edges only change sign.
// No algorithm keeps its verdicts when vertices or axes are reordered, because the rounding of a sum of three terms
// depends on their order.
struct Claims {
  std::string_view algorithm;
  std::vector<Invariant> invariants;
};
const Claims kClaims[] = {
    {"projected_sat", {Invariant::mirror}},
    {"interval_overlap", {Invariant::mirror}},
    {"moller_1997", {Invariant::mirror, Invariant::scale}},
    {"guigue_devillers_2003", {Invariant::scale, Invariant::translate}},
    {"separating_axes", {Invariant::swap, Invariant::mirror, Invariant::scale}},
};

// The indices in kScales of the scales at which the pair loses no bit, in the order of its images under `scale`.
template <class Real>
std::vector<std::size_t> used_scales(const BasicPair<Real>& pair) {
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < kScales.size(); ++s) {
    if (exactly_scaled(pair, kScales[s])) places.push_back(s);
  }
  return places;
}

// The range of the block's pairs that are images of one pair under one invariant.
struct Group {
  Invariant invariant;
  std::size_t pair, first, last;
};

// Some pairs of one source, followed by all their images.
template <class Real>
struct Asked {
  std::vector<BasicPair<Real>> all;
  std::size_t pairs;
  std::vector<Group> groups;

  explicit Asked(const std::vector<BasicPair<Real>>& of) : all(of), pairs(of.size()) {
    for (std::size_t p = 0; p < pairs; ++p) {
      if (!is_finite(all[p])) continue;
      for (const InvariantInfo& invariant : kInvariants) {
        const std::vector<BasicPair<Real>> made = images(invariant.invariant, all[p]);
        groups.push_back({invariant.invariant, p, all.size(), all.size() + made.size()});
        all.insert(all.end(), made.begin(), made.end());
      }
    }
  }
};

template <class Real>
bool leaves_open(const Lane& lane, const BasicPair<Real>& pair) {
  return lane.outside != 0 && is_outside(lane.outside, pair, relation_of(pair));
}

InvariantBroken broken(std::string_view who, Invariant invariant, const strata::PairSource& source, std::uint64_t index,
                       Verdict pair, Verdict image) {
  return InvariantBroken(fmt::format("{} breaks the invariant \"{}\" on pair {} of {}: it says {}, but on {} {}", who,
                                     kInvariants[static_cast<std::size_t>(invariant)].id, index, source.id, name(pair),
                                     invariant == Invariant::part ? "a part" : "an image", name(image)));
}

struct Run {
  const InvariantSpec& spec;

  // Runs the exact decision on every image, and the oracle on the images of some pairs.
  template <class Real>
  void expect_truth(const Asked<Real>& asked, const PairPlace& place, Invariants& counts) const {
    const strata::PairSource& source = spec.sources[static_cast<std::size_t>(place.source)];
    const std::uint64_t first = place.index;
    const std::vector<Verdict> exactly = verdicts_of(spec.exact, asked.all);
    const auto by_oracle = [&](std::size_t i) {
      return spec.intersects(asked.all[i]) ? Verdict::intersects : Verdict::disjoint;
    };
    std::vector<Verdict> of_pair(asked.pairs, Verdict::declined);
    for (std::size_t p = 0; p < asked.pairs; ++p) {
      if ((first + p) % spec.oracle_every != 0 || !is_finite(asked.all[p])) continue;
      of_pair[p] = by_oracle(p);
      ++counts.by_oracle;
      if (of_pair[p] != exactly[p])
        throw InvariantBroken(fmt::format("exact and the oracle differ on pair {} of {}: {} and {}", first + p,
                                          source.id, name(exactly[p]), name(of_pair[p])));
    }
    for (const Group& group : asked.groups) {
      for (std::size_t i = group.first; i < group.last; ++i) {
        if (breaks(group.invariant, exactly[group.pair], exactly[i]))
          throw broken("exact", group.invariant, source, first + group.pair, exactly[group.pair], exactly[i]);
        if (of_pair[group.pair] == Verdict::declined) continue;
        const Verdict of_image = by_oracle(i);
        ++counts.its_images;
        if (breaks(group.invariant, of_pair[group.pair], of_image))
          throw broken("the oracle", group.invariant, source, first + group.pair, of_pair[group.pair], of_image);
      }
    }
    counts.pairs += asked.groups.size() / kInvariantCount;  // the finite pairs
    counts.images += asked.all.size() - asked.pairs;
  }

  // Uses the host lane, which performs the same operations as the twin.
  static bool leaves(const Lane& lane, const AnyPair& pair, const AnyPair& image) {
    const Lane& host = *counterpart(lane, Variant::cpu);
    return leaves_exponents(host, pair) || leaves_exponents(host, image);
  }

  void keep(std::optional<InvariantCase>& kept, const InvariantCase& found) const {
    const bool better = !kept || spec.simpler(found.pair, kept->pair) ||
                        (!spec.simpler(kept->pair, found.pair) && found.place < kept->place);
    if (better) kept = found;
  }

  template <class Real>
  void count(std::size_t l, const Asked<Real>& asked, const PairPlace& first, InvariantsOfLane& result) const {
    const Lane& lane = *spec.lanes[l];
    const strata::PairSource& source = spec.sources[static_cast<std::size_t>(first.source)];
    const std::vector<Verdict> said = verdicts_of(spec.on_host[l], asked.all);
    std::vector<bool> outside(asked.pairs);
    for (std::size_t p = 0; p < asked.pairs; ++p) outside[p] = leaves_open(lane, asked.all[p]);
    for (const Group& group : asked.groups) {
      if (group.first == group.last || outside[group.pair]) continue;
      const auto invariant = static_cast<std::size_t>(group.invariant);
      InvariantCount& counts = result.counts[invariant][static_cast<std::size_t>(first.source)];
      ++counts.pairs;
      bool changed = false, in_range = false;
      const PairPlace place{first.source, first.index + group.pair};
      const bool scale = group.invariant == Invariant::scale;
      const std::vector<std::size_t> scales = scale ? used_scales(asked.all[group.pair]) : std::vector<std::size_t>();
      for (const std::size_t s : scales) ++result.by_scale[s].pairs;
      for (std::size_t i = group.first; i < group.last; ++i) {
        if (!breaks(group.invariant, said[group.pair], said[i])) continue;
        if (group.invariant == Invariant::part && leaves_open(lane, asked.all[i])) continue;
        const InvariantCase found{place, asked.all[group.pair], asked.all[i], said[group.pair], said[i]};
        const bool stays = (scale || !in_range) && knows_range(lane) && !leaves(lane, found.pair, found.image);
        in_range = in_range || stays;
        if (scale) result.by_scale[scales[i - group.first]] += {0, 1, stays};
        if (lane.exact || (claims(lane, group.invariant) && in_range))
          throw broken(lane.id + (lane.exact ? "" : ", which claims it,"), group.invariant, source, place.index,
                       found.of_pair, found.of_image);
        if (!changed) keep(result.simplest[invariant], found);
        changed = true;
      }
      counts.changed += changed;
      counts.in_range += in_range;
    }
  }

  template <class Real>
  void ask(const std::vector<std::size_t>& lanes, const std::vector<BasicPair<Real>>& pairs, const PairPlace& first,
           Invariants& result) const {
    if (lanes.empty()) return;
    const Asked asked(pairs);
    expect_truth(asked, first, result);
    for (const std::size_t l : lanes) count(l, asked, first, result.lanes[l]);
  }

  void ask(const SourceBlock& block, Invariants& result) const {
    const strata::PairSource& source = spec.sources[static_cast<std::size_t>(block.source)];
    const strata::PairBlock pairs = strata::pairs_of(source, block.first, block.count);
    std::vector<std::size_t> floats, doubles;
    for (std::size_t l = 0; l < spec.lanes.size(); ++l)
      (source.in_doubles() && spec.on_host[l].decides_doubles() ? doubles : floats).push_back(l);
    ask(doubles, pairs.doubles, {block.source, block.first}, result);
    ask(floats, pairs.floats, {block.source, block.first}, result);
  }
};

Invariants nothing_yet(const InvariantSpec& spec) {
  Invariants invariants;
  invariants.lanes.resize(spec.lanes.size());
  for (InvariantsOfLane& lane : invariants.lanes) lane.counts.fill(std::vector<InvariantCount>(spec.sources.size()));
  return invariants;
}

}  // namespace

InvariantCount& InvariantCount::operator+=(const InvariantCount& other) {
  pairs += other.pairs;
  changed += other.changed;
  in_range += other.in_range;
  return *this;
}

InvariantCount InvariantsOfLane::total(Invariant invariant) const {
  InvariantCount sum;
  for (const InvariantCount& of_source : counts[static_cast<std::size_t>(invariant)]) sum += of_source;
  return sum;
}

template <class Real>
std::vector<BasicPair<Real>> images(Invariant invariant, const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result;
  switch (invariant) {
    case Invariant::swap:
      return {BasicPair<Real>{{pair.b[0], pair.b[1], pair.b[2]}, {pair.a[0], pair.a[1], pair.a[2]}}};
    case Invariant::order:
      result = orders(pair);
      result.resize(36);
      break;
    case Invariant::mirror:
      result = mirrored(pair);
      break;
    case Invariant::axes:
      result = axes(pair);
      break;
    case Invariant::scale:
      for (const int k : kScales) {
        if (const auto image = exactly_scaled(pair, k)) result.push_back(*image);
      }
      return result;
    case Invariant::translate:
      result = translated(pair);
      break;
    case Invariant::part:
      result = parts(pair);
      break;
  }
  result.erase(result.begin());
  return result;
}

template std::vector<Pair> images(Invariant, const Pair&);
template std::vector<DoublePair> images(Invariant, const DoublePair&);

bool breaks(Invariant invariant, Verdict of_pair, Verdict of_image) {
  if (invariant != Invariant::part) return of_pair != of_image;
  return of_image == Verdict::intersects && of_pair == Verdict::disjoint;
}

std::vector<Invariant> claimed_invariants(std::string_view algorithm) {
  for (const Claims& row : kClaims) {
    if (row.algorithm == algorithm) return row.invariants;
  }
  return {};
}

bool knows_range(const Lane& lane) { return lane.algorithm >= 0 && lane.policy.empty(); }

bool claims(const Lane& lane, Invariant invariant) {
  if (!knows_range(lane) || info_of(lane.variant).arithmetic != Arithmetic::rounded) return false;
  const std::vector<Invariant> claimed = claimed_invariants(lane.info->id);
  return std::find(claimed.begin(), claimed.end(), invariant) != claimed.end();
}

bool oracle_intersects(const AnyPair& pair) {
  return visit(pair, [](const auto& own) {
    const bool intersects = oracle::cgal_verdict(own) == Verdict::intersects;
    if (intersects == (oracle::gmp_contact(own) == Contact::none))
      throw InvariantBroken(fmt::format("CGAL and GMP differ: {} and {}", intersects, !intersects));
    return intersects;
  });
}

Invariants invariants(const InvariantSpec& spec) {
  const std::vector<SourceBlock> blocks = blocks_of(spec.sources, kBlock);
  const Run run{spec};
  // Reports the broken invariant of the first block that has one, no matter which thread finds one first.
  std::mutex mutex;
  std::size_t first_broken = blocks.size();
  std::string what;
  const auto run_block = [&](std::size_t b, Invariants& result) {
    {
      const std::lock_guard lock(mutex);
      if (b > first_broken) return;
    }
    try {
      run.ask(blocks[b], result);
    } catch (const InvariantBroken& error) {
      const std::lock_guard lock(mutex);
      if (b < first_broken) first_broken = b, what = error.what();
    }
  };
  const auto add = [&](Invariants& all, const Invariants& some) {
    all.pairs += some.pairs;
    all.images += some.images;
    all.by_oracle += some.by_oracle;
    all.its_images += some.its_images;
    for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
      for (std::size_t invariant = 0; invariant < kInvariantCount; ++invariant) {
        for (std::size_t s = 0; s < spec.sources.size(); ++s)
          all.lanes[l].counts[invariant][s] += some.lanes[l].counts[invariant][s];
        if (some.lanes[l].simplest[invariant])
          run.keep(all.lanes[l].simplest[invariant], *some.lanes[l].simplest[invariant]);
      }
      for (std::size_t s = 0; s < kScales.size(); ++s) all.lanes[l].by_scale[s] += some.lanes[l].by_scale[s];
    }
  };
  Invariants all = sum_over_threads(
      blocks.size(), spec.threads, [&] { return nothing_yet(spec); }, run_block, add);
  if (first_broken < blocks.size()) throw InvariantBroken(what);
  return all;
}

}  // namespace graze::analysis
