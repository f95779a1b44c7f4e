// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/mutations.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "strata/scene/place.h"

namespace graze::fuzz {
namespace {

using strata::Draws;
using strata::Vec;

Vec wide(const Vec3<float>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// The two triangles, in either order.
struct Sides {
  Vec3<float>* own;
  const Vec3<float>* other;
};

Sides choose(Pair& pair, Draws& draws) { return draws.coin() ? Sides{pair.a, pair.b} : Sides{pair.b, pair.a}; }

void move(std::span<Vec3<float>> vertices, const Vec& by) {
  for (Vec3<float>& vertex : vertices) vertex = strata::rounded(wide(vertex) + by);
}

// Moves the vertex to `to`, alone or together with its triangle.
void bring(Vec3<float>* triangle, std::uint32_t vertex, const Vec& to, bool alone) {
  if (!alone) move({triangle, 3}, to - wide(triangle[vertex]));
  triangle[vertex] = strata::rounded(to);
}

// A place on a segment; often an end or a simple fraction.
double draw_share(Draws& draws) {
  constexpr double kShares[] = {0, 1, 0.5, 0.25, 0.75};
  const std::uint32_t kind = draws.below(8);
  return kind < 5 ? kShares[kind] : kind < 7 ? draws.positive() : 2 * draws.real();
}

Vec point_between(const Vec3<float>& from, const Vec3<float>& to, double share) {
  return wide(from) + (wide(to) - wide(from)) * share;
}

void by_ulps(Pair& pair, Draws& draws) {
  const std::uint32_t vertex = draws.below(6);
  Vec3<float>& v = vertex < 3 ? pair.a[vertex] : pair.b[vertex - 3];
  const bool whole = draws.below(4) == 0;
  const int axis = draws.between(0, 2), reach = 1 << draws.below(6);
  for (int i = 0; i < 3; ++i) {
    const int steps = draws.integer(reach);
    if (whole || i == axis) component(v, i) = strata::nudged(component(v, i), steps == 0 ? 1 : steps);
  }
}

void onto_edge(Pair& pair, Draws& draws) {
  const Sides sides = choose(pair, draws);
  const std::uint32_t from = draws.below(3), vertex = draws.below(3);
  const Vec place = point_between(sides.other[from], sides.other[(from + 1) % 3], draw_share(draws));
  if (draws.coin()) {
    const bool alone = draws.coin();
    return bring(sides.own, vertex, place, alone);
  }
  const Vec own = point_between(sides.own[vertex], sides.own[(vertex + 1) % 3], draw_share(draws));
  move({sides.own, 3}, place - own);
}

// Moves the point onto the plane, along one axis or the normal.
Vec onto_plane(const Vec& point, const Vec3<float>* plane, bool along_axis) {
  const Vec origin = wide(plane[0]), normal = cross(wide(plane[1]) - origin, wide(plane[2]) - origin);
  const int axis = dominant_axis(normal);
  const double distance = dot(normal, point - origin), largest = component(normal, axis);
  if (largest == 0) return point;
  if (along_axis) return point - strata::unit_axis(axis) * (distance / largest);
  return point - normal * (distance / dot(normal, normal));
}

void scale(Pair& pair, Draws& draws) {
  const std::uint32_t what = draws.below(6);  // 0: both, 1: a, 2: b, from 3 on: an axis
  const float factor = static_cast<float>(strata::power_of_two(draws.coin() ? draws.integer(4) : draws.integer(60)));
  for (int i = 0; i < kCoordinates; ++i) {
    const bool meant =
        what == 0 || (what == 1 && i < 9) || (what == 2 && i >= 9) || static_cast<int>(what) - 3 == i % 3;
    if (meant) coordinates(pair)[i] *= factor;
  }
}

double largest_of(const Pair& pair) {
  double largest = 0;
  for (int i = 0; i < kCoordinates; ++i)
    largest = std::max(largest, std::fabs(static_cast<double>(coordinates(pair)[i])));
  return largest;
}

void move_both(Pair& pair, Draws& draws) {
  if (draws.coin()) {  // a vertex to the origin
    const std::uint32_t vertex = draws.below(6);
    const Vec by = wide(vertex < 3 ? pair.a[vertex] : pair.b[vertex - 3]) * -1.0;
    move(pair.a, by);
    return move(pair.b, by);
  }
  const double far = largest_of(pair) * strata::power_of_two(draws.integer(12));
  const Vec by = draws.reals() * far;
  move(pair.a, by);
  move(pair.b, by);
}

void onto_grid(Pair& pair, Draws& draws) {
  int exponent = 0;
  std::frexp(largest_of(pair), &exponent);
  const double step = std::ldexp(1.0, exponent - draws.between(1, 20));
  for (int i = 0; i < kCoordinates; ++i) {
    float& x = coordinates(pair)[i];
    x = static_cast<float>(std::nearbyint(static_cast<double>(x) / step) * step);
  }
}

void mirror(Pair& pair, Draws& draws) {
  const Sides sides = choose(pair, draws);
  const int axis = draws.between(0, 2), other_axis = draws.between(0, 2);
  const std::uint32_t through = draws.below(3);
  const bool swap = draws.coin(), at_origin = draws.coin();
  for (int i = 0; i < 3; ++i) {
    Vec v = wide(sides.other[i]);
    const Vec centre = at_origin ? Vec{0, 0, 0} : wide(sides.other[through]);
    if (swap) std::swap(component(v, axis), component(v, other_axis));
    if (!swap || axis == other_axis) component(v, axis) = 2 * component(centre, axis) - component(v, axis);
    sides.own[i] = strata::rounded(v);
  }
}

void cross_with(Pair& pair, const Pair& other, Draws& draws) {
  const Vec3<float>* theirs = draws.coin() ? other.a : other.b;
  Vec3<float>* own = draws.coin() ? pair.a : pair.b;
  const Vec3<float>* kept = own == pair.a ? pair.b : pair.a;
  std::copy_n(theirs, 3, own);
  if (!draws.coin()) return;
  const std::uint32_t from = draws.below(3), to = draws.below(3);
  bring(own, from, wide(kept[to]), false);
}

double edge_length(const Vec3<float>& u, const Vec3<float>& v) {
  const Vec edge = wide(v) - wide(u);
  return std::sqrt(dot(edge, edge));
}

bool has_size_of(const strata::Scene& scene, const Vec3<float> (&t)[3]) {
  constexpr double kRoom = 1 + 0x1p-20;  // for the rounding of coordinates and of this computation
  const double longest = std::max({edge_length(t[0], t[1]), edge_length(t[1], t[2]), edge_length(t[2], t[0])});
  if (longest > scene.edges.at[strata::kQuantiles - 1] * kRoom) return false;
  const Vec normal = cross(wide(t[1]) - wide(t[0]), wide(t[2]) - wide(t[0]));
  const double area = std::sqrt(dot(normal, normal));
  return area == 0 || longest * longest <= area * scene.aspect.at[strata::kQuantiles - 1] * kRoom;
}

}  // namespace

Pair mutated(Mutation mutation, const Pair& pair, const Pair& other, Draws& draws) {
  Pair result = pair;
  switch (mutation) {
    case Mutation::fresh:
      break;
    case Mutation::ulps:
      by_ulps(result, draws);
      break;
    case Mutation::onto_vertex: {
      const Sides sides = choose(result, draws);
      const std::uint32_t from = draws.below(3), to = draws.below(3);
      bring(sides.own, from, wide(sides.other[to]), draws.coin());
      break;
    }
    case Mutation::onto_edge:
      onto_edge(result, draws);
      break;
    case Mutation::onto_plane: {
      const Sides sides = choose(result, draws);
      const std::uint32_t vertex = draws.below(3);
      const Vec place = onto_plane(wide(sides.own[vertex]), sides.other, draws.coin());
      bring(sides.own, vertex, place, draws.coin());
      break;
    }
    case Mutation::coplanar: {
      const Sides sides = choose(result, draws);
      const bool along_axis = draws.coin();
      for (int i = 0; i < 3; ++i)
        sides.own[i] = strata::rounded(onto_plane(wide(sides.own[i]), sides.other, along_axis));
      break;
    }
    case Mutation::collinear: {
      const Sides sides = choose(result, draws);
      const std::uint32_t vertex = draws.below(3);
      sides.own[vertex] =
          strata::rounded(point_between(sides.own[(vertex + 1) % 3], sides.own[(vertex + 2) % 3], draw_share(draws)));
      break;
    }
    case Mutation::shared_edge: {
      const Sides sides = choose(result, draws);
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

Pair fresh_pair(const Drawn& drawn, Draws& draws) {
  const strata::PairSource& source = drawn.sources[draws.below(static_cast<std::uint32_t>(drawn.sources.size()))];
  const std::uint64_t high = draws.below(1 << 16);
  return source.pair(high << 32 | draws.word());
}

bool fit(const strata::Scene& scene, Pair& pair) {
  for (Vec3<float>(*triangle)[3] : {&pair.a, &pair.b}) {
    for (Vec3<float>& vertex : *triangle) vertex = strata::in_scene::stored(scene, wide(vertex));
    if (!has_size_of(scene, *triangle)) return false;
  }
  return true;
}

Pair next_pair(const Drawn& drawn, const Pair& pair, const Pair* other, Draws& draws, Mutation& mutation) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    // If libFuzzer offers a second pair, it wants a crossing.
    mutation = other ? Mutation::crossed : static_cast<Mutation>(draws.below(kMutationCount - 1));
    if (mutation == Mutation::fresh) break;
    Pair result = mutated(mutation, pair, other ? *other : pair, draws);
    if (!is_finite(result) || (drawn.scene && !fit(*drawn.scene, result))) continue;
    if (std::memcmp(&result, &pair, sizeof pair) != 0) return result;
  }
  mutation = Mutation::fresh;
  return fresh_pair(drawn, draws);
}

}  // namespace graze::fuzz
