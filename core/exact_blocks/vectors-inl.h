// SPDX-License-Identifier: Apache-2.0
// Vector code for decide.cpp: vectors of doubles with one pair in each vector lane. It is included once for each
// instruction set, within its namespace, so it has no include guard.
//
//   filter_all    the decision by planes with one error bound for each pair, like core/exact/filter.h; in Double, or
//                 in DoubleDouble (doubles-inl.h)
//   share_vertex  like core/exact/shared_vertex.h
//   separated     the decision by axes, like core/exact/by_axes.h, on numbers whose signs are exact: Double where
//                 nothing rounds, otherwise DoubleAndInteger, which stores each number as a nearby double and as a
//                 64-bit integer, which is the number modulo 2^64. If the double is small, the integer is the
//                 number.

constexpr std::size_t kNumbers = 18;  // coordinates of a pair
using Tag = hn::CappedTag<double, 8>;
using FloatTag = hn::Rebind<float, Tag>;
using IntegerTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using VF = hn::Vec<FloatTag>;
using VI = hn::Vec<IntegerTag>;
using M = hn::Mask<Tag>;
constexpr Tag d;
constexpr FloatTag df;
constexpr IntegerTag di;
constexpr std::size_t kAtOnce = HWY_MAX_BYTES >= 64 ? 8 : 4;
constexpr int kBitsOfBoth = 34;  // the most bits that DoubleAndInteger holds

template <class AnyTag>
HWY_INLINE unsigned bits(AnyTag tag, hn::Mask<AnyTag> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, mask, bytes);
  return bytes[0];
}
HWY_INLINE unsigned bits(M mask) { return bits(d, mask); }

template <class T>
struct Three {
  T x, y, z;
};
template <class T>
HWY_INLINE Three<T> operator-(const Three<T>& l, const Three<T>& r) {
  return {l.x - r.x, l.y - r.y, l.z - r.z};
}

// A double in each vector lane. Its operations round.
struct Double {
  static constexpr double kError = 6 * detail::kDeterminantError;  // see determinant_error in core/exact/error_bound.h
  V v;
  static HWY_INLINE Double of_integer(V x) { return {x}; }
  static HWY_INLINE Double difference(V l, V r) { return {hn::Sub(l, r)}; }
  HWY_INLINE V sign() const { return v; }
  friend HWY_INLINE Double operator-(Double l, Double r) { return {hn::Sub(l.v, r.v)}; }
  // Computes p q - r s.
  static HWY_INLINE Double minor_of(Double p, Double q, Double r, Double s) {
    return {hn::MulSub(p.v, q.v, hn::Mul(r.v, s.v))};
  }
  static HWY_INLINE Double dot(const Three<Double>& u, const Three<Double>& v) {
    return {hn::MulAdd(u.z.v, v.z.v, hn::MulAdd(u.y.v, v.y.v, hn::Mul(u.x.v, v.x.v)))};
  }
};

// For integers of up to 34 bits. A difference has 35 bits, a determinant is less than 6 * 2^105, and its double is off
// by at most 2^-50 of that (error_bound.h), less than 2^58. Beyond 2^60 the double has the correct sign, even for a
// difference of two determinants. Otherwise the number fits in 64 bits, even with the error.
static_assert(2 * 6 * (std::int64_t{1} << (3 * (kBitsOfBoth + 1) - 50)) < std::int64_t{1} << 60);
struct DoubleAndInteger {
  V v;
  VI i;
  static HWY_INLINE DoubleAndInteger of_integer(V x) { return {x, hn::ConvertTo(di, x)}; }
  // A double with the number's sign.
  HWY_INLINE V sign() const { return hn::IfThenElse(hn::Gt(hn::Abs(v), hn::Set(d, 0x1p60)), v, hn::ConvertTo(d, i)); }
  friend HWY_INLINE DoubleAndInteger operator-(DoubleAndInteger l, DoubleAndInteger r) {
    return {hn::Sub(l.v, r.v), hn::Sub(l.i, r.i)};
  }
  static HWY_INLINE DoubleAndInteger minor_of(DoubleAndInteger p, DoubleAndInteger q, DoubleAndInteger r,
                                              DoubleAndInteger s) {
    return {hn::MulSub(p.v, q.v, hn::Mul(r.v, s.v)), hn::Sub(hn::Mul(p.i, q.i), hn::Mul(r.i, s.i))};
  }
  static HWY_INLINE DoubleAndInteger dot(const Three<DoubleAndInteger>& u, const Three<DoubleAndInteger>& v) {
    return {hn::MulAdd(u.z.v, v.z.v, hn::MulAdd(u.y.v, v.y.v, hn::Mul(u.x.v, v.x.v))),
            hn::Add(hn::Add(hn::Mul(u.x.i, v.x.i), hn::Mul(u.y.i, v.y.i)), hn::Mul(u.z.i, v.z.i))};
  }
};

