// SPDX-License-Identifier: Apache-2.0
// Exact triangle-triangle intersection for float32 input, on host and device: closed triangles, segments and points;
// crossing, touching, coplanar, shared vertices and edges; any finite coordinates, subnormals and 1e38 included.
// Needs the C++ standard library only, and a compiler with 128-bit integers (GCC, Clang, nvcc).
//
// Two decisions, written over the numbers they compute with:
//   by_planes  Guigue and Devillers 2003: the sides of the vertices, then two orientations. For pairs in general
//              position. Its first attempt, in doubles, is written apart, for speed.
//   by_axes    separating axes of the Minkowski difference D = { x - y : x in a, y in b }, which holds the origin
//              exactly when a and b meet. Proper, coplanar and degenerate pairs alike.
// and four kinds of numbers, each exact or saying that it is not. First doubles with one error bound for all; what it
// leaves open intersects where a vertex is shared, and otherwise goes to the smallest exact kind that holds the pair,
// wide ones only after a tighter bound of each value.
//   bounded    doubles with an error bound. A determinant of three differences, each rounded once, is off by at most
//              (7 + 56 e) e sum |products|, e = 2^-53 (Shewchuk 1997, orient3d stage A); contraction only removes
//              roundings. No overflow or underflow: differences of floats lie between 2^-149 and 2^129, or are zero.
//   doubles    coordinates that are integers of up to 15 bits times one power of two: a determinant is less than
//              6 * 2^(3 * 16) < 2^53, so nothing rounds; in floats so up to 6 bits: 6 * 2^(3 * 7) < 2^24.
//   int128     up to 30 bits: minors fit in 64 bits; up to 40 bits: a determinant is less than 6 * 2^(3 * 41) < 2^127.
//   wide       up to 90 bits: a minor is less than 2 * 2^(2 * 91) < 2^191, a determinant than 6 * 2^(3 * 91) < 2^319;
//              else multiples of 2^-149: a float has 277 bits, a difference 278, a determinant less than 840.
// Integers do not round: what is exact here does not hang on rounding modes, contraction or optimisation.
#pragma once

#include <cstdint>
#include <cstring>
#if defined(__SSE2__) && !defined(__CUDACC__)
#include <emmintrin.h>
#endif

#ifdef __FAST_MATH__
#error "graze/exact.h: error bounds do not hold under -ffast-math"
#endif

#ifndef GRAZE_HD
#ifdef __CUDACC__
#define GRAZE_HD __host__ __device__
#else
#define GRAZE_HD
#endif
#endif

namespace graze::exact {

// Which numbers decided; bounded also where the triangles share a vertex.
enum class Stage : std::uint8_t { bounded, doubles, int128, wide };
inline constexpr int kStages = 4;

// What two triangles have to do with each other.
struct Relation {
  bool intersects = false;
  int contact = -1;     // dimension of the common set: 0 point, 1 segment, 2 area; -1: none
  int margin_sign = 1;  // 1: disjoint; -1: they intersect, and a translation small enough does not part them; else 0
  int dimension_a = 2;  // of the hull: 0 point, 1 segment, 2 triangle
  int dimension_b = 2;
  bool coplanar = false;  // one plane holds all six points
  friend bool operator==(const Relation&, const Relation&) = default;
};

namespace detail {

using Int128 = __int128;

template <class T>
struct Vec {
  T x, y, z;
};

template <class T>
GRAZE_HD Vec<T> operator-(const Vec<T>& u, const Vec<T>& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}

// Minors and determinants in a type M or T that holds them.
template <class M, class D>
GRAZE_HD Vec<M> cross(const Vec<D>& u, const Vec<D>& v) {
  return {M(u.y) * v.z - M(u.z) * v.y, M(u.z) * v.x - M(u.x) * v.z, M(u.x) * v.y - M(u.y) * v.x};
}

template <class T, class M, class D>
GRAZE_HD T dot(const Vec<M>& n, const Vec<D>& v) {
  return T(n.x) * v.x + T(n.y) * v.y + T(n.z) * v.z;
}

template <class T>
GRAZE_HD bool is_zero(const Vec<T>& v) {
  return v.x == T(0) && v.y == T(0) && v.z == T(0);
}

// Relative to the sum of the products' magnitudes: (7 + 56 e) e < 8 e.
inline constexpr double kDeterminantError = 8 * 0x1p-53;

// A sum of products, and the sum of the products' magnitudes.
struct Bounded {
  double value, size;
  GRAZE_HD explicit Bounded(double x) : value(x), size(x < 0 ? -x : x) {}
  GRAZE_HD Bounded(double v, double s) : value(v), size(s) {}
  GRAZE_HD friend Bounded operator*(const Bounded& l, double r) { return {l.value * r, l.size * (r < 0 ? -r : r)}; }
  GRAZE_HD friend Bounded operator+(const Bounded& l, const Bounded& r) { return {l.value + r.value, l.size + r.size}; }
  GRAZE_HD friend Bounded operator-(const Bounded& l, const Bounded& r) { return {l.value - r.value, l.size + r.size}; }
};

// Two's complement integers of N 64-bit limbs, lowest first; enough limbs are at hand wherever they are used.
template <int N>
struct Wide {
  std::uint64_t limb[N];

  GRAZE_HD Wide() : limb{} {}
  GRAZE_HD explicit Wide(int zero) : limb{} { limb[0] = static_cast<std::uint64_t>(zero); }
  template <int K>
  GRAZE_HD explicit Wide(const Wide<K>& x) {
    for (int i = 0; i < N; ++i) limb[i] = i < K ? x.limb[i] : x.negative() ? ~std::uint64_t{0} : 0;
  }

