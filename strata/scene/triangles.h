// SPDX-License-Identifier: Apache-2.0
// Triangles with a scene's sizes, and pairs of triangles that touch at the origin. Unlike in strata/contact.h, a
// triangle's longest edge and aspect are drawn first, and the triangle is then rotated into place.
#pragma once

#include <cmath>

#include "strata/scene/place.h"

namespace graze::strata::in_scene {
inline namespace GRAZE_FP {

// The range of quantile fractions from which to draw.
struct Part {
  double from = 0, to = 1;
};
struct Sizes {
  Part edges, aspect;
};

// Sizes are functions, because device code cannot refer to constants of class type.
GRAZE_HD inline Sizes largest_eighth() { return {{0.875, 1}, {}}; }
GRAZE_HD inline Sizes smallest_eighth() { return {{0, 0.125}, {}}; }

GRAZE_HD inline double draw_from(auto& draws, const Quantiles& quantiles, const Part& part) {
  const double fraction = part.from + (part.to - part.from) * draws.positive();
  const double at = fraction * (kQuantiles - 1);
  int i = static_cast<int>(at);
  if (i > kQuantiles - 2) i = kQuantiles - 2;
  return quantiles.at[i] + (quantiles.at[i + 1] - quantiles.at[i]) * (at - i);
}

inline constexpr double kSliver = 1024;  // a sliver's least aspect

// The fraction of aspects below kSliver.   Requires: the greatest aspect is at least kSliver.
GRAZE_HD inline double sliver_from(const Scene& scene) {
  const Quantiles& aspect = scene.aspect;
  int i = 0;
  while (i < kQuantiles - 1 && aspect.at[i] < kSliver) ++i;
  if (i == 0) return 0;
  const double below = aspect.at[i - 1];
  return (i - 1 + (kSliver - below) / (aspect.at[i] - below)) / (kQuantiles - 1);
}

// Vertices (0, 0), (length, 0) and (foot, height). The first edge is the longest.
struct Form {
  double length, height, foot;
};

GRAZE_HD inline Form draw_form(auto& draws, const Scene& scene, const Sizes& sizes = {}) {
  const double length = draw_from(draws, scene.edges, sizes.edges);
  const double flat = 1 / draw_from(draws, scene.aspect, sizes.aspect);
  double most = 1 - flat * flat;  // squared ratio of the foot's greatest distance from an end to the edge
  most = most > 0.25 ? sqrt(most) : 0.5;
  const double foot = (1 - most) + (2 * most - 1) * draws.positive();
  return {length, length * flat, length * foot};
}

// The same triangle with another edge first: its vertices are (0, 0), (length, 0) and (foot, height).
GRAZE_HD inline Form seen_from(const Form& form, std::uint32_t edge) {
  if (edge == 0) return form;
  const double foot = edge == 1 ? form.length - form.foot : form.foot;
  const double length = sqrt(foot * foot + form.height * form.height);
  return {length, form.length * form.height / length, form.length * foot / length};
}

// v scaled to length 1, or an axis if v is too short.
GRAZE_HD inline Vec unit(const Vec& v) {
  const double squared = dot(v, v);
  return squared > 0x1p-200 ? v * (1 / sqrt(squared)) : unit_axis(0);
}

// The directions from which to draw: all, or, if `flat`, those in the plane of the perpendicular unit vectors x and y.
struct Space {
  bool flat = false;
  Vec x{1, 0, 0}, y{0, 1, 0};
};

GRAZE_HD inline Vec draw_direction(auto& draws, const Space& space) {
  const Vec v = draws.reals();
  if (!space.flat) return unit(v);
  const double squared = v.x * v.x + v.y * v.y;
  return squared > 0 ? (space.x * v.x + space.y * v.y) * (1 / sqrt(squared)) : space.x;
}

// A random direction perpendicular to f.
GRAZE_HD inline Vec draw_across(auto& draws, const Space& space, const Vec& f) {
  const Vec v = draws.reals();
  if (space.flat) return unit(cross(cross(space.x, space.y), f)) * (v.x < 0 ? -1.0 : 1.0);
  const Vec w = cross(f, v);
  return unit(dot(w, w) > 0x1p-40 ? w : cross(f, unit_axis((dominant_axis(f) + 1) % 3)));
}

// draw_plane returns a random plane through the origin, and axis_plane the plane of two coordinate axes.
GRAZE_HD inline Space draw_plane(auto& draws) {
  const Vec x = draw_direction(draws, {});
  return {true, x, draw_across(draws, {}, x)};
}
GRAZE_HD inline Space axis_plane(int normal) {
  return {true, unit_axis((normal + 1) % 3), unit_axis((normal + 2) % 3)};
}

// A triangle of this form with a random corner, vertex [0], at the origin; the other vertices lie on the given side.
GRAZE_HD inline void put_vertex(auto& draws, const Space& space, const Form& form, const Vec& side,
                                Vec (&triangle)[3]) {
  const std::uint32_t corner = draws.below(3);
  const Vec any = toward(side, draw_direction(draws, space));
  Vec across = draw_across(draws, space, any);
  triangle[0] = {0, 0, 0};
  if (corner < 2) {  // at an end of the longest edge, where the angle is never obtuse
    const Form seen = corner == 0 ? form : Form{form.length, form.height, form.length - form.foot};
    across = toward(side, across);
    triangle[1] = any * seen.length;
    triangle[2] = any * seen.foot + across * seen.height;
    return;
  }
  const double left = form.foot, right = form.length - form.foot;
  Vec up = any;
  if (dot(side, up * form.height - across * left) < 0 || dot(side, up * form.height + across * right) < 0) {
    up = unit(side);
    across = draw_across(draws, space, up);
  }
  triangle[1] = up * form.height - across * left;
  triangle[2] = up * form.height + across * right;
}

// A triangle whose edge [0][1] passes through the origin in the direction of e.   Requires: e is perpendicular to side.
GRAZE_HD inline void put_edge(auto& draws, const Space& space, const Form& form, const Vec& e, const Vec& side,
                              Vec (&triangle)[3]) {
  const Form seen = seen_from(form, draws.below(3));
  const double back = seen.length * draws.positive();
  const Vec up = toward(side, draw_across(draws, space, e));
  triangle[0] = e * -back;
  triangle[1] = e * (seen.length - back);
  triangle[2] = e * (seen.foot - back) + up * seen.height;
}

// A triangle in the given plane, with the origin inside it.
GRAZE_HD inline void put_face(auto& draws, const Space& plane, const Form& form, Vec (&triangle)[3]) {
  const double w0 = draws.positive();
  const double w1 = draws.positive();
  const double w2 = draws.positive();
  const double all = 1 / (w0 + w1 + w2);
  const double x = (form.length * w1 + form.foot * w2) * all, y = form.height * w2 * all;
  triangle[0] = plane.x * -x - plane.y * y;
  triangle[1] = plane.x * (form.length - x) - plane.y * y;
  triangle[2] = plane.x * (form.foot - x) + plane.y * (form.height - y);
}

// Two triangles that meet only at the origin before rounding. If the space is flat, edges that touch lie along each
// other. Returns: the unit vector in the direction that separates B from A.
GRAZE_HD inline Vec put_contact(auto& draws, Touch touch, const Space& space, const Form& form_a, const Form& form_b,
                                Draft& draft) {
  const Vec u = draw_direction(draws, space);
  const Vec v = draw_direction(draws, space);
  const Vec across = draw_across(draws, space, u);
  Vec away = across;
  if (touch == Touch::vertex_vertex) away = v;
  if (touch == Touch::edge_edge && !space.flat) away = unit(cross(u, v));
  if (touch == Touch::vertex_face) away = cross(u, across);
  const Vec back = away * -1.0;
  if (touch == Touch::vertex_face) {
    put_face(draws, {true, u, across}, form_a, draft.a);
  } else if (touch == Touch::vertex_vertex) {
    put_vertex(draws, space, form_a, back, draft.a);
  } else {
    put_edge(draws, space, form_a, u, back, draft.a);
  }
  if (touch == Touch::edge_edge) {
    put_edge(draws, space, form_b, space.flat ? u : v, away, draft.b);
  } else {
    put_vertex(draws, space, form_b, away, draft.b);
  }
  return away;
}

}  // namespace GRAZE_FP
}  // namespace graze::strata::in_scene
