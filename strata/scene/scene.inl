// SPDX-License-Identifier: Apache-2.0
// The strata in a scene, and the switch that selects a stratum. The exact strata are in exact.h.
#include "strata/scene/triangles.h"

#include "strata/scene/exact.h"

namespace graze::strata {
namespace in_scene {
inline namespace GRAZE_FP {

GRAZE_HD inline auto near_contact(auto& draws, const Scene& scene, Touch touch, const Space& space,
                                  const Sizes& sizes_a = {}, const Sizes& sizes_b = {}) {
  const Form a = draw_form(draws, scene, sizes_a);
  const Form b = draw_form(draws, scene, sizes_b);
  Draft draft;
  const Vec away = put_contact(draws, touch, space, a, b, draft);
  const Push push = draw_push(draws);
  move(draft.b, away * (push.gap * (a.length < b.length ? a.length : b.length)));
  return finished(draws, scene, draft, push);
}

// Two triangles at random places where their boxes overlap.
GRAZE_HD inline auto uniform(auto& draws, const Scene& scene) {
  Draft draft;
  const Space plane_a = draw_plane(draws);
  put_face(draws, plane_a, draw_form(draws, scene), draft.a);
  const Space plane_b = draw_plane(draws);
  put_face(draws, plane_b, draw_form(draws, scene), draft.b);
  Vec by{0, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const Interval a = span_of(draft.a, axis), b = span_of(draft.b, axis);
    component(by, axis) = (a.low - b.high) + ((a.high - a.low) + (b.high - b.low)) * draws.positive();
  }
  move(draft.b, by);
  return finished(draws, scene, draft, {});
}

// Two triangles in a plane. In half of the pairs they touch or nearly touch; in the other half they overlap or lie
// apart.
GRAZE_HD inline auto coplanar(auto& draws, const Scene& scene, const Space& plane) {
  if (draws.coin()) {
    const Touch touch = draws.coin() ? Touch::vertex_edge : draws.coin() ? Touch::edge_edge : Touch::vertex_vertex;
    const Form a = draw_form(draws, scene);
    const Form b = draw_form(draws, scene);
    Draft draft;
    const Vec away = put_contact(draws, touch, plane, a, b, draft);
    // Only the gap is used, because a push by ulps would leave the plane.
    const Push push = draw_push(draws);
    move(draft.b, away * (push.gap * (a.length < b.length ? a.length : b.length)));
    return finished(draws, scene, draft, {});
  }
  Draft draft;
  const Form form = draw_form(draws, scene);
  put_face(draws, plane, form, draft.a);
  const Vec turned = draw_direction(draws, plane);
  const Form other = draw_form(draws, scene);
  put_face(draws, {true, turned, draw_across(draws, plane, turned)}, other, draft.b);
  const double x = draws.real();
  const double y = draws.real();
  move(draft.b, plane.x * (x * form.length) + plane.y * (y * form.length));
  return finished(draws, scene, draft, {});
}

// A large triangle and a small one. In half of the pairs, they share an inner point of the large triangle. In a quarter
// of these pairs, the small triangle pierces the large one; in the rest, it lies in the same plane, usually inside. In
// the other half of all pairs, the small triangle lies in the same plane and touches or nearly touches an edge of the
// large one, from inside or outside.
GRAZE_HD inline auto nested(auto& draws, const Scene& scene) {
  const bool tilted = draws.coin();
  const int normal = draws.between(0, 2);
  const Space any = draw_plane(draws);
  const Space plane = tilted ? any : axis_plane(normal);
  const Form large = draw_form(draws, scene, largest_eighth());
  const Form small = draw_form(draws, scene, smallest_eighth());
  const Vec u = draw_direction(draws, plane);
  const Vec inward = draw_across(draws, plane, u);
  Draft draft;
  if (draws.coin()) {
    const bool pierces = draws.below(4) == 0;
    const Space other = draw_plane(draws);
    const Vec turned = draw_direction(draws, plane);
    const Vec across = draw_across(draws, plane, turned);
    put_face(draws, {true, u, inward}, large, draft.a);
    put_face(draws, pierces ? other : Space{true, turned, across}, small, draft.b);
    return finished(draws, scene, draft, {});
  }
  const double side = draws.sign();
  put_edge(draws, plane, large, u, inward, draft.a);
  put_vertex(draws, plane, small, inward * side, draft.b);
  const Push push = draw_push(draws);  // only its gap is used, because a push by ulps would leave the plane
  move(draft.b, inward * (push.gap * small.length));
  return finished(draws, scene, draft, {});
}

// Two triangles in parallel planes. In half of the pairs, the planes are tilted and parallel before rounding; their
// distance is the size times 1 … 2^-40 (doubles: 2^-100). In the other half, they are axis-aligned and at most 4 grid
// steps or ulps apart.
template <class D>
GRAZE_HD BasicPair<typename D::Real> parallel(D& draws, const Scene& scene) {
  const bool tilted = draws.coin();
  const int normal = draws.between(0, 2);
  const Space plane = tilted ? draw_plane(draws) : axis_plane(normal);
  Draft draft;
  const Form form = draw_form(draws, scene);
  put_face(draws, plane, form, draft.a);
  const Vec turned = draw_direction(draws, plane);
  const Form other = draw_form(draws, scene);
  put_face(draws, {true, turned, draw_across(draws, plane, turned)}, other, draft.b);
  const double gap = draws.sign();
  const int halvings = draws.between(0, draws.kGap);
  const int steps = draws.integer(4);
  if (tilted) move(draft.b, cross(plane.x, plane.y) * (gap * power_of_two(-halvings) * form.length));
  place(draws, scene, draft);
  BasicPair<typename D::Real> pair = stored<typename D::Real>(scene, draft);
  if (!tilted) {
    for (auto& vertex : pair.b) vertex = pushed(scene, vertex, normal, steps);
  }
  return shuffled(draws, pair);
}

// A segment that contains the origin or starts at it. The third vertex is an end of the segment, or, on a segment
// parallel to an axis, any of its points, because rounding cannot move a point off such a line.
GRAZE_HD inline void put_segment(auto& draws, const Vec& e, bool along_axis, double length, Vec (&triangle)[3]) {
  const double back = draws.coin() ? length * draws.positive() : 0;
  const double third = length * draws.positive();
  const bool end = draws.coin();
  triangle[0] = e * -back;
  triangle[1] = e * (length - back);
  triangle[2] = along_axis ? e * (third - back) : end ? triangle[0] : triangle[1];
}

// B is a segment or a point; A may also be a proper triangle. They have a common point. In half of the pairs, B is then
// moved by a few grid steps or ulps.
template <class D>
GRAZE_HD BasicPair<typename D::Real> degenerate(D& draws, const Scene& scene) {
  const Form a = draw_form(draws, scene);
  const Form b = draw_form(draws, scene);
  const bool along_axis = draws.coin();
  const int axis = draws.between(0, 2);
  const Vec any = draw_direction(draws, {});
  const Vec e = along_axis ? unit_axis(axis) : any;
  const Vec across = draw_across(draws, {}, e);
  Draft draft{};
  const std::uint32_t kind = draws.below(5);
  if (kind == 1) put_segment(draws, e, along_axis, a.length, draft.a);
  if (kind == 2) put_vertex(draws, {}, a, across, draft.a);
  if (kind == 3) put_edge(draws, {}, a, e, across, draft.a);
  if (kind == 4) put_face(draws, {true, e, across}, a, draft.a);
  if (draws.below(4) != 0) {
    const bool same = draws.below(3) == 0;  // along A's segment, along A's edge, or in the plane of A's face
    const int other = draws.between(0, 2);
    put_segment(draws, same ? e : unit_axis(other), same ? along_axis : true, b.length, draft.b);
  }
  const int push_axis = draws.between(0, 2);
  const int steps = draws.coin() ? draws.integer(8) : 0;
  place(draws, scene, draft);
  BasicPair<typename D::Real> pair = stored<typename D::Real>(scene, draft);
  for (auto& vertex : pair.b) vertex = pushed(scene, vertex, push_axis, steps);
  return shuffled(draws, pair);
}

// How far the neighbour's plane is tilted out of the first triangle's plane. Half of the tilts are 0; the other half
// are ±2^0 … ±2^-30 (doubles: 2^-90).
GRAZE_HD inline double draw_lift(auto& draws) {
  const double sign = draws.sign();
  const double lift = sign * power_of_two(-draws.between(0, draws.kGap - 10));
  return draws.coin() ? lift : 0;
}

GRAZE_HD inline auto shared_vertex(auto& draws, const Scene& scene) {
  const Space plane = draw_plane(draws);
  const double lift = draw_lift(draws);
  const Space other{true, plane.x, unit(plane.y + cross(plane.x, plane.y) * lift)};
  Draft draft;
  const Vec side_a = draw_direction(draws, plane);
  put_vertex(draws, plane, draw_form(draws, scene), side_a, draft.a);
  const Vec side_b = draw_direction(draws, other);
  put_vertex(draws, other, draw_form(draws, scene), side_b, draft.b);
  return finished(draws, scene, draft, {});
}

// The neighbour is the first triangle's mirror image, so its edges have the same lengths.
GRAZE_HD inline auto shared_edge(auto& draws, const Scene& scene) {
  const Space plane = draw_plane(draws);
  const double lift = draw_lift(draws);
  const bool folded = draws.coin(), mirrored = draws.coin();
  const Form form = draw_form(draws, scene);
  const Form seen = seen_from(form, draws.below(3));
  const Vec up = unit(plane.y * (folded ? 1.0 : -1.0) + cross(plane.x, plane.y) * lift);
  const double foot = folded || mirrored ? seen.length - seen.foot : seen.foot;
  const Vec end = plane.x * seen.length;
  Draft draft{{{0, 0, 0}, end, plane.x * seen.foot + plane.y * seen.height},
              {{0, 0, 0}, end, plane.x * foot + up * seen.height}};
  return finished(draws, scene, draft, {});
}

}  // namespace GRAZE_FP
}  // namespace in_scene

inline namespace GRAZE_FP {

// Draws a pair of one stratum. Only the code of that stratum is compiled.
template <Stratum stratum, class D>
GRAZE_HD BasicPair<typename D::Real> draw_stratum(D draws, const Scene& scene) {
  switch (stratum) {
    case Stratum::uniform:
      return in_scene::uniform(draws, scene);
    case Stratum::near_vertex_face:
      return in_scene::near_contact(draws, scene, Touch::vertex_face, {});
    case Stratum::near_edge_edge:
      return in_scene::near_contact(draws, scene, Touch::edge_edge, {});
    case Stratum::near_vertex_edge:
      return in_scene::near_contact(draws, scene, Touch::vertex_edge, {});
    case Stratum::near_vertex_vertex:
      return in_scene::near_contact(draws, scene, Touch::vertex_vertex, {});
    case Stratum::coplanar_lattice: {
      const int normal = draws.between(0, 2);
      return in_scene::coplanar(draws, scene, in_scene::axis_plane(normal));
    }
    case Stratum::coplanar_wide:
      return in_scene::coplanar_wide(draws, scene);
    case Stratum::exact_contact:
      return in_scene::exact_contact(draws, scene);
    case Stratum::coplanar_rounded: {
      const in_scene::Space plane = in_scene::draw_plane(draws);
      return in_scene::coplanar(draws, scene, plane);
    }
    case Stratum::parallel:
      return in_scene::parallel(draws, scene);
    case Stratum::sliver: {
      const Touch touch = draw_touch(draws);
      const std::uint32_t which = draws.below(3);  // the sliver is A, B or both
      const in_scene::Sizes sliver{{}, {in_scene::sliver_from(scene), 1}};
      return in_scene::near_contact(draws, scene, touch, {}, which != 1 ? sliver : in_scene::Sizes{},
                                    which != 0 ? sliver : in_scene::Sizes{});
    }
    case Stratum::degenerate:
      return in_scene::degenerate(draws, scene);
    case Stratum::shared_vertex:
      return in_scene::shared_vertex(draws, scene);
    case Stratum::shared_edge:
      return in_scene::shared_edge(draws, scene);
    case Stratum::mixed_scale: {
      const Touch touch = draw_touch(draws);
      return in_scene::near_contact(draws, scene, touch, {}, in_scene::largest_eighth(), in_scene::smallest_eighth());
    }
    case Stratum::lattice:
      return in_scene::lattice(draws, scene);
    case Stratum::nested:
      return in_scene::nested(draws, scene);
    default:
      break;  // no scene can contain the other strata
  }
  return {};
}

template <Stratum stratum, class D>
GRAZE_HD BasicPair<typename D::Real> generate_one(std::uint64_t seed, const Scene& scene, std::uint64_t index) {
  // The random words differ from those of the same stratum without a scene.
  return draw_stratum<stratum>(D(seed, 0x100u + static_cast<std::uint32_t>(stratum), index), scene);
}

template <class D>
GRAZE_HD BasicPair<typename D::Real> generate_by(std::uint64_t seed, Stratum stratum, const Scene& scene,
                                                 std::uint64_t index) {
  switch (stratum) {
#define GRAZE_STRATUM(name, ...) \
  case Stratum::name:            \
    return generate_one<Stratum::name, D>(seed, scene, index);
#include "strata/strata.inc"
#undef GRAZE_STRATUM
    default:
      return {};
  }
}

GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, const Scene& scene, std::uint64_t index) {
  return generate_by<Draws>(seed, stratum, scene, index);
}

GRAZE_HD inline DoublePair generate_doubles(std::uint64_t seed, Stratum stratum, const Scene& scene,
                                            std::uint64_t index) {
  return generate_by<DoubleDraws>(seed, stratum, scene, index);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