  GRAZE_HD bool negative() const { return limb[N - 1] >> 63 != 0; }

  GRAZE_HD Wide operator-() const { return Wide(0) - *this; }

  GRAZE_HD friend Wide operator+(const Wide& l, const Wide& r) {
    Wide sum;
    unsigned __int128 carry = 0;
    for (int i = 0; i < N; ++i) {
      carry += static_cast<unsigned __int128>(l.limb[i]) + r.limb[i];
      sum.limb[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }

  GRAZE_HD friend Wide operator-(const Wide& l, const Wide& r) {
    Wide difference;
    std::uint64_t borrow = 0;
    for (int i = 0; i < N; ++i) {
      const std::uint64_t part = l.limb[i] - r.limb[i];
      difference.limb[i] = part - borrow;
      borrow = (l.limb[i] < r.limb[i]) | (part < borrow);
    }
    return difference;
  }

  template <int K>
  GRAZE_HD friend Wide operator*(const Wide& l, const Wide<K>& r) {
    const bool turn = l.negative() != r.negative();
    const Wide u = l.negative() ? -l : l;
    const Wide<K> v = r.negative() ? -r : r;
    Wide product;
    for (int i = 0; i < N; ++i) {
      if (u.limb[i] == 0) continue;
      std::uint64_t carry = 0;
      for (int j = 0; i + j < N; ++j) {
        if (j >= K && carry == 0) break;
        const unsigned __int128 term =
            static_cast<unsigned __int128>(u.limb[i]) * (j < K ? v.limb[j] : 0) + product.limb[i + j] + carry;
        product.limb[i + j] = static_cast<std::uint64_t>(term);
        carry = static_cast<std::uint64_t>(term >> 64);
      }
    }
    return turn ? -product : product;
  }

  GRAZE_HD friend bool operator<(const Wide& l, const Wide& r) { return (l - r).negative(); }
  GRAZE_HD friend bool operator>(const Wide& l, const Wide& r) { return r < l; }
  GRAZE_HD friend bool operator==(const Wide& l, const Wide& r) {
    for (int i = 0; i < N; ++i) {
      if (l.limb[i] != r.limb[i]) return false;
    }
    return true;
  }
};

// The numbers of a stage: coordinates and their differences, minors, determinants.
// Of a determinant, these say what is beyond doubt.
struct BoundedNumbers {
  using D = double;
  using M = Bounded;
  using T = Bounded;
  GRAZE_HD bool positive(const T& x) const { return x.value > kDeterminantError * x.size; }
  GRAZE_HD bool negative(const T& x) const { return x.value < -kDeterminantError * x.size; }
  GRAZE_HD bool zero(const T& x) const { return x.size == 0; }
  GRAZE_HD bool is_proper(const Vec<M>&) const { return false; }
};
template <class Difference, class Minor, class Determinant>
struct ExactNumbers {
  using D = Difference;
  using M = Minor;
  using T = Determinant;
  GRAZE_HD bool positive(const T& x) const { return x > T(0); }
  GRAZE_HD bool negative(const T& x) const { return x < T(0); }
  GRAZE_HD bool zero(const T& x) const { return x == T(0); }
  GRAZE_HD bool is_proper(const Vec<M>& normal) const { return !is_zero(normal); }
};
// Of the coordinates on their grid, how many bits these numbers hold.
inline constexpr int kSingleBits = 6, kDoubleBits = 15, kNarrowBits = 30, kIntBits = 40, kLongBits = 90;
using SingleNumbers = ExactNumbers<float, float, float>;  // for devices; grids from 2^-30 to 2^30
using DoubleNumbers = ExactNumbers<double, double, double>;
using NarrowNumbers = ExactNumbers<std::int64_t, std::int64_t, Int128>;
using IntNumbers = ExactNumbers<std::int64_t, Int128, Int128>;
using LongNumbers = ExactNumbers<Wide<2>, Wide<3>, Wide<5>>;
using WideNumbers = ExactNumbers<Wide<5>, Wide<9>, Wide<14>>;

template <class Numbers>
struct Triangles {
  Vec<typename Numbers::D> a[3], b[3];
};

// The grid of a pair: the coordinates are integers of so many bits times 2^exponent.
struct Grid {
  int exponent, bits;
};

GRAZE_HD inline std::uint32_t bits_of(float x) {
  std::uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

GRAZE_HD inline int trailing_zeros(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __ffs(static_cast<int>(x)) - 1;
#else
  return __builtin_ctz(x);
#endif
}

GRAZE_HD inline Grid grid_of(const float* a, const float* b) {
  int lowest = 1 << 10, highest = -(1 << 10);
  for (int i = 0; i < 18; ++i) {
    const std::uint32_t bits = bits_of(i < 9 ? a[i] : b[i - 9]) & 0x7fffffffu;
    if (bits == 0) continue;
    const int exponent = bits < 0x800000u ? 1 : static_cast<int>(bits >> 23);
    const std::uint32_t mantissa = bits < 0x800000u ? bits : (bits & 0x7fffffu) | 0x800000u;
    const int low = exponent - 150 + trailing_zeros(mantissa), high = exponent - 126;
    lowest = low < lowest ? low : lowest;
    highest = high > highest ? high : highest;
  }
  return highest < lowest ? Grid{0, 0} : Grid{lowest, highest - lowest};
}

GRAZE_HD inline double power_of_two(int exponent) {
  const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

GRAZE_HD inline void convert(float x, double, float& out) { out = x; }
GRAZE_HD inline void convert(float x, double, double& out) { out = static_cast<double>(x); }
GRAZE_HD inline void convert(float x, double scale, std::int64_t& out) { out = static_cast<std::int64_t>(x * scale); }
GRAZE_HD inline void convert(float x, double scale, Wide<2>& out) {
  const double integer = x < 0 ? x * -scale : x * scale;
  const auto high = static_cast<std::uint64_t>(integer * 0x1p-64);
  out.limb[0] = static_cast<std::uint64_t>(integer - static_cast<double>(high) * 0x1p64);
  out.limb[1] = high;
  if (x < 0) out = -out;
}
GRAZE_HD inline void convert(float x, double, Wide<5>& out) {
  const std::uint32_t bits = bits_of(x), exponent = bits >> 23 & 0xffu, fraction = bits & 0x7fffffu;
  const std::uint32_t shift = exponent == 0 ? 0 : exponent - 1;
  const std::uint64_t mantissa = exponent == 0 ? fraction : fraction | 0x800000u;
  out = Wide<5>(0);
  for (std::uint32_t i = 0; i < 5; ++i) {
    if (i == shift / 64) out.limb[i] = mantissa << shift % 64;
    if (i == shift / 64 + 1 && shift % 64 > 40) out.limb[i] = mantissa >> (64 - shift % 64);
  }
  if (bits >> 31) out = -out;
}

template <class Numbers>
GRAZE_HD Triangles<Numbers> triangles(const float* a, const float* b, int exponent = 0) {
  const double scale = power_of_two(-exponent);
  Triangles<Numbers> t;
  for (int i = 0; i < 3; ++i) {
    convert(a[3 * i], scale, t.a[i].x);
    convert(a[3 * i + 1], scale, t.a[i].y);
    convert(a[3 * i + 2], scale, t.a[i].z);
    convert(b[3 * i], scale, t.b[i].x);
    convert(b[3 * i + 1], scale, t.b[i].y);
    convert(b[3 * i + 2], scale, t.b[i].z);
  }
  return t;
}

// crosses: in general position. coplanar: all in the plane of a proper triangle. unsure: of all else.
enum class Answer { disjoint, intersects, crosses, coplanar, unsure };

// A triangle's vertices above and below a plane, and in it: bit i for vertex i. Those in none are not known.
struct Sides {
  unsigned above = 0, below = 0, in = 0;

  GRAZE_HD bool one_side() const { return above == 7 || below == 7; }
  GRAZE_HD bool known() const { return (above | below | in) == 7; }

  // The vertex that is alone on its side, the others being on the other side or in the plane; without branches, which
  // would be mispredicted.
  // Requires: known, neither on one side nor in the plane.   Returns: its place; in `over` whether its side is below.
  GRAZE_HD constexpr unsigned alone(unsigned& over) const {
    if (in == 0) {  // two bits, or one, for each of the eight values of `above`
      over = 0x68u >> above & 1;
      return 0x690u >> 2 * above & 3;
    }
    constexpr unsigned kOneBit = 1u << 1 | 1u << 2 | 1u << 4;
    const unsigned one_above = kOneBit >> above & 1, one_below = kOneBit >> below & 1 & ~one_above;
    over = (one_below | unsigned{above != 0}) & ~one_above & 1;
    return (one_above * above + one_below * below + (1 - one_above - one_below) * in) >> 1;
  }
};

template <class Numbers>
using VecOf = Vec<typename Numbers::D>;

template <class Numbers>
using NormalOf = Vec<typename Numbers::M>;

template <class Numbers>
GRAZE_HD NormalOf<Numbers> normal(const VecOf<Numbers> (&v)[3]) {
  return cross<typename Numbers::M>(v[1] - v[0], v[2] - v[0]);
}

// Sides of q's vertices to the plane of p, whose normal is n.
template <class Numbers>
GRAZE_HD Sides sides(const VecOf<Numbers> (&p)[3], const NormalOf<Numbers>& n, const VecOf<Numbers> (&q)[3],
                     const Numbers& numbers) {
  Sides s;
  for (unsigned i = 0; i < 3; ++i) {
    const auto height = dot<typename Numbers::T>(n, q[i] - p[0]);
    s.above |= unsigned{numbers.positive(height)} << i;
    s.below |= unsigned{numbers.negative(height)} << i;
    s.in |= unsigned{numbers.zero(height)} << i;
  }
  return s;
}

// (s - o) . ((q - o) x (r - o)).
template <class Numbers>
GRAZE_HD typename Numbers::T determinant(const VecOf<Numbers>& o, const VecOf<Numbers>& q, const VecOf<Numbers>& r,
                                         const VecOf<Numbers>& s) {
  return dot<typename Numbers::T>(cross<typename Numbers::M>(q - o, r - o), s - o);
}

// Number i of three. On a device without indexing, which would move all three from registers to memory.
template <class T>
GRAZE_HD T pick(const T& x, const T& y, const T& z, unsigned i) {
  return i == 0 ? x : i == 1 ? y : z;
}

template <class D>
GRAZE_HD Vec<D> pick(const Vec<D> (&v)[3], unsigned i) {
#ifdef __CUDA_ARCH__
  return {pick(v[0].x, v[1].x, v[2].x, i), pick(v[0].y, v[1].y, v[2].y, i), pick(v[0].z, v[1].z, v[2].z, i)};
#else
  return v[i];
#endif
}

GRAZE_HD inline Vec<float> vertex(const float* v, unsigned i) {
#ifdef __CUDA_ARCH__
  return {pick(v[0], v[3], v[6], i), pick(v[1], v[4], v[7], i), pick(v[2], v[5], v[8], i)};
#else
  return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
#endif
}

// The order of vertices in which each triangle has its lone vertex first, and it lies above the other triangle.
struct Turn {
  unsigned a[3], b[3];
};

GRAZE_HD constexpr void turn_to(unsigned first, unsigned over, unsigned (&order)[3]) {
  const unsigned next = 0b001001u >> 2 * first & 3, last = 3 - first - next;
  order[0] = first;
  order[1] = next ^ ((next ^ last) & (0u - over));  // over ? last : next
  order[2] = 3 - first - order[1];
}

GRAZE_HD constexpr Turn lone_vertices(const Sides& of_a, const Sides& of_b) {
  unsigned over_a, over_b;
  const unsigned alone_a = of_a.alone(over_b), alone_b = of_b.alone(over_a);
  Turn turn;
  turn_to(alone_a, over_a, turn.a);
  turn_to(alone_b, over_b, turn.b);
  return turn;
}

// Reference: Guigue and Devillers 2003. Unsure of coplanar and degenerate pairs, whatever the numbers.
template <class Numbers>
GRAZE_HD Answer by_planes(const Triangles<Numbers>& t, const Numbers& numbers = {}) {
  const NormalOf<Numbers> normal_a = normal<Numbers>(t.a);
  const Sides of_b = sides(t.a, normal_a, t.b, numbers);
  if (of_b.one_side()) return Answer::disjoint;
  const NormalOf<Numbers> normal_b = normal<Numbers>(t.b);
  const Sides of_a = sides(t.b, normal_b, t.a, numbers);
  if (of_a.one_side()) return Answer::disjoint;
  if (!of_a.known() || !of_b.known()) return Answer::unsure;
  if (of_b.in == 7 && numbers.is_proper(normal_a)) return Answer::coplanar;
  if (of_a.in == 7 && numbers.is_proper(normal_b)) return Answer::coplanar;
  if (of_a.in == 7 || of_b.in == 7) return Answer::unsure;

  const Turn turn = lone_vertices(of_a, of_b);
  const VecOf<Numbers> a0 = pick(t.a, turn.a[0]), b0 = pick(t.b, turn.b[0]);
  const auto first = determinant<Numbers>(pick(t.a, turn.a[1]), b0, a0, pick(t.b, turn.b[1]));
  const auto second = determinant<Numbers>(a0, b0, pick(t.a, turn.a[2]), pick(t.b, turn.b[2]));
  if (numbers.positive(first) || numbers.positive(second)) return Answer::disjoint;
  if (numbers.negative(first) && numbers.negative(second)) {
    return (of_a.in | of_b.in) == 0 ? Answer::crosses : Answer::intersects;
  }
  const bool known =
      (numbers.negative(first) || numbers.zero(first)) && (numbers.negative(second) || numbers.zero(second));
  return known ? Answer::intersects : Answer::unsure;
}

// The extent of the pair in each axis, each rounded once.
GRAZE_HD inline Vec<double> extent_of(const float* a, const float* b) {
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) {
    float low = a[axis], high = a[axis];
    for (int i = axis; i < 9; i += 3) {
      low = a[i] < low ? a[i] : low;
      high = a[i] > high ? a[i] : high;
      low = b[i] < low ? b[i] : low;
      high = b[i] > high ? b[i] : high;
    }
    extent[axis] = static_cast<double>(high) - static_cast<double>(low);
  }
  return {extent[0], extent[1], extent[2]};
}

// A bound of the error of every determinant of the pair: each is a sum of six products of a difference in x, one in y
// and one in z, none of them larger than the extent of the pair.
GRAZE_HD inline double determinant_error(const Vec<double>& extent) {
  return 6 * kDeterminantError * extent.x * extent.y * extent.z;
}

// Whether both are triangles beyond doubt: a component of a normal is the difference of two products of differences.
GRAZE_HD inline bool both_proper(const float* a, const float* b) {
  const Vec<double> extent = extent_of(a, b);
  const double error_x = 2 * kDeterminantError * extent.y * extent.z,
               error_y = 2 * kDeterminantError * extent.z * extent.x,
               error_z = 2 * kDeterminantError * extent.x * extent.y;
  bool proper = true;
  const float* const triangles[2] = {a, b};
  for (const float* v : triangles) {
    const Vec<double> u{double(v[3]) - v[0], double(v[4]) - v[1], double(v[5]) - v[2]};
    const Vec<double> w{double(v[6]) - v[0], double(v[7]) - v[1], double(v[8]) - v[2]};
    const Vec<double> n = cross<double>(u, w);
    proper = proper &&
             (n.x > error_x || n.x < -error_x || n.y > error_y || n.y < -error_y || n.z > error_z || n.z < -error_z);
  }
  return proper;
}

// The same decision in doubles, with one bound for all: unsure wherever a determinant is smaller. Computed for a and b
// at once, since their parts are the same with a and b exchanged.
#if defined(__SSE2__) && !defined(__CUDACC__)
using Two = double __attribute__((vector_size(16)));

// Bit 0 and bit 1: which of the two exceeds its bound.
inline unsigned exceeds(Two x, Two bound) { return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(x, bound))); }

inline unsigned signs(Two x) { return static_cast<unsigned>(_mm_movemask_pd(x)); }

inline Two exchanged(Two x) { return _mm_shuffle_pd(x, x, 1); }

inline Vec<Two> exchanged(const Vec<Two>& v) { return {exchanged(v.x), exchanged(v.y), exchanged(v.z)}; }

inline Two least(Two x, Two y) { return _mm_min_pd(x, y); }

inline Two most(Two x, Two y) { return _mm_max_pd(x, y); }

inline Two magnitude(Two x) { return _mm_andnot_pd(_mm_set1_pd(-0.0), x); }

// The coordinates of a triangle as doubles, widened two at a time.
struct Widened {
  Two two[5];  // 0 and 1, 2 and 3, 4 and 5, 6 and 7, 8 and 8

