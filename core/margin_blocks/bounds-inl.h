// SPDX-License-Identifier: Apache-2.0
// Bounds on margins in vectors of doubles, one pair in each vector lane, with the errors that core/margin/distance.h
// and depth.h derive. Included once for each instruction set, after core/exact_blocks/vectors-inl.h and in the same
// namespace, so it has no include guard.

using Vector = Three<V>;

constexpr double kHalf = 0x1p-53;  // unit roundoff

HWY_INLINE V number(double x) { return hn::Set(d, x); }
HWY_INLINE V dot(const Vector& u, const Vector& v) {
  return hn::MulAdd(u.z, v.z, hn::MulAdd(u.y, v.y, hn::Mul(u.x, v.x)));
}
HWY_INLINE V dot_of_magnitudes(const Vector& u, const Vector& v) {
  return hn::MulAdd(hn::Abs(u.z), hn::Abs(v.z),
                    hn::MulAdd(hn::Abs(u.y), hn::Abs(v.y), hn::Mul(hn::Abs(u.x), hn::Abs(v.x))));
}
HWY_INLINE Vector less(const Vector& u, const Vector& v) {
  return {hn::Sub(u.x, v.x), hn::Sub(u.y, v.y), hn::Sub(u.z, v.z)};
}
HWY_INLINE Vector scaled(const Vector& u, V by) { return {hn::Mul(u.x, by), hn::Mul(u.y, by), hn::Mul(u.z, by)}; }
HWY_INLINE Vector added(const Vector& u, V by, const Vector& v) {  // u + by * v
  return {hn::MulAdd(by, v.x, u.x), hn::MulAdd(by, v.y, u.y), hn::MulAdd(by, v.z, u.z)};
}
HWY_INLINE Vector chosen(M mask, const Vector& yes, const Vector& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE Vector quick_cross(const Vector& u, const Vector& v) {
  return {hn::MulSub(u.y, v.z, hn::Mul(u.z, v.y)), hn::MulSub(u.z, v.x, hn::Mul(u.x, v.z)),
          hn::MulSub(u.x, v.y, hn::Mul(u.y, v.x))};
}
// Like difference_of_products in core/margin/frame.h.
HWY_INLINE V accurate_minor(V p, V q, V r, V s) {
  const V rs = hn::Mul(r, s);
  return hn::Add(hn::MulSub(p, q, rs), hn::NegMulAdd(r, s, rs));
}
HWY_INLINE Vector accurate_cross(const Vector& u, const Vector& v) {
  return {accurate_minor(u.y, v.z, u.z, v.y), accurate_minor(u.z, v.x, u.x, v.z), accurate_minor(u.x, v.y, u.y, v.x)};
}

// The differences of the pairs' vertices, each with one rounding.
struct Frame {
  Vector edge_a[3], edge_b[3];  // from vertex i to i + 1
  Vector between[3][3];         // from a[i] to b[j]
  V largest;                    // the largest coordinate in magnitude
  M exact;                      // no difference is rounded: differences_are_exact in core/margin/frame.h

  HWY_INLINE explicit Frame(const Coordinates& pairs) {
    Vector a[3], b[3];
    const auto at = [&](std::size_t c) HWY_ATTR { return hn::PromoteTo(d, pairs.x[c]); };
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = {at(3 * i), at(3 * i + 1), at(3 * i + 2)};
      b[i] = {at(3 * i + 9), at(3 * i + 10), at(3 * i + 11)};
    }
    for (std::size_t i = 0; i < 3; ++i) {
      edge_a[i] = less(a[(i + 1) % 3], a[i]);
      edge_b[i] = less(b[(i + 1) % 3], b[i]);
      for (std::size_t j = 0; j < 3; ++j) between[i][j] = less(b[j], a[i]);
    }
    VF most = hn::Zero(df), least = hn::Set(df, 0x1p127f);
    for (const VF& x : pairs.x) {
      const VF size = hn::Abs(x);
      most = hn::Max(most, size);
      least = hn::Min(least, hn::IfThenElse(hn::Eq(size, hn::Zero(df)), hn::Set(df, 0x1p127f), size));
    }
    largest = hn::PromoteTo(d, most);
    // Differences are multiples of least * 2^-23 or 2^-149, below 2 * largest: 27 + 1 + 24 bits. A double has 53.
    exact = hn::Le(largest, hn::Mul(number(0x1p27), hn::Max(hn::PromoteTo(d, least), number(0x1p-126))));
  }
};