template <class T>
HWY_INLINE Three<T> cross(const Three<T>& u, const Three<T>& v) {
  return {T::minor_of(u.y, v.z, u.z, v.y), T::minor_of(u.z, v.x, u.x, v.z), T::minor_of(u.x, v.y, u.y, v.x)};
}

HWY_INLINE Three<Double> chosen(M mask, const Three<Double>& yes, const Three<Double>& no) {
  return {{hn::IfThenElse(mask, yes.x.v, no.x.v)},
          {hn::IfThenElse(mask, yes.y.v, no.y.v)},
          {hn::IfThenElse(mask, yes.z.v, no.z.v)}};
}

HWY_INLINE V widened(VF x) { return hn::PromoteTo(d, x); }
HWY_INLINE V widened(V x) { return x; }

// The coordinates of kAtOnce pairs, which need not be adjacent in memory.
template <class Real>
struct CoordinatesOf;

template <>
struct CoordinatesOf<float> {
  static constexpr FloatTag tag{};
  VF x[kNumbers];

  HWY_INLINE explicit CoordinatesOf(const float* const (&pairs)[kAtOnce]) {
    for (std::size_t c = 0; c < 16; c += 4) columns(pairs, c, x[c], x[c + 1], x[c + 2], x[c + 3]);
    VF again, too;
    columns(pairs, 14, again, too, x[16], x[17]);
  }

 private:
  // Four floats of one pair in each 128 bits.
  static HWY_INLINE VF row(const float* const (&pairs)[kAtOnce], std::size_t k, std::size_t c) {
    constexpr hn::FixedTag<float, 4> four;
#if HWY_MAX_BYTES >= 64
    return hn::Combine(df, hn::LoadU(four, pairs[k + 4] + c), hn::LoadU(four, pairs[k] + c));
#else
    return hn::LoadU(four, pairs[k] + c);
#endif
  }

  static HWY_INLINE void columns(const float* const (&pairs)[kAtOnce], std::size_t c, VF& c0, VF& c1, VF& c2, VF& c3) {
    constexpr hn::Repartition<double, FloatTag> by_two;
    const VF r0 = row(pairs, 0, c), r1 = row(pairs, 1, c), r2 = row(pairs, 2, c), r3 = row(pairs, 3, c);
    const auto lower_01 = hn::BitCast(by_two, hn::InterleaveLower(df, r0, r1));
    const auto lower_23 = hn::BitCast(by_two, hn::InterleaveLower(df, r2, r3));
    const auto upper_01 = hn::BitCast(by_two, hn::InterleaveUpper(df, r0, r1));
    const auto upper_23 = hn::BitCast(by_two, hn::InterleaveUpper(df, r2, r3));
    c0 = hn::BitCast(df, hn::InterleaveLower(by_two, lower_01, lower_23));
    c1 = hn::BitCast(df, hn::InterleaveUpper(by_two, lower_01, lower_23));
    c2 = hn::BitCast(df, hn::InterleaveLower(by_two, upper_01, upper_23));
    c3 = hn::BitCast(df, hn::InterleaveUpper(by_two, upper_01, upper_23));
  }
};

using Coordinates = CoordinatesOf<float>;

// Bit i is set if the result of pair i is certain.
struct Filtered {
  unsigned intersects, disjoint, declined;
};

// One triangle's vertices, starting with the one alone on its side, in the order of lone_vertices (core/exact/sides.h).
struct Turned {
  Three<Double> first, second, third;
};

// below: which vertices are below the other triangle's plane: one or two of them.
HWY_INLINE Turned turned(const Three<Double> (&v)[3], const M (&below)[3], M other_is_below) {
  const M apart_01 = hn::Xor(below[0], below[1]), apart_02 = hn::Xor(below[0], below[2]);
  const M is_1 = hn::AndNot(apart_02, apart_01), is_2 = hn::AndNot(apart_01, apart_02);
  const Three<Double> next = chosen(is_1, v[2], chosen(is_2, v[0], v[1]));
  const Three<Double> last = chosen(is_1, v[0], chosen(is_2, v[1], v[2]));
  return {chosen(is_1, v[1], chosen(is_2, v[2], v[0])), chosen(other_is_below, last, next),
          chosen(other_is_below, next, last)};
}