  explicit Widened(const float* v) {
    for (int i = 0; i < 4; ++i)
      two[i] = _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(v + 2 * i))));
    two[4] = _mm_set1_pd(v[8]);
  }

  void store(double* to) const {
    for (int i = 0; i < 5; ++i) _mm_storeu_pd(to + 2 * i, two[i]);
  }
};

// Coordinate i of both.
inline Two both(const Widened& l, const Widened& r, int i) {
  return i % 2 == 0 ? _mm_unpacklo_pd(l.two[i / 2], r.two[i / 2]) : _mm_unpackhi_pd(l.two[i / 2], r.two[i / 2]);
}

// Two vertices.
inline Vec<Two> both(const double* l, const double* r) { return {Two{l[0], r[0]}, Two{l[1], r[1]}, Two{l[2], r[2]}}; }

// determinant_error(extent_of(a, b)), twice.   Requires: the vertices of both.
inline Two determinant_error(const Vec<Two> (&v)[3]) {
  const Vec<Two> low{least(least(v[0].x, v[1].x), v[2].x), least(least(v[0].y, v[1].y), v[2].y),
                     least(least(v[0].z, v[1].z), v[2].z)};
  const Vec<Two> high{most(most(v[0].x, v[1].x), v[2].x), most(most(v[0].y, v[1].y), v[2].y),
                      most(most(v[0].z, v[1].z), v[2].z)};
  const Two xy = most(_mm_unpacklo_pd(high.x, high.y), _mm_unpackhi_pd(high.x, high.y)) -
                 least(_mm_unpacklo_pd(low.x, low.y), _mm_unpackhi_pd(low.x, low.y));
  const Two z = most(high.z, exchanged(high.z)) - least(low.z, exchanged(low.z));
  return 6 * kDeterminantError * xy * exchanged(xy) * z;
}