struct Bounds {
  V lo, hi;
};

// The two features that seem nearest so far.
struct Guess {
  V squared, kind, i, j;

  HWY_INLINE Guess() : squared(number(INFINITY)), kind(hn::Zero(d)), i(hn::Zero(d)), j(hn::Zero(d)) {}
  HWY_INLINE void consider(V at, M valid, double candidate, double of_a, double of_b) {
    const M better = hn::And(valid, hn::Lt(at, squared));
    squared = hn::IfThenElse(better, at, squared);
    kind = hn::IfThenElse(better, number(candidate), kind);
    i = hn::IfThenElse(better, number(of_a), i);
    j = hn::IfThenElse(better, number(of_b), j);
  }
};
constexpr double kVertices = 0, kEdgeA = 1, kEdgeB = 2, kEdges = 3, kFaceA = 4, kFaceB = 5;

HWY_INLINE M within(V x, V end) { return hn::And(hn::Gt(x, hn::Zero(d)), hn::Lt(x, end)); }

// Whether s >= 0, t >= 0, s + t <= end, and end > 0.
HWY_INLINE M inside(V s, V t, V end) {
  return hn::And(hn::And(hn::Ge(s, hn::Zero(d)), hn::Ge(t, hn::Zero(d))),
                 hn::And(hn::Le(hn::Add(s, t), end), hn::Gt(end, hn::Zero(d))));
}

HWY_INLINE Guess nearest_features(const Frame& f) {
  V length_a[3], length_b[3], per_a[3], per_b[3];  // squares, and their reciprocals
  for (std::size_t i = 0; i < 3; ++i) {
    length_a[i] = dot(f.edge_a[i], f.edge_a[i]);
    length_b[i] = dot(f.edge_b[i], f.edge_b[i]);
    per_a[i] = hn::Div(number(1), length_a[i]);
    per_b[i] = hn::Div(number(1), length_b[i]);
  }
  const Vector normal_a = quick_cross(f.edge_a[0], f.edge_a[1]), normal_b = quick_cross(f.edge_b[0], f.edge_b[1]);
  const V n2_a = dot(normal_a, normal_a), n2_b = dot(normal_b, normal_b);
  const V per_normal_a = hn::Div(number(1), n2_a), per_normal_b = hn::Div(number(1), n2_b);
  Guess best;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double of_a = static_cast<double>(i), of_b = static_cast<double>(j);
      const Vector &w = f.between[i][j], &u = f.edge_a[i], &v = f.edge_b[j];
      const V along_a = dot(w, u), along_b = hn::Neg(dot(w, v));
      const Vector across_a = quick_cross(w, u), across_b = quick_cross(w, v), n = quick_cross(u, v);
      best.consider(dot(w, w), hn::Eq(w.x, w.x), kVertices, of_a, of_b);
      best.consider(hn::Mul(dot(across_a, across_a), per_a[i]), within(along_a, length_a[i]), kEdgeA, of_a, of_b);
      best.consider(hn::Mul(dot(across_b, across_b), per_b[j]), within(along_b, length_b[j]), kEdgeB, of_a, of_b);
      const V n2 = dot(n, n), gap = dot(w, n);
      best.consider(hn::Div(hn::Mul(gap, gap), n2), hn::And(within(dot(across_b, n), n2), within(dot(across_a, n), n2)),
                    kEdges, of_a, of_b);
      if (i == 0) {  // a vertex of b over a
        const V s = dot(quick_cross(f.edge_a[2], w), normal_a), t = dot(quick_cross(f.edge_a[0], w), normal_a);
        const V height = dot(w, normal_a);
        best.consider(hn::Mul(hn::Mul(height, height), per_normal_a), inside(s, t, n2_a), kFaceA, 0, of_b);
      }
      if (j == 0) {  // a vertex of a over b; w points away from it
        const V s = hn::Neg(dot(quick_cross(f.edge_b[2], w), normal_b)),
                t = hn::Neg(dot(quick_cross(f.edge_b[0], w), normal_b));
        const V height = dot(w, normal_b);
        best.consider(hn::Mul(hn::Mul(height, height), per_normal_b), inside(s, t, n2_b), kFaceB, of_a, 0);
      }
    }
  }
  return best;
}

template <class Of>
HWY_INLINE Vector selected(V index, const Of& of) {
  return chosen(hn::Eq(index, number(0)), of(0), chosen(hn::Eq(index, number(1)), of(1), of(2)));
}

