// SPDX-License-Identifier: Apache-2.0
// The independent decision: counts the common set's extreme points, using signs of determinants of GMP integers.
//
// A point x of A ∩ B lies in the relative interior of exactly one face (vertex, edge, triangle) of A and one of B.
// The point x is extreme in A ∩ B if and only if these two faces share no direction. So the extreme points are:
//   vertices of A in B, and vertices of B in A that are not vertices of A,
//   points where an open edge crosses an open edge that is not parallel to it,
//   points where an open edge pierces an open triangle that it is not parallel to.
// The common set is their convex hull: empty for 0 points, a point for 1, a segment for 2, and an area for more.
#include <bit>

#include "oracle/gmp_simplex.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using namespace gmp;

template <class Number>
struct Workspace {
  using Point = gmp::Point<Number>;
  Point p[3], q[3];         // the pair
  Point u, v, w, normal;    // vectors
  Point na, nb, moment[3];  // noncoplanar(): normals, and a[i] x a[i+1] relative to b[0]
  Point ra[3];              // noncoplanar(): a[i] - b[0]
  Number along_u[3], along_v[3], heights[3], height, side, term;
};

// normal = (p[1] - p[0]) x (p[2] - p[0]); the triangle is flat if the normal is zero.
template <class Number>
Simplex<Number> simplex_of(Workspace<Number>& work, const Point<Number> (&p)[3], Point<Number>& normal) {
  subtract(work.u, p[1], p[0]);
  subtract(work.v, p[2], p[0]);
  cross(normal, work.u, work.v);
  return is_zero(normal) ? flat_simplex(p) : Simplex<Number>{{&p[0], &p[1], &p[2]}, 3};
}

Contact contact_of(int extreme_points) { return static_cast<Contact>(extreme_points < 3 ? extreme_points : 3); }

// Decides two triangles whose planes differ, from the signs of 15 determinants: one for each choice of four of the six
// vertices. Each determinant is a sum of dot products with three moments.
// Requires: neither triangle is flat; ra[i] = a[i] - b[0], u = b[1] - b[0], v = b[2] - b[0], nb = u x v, na is A's
// normal, heights[i] = ra[i] . nb, sa[i] is the sign of heights[i], and the signs are not all zero.
template <class Number>
Contact noncoplanar(Workspace<Number>& work, const int (&sa)[3]) {
  // The moments add up to A's normal.
  cross(work.moment[0], work.ra[0], work.ra[1]);
  cross(work.moment[1], work.ra[1], work.ra[2]);
  subtract(work.moment[2], work.na, work.moment[0]);
  subtract(work.moment[2], work.moment[2], work.moment[1]);
  for (int i = 0; i < 3; ++i) {
    dot(work.along_u[i], work.moment[i], work.u);
    dot(work.along_v[i], work.moment[i], work.v);
  }
  // The sides of b[j] relative to A's plane, starting with b[0].
  dot(work.height, work.moment[1], work.ra[0]);
  int tb[3] = {-work.height.sign(), 0, 0};
  for (int j = 1; j < 3; ++j) {
    const Number* along = j == 1 ? work.along_u : work.along_v;
    add(work.term, along[0], along[1]);
    add(work.term, work.term, along[2]);
    tb[j] = compare(work.term, work.height);
  }
  if ((tb[0] > 0 && tb[1] > 0 && tb[2] > 0) || (tb[0] < 0 && tb[1] < 0 && tb[2] < 0)) return Contact::none;

  // side[i][j]: sign of det[a_i+1 - a_i, b_j - a_i, b_j+1 - b_j]. B's edges 0 and 2 pass through b[0], with
  // directions u and -v. The determinants of B's three edges add up to (a_i+1 - a_i) . b_normal, which gives edge 1's.
  int side[3][3];
  for (int i = 0; i < 3; ++i) {
    side[i][0] = work.along_u[i].sign();
    side[i][2] = -work.along_v[i].sign();
    sub(work.side, work.heights[(i + 1) % 3], work.heights[i]);
    sub(work.term, work.along_v[i], work.along_u[i]);
    add(work.side, work.side, work.term);
    side[i][1] = work.side.sign();
  }

  // One bit for each extreme point, so that a point that is found from both triangles counts once.
  unsigned found = 0;
  const auto vertex_a = [](int i) { return 1u << i; };
  const auto vertex_b = [](int j) { return 1u << (3 + j); };
  const auto face_b = [](int i) { return 1u << (6 + i); };
  const auto face_a = [](int j) { return 1u << (9 + j); };
  const auto crossing = [](int i, int j) { return 1u << (12 + 3 * i + j); };
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if (sa[i] == 0) {
      // Looks along an edge that leaves B's plane at a_i.
      const Location at = locate(sa[next] != 0 ? side[i] : side[(i + 2) % 3]);
      if (at.place != Place::outside) found |= vertex_a(i);
    }
    if (sa[i] * sa[next] < 0) {
      const Location at = locate(side[i]);
      if (at.place == Place::face) found |= face_b(i);
      if (at.place == Place::edge) found |= crossing(i, at.edge);
    }
  }
  for (int j = 0; j < 3; ++j) {
    const int next = (j + 1) % 3, last = (j + 2) % 3;
    const int sides[3] = {side[0][j], side[1][j], side[2][j]};
    if (tb[j] == 0) {
      const int sides_last[3] = {side[0][last], side[1][last], side[2][last]};
      const Location at = tb[next] != 0 ? locate(sides) : locate(sides_last);
      if (at.place == Place::face || at.place == Place::edge) found |= vertex_b(j);
    }
    if (tb[j] * tb[next] < 0) {
      const Location at = locate(sides);
      if (at.place == Place::face) found |= face_a(j);
      if (at.place == Place::edge) found |= crossing(at.edge, j);
    }
  }
  return contact_of(std::popcount(found));
}