// lone_vertices as a table, for vertices of which none lies in the other's plane: bit 2 i says that vertex i of a is
// below b, and bit 2 i + 1 that vertex i of b is below a. Each vertex by the place of its first coordinate.
struct Turns {
  std::uint8_t a[64][4] = {}, b[64][4] = {};

  constexpr Turns() {
    for (unsigned i = 0; i < 64; ++i) {
      const unsigned below_a = (i & 1) | (i >> 1 & 2) | (i >> 2 & 4),
                     below_b = (i >> 1 & 1) | (i >> 2 & 2) | (i >> 3 & 4);
      const Turn turn = lone_vertices({7 & ~below_a, below_a, 0}, {7 & ~below_b, below_b, 0});
      for (unsigned k = 0; k < 3; ++k) {
        a[i][k] = static_cast<std::uint8_t>(3 * turn.a[k]);
        b[i][k] = static_cast<std::uint8_t>(3 * turn.b[k]);
      }
    }
  }
};
inline constexpr Turns kTurns;

// Its branches are those that most pairs of a kind take alike: one foreseen wrongly costs as much as all that follows
// it.
inline Answer by_planes_quickly(const float* a, const float* b) {
  const Widened wide_a(a), wide_b(b);
  alignas(16) double at_a[10], at_b[10];
  wide_a.store(at_a);
  wide_b.store(at_b);
  Vec<Two> v[3];
  for (int i = 0; i < 3; ++i)
    v[i] = {both(wide_a, wide_b, 3 * i), both(wide_a, wide_b, 3 * i + 1), both(wide_a, wide_b, 3 * i + 2)};
  const Two bound = determinant_error(v);
  // Of the other triangle: the heights are those of a's vertices over b, and of b's over a.
  const Vec<Two> n = exchanged(cross<Two>(v[1] - v[0], v[2] - v[0])), from = exchanged(v[0]);
  const Two height[3] = {dot<Two>(n, v[0] - from), dot<Two>(n, v[1] - from), dot<Two>(n, v[2] - from)};
  const Two lowest = least(least(height[0], height[1]), height[2]);
  const Two highest = most(most(height[0], height[1]), height[2]);
  if ((exceeds(lowest, bound) | exceeds(-highest, bound)) != 0) return Answer::disjoint;
  const Two nearest = least(least(magnitude(height[0]), magnitude(height[1])), magnitude(height[2]));
  if (exceeds(nearest, bound) != 3) return Answer::unsure;

  const unsigned below = signs(height[0]) | signs(height[1]) << 2 | signs(height[2]) << 4;
  const auto &turn_a = kTurns.a[below], &turn_b = kTurns.b[below];
  const double *a0 = at_a + turn_a[0], *b0 = at_b + turn_b[0];
  const Vec<Two> o = both(at_a + turn_a[1], a0), p = both(b0, b0), q = both(a0, at_a + turn_a[2]),
                 r = both(at_b + turn_b[1], at_b + turn_b[2]);
  const Two between = dot<Two>(cross<Two>(p - o, q - o), r - o);
  const unsigned beside = exceeds(between, bound) != 0, crosses = exceeds(-between, bound) == 3;
  constexpr Answer kAnswers[] = {Answer::unsure, Answer::disjoint, Answer::crosses};
  return kAnswers[beside | crosses << 1];
}
#else
struct Two {
  double part[2];
  GRAZE_HD double operator[](int i) const { return part[i]; }
  GRAZE_HD Two operator-() const { return {-part[0], -part[1]}; }
  GRAZE_HD friend Two operator+(Two l, Two r) { return {l[0] + r[0], l[1] + r[1]}; }
  GRAZE_HD friend Two operator-(Two l, Two r) { return {l[0] - r[0], l[1] - r[1]}; }
  GRAZE_HD friend Two operator*(Two l, Two r) { return {l[0] * r[0], l[1] * r[1]}; }
};
GRAZE_HD inline unsigned exceeds(const Two& x, const Two& bound) {
  return unsigned{x[0] > bound[0]} | unsigned{x[1] > bound[1]} << 1;
}

