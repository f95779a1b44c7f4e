// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/mutations.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "strata/scene/place.h"

namespace graze::fuzz {
namespace {

using strata::Vec;

template <class Real>
Vec wide(const Vec3<Real>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

template <class Real>
void store(Vec3<Real>& vertex, const Vec& v) {
  vertex = {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

// A pair's two triangles, in either order; only the triangle `own` may change.
template <class Real>
struct Sides {
  Vec3<Real>* own;
  const Vec3<Real>* other;
};

template <class Real>
Sides<Real> choose(BasicPair<Real>& pair, strata::Draws& draws) {
  return draws.coin() ? Sides<Real>{pair.a, pair.b} : Sides<Real>{pair.b, pair.a};
}

template <class Real>
void shift(Vec3<Real>* triangle, const Vec& by) {
  for (int i = 0; i < 3; ++i) store(triangle[i], wide(triangle[i]) + by);
}

// Moves the vertex to `to`, either by itself or with its whole triangle.
template <class Real>
void bring(Vec3<Real>* triangle, std::uint32_t vertex, const Vec& to, bool alone) {
  if (!alone) shift(triangle, to - wide(triangle[vertex]));
  store(triangle[vertex], to);
}

// A parameter along a segment: often 0, 1 or a simple fraction, and sometimes outside [0, 1].
template <class Draws>
double draw_share(Draws& draws) {
  constexpr double kShares[] = {0, 1, 0.5, 0.25, 0.75};
  const std::uint32_t kind = draws.below(8);
  return kind < 5 ? kShares[kind] : kind < 7 ? draws.positive() : 2 * draws.real();
}

template <class Real>
Vec point_between(const Vec3<Real>& from, const Vec3<Real>& to, double share) {
  return wide(from) + (wide(to) - wide(from)) * share;
}

template <class Real>
void by_ulps(BasicPair<Real>& pair, strata::Draws& draws) {
  const std::uint32_t vertex = draws.below(6);
  Vec3<Real>& v = vertex < 3 ? pair.a[vertex] : pair.b[vertex - 3];
  const bool whole = draws.below(4) == 0;
  const int axis = draws.between(0, 2), reach = 1 << draws.below(6);
  for (int i = 0; i < 3; ++i) {
    const int steps = draws.integer(reach);
    if (whole || i == axis) component(v, i) = strata::nudged(component(v, i), steps == 0 ? 1 : steps);
  }
}

template <class Draws>
void onto_edge(DrawnPair<Draws>& pair, Draws& draws) {
  const auto sides = choose(pair, draws);
  const std::uint32_t from = draws.below(3), vertex = draws.below(3);
  const Vec place = point_between(sides.other[from], sides.other[(from + 1) % 3], draw_share(draws));
  if (draws.coin()) {
    const bool alone = draws.coin();
    return bring(sides.own, vertex, place, alone);
  }
  const Vec own = point_between(sides.own[vertex], sides.own[(vertex + 1) % 3], draw_share(draws));
  shift(sides.own, place - own);
}

// Moves the point onto the plane, along one axis or the normal.
template <class Real>
Vec onto_plane(const Vec& point, const Vec3<Real>* plane, bool along_axis) {
  const Vec origin = wide(plane[0]), normal = cross(wide(plane[1]) - origin, wide(plane[2]) - origin);
  const int axis = dominant_axis(normal);
  const double distance = dot(normal, point - origin), largest = component(normal, axis);
  if (largest == 0) return point;
  if (along_axis) return point - strata::unit_axis(axis) * (distance / largest);
  return point - normal * (distance / dot(normal, normal));
}

template <class Real>
void scale(BasicPair<Real>& pair, strata::Draws& draws) {
  constexpr int kFar = sizeof(Real) == sizeof(float) ? 60 : 500;
  const std::uint32_t what = draws.below(6);  // 0: both triangles, 1: a, 2: b, 3 to 5: an axis
  const Real factor = static_cast<Real>(strata::power_of_two(draws.coin() ? draws.integer(4) : draws.integer(kFar)));
  for (int i = 0; i < kCoordinates; ++i) {
    const bool meant =
        what == 0 || (what == 1 && i < 9) || (what == 2 && i >= 9) || static_cast<int>(what) - 3 == i % 3;
    if (meant) coordinates(pair)[i] *= factor;
  }
}

template <class Real>
double largest_of(const BasicPair<Real>& pair) {
  double largest = 0;
  for (int i = 0; i < kCoordinates; ++i)
    largest = std::max(largest, std::fabs(static_cast<double>(coordinates(pair)[i])));
  return largest;
}

template <class Draws>
void move_both(DrawnPair<Draws>& pair, Draws& draws) {
  if (draws.coin()) {  // moves a vertex to the origin
    const std::uint32_t vertex = draws.below(6);
    const Vec by = wide(vertex < 3 ? pair.a[vertex] : pair.b[vertex - 3]) * -1.0;
    shift(pair.a, by);
    return shift(pair.b, by);
  }
  const double far = largest_of(pair) * strata::power_of_two(draws.integer(12));
  const Vec by = draws.reals() * far;
  shift(pair.a, by);
  shift(pair.b, by);
}

template <class Draws>
void onto_grid(DrawnPair<Draws>& pair, Draws& draws) {
  int exponent = 0;
  std::frexp(largest_of(pair), &exponent);
  const double step = std::ldexp(1.0, exponent - draws.between(1, Draws::kBits - 4));
  for (int i = 0; i < kCoordinates; ++i) {
    auto& x = coordinates(pair)[i];
    x = static_cast<typename Draws::Real>(std::nearbyint(static_cast<double>(x) / step) * step);
  }
}

template <class Real>
void mirror(BasicPair<Real>& pair, strata::Draws& draws) {
  const auto sides = choose(pair, draws);
  const int axis = draws.between(0, 2), other_axis = draws.between(0, 2);
  const std::uint32_t through = draws.below(3);
  const bool swap = draws.coin(), at_origin = draws.coin();
  for (int i = 0; i < 3; ++i) {
    Vec v = wide(sides.other[i]);
    const Vec centre = at_origin ? Vec{0, 0, 0} : wide(sides.other[through]);
    if (swap) std::swap(component(v, axis), component(v, other_axis));
    if (!swap || axis == other_axis) component(v, axis) = 2 * component(centre, axis) - component(v, axis);
    store(sides.own[i], v);
  }
}

template <class Real>
void cross_with(BasicPair<Real>& pair, const BasicPair<Real>& other, strata::Draws& draws) {
  const Vec3<Real>* theirs = draws.coin() ? other.a : other.b;
  Vec3<Real>* own = draws.coin() ? pair.a : pair.b;
  const Vec3<Real>* kept = own == pair.a ? pair.b : pair.a;
  std::copy_n(theirs, 3, own);
  if (!draws.coin()) return;
  const std::uint32_t from = draws.below(3), to = draws.below(3);
  bring(own, from, wide(kept[to]), false);
}

template <class Real>
double edge_length(const Vec3<Real>& u, const Vec3<Real>& v) {
  const Vec edge = wide(v) - wide(u);
  return std::sqrt(dot(edge, edge));
}

template <class Real>
bool has_size_of(const strata::Scene& scene, const Vec3<Real> (&t)[3]) {
  constexpr double kRoom = 1 + 0x1p-20;  // allows for rounded coordinates and rounding here
  const double longest = std::max({edge_length(t[0], t[1]), edge_length(t[1], t[2]), edge_length(t[2], t[0])});
  if (longest > scene.edges.at[strata::kQuantiles - 1] * kRoom) return false;
  const Vec normal = cross(wide(t[1]) - wide(t[0]), wide(t[2]) - wide(t[0]));
  const double area = std::sqrt(dot(normal, normal));
  return area == 0 || longest * longest <= area * scene.aspect.at[strata::kQuantiles - 1] * kRoom;
}

}  // namespace

template <class Draws>
DrawnPair<Draws> mutated(Mutation mutation, const DrawnPair<Draws>& pair, const DrawnPair<Draws>& other, Draws& draws) {
  DrawnPair<Draws> result = pair;
  switch (mutation) {
    case Mutation::fresh:
      break;
    case Mutation::ulps:
      by_ulps(result, draws);
      break;
    case Mutation::onto_vertex: {
      const auto sides = choose(result, draws);
      const std::uint32_t from = draws.below(3), to = draws.below(3);
      bring(sides.own, from, wide(sides.other[to]), draws.coin());
      break;
    }
    case Mutation::onto_edge:
      onto_edge(result, draws);
      break;
    case Mutation::onto_plane: {
      const auto sides = choose(result, draws);
      const std::uint32_t vertex = draws.below(3);
      const Vec place = onto_plane(wide(sides.own[vertex]), sides.other, draws.coin());
      bring(sides.own, vertex, place, draws.coin());
      break;
    }
    case Mutation::coplanar: {
      const auto sides = choose(result, draws);
      const bool along_axis = draws.coin();
      for (int i = 0; i < 3; ++i) store(sides.own[i], onto_plane(wide(sides.own[i]), sides.other, along_axis));
      break;
    }
    case Mutation::collinear: {
      const auto sides = choose(result, draws);
      const std::uint32_t vertex = draws.below(3);
      store(sides.own[vertex],
            point_between(sides.own[(vertex + 1) % 3], sides.own[(vertex + 2) % 3], draw_share(draws)));
      break;
    }
    case Mutation::shared_edge: {
      const auto sides = choose(result, draws);
      const std::uint32_t from = draws.below(3), to = draws.below(3), step = 1 + draws.below(2);
      sides.own[from] = sides.other[to];
      sides.own[(from + 1) % 3] = sides.other[(to + step) % 3];
      break;
    }
    case Mutation::scaled:
      scale(result, draws);
      break;
    case Mutation::moved:
      move_both(result, draws);
      break;
    case Mutation::on_grid:
      onto_grid(result, draws);
      break;
    case Mutation::mirrored:
      mirror(result, draws);
      break;
    case Mutation::reordered:
      result = strata::shuffled(draws, result);
      break;
    case Mutation::crossed:
      cross_with(result, other, draws);
      break;
  }
  return result;
}

template <class Draws>
DrawnPair<Draws> fresh_pair(const Drawn& drawn, Draws& draws) {
  const strata::PairSource& source = drawn.sources[draws.below(static_cast<std::uint32_t>(drawn.sources.size()))];
  const std::uint64_t high = draws.below(1 << 16);
  const std::uint64_t index = high << 32 | draws.word();
  if constexpr (std::is_same_v<typename Draws::Real, float>) {
    return source.pair(index);
  } else {
    return source.double_pair(index);
  }
}

template <class Real>
bool fit(const strata::Scene& scene, BasicPair<Real>& pair) {
  for (Vec3<Real>(*triangle)[3] : {&pair.a, &pair.b}) {
    for (Vec3<Real>& vertex : *triangle) vertex = strata::in_scene::stored<Real>(scene, wide(vertex));
    if (!has_size_of(scene, *triangle)) return false;
  }
  return true;
}

template <class Draws>
DrawnPair<Draws> next_pair(const Drawn& drawn, const DrawnPair<Draws>& pair, const DrawnPair<Draws>* other,
                           Draws& draws, Mutation& mutation) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    // libFuzzer passes a second pair only for a crossing.
    mutation = other ? Mutation::crossed : static_cast<Mutation>(draws.below(kMutationCount - 1));
    if (mutation == Mutation::fresh) break;
    DrawnPair<Draws> result = mutated(mutation, pair, other ? *other : pair, draws);
    if (!is_finite(result)) continue;
    if (drawn.scene && !fit(*drawn.scene, result)) continue;
    if (std::memcmp(&result, &pair, sizeof pair) != 0) return result;
  }
  mutation = Mutation::fresh;
  return fresh_pair(drawn, draws);
}

template Pair mutated(Mutation, const Pair&, const Pair&, strata::Draws&);
template DoublePair mutated(Mutation, const DoublePair&, const DoublePair&, strata::DoubleDraws&);
template Pair fresh_pair(const Drawn&, strata::Draws&);
template DoublePair fresh_pair(const Drawn&, strata::DoubleDraws&);
template bool fit(const strata::Scene&, Pair&);
template bool fit(const strata::Scene&, DoublePair&);
template Pair next_pair(const Drawn&, const Pair&, const Pair*, strata::Draws&, Mutation&);
template DoublePair next_pair(const Drawn&, const DoublePair&, const DoublePair*, strata::DoubleDraws&, Mutation&);

}  // namespace graze::fuzz