// Decides a segment and triangle b. The segment's line meets b's plane in one point; there is contact only if that
// point is in b.   Requires: the segment's ends are not both in the plane, and not both strictly on one side of it.
template <class Number>
Contact pierced(Workspace<Number>& work, const Simplex<Number>& segment, const Simplex<Number>& b) {
  subtract(work.w, *segment.vertex[1], *segment.vertex[0]);
  int side[3];
  for (int j = 0; j < 3; ++j) {
    subtract(work.u, b.from(j), *segment.vertex[0]);
    subtract(work.v, b.to(j), *segment.vertex[0]);
    cross(work.normal, work.u, work.v);
    dot(work.side, work.normal, work.w);
    side[j] = work.side.sign();
  }
  return locate(side).place == Place::outside ? Contact::none : Contact::point;
}

// Two simplices in one plane or on one line, projected by dropping the coordinate `dropped`, which keeps distinct
// points distinct.
template <class Number>
struct Planar {
  Workspace<Number>& work;
  int x, y;
  Planar(Workspace<Number>& w, int dropped) : work(w), x((dropped + 1) % 3), y((dropped + 2) % 3) {}

  int orient(const Point<Number>& p, const Point<Number>& q, const Point<Number>& r) {
    sub(work.u.c[0], q.c[x], p.c[x]);
    sub(work.u.c[1], q.c[y], p.c[y]);
    sub(work.v.c[0], r.c[x], p.c[x]);
    sub(work.v.c[1], r.c[y], p.c[y]);
    mul(work.side, work.u.c[0], work.v.c[1]);
    sub_mul(work.side, work.u.c[1], work.v.c[0]);
    return work.side.sign();
  }

  // Signed sides of one simplex's vertices (second index) relative to the other's edges (first index).
  struct Sides {
    int of[3][3];
  };

  Sides sides(const Simplex<Number>& edges, const Simplex<Number>& vertices) {
    Sides result{};
    for (int i = 0; i < edges.edges(); ++i) {
      for (int j = 0; j < vertices.count; ++j) {
        result.of[i][j] = orient(edges.from(i), edges.to(i), *vertices.vertex[j]);
      }
    }
    return result;
  }

  // Whether p, the vertex with index j in `sides`, lies in s.
  static bool inside(const Point<Number>& p, int j, const Simplex<Number>& s, const Sides& sides) {
    if (s.count == 1) return compare(p, *s.vertex[0]) == 0;
    if (s.count == 3) return locate({sides.of[0][j], sides.of[1][j], sides.of[2][j]}).place != Place::outside;
    // p is in s if it is on the line and lies between the ends in lexicographic order.
    return sides.of[0][j] == 0 && compare(p, *s.vertex[0]) * compare(p, *s.vertex[1]) <= 0;
  }

  Contact contact(const Simplex<Number>& a, const Simplex<Number>& b) {
    const Sides a_against_b = sides(b, a), b_against_a = sides(a, b);
    int count = 0;
    for (int i = 0; i < a.count; ++i) count += inside(*a.vertex[i], i, b, a_against_b);
    for (int j = 0; j < b.count; ++j) {
      bool is_vertex_of_a = false;
      for (int i = 0; i < a.count; ++i) is_vertex_of_a |= compare(*a.vertex[i], *b.vertex[j]) == 0;
      if (!is_vertex_of_a) count += inside(*b.vertex[j], j, a, b_against_a);
    }
    for (int i = 0; i < a.edges(); ++i) {
      for (int j = 0; j < b.edges(); ++j) {
        count += b_against_a.of[i][j] * b_against_a.of[i][(j + 1) % 3] < 0 &&
                 a_against_b.of[j][i] * a_against_b.of[j][(i + 1) % 3] < 0;
      }
    }
    return contact_of(count);
  }
};

// A coordinate that can be dropped in a plane with this normal.
template <class Number>
int droppable(const Point<Number>& normal) {
  return normal.c[0].sign() ? 0 : normal.c[1].sign() ? 1 : 2;
}