GRAZE_HD inline Two exchanged(const Two& x) { return Two{x[1], x[0]}; }

GRAZE_HD inline Vec<Two> both(const Vec<float>& l, const Vec<float>& r) {
  return {Two{double(l.x), double(r.x)}, Two{double(l.y), double(r.y)}, Two{double(l.z), double(r.z)}};
}

GRAZE_HD inline Answer by_planes_quickly(const float* a, const float* b) {
  const double error = determinant_error(extent_of(a, b));
  const Two bound = {error, error};
  const Vec<Two> v[3] = {both(vertex(a, 0), vertex(b, 0)), both(vertex(a, 1), vertex(b, 1)),
                         both(vertex(a, 2), vertex(b, 2))};
  const Vec<Two> n = cross<Two>(v[1] - v[0], v[2] - v[0]);
  unsigned above[3], below[3];  // of each vertex: bit 0 of b's, bit 1 of a's
  for (int i = 0; i < 3; ++i) {
    const Two height = dot<Two>(n, Vec<Two>{exchanged(v[i].x), exchanged(v[i].y), exchanged(v[i].z)} - v[0]);
    above[i] = exceeds(height, bound);
    below[i] = exceeds(-height, bound);
  }
  if (((above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2])) != 0) return Answer::disjoint;
  if (((above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2])) != 3) return Answer::unsure;

  const unsigned above_a = above[0] >> 1 | (above[1] >> 1) << 1 | (above[2] >> 1) << 2;
  const unsigned above_b = (above[0] & 1) | (above[1] & 1) << 1 | (above[2] & 1) << 2;
  const Turn turn = lone_vertices({above_a, 7 & ~above_a, 0}, {above_b, 7 & ~above_b, 0});
  const Vec<float> a0 = vertex(a, turn.a[0]), b0 = vertex(b, turn.b[0]);
  const Vec<Two> o = both(vertex(a, turn.a[1]), a0), p = both(b0, b0), q = both(a0, vertex(a, turn.a[2])),
                 r = both(vertex(b, turn.b[1]), vertex(b, turn.b[2]));
  const Two height = dot<Two>(cross<Two>(p - o, q - o), r - o);
  if (exceeds(height, bound) != 0) return Answer::disjoint;
  return exceeds(-height, bound) == 3 ? Answer::crosses : Answer::unsure;
}
#endif