// Whether the lone vertex is below. The equal bits of the other two cancel.   Requires: not all on the same side.
HWY_INLINE M alone_is_below(const M (&below)[3]) { return hn::Xor(hn::Xor(below[0], below[1]), below[2]); }

// The difference of two vertices, in this kind of numbers.
template <class Number>
HWY_INLINE Three<Number> difference(const Three<Double>& l, const Three<Double>& r) {
  return {Number::difference(l.x.v, r.x.v), Number::difference(l.y.v, r.y.v), Number::difference(l.z.v, r.z.v)};
}

// The determinant (p - o) x (q - o) . (r - o); only its sign matters.
template <class Number>
HWY_INLINE V orientation(const Three<Double>& o, const Three<Double>& p, const Three<Double>& q,
                         const Three<Double>& r) {
  return Number::dot(cross(difference<Number>(p, o), difference<Number>(q, o)), difference<Number>(r, o)).sign();
}

template <class Number = Double, class Real>
HWY_INLINE Filtered filter_all(const CoordinatesOf<Real>& pairs) {
  auto zeros = hn::Zero(pairs.tag);  // becomes NaN if a coordinate is not finite
  for (const auto& x : pairs.x) zeros = hn::MulAdd(x, hn::Zero(pairs.tag), zeros);
  const unsigned declined = bits(hn::IsNaN(widened(zeros)));

  V bound = hn::Set(d, Number::kError);
  V most_extent = hn::Zero(d);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = pairs.x[axis], high = pairs.x[axis];
    for (std::size_t i = axis + 3; i < kNumbers; i += 3) {
      low = hn::Min(low, pairs.x[i]);
      high = hn::Max(high, pairs.x[i]);
    }
    const V extent = hn::Sub(widened(high), widened(low));
    most_extent = hn::Max(most_extent, extent);
    bound = hn::Mul(bound, extent);
  }
  if constexpr (sizeof(Real) > sizeof(float)) {
    bound = hn::IfThenElse(hn::Le(most_extent, hn::Set(d, detail::kMostExtent)),
                           hn::Add(bound, hn::Set(d, detail::kDeterminantUnderflow)), hn::Set(d, __builtin_inf()));
  }

  Three<Double> a[3], b[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = [&](std::size_t c) HWY_ATTR { return Double{widened(pairs.x[c])}; };
    a[i] = {at(3 * i), at(3 * i + 1), at(3 * i + 2)};
    b[i] = {at(3 * i + 9), at(3 * i + 10), at(3 * i + 11)};
  }
  const Three<Number> normal_a = cross(difference<Number>(a[1], a[0]), difference<Number>(a[2], a[0])),
                      normal_b = cross(difference<Number>(b[1], b[0]), difference<Number>(b[2], b[0]));
  const auto height = [](const Three<Number>& normal, const Three<Double>& v, const Three<Double>& from)
                          HWY_ATTR { return Number::dot(normal, difference<Number>(v, from)).sign(); };
  const V of_a[3] = {height(normal_b, a[0], b[0]), height(normal_b, a[1], b[0]), height(normal_b, a[2], b[0])};
  const V of_b[3] = {height(normal_a, b[0], a[0]), height(normal_a, b[1], a[0]), height(normal_a, b[2], a[0])};
  const auto least = [](const V(&v)[3]) HWY_ATTR { return hn::Min(hn::Min(v[0], v[1]), v[2]); };
  const auto most = [](const V(&v)[3]) HWY_ATTR { return hn::Max(hn::Max(v[0], v[1]), v[2]); };
  const V nearest = hn::Min(hn::Min(hn::Min(hn::Abs(of_a[0]), hn::Abs(of_a[1])), hn::Abs(of_a[2])),
                            hn::Min(hn::Min(hn::Abs(of_b[0]), hn::Abs(of_b[1])), hn::Abs(of_b[2])));
  const unsigned parted =
      ~declined &
      bits(
          hn::Gt(hn::Max(hn::Max(least(of_a), least(of_b)), hn::Max(hn::Neg(most(of_a)), hn::Neg(most(of_b)))), bound));
  const unsigned on_sides = ~(parted | declined) & bits(hn::Gt(nearest, bound));
  if (on_sides == 0) return {0, parted, declined};

  const V zero = hn::Zero(d);
  const M a_below[3] = {hn::Lt(of_a[0], zero), hn::Lt(of_a[1], zero), hn::Lt(of_a[2], zero)};
  const M b_below[3] = {hn::Lt(of_b[0], zero), hn::Lt(of_b[1], zero), hn::Lt(of_b[2], zero)};
  const Turned t = turned(a, a_below, alone_is_below(b_below)), u = turned(b, b_below, alone_is_below(a_below));
  const V first = orientation<Number>(t.second, u.first, t.first, u.second);
  const V second = orientation<Number>(t.first, u.first, t.third, u.third);
  const V between = hn::Max(first, second);
  return {on_sides & bits(hn::Lt(between, hn::Neg(bound))), parted | (on_sides & bits(hn::Gt(between, bound))),
          declined};
}