// A coordinate that can be dropped for a line with this direction (any if the direction is zero).
template <class Number>
int droppable_of_line(const Point<Number>& direction) {
  return direction.c[0].sign() ? 2 : 0;
}

// Requires: b is a triangle with normal nb; a is flat.
template <class Number>
Contact flat_with_triangle(Workspace<Number>& work, const Simplex<Number>& a, const Simplex<Number>& b) {
  int sa[2] = {0, 0};
  for (int i = 0; i < a.count; ++i) {
    subtract(work.w, *a.vertex[i], *b.vertex[0]);
    dot(work.height, work.w, work.nb);
    sa[i] = work.height.sign();
  }
  if (sa[0] == 0 && sa[1] == 0) return Planar<Number>(work, droppable(work.nb)).contact(a, b);
  if (a.count == 1 || sa[0] * sa[1] > 0) return Contact::none;
  return pierced(work, a, b);
}

// Decides two points or segments, which together span a line, a plane, or, as skew segments, space.
template <class Number>
Contact flat_with_flat(Workspace<Number>& work, const Simplex<Number>& a, const Simplex<Number>& b) {
  if (a.count < b.count) return flat_with_flat(work, b, a);
  if (a.count == 1) return contact_of(compare(*a.vertex[0], *b.vertex[0]) == 0 ? 1 : 0);
  Point<Number>& direction = work.na;
  subtract(direction, *a.vertex[1], *a.vertex[0]);
  subtract(work.w, *b.vertex[0], *a.vertex[0]);
  if (b.count == 2) {
    subtract(work.v, *b.vertex[1], *b.vertex[0]);
    cross(work.normal, direction, work.v);
    if (!is_zero(work.normal)) {
      dot(work.side, work.normal, work.w);
      if (work.side.sign() != 0) return Contact::none;
      return Planar<Number>(work, droppable(work.normal)).contact(a, b);
    }
  }
  cross(work.normal, direction, work.w);
  if (!is_zero(work.normal)) return Contact::none;  // b starts off a's line and does not cross it
  return Planar<Number>(work, droppable_of_line(direction)).contact(a, b);
}

// Requires: p and q hold the pair.
template <class Number>
Contact contact_of_pair(Workspace<Number>& work) {
  const Simplex<Number> b = simplex_of(work, work.q, work.nb);
  if (b.count == 3) {
    int sa[3];
    for (int i = 0; i < 3; ++i) {
      subtract(work.ra[i], work.p[i], work.q[0]);
      dot(work.heights[i], work.ra[i], work.nb);
      sa[i] = work.heights[i].sign();
    }
    if ((sa[0] > 0 && sa[1] > 0 && sa[2] > 0) || (sa[0] < 0 && sa[1] < 0 && sa[2] < 0)) return Contact::none;
    subtract(work.v, work.ra[1], work.ra[0]);
    subtract(work.w, work.ra[2], work.ra[0]);
    cross(work.na, work.v, work.w);
    if (is_zero(work.na)) return flat_with_triangle(work, flat_simplex(work.p), b);
    if (sa[0] == 0 && sa[1] == 0 && sa[2] == 0) {
      const Simplex<Number> a{{&work.p[0], &work.p[1], &work.p[2]}, 3};
      return Planar<Number>(work, droppable(work.nb)).contact(a, b);
    }
    subtract(work.v, work.q[2], work.q[0]);
    return noncoplanar(work, sa);
  }
  const Simplex<Number> a = simplex_of(work, work.p, work.na);
  if (a.count < 3) return flat_with_flat(work, a, b);
  for (int i = 0; i < 3; ++i) exchange(work.nb.c[i], work.na.c[i]);
  return flat_with_triangle(work, b, a);
}

}  // namespace

Contact gmp_contact(const DoublePair& pair) {
  const Grid grid = grid_of(pair);
  if (grid.is_small()) {
    Workspace<TwoLimbs> work;
    const SmallPair small = small_integers(pair, grid);
    for (int i = 0; i < 9; ++i) {
      set(work.p[i / 3].c[i % 3], (&small.a[0].x)[i]);
      set(work.q[i / 3].c[i % 3], (&small.b[0].x)[i]);
    }
    return contact_of_pair(work);
  }
  thread_local Workspace<Register> work;
  for (int i = 0; i < 9; ++i) {
    set_integer(work.p[i / 3].c[i % 3].value, coordinates(pair)[i], grid);
    set_integer(work.q[i / 3].c[i % 3].value, coordinates(pair)[9 + i], grid);
  }
  return contact_of_pair(work);
}

Contact gmp_contact(const LargePair& pair) {
  Workspace<Register> work;
  for (int i = 0; i < 9; ++i) {
    mpz_set(work.p[i / 3].c[i % 3].value, component(pair.a[i / 3], i % 3).get_mpz_t());
    mpz_set(work.q[i / 3].c[i % 3].value, component(pair.b[i / 3], i % 3).get_mpz_t());
  }
  return contact_of_pair(work);
}

}  // namespace graze::oracle