template <class T>
GRAZE_HD T least(const T (&v)[3]) {
  const T& m = v[1] < v[0] ? v[1] : v[0];
  return v[2] < m ? v[2] : m;
}

template <class T>
GRAZE_HD T most(const T (&v)[3]) {
  const T& m = v[1] > v[0] ? v[1] : v[0];
  return v[2] > m ? v[2] : m;
}

// What the axes looked at so far have shown.
struct Seen {
  bool separated = false;
  bool touching = false;            // the origin lies on a face of D that is not all of D
  bool flat = true;                 // D has no volume
  bool coplanar = true;             // nor has the hull of all six points
  unsigned face_a = 7, face_b = 7;  // the vertices that may belong to the common set

  // The projections of the vertices on an axis.
  template <class T>
  GRAZE_HD void look(const T (&a)[3], const T (&b)[3]) {
    const T least_a = least(a), most_a = most(a), least_b = least(b), most_b = most(b);
    const bool extends = least_a < most_a || least_b < most_b;
    separated = separated || most_a < least_b || most_b < least_a;
    flat = flat && !extends;
    coplanar = coplanar && !extends && least_a == least_b;
    if (most_a == least_b) touch(a, b, most_a, extends);
    if (most_b == least_a) touch(a, b, least_a, extends);
  }

  template <class T>
  GRAZE_HD void touch(const T (&a)[3], const T (&b)[3], const T& at, bool extends) {
    touching = touching || extends;
    for (unsigned i = 0; i < 3; ++i) {
      if (!(a[i] == at)) face_a &= ~(1u << i);
      if (!(b[i] == at)) face_b &= ~(1u << i);
    }
  }
};

template <class Numbers>
GRAZE_HD void look_along(const Triangles<Numbers>& t, const Vec<typename Numbers::M>& n, Seen& seen) {
  using T = typename Numbers::T;
  T a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = dot<T>(n, t.a[i] - t.a[0]);
    b[i] = dot<T>(n, t.b[i] - t.a[0]);
  }
  seen.look(a, b);
}

// Square to each edge, in the projection on a coordinate plane.
template <class Numbers>
GRAZE_HD void look_in_plane(const Triangles<Numbers>& t, typename Numbers::D VecOf<Numbers>::*x,
                            typename Numbers::D VecOf<Numbers>::*y, Seen& seen) {
  using M = typename Numbers::M;
  for (int edge = 0; edge < 6; ++edge) {
    const VecOf<Numbers>* v = edge < 3 ? t.a : t.b;
    const int from = edge % 3, to = from == 2 ? 0 : from + 1;
    const VecOf<Numbers> e = v[to] - v[from];
    M a[3], b[3];
    for (int i = 0; i < 3; ++i) {
      const VecOf<Numbers> p = t.a[i] - t.a[0], q = t.b[i] - t.a[0];
      a[i] = M(e.*x) * (p.*y) - M(e.*y) * (p.*x);
      b[i] = M(e.*x) * (q.*y) - M(e.*y) * (q.*x);
    }
    seen.look(a, b);
  }
}