// Bounds for disjoint triangles. The distance is at most the length of the connection between the features that seem
// nearest, and at least the separation along their common perpendicular.
HWY_INLINE Bounds distance_bounds(const Frame& f) {
  const Guess guess = nearest_features(f);
  const auto is = [&](double kind) HWY_ATTR { return hn::Eq(guess.kind, number(kind)); };
  const M vertices = is(kVertices), edge_a = is(kEdgeA), edge_b = is(kEdgeB), face_a = is(kFaceA), face_b = is(kFaceB);
  const M edges = is(kEdges), edge = hn::Or(edge_a, edge_b), face = hn::Or(face_a, face_b);
  const Vector w = selected(guess.i, [&](std::size_t i) HWY_ATTR {
    return selected(guess.j, [&](std::size_t j) HWY_ATTR { return f.between[i][j]; });
  });
  // Two edges: u is a's, v is b's. One edge: u. A face: u and v begin at its first vertex.
  const Vector of_a = selected(guess.i, [&](std::size_t i) HWY_ATTR { return f.edge_a[i]; });
  const Vector of_b = selected(guess.j, [&](std::size_t j) HWY_ATTR { return f.edge_b[j]; });
  const Vector none = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  const Vector from = chosen(hn::Or(face_b, edge_b), less(none, w), w);
  const Vector u = chosen(face_a, f.edge_a[0], chosen(face_b, f.edge_b[0], chosen(edge_b, of_b, of_a)));
  const Vector v = chosen(face_a, less(none, f.edge_a[2]), chosen(face_b, less(none, f.edge_b[2]), of_b));
  const Vector normal = accurate_cross(u, v), perpendicular = accurate_cross(accurate_cross(u, from), u);
  const V n2 = dot(normal, normal), u2 = dot(u, u);

  // The connection is the vector `from + s u + t v` with s and t in [-1, 0], but t in [0, 1] for two edges.
  const V along = hn::IfThenElse(edge, dot(from, u), dot(quick_cross(from, v), normal)),
          whole = hn::IfThenElse(edge, u2, n2);
  const V beside = hn::IfThenElse(edges, dot(quick_cross(from, u), normal), dot(quick_cross(u, from), normal));
  const M valid = hn::Or(hn::Or(vertices, hn::And(edge, within(along, whole))),
                         hn::Or(hn::And(edges, hn::And(within(along, whole), within(beside, whole))),
                                hn::And(face, inside(along, beside, whole))));
  const V s = hn::IfThenElseZero(hn::Not(vertices), hn::Neg(hn::Div(along, whole)));
  const V t = hn::IfThenElseZero(hn::Or(edges, face), hn::Div(hn::IfThenElse(edges, beside, hn::Neg(beside)), whole));
  const Vector su = scaled(u, s), tv = scaled(v, t);
  const Vector connection = added(added(from, number(1), su), number(1), tv);
  const auto sum = [&](const Vector& x) HWY_ATTR { return hn::Add(hn::Add(hn::Abs(x.x), hn::Abs(x.y)), hn::Abs(x.z)); };
  const V terms = hn::Add(hn::Add(sum(from), sum(su)), sum(tv));
  const V hi =
      hn::MulAdd(hn::Sqrt(dot(connection, connection)), number(1 + 8 * kHalf), hn::Mul(terms, number(8 * kHalf)));

  // A perpendicular has degree three, and nothing here exceeds degree six: see MarginFrame in core/margin/frame.h.
  const Vector n = chosen(vertices, w, chosen(edge, perpendicular, normal));
  V least = number(INFINITY), most = number(-INFINITY);
  for (const Vector(&row)[3] : f.between) {
    for (const Vector& x : row) {
      const V seen = dot(n, x), error = hn::Mul(dot_of_magnitudes(n, x), number(6 * kHalf));
      least = hn::Min(least, hn::Sub(seen, error));
      most = hn::Max(most, hn::Add(seen, error));
    }
  }
  const V gap = hn::Max(hn::Max(least, hn::Neg(most)), hn::Zero(d));
  const V lo = hn::Mul(hn::Div(gap, hn::Sqrt(dot(n, n))), number(1 - 8 * kHalf));
  return {hn::IfThenElseZero(valid, lo), hi};
}

// The squares of bounds on the depth of intersecting triangles. All differences of coordinates are exact.
struct Depth {
  V lo, hi;