template <class Real>
HWY_INLINE unsigned share_vertex(const CoordinatesOf<Real>& pairs) {
  auto shared = hn::Gt(hn::Zero(pairs.tag), hn::Zero(pairs.tag));
  for (std::size_t i = 0; i < 9; i += 3) {
    for (std::size_t j = 9; j < kNumbers; j += 3) {
      const auto same = hn::And(hn::Eq(pairs.x[i], pairs.x[j]), hn::And(hn::Eq(pairs.x[i + 1], pairs.x[j + 1]),
                                                                        hn::Eq(pairs.x[i + 2], pairs.x[j + 2])));
      shared = hn::Or(shared, same);
    }
  }
  return bits(pairs.tag, shared);
}

// The coordinates as integers, if the given number of bits holds them all.
struct OnGrid {
  V x[kNumbers];
  unsigned within;  // bit i is set if the coordinates of pair i are integers

  template <class Real>
  HWY_INLINE OnGrid(const CoordinatesOf<Real>& pairs, int bits_of_grid) {
    // The scale depends on the largest coordinate, or on this number if all coordinates are smaller.
    auto largest = hn::Set(pairs.tag, sizeof(Real) == sizeof(float) ? Real(0x1p-126) : Real(0x1p-900));
    for (const auto& c : pairs.x) largest = hn::Max(largest, hn::Abs(c));
    // Scales the largest value into [2^(bits_of_grid - 1), 2^bits_of_grid). If that value's exponent is e,
    // the scale is 2^(bits_of_grid - 1 - e).
    const VI exponent = hn::And(hn::BitCast(di, widened(largest)), hn::Set(di, std::int64_t{0x7ff} << 52));
    const V scale = hn::BitCast(d, hn::Sub(hn::Set(di, std::int64_t{2 * 1023 + bits_of_grid - 1} << 52), exponent));
    M whole = hn::Eq(scale, scale);
    for (std::size_t c = 0; c < kNumbers; ++c) {
      x[c] = hn::Mul(widened(pairs.x[c]), scale);
      whole = hn::And(whole, hn::Eq(hn::Round(x[c]), x[c]));
      if constexpr (sizeof(Real) > sizeof(float)) {  // a small number times a small scale may underflow to zero
        const V zero = hn::Zero(d);
        whole = hn::And(whole, hn::Or(hn::Ne(x[c], zero), hn::Eq(pairs.x[c], zero)));
      }
    }
    within = bits(whole);
  }
};

// The least and the greatest of the numbers, as doubles with the same signs.
struct Ends {
  V low = hn::Set(d, 0x1p1000), high = hn::Set(d, -0x1p1000);

  template <class... T>
  HWY_INLINE explicit Ends(const T&... number) {
    ((low = hn::Min(low, number.sign()), high = hn::Max(high, number.sign())), ...);
  }
};

// Whether some axis separates the triangles. An axis separates them if all differences along it have the same sign.
struct Axes {
  M separated;
  V least, most;  // the least and the greatest difference along all axes

  HWY_INLINE Axes() : separated(hn::Gt(hn::Zero(d), hn::Zero(d))), least(hn::Zero(d)), most(hn::Zero(d)) {}
  HWY_INLINE void look(V low, V high) {
    separated = hn::Or(separated, hn::Or(hn::Gt(low, hn::Zero(d)), hn::Lt(high, hn::Zero(d))));
    least = hn::Min(least, low);
    most = hn::Max(most, high);
  }
  template <class... T>
  HWY_INLINE void look_at(const T&... difference) {
    const Ends ends(difference...);
    look(ends.low, ends.high);
  }
};