// The axes that decide when D lies in a plane through the origin, n being its normal: the projection along a
// coordinate axis that is not square to n keeps it in shape, and its edges are edges of a and b. Without a normal D is
// a segment or a point: then some projection shows it beside the origin, or else some coordinate.
template <class Numbers>
GRAZE_HD void look_flat(const Triangles<Numbers>& t, const NormalOf<Numbers>& n, Seen& seen) {
  using D = typename Numbers::D;
  using V = VecOf<Numbers>;
  const typename Numbers::M zero(0);
  const bool none = is_zero(n);
  if (none || !(n.z == zero)) look_in_plane<Numbers>(t, &V::x, &V::y, seen);
  if (none || (n.z == zero && !(n.x == zero))) look_in_plane<Numbers>(t, &V::y, &V::z, seen);
  if (none || (n.z == zero && n.x == zero)) look_in_plane<Numbers>(t, &V::z, &V::x, seen);
  if (!none) return;
  D V::*const axes[3] = {&V::x, &V::y, &V::z};
  for (D V::*x : axes) {
    const D a[3] = {t.a[0].*x, t.a[1].*x, t.a[2].*x}, b[3] = {t.b[0].*x, t.b[1].*x, t.b[2].*x};
    seen.look(a, b);
  }
}

// The axes that decide. When D has a volume, its faces are square to 11 axes: the normals of a and b, and the products
// of their edges. When it has none, they show whether its plane holds the origin. An axis too many does no harm.
template <class Numbers>
GRAZE_HD Seen look(const Triangles<Numbers>& t, bool verdict_only) {
  Seen seen;
  const typename Numbers::M zero(0);
  NormalOf<Numbers> n{zero, zero, zero};
  for (int axis = 0; axis < 11 && !(verdict_only && seen.separated); ++axis) {
    const int i = axis / 3, j = axis % 3;
    const NormalOf<Numbers> along =
        axis == 10  ? normal<Numbers>(t.a)
        : axis == 9 ? normal<Numbers>(t.b)
                    : cross<typename Numbers::M>(t.a[i == 2 ? 0 : i + 1] - t.a[i], t.b[j == 2 ? 0 : j + 1] - t.b[j]);
    look_along<Numbers>(t, along, seen);
    if (is_zero(n)) n = along;
  }
  if (seen.separated || !seen.flat) return seen;
  Seen in_plane;
  look_flat<Numbers>(t, n, in_plane);
  in_plane.flat = true;
  in_plane.coplanar = seen.coplanar;
  return in_plane;
}

// Rank of up to four vectors.
template <class Numbers>
GRAZE_HD int rank(const VecOf<Numbers> (&v)[4]) {
  using M = typename Numbers::M;
  using T = typename Numbers::T;
  int most_so_far = 0;
  for (int i = 0; i < 4; ++i) {
    if (is_zero(v[i])) continue;
    most_so_far = most_so_far < 1 ? 1 : most_so_far;
    for (int j = 0; j < i; ++j) {
      const Vec<M> n = cross<M>(v[i], v[j]);
      if (is_zero(n)) continue;
      most_so_far = most_so_far < 2 ? 2 : most_so_far;
      for (int k = 0; k < j; ++k) {
        if (!(dot<T>(n, v[k]) == T(0))) return 3;
      }
    }
  }
  return most_so_far;
}

// The directions that the vertices in the mask span; zero vectors for the rest.
template <class D>
GRAZE_HD void directions(const Vec<D> (&v)[3], unsigned mask, Vec<D>& first, Vec<D>& second) {
  const int from = mask & 1 ? 0 : mask & 2 ? 1 : 2;
  first = mask & 2 ? v[1] - v[from] : v[0] - v[0];
  second = mask & 4 ? v[2] - v[from] : v[0] - v[0];
}

// When a and b meet, the origin lies inside one face F of D, which is the difference of a face A of a and a face B of
// b; their insides meet, so the common set, which is that of A and B, has dimension dim A + dim B - dim F.
template <class Numbers>
GRAZE_HD Relation by_axes(const Triangles<Numbers>& t) {
  const Seen seen = look<Numbers>(t, false);
  VecOf<Numbers> v[4];
  const VecOf<Numbers> zero = t.a[0] - t.a[0];
  const auto dimension = [&](unsigned in_a, unsigned in_b) {
    v[0] = v[1] = v[2] = v[3] = zero;
    if (in_a) directions(t.a, in_a, v[0], v[1]);
    if (in_b) directions(t.b, in_b, v[2], v[3]);
    return rank<Numbers>(v);
  };
  Relation r;
  r.dimension_a = dimension(7, 0);
  r.dimension_b = dimension(0, 7);
  r.coplanar = seen.coplanar;
  r.intersects = !seen.separated;
  if (seen.separated) return r;
  r.margin_sign = seen.flat || seen.touching ? 0 : -1;
  r.contact = dimension(seen.face_a, 0) + dimension(0, seen.face_b) - dimension(seen.face_a, seen.face_b);
  return r;
}

template <class Numbers>
GRAZE_HD bool decide(const float* a, const float* b, int exponent) {
  const Triangles<Numbers> t = triangles<Numbers>(a, b, exponent);
  const Answer answer = by_planes(t);
  if (answer == Answer::unsure) return !look<Numbers>(t, true).separated;
  if (answer != Answer::coplanar) return answer != Answer::disjoint;
  const NormalOf<Numbers> n = normal<Numbers>(t.a);
  Seen seen;
  look_flat<Numbers>(t, is_zero(n) ? normal<Numbers>(t.b) : n, seen);
  return !seen.separated;
}