  HWY_INLINE Depth() : lo(number(INFINITY)), hi(number(INFINITY)) {}
  // Adds the axis n, with points relative to the feature that it is perpendicular to. own: the third vertex of an
  // edge's triangle, 0 for a face. With exact differences n has a relative error of 5 kHalf (core/margin/depth.h).
  template <class... Other>
  HWY_INLINE void look(const Vector& n, const V& own, const V& own_error, const Other&... other) {
    const V zero = hn::Zero(d);
    V least_lo = number(INFINITY), least_hi = least_lo, most_lo = number(-INFINITY), most_hi = most_lo;
    const auto include = [&](const Vector& x) HWY_ATTR {
      const V seen = dot(n, x), error = hn::Mul(dot_of_magnitudes(n, x), number(12 * kHalf));
      least_lo = hn::Min(least_lo, hn::Sub(seen, error));
      least_hi = hn::Min(least_hi, hn::Add(seen, error));
      most_lo = hn::Max(most_lo, hn::Sub(seen, error));
      most_hi = hn::Max(most_hi, hn::Add(seen, error));
    };
    (include(other), ...);
    const V own_low = hn::Sub(own, own_error), own_high = hn::Add(own, own_error);
    const V over =
        hn::Max(hn::Min(hn::Sub(hn::Max(zero, own_low), least_hi), hn::Sub(most_lo, hn::Min(zero, own_high))), zero);
    const V under =
        hn::Max(hn::Min(hn::Sub(hn::Max(zero, own_high), least_lo), hn::Sub(most_hi, hn::Min(zero, own_low))), zero);
    const V n2 = dot(n, n), per_n2 = hn::Div(number(1), n2);
    const M axis = hn::Gt(n2, zero);  // else two edges are parallel, or a triangle is flat
    lo = hn::IfThenElse(axis, hn::Min(lo, hn::Mul(hn::Mul(over, over), per_n2)), lo);
    hi = hn::IfThenElse(axis, hn::Min(hi, hn::Mul(hn::Mul(under, under), per_n2)), hi);
  }
};

HWY_INLINE Bounds squared_depth_bounds(const Frame& f) {
  Depth depth;
  const V none = hn::Zero(d);
  const auto& w = f.between;
  depth.look(accurate_cross(f.edge_a[0], f.edge_a[1]), none, none, w[0][0], w[0][1], w[0][2]);
  const auto reversed = [&](const Vector& x) HWY_ATTR { return Vector{hn::Neg(x.x), hn::Neg(x.y), hn::Neg(x.z)}; };
  depth.look(accurate_cross(f.edge_b[0], f.edge_b[1]), none, none, reversed(w[0][0]), reversed(w[1][0]),
             reversed(w[2][0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector third = reversed(f.edge_a[(i + 2) % 3]);  // a[i + 2] seen from a[i]
    for (std::size_t j = 0; j < 3; ++j) {
      const Vector n = accurate_cross(f.edge_a[i], f.edge_b[j]);
      depth.look(n, dot(n, third), hn::Mul(dot_of_magnitudes(n, third), number(12 * kHalf)), w[i][j],
                 w[i][(j + 2) % 3]);
    }
  }
  // 32 is 2 * 5 for n, 3 for its square, 5 for the later operations, and slack.
  return {hn::Mul(depth.lo, number(1 - 32 * kHalf)), hn::Mul(depth.hi, number(1 + 32 * kHalf))};
}

// Whether intersecting triangles only touch: the overlap along some axis is zero, or there is no axis.
template <class T>
HWY_INLINE unsigned touch(const OnGrid& pair) {
  M touching = hn::Gt(hn::Zero(d), hn::Zero(d)), any_axis = touching;
  FromFirst<T>(pair).for_each_axis([&](const Three<T>& n, const auto&... difference) HWY_ATTR {
    const Ends ends(difference...);
    const M axis = hn::Gt(hn::Max(hn::Max(hn::Abs(n.x.sign()), hn::Abs(n.y.sign())), hn::Abs(n.z.sign())), hn::Zero(d));
    any_axis = hn::Or(any_axis, axis);
    touching = hn::Or(touching, hn::And(axis, hn::Or(hn::Eq(ends.low, hn::Zero(d)), hn::Eq(ends.high, hn::Zero(d)))));
  });
  return bits(hn::Or(touching, hn::Not(any_axis)));
}
