// SPDX-License-Identifier: Apache-2.0
// The two algorithms of the 2012 thesis (Maffina 2012, sections 3.1 and 3.2) in OpenCL C. They perform the same
// operations in the same order as core/algorithms/projected_sat.h and interval_overlap.h. REAL is float or double; see
// subjects/opencl/runner.cpp. Both are in one file, because a subject in OpenCL C cannot include others.
//   --subject thesis=subjects/examples/thesis.cl:interval_overlap
typedef struct {
  REAL3 normal, point;
  REAL d;
} Plane;

typedef struct {
  REAL3 point, direction;
} Line;

typedef struct {
  REAL lo, hi;
} Range;

REAL dot3(REAL3 u, REAL3 v) { return u.x * v.x + u.y * v.y + u.z * v.z; }

REAL3 cross3(REAL3 u, REAL3 v) {
  return (REAL3)(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
}

REAL3 normalised(REAL3 v) { return v / sqrt(dot3(v, v)); }

Plane plane_of(const REAL3* v) {
  Plane plane;
  plane.normal = cross3(v[1] - v[0], v[2] - v[0]);
  plane.point = v[0];
  plane.d = dot3(plane.normal, (REAL3)(0) - plane.point);
  return plane;
}

void plane_distances(const Plane* plane, const REAL3* v, REAL* distance) {
  for (int i = 0; i < 3; ++i) distance[i] = dot3(plane->normal, v[i] - plane->point);
}

bool strictly_one_side(const REAL* distance) {
  return (distance[0] > 0 && distance[1] > 0 && distance[2] > 0) ||
         (distance[0] < 0 && distance[1] < 0 && distance[2] < 0);
}

// The range of the dot product of `direction` with a triangle's vertices.
Range project(REAL3 direction, const REAL3* v) {
  const REAL first = dot3(direction, v[0]);
  Range range = {first, first};
  for (int i = 1; i < 3; ++i) {
    const REAL t = dot3(direction, v[i]);
    range.lo = t < range.lo ? t : range.lo;
    range.hi = t > range.hi ? t : range.hi;
  }
  return range;
}

bool separated(REAL3 direction, const REAL3* a, const REAL3* b) {
  const Range s = project(direction, a), t = project(direction, b);
  return s.hi < t.lo || t.hi < s.lo;
}

// Projects both triangles onto the plane, and tests whether one of the six edge normals in the plane separates them.
bool projections_intersect(const REAL3* a, const REAL3* b, const Plane* plane) {
  const REAL3 n = normalised(plane->normal);
  REAL3 pa[3], pb[3];
  for (int i = 0; i < 3; ++i) {
    pa[i] = a[i] - n * (dot3(a[i], n) + plane->d);
    pb[i] = b[i] - n * (dot3(b[i], n) + plane->d);
  }
  for (int i = 0; i < 3; ++i) {
    if (separated(cross3(n, pa[(i + 1) % 3] - pa[i]), pa, pb)) return false;
    if (separated(cross3(n, pb[(i + 1) % 3] - pb[i]), pa, pb)) return false;
  }
  return true;
}

// The common line of two planes; `direction` is the cross product of their normals.
Line common_line(const Plane* p, const Plane* q, REAL3 direction) {
  const REAL n_dot = dot3(p->normal, q->normal);
  const REAL p_square = dot3(p->normal, p->normal);
  const REAL q_square = dot3(q->normal, q->normal);
  const REAL denominator = n_dot * n_dot - p_square * q_square;
  REAL s = 0, t = 0;
  if (denominator != 0) {
    s = (q->d * n_dot - p->d * q_square) / denominator;
    t = (p->d * n_dot - q->d * p_square) / denominator;
  }
  Line line;
  line.point = -(p->normal * s + q->normal * t);
  line.direction = normalised(direction);
  return line;
}

// The vertex that is alone on its side, or else a vertex on the line. If one vertex is on the line and the others are
// on opposite sides, then one of these others.
int vertex_to_put_last(const REAL* distance) {
  int positive = 0, negative = 0, first_positive = 2, first_negative = 2, first_zero = 2;
  for (int i = 2; i >= 0; --i) {
    if (distance[i] > 0) {
      ++positive;
      first_positive = i;
    } else if (distance[i] < 0) {
      ++negative;
      first_negative = i;
    } else {
      first_zero = i;
    }
  }
  const int on_line = 3 - positive - negative;
  if (on_line == 0) return positive == 2 ? first_negative : negative == 2 ? first_positive : 2;
  if (on_line == 1 && positive == 1 && negative == 1) return first_zero == 2 ? 0 : 2;
  return on_line == 3 ? 2 : first_zero;
}

// The part of the line within a triangle whose vertices have these signed distances to the other plane.
Range section(const Line* line, const REAL3* v, const REAL* distance) {
  const int last = vertex_to_put_last(distance);
  REAL3 on_line[3];
  REAL d[3], t[2];
  for (int i = 0; i < 3; ++i) {
    const int from = i == 2 ? last : i == last ? 2 : i;
    on_line[i] = line->point + line->direction * dot3(line->direction, v[from] - line->point);
    d[i] = distance[from];
  }
  for (int i = 0; i < 2; ++i) {
    const REAL difference = d[i] - d[2];
    const REAL share = difference == 0 ? 0 : d[i] / difference;
    t[i] = dot3(line->direction, on_line[i] + (on_line[2] - on_line[i]) * share - line->point);
  }
  const bool ordered = t[0] < t[1];
  Range range = {ordered ? t[0] : t[1], ordered ? t[1] : t[0]};
  return range;
}

bool contains(Range range, REAL t) { return range.lo <= t && t <= range.hi; }

int interval_overlap(const REAL* a, const REAL* b) {
  REAL3 p[3], q[3];
  REAL distance_p[3], distance_q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = (REAL3)(a[3 * i], a[3 * i + 1], a[3 * i + 2]);
    q[i] = (REAL3)(b[3 * i], b[3 * i + 1], b[3 * i + 2]);
  }
  const Plane plane_p = plane_of(p), plane_q = plane_of(q);
  plane_distances(&plane_p, q, distance_q);
  if (strictly_one_side(distance_q)) return 0;
  const REAL3 direction = cross3(plane_p.normal, plane_q.normal);
  if (direction.x == 0 && direction.y == 0 && direction.z == 0) return projections_intersect(p, q, &plane_p);
  plane_distances(&plane_q, p, distance_p);
  if (strictly_one_side(distance_p)) return 0;
  const Line line = common_line(&plane_p, &plane_q, direction);
  const Range s = section(&line, p, distance_p), t = section(&line, q, distance_q);
  return contains(s, t.lo) || contains(s, t.hi) || contains(t, s.lo) || contains(t, s.hi);
}

int projected_sat(const REAL* a, const REAL* b) {
  REAL3 p[3], q[3];
  REAL distance[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = (REAL3)(a[3 * i], a[3 * i + 1], a[3 * i + 2]);
    q[i] = (REAL3)(b[3 * i], b[3 * i + 1], b[3 * i + 2]);
  }
  const Plane plane_p = plane_of(p), plane_q = plane_of(q);
  plane_distances(&plane_p, q, distance);
  if (strictly_one_side(distance)) return 0;
  plane_distances(&plane_q, p, distance);
  if (strictly_one_side(distance)) return 0;
  return projections_intersect(p, q, &plane_p);
}
