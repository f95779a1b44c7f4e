// SPDX-License-Identifier: Apache-2.0
// A triangle test that looks for edges piercing the other triangle; it is right on small integers. causes.test.cpp
// plants bugs in it. The file includes nothing, so that it compiles fast.
static float least(float p, float q) { return p < q ? p : q; }
static float most(float p, float q) { return p > q ? p : q; }
static float size(float p) { return p < 0 ? -p : p; }

struct V {
  float x, y, z;
};
static V operator-(V p, V q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
static float dot(V p, V q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
static V cross(V p, V q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
static float det(V o, V p, V q, V r) { return dot(cross(p - o, q - o), r - o); }
static bool one_side(float p, float q) { return (p > 0 && q > 0) || (p < 0 && q < 0); }

// Whether the edge p q, which does not lie in the plane of t, meets t.
static bool pierces(V p, V q, const V* t) {
  const float dp = det(t[0], t[1], t[2], p), dq = det(t[0], t[1], t[2], q);
  if (one_side(dp, dq) || (dp == 0 && dq == 0)) return false;
  const float s[] = {det(p, q, t[0], t[1]), det(p, q, t[1], t[2]), det(p, q, t[2], t[0])};
  const bool left = s[0] > 0 || s[1] > 0 || s[2] > 0, right = s[0] < 0 || s[1] < 0 || s[2] < 0;
  return !(left && right);
}

struct Flat {
  float x, y;
};
static Flat flat(V p, int drop) { return drop == 2 ? Flat{p.x, p.y} : drop == 1 ? Flat{p.z, p.x} : Flat{p.y, p.z}; }
static float turn(Flat o, Flat p, Flat q) { return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x); }
static float largest(V n) { return most(most(size(n.x), size(n.y)), size(n.z)); }

// Whether the segments p q and u v, which lie on one line, have a point in common.
static bool overlap(Flat p, Flat q, Flat u, Flat v) {
  return most(least(p.x, q.x), least(u.x, v.x)) <= least(most(p.x, q.x), most(u.x, v.x)) &&
         most(least(p.y, q.y), least(u.y, v.y)) <= least(most(p.y, q.y), most(u.y, v.y));
}
static bool touch(Flat p, Flat q, Flat u, Flat v) {
  const float a = turn(u, v, p), b = turn(u, v, q), c = turn(p, q, u), d = turn(p, q, v);
  if (a == 0 && b == 0 && c == 0 && d == 0) return overlap(p, q, u, v);
  return !one_side(a, b) && !one_side(c, d);
}
static bool inside(Flat p, const Flat* t) {
  const float s[] = {turn(t[0], t[1], p), turn(t[1], t[2], p), turn(t[2], t[0], p)};
  const bool left = s[0] > 0 || s[1] > 0 || s[2] > 0, right = s[0] < 0 || s[1] < 0 || s[2] < 0;
  return turn(t[0], t[1], t[2]) != 0 && !(left && right);
}

static bool meet_in_plane(const V* a, const V* b, V n) {
  int drop;
  if (size(n.z) == largest(n)) {
    drop = 2;
  } else if (size(n.y) == largest(n)) {
    drop = 1;
  } else {
    drop = 0;
  }
  Flat p[3], q[3];
  for (int i = 0; i < 3; ++i) p[i] = flat(a[i], drop), q[i] = flat(b[i], drop);
  for (int i = 0; i < 9; ++i)
    if (touch(p[i / 3], p[(i / 3 + 1) % 3], q[i % 3], q[(i % 3 + 1) % 3])) return true;
  return inside(p[0], q) || inside(q[0], p);
}

static bool segments_meet(const V* a, const V* b) {
  for (int i = 0; i < 9; ++i) {
    const V p = a[i / 3], q = a[(i / 3 + 1) % 3], u = b[i % 3], v = b[(i % 3 + 1) % 3];
    bool meet = det(p, q, u, v) == 0;
    for (int drop = 0; drop < 3; ++drop)
      meet = meet && touch(flat(p, drop), flat(q, drop), flat(u, drop), flat(v, drop));
    if (meet) return true;
  }
  return false;
}

bool intersects(const float f[9], const float g[9]) {
  const V a[] = {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}, {f[6], f[7], f[8]}};
  const V b[] = {{g[0], g[1], g[2]}, {g[3], g[4], g[5]}, {g[6], g[7], g[8]}};
  const V m = cross(a[1] - a[0], a[2] - a[0]), n = cross(b[1] - b[0], b[2] - b[0]);
  if (largest(m) == 0 && largest(n) == 0) return segments_meet(a, b);
  bool coplanar = true;
  for (int i = 0; i < 3; ++i) coplanar = coplanar && dot(m, b[i] - a[0]) == 0 && dot(n, a[i] - b[0]) == 0;
  if (coplanar) return meet_in_plane(a, b, largest(m) == 0 ? n : m);
  for (int i = 0; i < 3; ++i)
    if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return true;
  return false;
}