// A vertex of a that is a vertex of b, as 3 * its place in a + that in b; -1 without one.
GRAZE_HD inline int shared_vertex(const float* a, const float* b) {
  int found = -1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool same = a[3 * i] == b[3 * j] && a[3 * i + 1] == b[3 * j + 1] && a[3 * i + 2] == b[3 * j + 2];
      found = same ? 3 * i + j : found;
    }
  }
  return found;
}

// The decision after the first attempt.
GRAZE_HD inline bool intersects_unsure(const float* a, const float* b, Stage& stage) {
  stage = Stage::bounded;
  if (shared_vertex(a, b) >= 0) return true;
  const Grid grid = grid_of(a, b);
  stage = grid.bits <= kDoubleBits ? Stage::doubles : Stage::int128;
  if (grid.bits <= kDoubleBits) return decide<DoubleNumbers>(a, b, 0);
  if (grid.bits <= kNarrowBits) return decide<NarrowNumbers>(a, b, grid.exponent);
  if (grid.bits <= kIntBits) return decide<IntNumbers>(a, b, grid.exponent);
  stage = Stage::bounded;
  const Answer answer = by_planes(triangles<BoundedNumbers>(a, b));
  if (answer != Answer::unsure) return answer != Answer::disjoint;
  stage = Stage::wide;
  return grid.bits <= kLongBits ? decide<LongNumbers>(a, b, grid.exponent) : decide<WideNumbers>(a, b, 0);
}

}  // namespace detail

// Whether the closed triangles a and b, each three vertices x y z, share a point.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline bool intersects(const float* a, const float* b, Stage* stage = nullptr) {
  using namespace detail;
  Stage decided = Stage::bounded;
  const Answer answer = by_planes_quickly(a, b);
  const bool result = answer == Answer::unsure ? intersects_unsure(a, b, decided) : answer != Answer::disjoint;
  if (stage) *stage = decided;
  return result;
}

namespace detail {

// The relation of two triangles with one vertex in common, seen from it. Let p and q be the signs of the heights of b's
// other vertices over a's plane and of a's over b's. Some plane through the vertex leaves a on one side and b on the
// other if that of a does (p is the same twice), or that of b, or one spanned by an edge of each; the determinants of
// these are the same four numbers. Then the triangles meet in the vertex alone; else in a segment that ends there.
// Returns: false when a sign is in doubt.
GRAZE_HD inline bool relate_at_vertex(const float* a, const float* b, int shared, Relation& r) {
  const double error = determinant_error(extent_of(a, b));
  const unsigned i = static_cast<unsigned>(shared) / 3, j = static_cast<unsigned>(shared) % 3;
  const auto seen = [](const float* v, unsigned k, const Vec<float>& from) {
    const Vec<float> at = vertex(v, k);
    return Vec<double>{double(at.x) - from.x, double(at.y) - from.y, double(at.z) - from.z};
  };
  const Vec<float> from = vertex(a, i);
  const Vec<double> a1 = seen(a, (i + 1) % 3, from), a2 = seen(a, (i + 2) % 3, from);
  const Vec<double> b1 = seen(b, (j + 1) % 3, from), b2 = seen(b, (j + 2) % 3, from);
  const Vec<double> normal_a = cross<double>(a1, a2), normal_b = cross<double>(b1, b2);
  const double heights[4] = {dot<double>(normal_a, b1), dot<double>(normal_a, b2), dot<double>(normal_b, a1),
                             dot<double>(normal_b, a2)};
  unsigned above = 0;
  for (unsigned k = 0; k < 4; ++k) {
    if (!(heights[k] > error || heights[k] < -error)) return false;
    above |= unsigned{heights[k] > 0} << k;
  }
  const bool p1 = above & 1, p2 = above >> 1 & 1, q1 = above >> 2 & 1, q2 = above >> 3 & 1;
  const bool parted = p1 == p2 || q1 == q2 || p1 == q1;
  r = {true, parted ? 0 : 1, parted ? 0 : -1, 2, 2, false};
  return true;
}

// The relation of pairs in general position: they cross, a plane or an edge of both parts them, or they share a vertex.
// Returns: false when that is not beyond doubt.
GRAZE_HD inline bool relate_quickly(const float* a, const float* b, Relation& r) {
  const Answer answer = by_planes_quickly(a, b);
  if (answer == Answer::unsure) {
    const int shared = shared_vertex(a, b);
    return shared >= 0 && relate_at_vertex(a, b, shared, r);
  }
  r = answer == Answer::crosses ? Relation{true, 1, -1, 2, 2, false} : Relation{};
  // A determinant that is certainly not zero parts them: they are not coplanar.
  return answer == Answer::crosses || (answer == Answer::disjoint && both_proper(a, b));
}

}  // namespace detail

// Contact, margin's sign and shape as well.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline Relation relation(const float* a, const float* b) {
  using namespace detail;
  Relation r;
  if (relate_quickly(a, b, r)) return r;
  const Grid grid = grid_of(a, b);
  return grid.bits <= kDoubleBits   ? by_axes(triangles<DoubleNumbers>(a, b))
         : grid.bits <= kNarrowBits ? by_axes(triangles<NarrowNumbers>(a, b, grid.exponent))
         : grid.bits <= kIntBits    ? by_axes(triangles<IntNumbers>(a, b, grid.exponent))
         : grid.bits <= kLongBits   ? by_axes(triangles<LongNumbers>(a, b, grid.exponent))
                                    : by_axes(triangles<WideNumbers>(a, b));
}

}  // namespace graze::exact