// p are a's vertices and q are b's, relative to a's first vertex. of_a and of_b are the triangles' edges.
template <class T>
struct FromFirst {
  Three<T> p[3], q[3], of_a[3], of_b[3];

  HWY_INLINE explicit FromFirst(const OnGrid& pair) {
    const auto at = [&](std::size_t c) HWY_ATTR { return T::of_integer(hn::Sub(pair.x[c], pair.x[c % 3])); };
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = {at(3 * i), at(3 * i + 1), at(3 * i + 2)};
      q[i] = {at(3 * i + 9), at(3 * i + 10), at(3 * i + 11)};
    }
    of_a[0] = p[1];
    of_a[1] = p[2] - p[1];
    of_a[2] = p[0] - p[2];
    of_b[0] = q[1] - q[0];
    of_b[1] = q[2] - q[1];
    of_b[2] = q[0] - q[2];
  }

  // Calls visit(axis, difference…) for the normals and the cross products of edges. The differences are those of b's
  // and a's vertices along the axis; equal differences are passed once.
  template <class Visit>
  HWY_INLINE void for_each_axis(const Visit& visit) const {
    const Three<T> normal_a = cross(p[1], p[2]), normal_b = cross(of_b[0], of_b[1]);
    visit(normal_a, T::dot(normal_a, q[0]), T::dot(normal_a, q[1]), T::dot(normal_a, q[2]));
    visit(normal_b, T::dot(normal_b, q[0]), T::dot(normal_b, q[0] - p[1]), T::dot(normal_b, q[0] - p[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const Three<T> n = cross(of_a[i], of_b[j]);
        const T s = T::dot(n, p[i == 0 ? 2 : 1]), u = T::dot(n, q[j]), v = T::dot(n, q[(j + 2) % 3]);
        visit(n, u, v, u - s, v - s);
      }
    }
  }
};

// Bit i is set if an axis separates pair i. The axes are those of look and look_flat in core/exact/axes.h.
template <class T>
HWY_INLINE unsigned separated(const OnGrid& pair) {
  const FromFirst<T> seen(pair);
  const auto& [p, q, of_a, of_b] = seen;
  Axes axes;
  seen.for_each_axis([&](const Three<T>&, const auto&... difference) HWY_ATTR { axes.look_at(difference...); });
  const auto all_zero = [&]() HWY_ATTR {
    return hn::And(hn::Eq(axes.least, hn::Zero(d)), hn::Eq(axes.most, hn::Zero(d)));
  };
  if (hn::AllFalse(d, all_zero())) return bits(axes.separated);

  // If the difference of a and b is flat, its plane contains the origin, and these axes decide.
  using Part = T Three<T>::*;
  constexpr Part kPlanes[3][2] = {
      {&Three<T>::x, &Three<T>::y}, {&Three<T>::y, &Three<T>::z}, {&Three<T>::z, &Three<T>::x}};
  for (const auto& [x, y] : kPlanes) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto beside = [&](const Three<T>& e, const Three<T>& v)
                              HWY_ATTR { return T::minor_of(e.*x, v.*y, e.*y, v.*x); };
      const Three<T>&e = of_a[i], &f = of_b[i];
      const T s = beside(e, p[i == 0 ? 2 : 1]), u0 = beside(e, q[0]), u1 = beside(e, q[1]), u2 = beside(e, q[2]);
      axes.look_at(u0, u1, u2, u0 - s, u1 - s, u2 - s);
      const T c = beside(f, q[i]), t = beside(f, q[(i + 2) % 3]), w1 = beside(f, p[1]), w2 = beside(f, p[2]);
      axes.look_at(c, t, c - w1, t - w1, c - w2, t - w2);
    }
  }
  for (const Part x : {&Three<T>::x, &Three<T>::y, &Three<T>::z}) {
    const V p1 = (p[1].*x).v, p2 = (p[2].*x).v, q0 = (q[0].*x).v, q1 = (q[1].*x).v, q2 = (q[2].*x).v;
    const V least_p = hn::Min(hn::Zero(d), hn::Min(p1, p2)), most_p = hn::Max(hn::Zero(d), hn::Max(p1, p2));
    const V least_q = hn::Min(q0, hn::Min(q1, q2)), most_q = hn::Max(q0, hn::Max(q1, q2));
    axes.look(hn::Sub(least_q, most_p), hn::Sub(most_q, least_p));
  }
  return bits(axes.separated);
}
