// SPDX-License-Identifier: Apache-2.0
// Sums and products are computed in double and rounded once, to the coordinate type. If the result is not exact, the
// move leads to a nearby pair.
#include "core/simplify/moves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/simplify/simplicity.h"

namespace graze {
namespace {

template <class Real>
using Pairs = std::vector<BasicPair<Real>>;

// The number of bits in the finest lattice that coordinates are rounded to; nearest_whole takes no more than 51.
template <class Real>
constexpr int kLatticeBits = std::min(std::numeric_limits<Real>::digits, 51);

template <class Real>
const Vec3<Real>& vertex(const BasicPair<Real>& pair, int i) {
  return i < 3 ? pair.a[i] : pair.b[i - 3];
}
template <class Real>
Vec3<Real>& vertex(BasicPair<Real>& pair, int i) {
  return i < 3 ? pair.a[i] : pair.b[i - 3];
}

template <class Real>
void append(Pairs<Real>& moved, const BasicPair<Real>& pair) {
  if (is_finite(pair)) moved.push_back(pair);
}

// Appends the pair with coordinate i = make(i), rounded, unless a coordinate overflows.
template <class Real, class Make>
void append_each(Pairs<Real>& moved, Make make) {
  BasicPair<Real> result;
  for (int i = 0; i < kCoordinates; ++i) coordinates(result)[i] = static_cast<Real>(make(i));
  append(moved, result);
}

// 2^exponent, exactly; 0 or infinite beyond double's exponents. Avoids std::ldexp, which took half the time of a move.
double power_of_two(int exponent) {
  if (exponent < -1022 || exponent > 1023) return std::ldexp(1.0, exponent);
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

// Requires: |x| < 2^51, rounding to nearest.   Returns: std::nearbyint(x), sign of zero included.
double nearest_whole(double x) {
  constexpr double kWholeFromHere = 0x1.8p52;
  return std::copysign((x + kWholeFromHere) - kWholeFromHere, x);
}

// Appends the pair rounded to each lattice. origin: a vertex to translate to the origin first; -1 for no translation.
template <class Real>
void lattices(const BasicPair<Real>& pair, int origin, Pairs<Real>& moved) {
  double seen[kCoordinates], largest = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    const double from = origin < 0 ? 0.0 : double{component(vertex(pair, origin), i % 3)};
    seen[i] = double{coordinates(pair)[i]} - from;
    largest = std::max(largest, std::fabs(seen[i]));
  }
  if (largest == 0) return;
  if (origin >= 0) append_each(moved, [&](int i) { return seen[i]; });
  const int top = std::ilogb(largest) + 1;
  for (int bits = 1; bits <= kLatticeBits<Real>; ++bits) {
    const double to_whole = power_of_two(bits - top), back = power_of_two(top - bits),
                 about_one = power_of_two(1 - bits);
    double whole[kCoordinates];
    for (int i = 0; i < kCoordinates; ++i) whole[i] = nearest_whole(seen[i] * to_whole);
    append_each(moved, [&](int i) { return whole[i]; });
    append_each(moved, [&](int i) { return whole[i] * back; });
    append_each(moved, [&](int i) { return whole[i] * about_one; });
  }
}

using Point = Vec3<double>;

template <class Real>
Point point(const BasicPair<Real>& pair, int i) {
  const Vec3<Real>& v = vertex(pair, i);
  return {double{v.x}, double{v.y}, double{v.z}};
}

// Appends the pair in the frame with this origin and axes u, v and w: unrounded, and rounded to each lattice.
template <class Real>
void in_frame(const BasicPair<Real>& pair, const Point& origin, const Point& u, const Point& v, const Point& w,
              Pairs<Real>& moved) {
  const Point vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
  const double volume = dot(u, vw);
  if (volume == 0) return;
  double seen[kCoordinates], largest = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    const Point from = point(pair, i / 3) - origin;
    seen[i] = dot(from, i % 3 == 0 ? vw : i % 3 == 1 ? wu : uv) / volume;
    largest = std::max(largest, std::fabs(seen[i]));
  }
  if (!std::isfinite(largest) || largest == 0) return;
  append_each(moved, [&](int i) { return seen[i]; });
  const int top = std::ilogb(largest) + 1;
  if (top > 1000 || top < -900) return;  // near the limits of a double's exponents
  for (int bits = 1; bits <= kLatticeBits<Real>; ++bits) {
    const double to_whole = power_of_two(bits - top), back = power_of_two(top - bits);
    append_each(moved, [&](int i) { return nearest_whole(seen[i] * to_whole) * back; });
  }
}

// Maps four vertices to the origin and the ends of the unit vectors.
template <class Real>
void frames(const BasicPair<Real>& pair, int origin, Pairs<Real>& moved) {
  const auto from_origin = [&](int i) { return point(pair, i) - point(pair, origin); };
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) {
      if (i == origin || j == origin) continue;
      for (int k = 0; k < j; ++k) {
        if (k != origin) in_frame(pair, point(pair, origin), from_origin(k), from_origin(j), from_origin(i), moved);
      }
    }
  }
}

template <class Real>
void replace_vertex(const BasicPair<Real>& pair, int v, Pairs<Real>& moved) {
  BasicPair<Real> result = pair;
  for (int other = 0; other < 6; ++other) {
    vertex(result, v) = vertex(pair, other);
    moved.push_back(result);
  }
  for (int point = 0; point < 27; ++point) {
    const auto digit = [point](int power) { return static_cast<Real>(point / power % 3 - 1); };
    vertex(result, v) = {digit(1), digit(3), digit(9)};
    moved.push_back(result);
  }
  for (int p = 0; p < 6; ++p) {
    for (int q = 0; q < p; ++q) {
      for (int r = 0; r < 6; ++r) {
        if (r == p || r == q) continue;
        append_each(moved, [&](int c) {
          if (c / 3 != v) return double{coordinates(pair)[c]};
          const auto at = [&](int other) { return double{component(vertex(pair, other), c % 3)}; };
          return at(p) + at(q) - at(r);
        });
      }
    }
  }
}

// Replaces two coordinates, each by 0, 1 or -1.
template <class Real>
void replace_two(const BasicPair<Real>& pair, int first, Pairs<Real>& moved) {
  for (int second = 0; second < first; ++second) {
    for (const int one : {0, 1, -1}) {
      for (const int other : {0, 1, -1}) {
        BasicPair<Real> result = pair;
        coordinates(result)[first] = static_cast<Real>(one);
        coordinates(result)[second] = static_cast<Real>(other);
        moved.push_back(result);
      }
    }
  }
}

// Subtracts a multiple of one axis from another. The factor is a quotient that makes some vertex's coordinate 0, or
// the whole number nearest to such a quotient.
template <class Real>
void shear(const BasicPair<Real>& pair, int axis, int other, Pairs<Real>& moved) {
  for (int v = 0; v < 6; ++v) {
    const double quotient = double{component(vertex(pair, v), axis)} / component(vertex(pair, v), other);
    for (const double times : {quotient, std::nearbyint(quotient)}) {
      append_each(moved, [&](int c) {
        const double taken = c % 3 == axis ? times * component(vertex(pair, c / 3), other) : 0.0;
        return double{coordinates(pair)[c]} - taken;
      });
    }
  }
}

template <class Real>
void change_axis(const BasicPair<Real>& pair, int axis, Pairs<Real>& moved) {
  std::vector<Real> values{0, 1, -1};
  for (int v = 0; v < 6; ++v) values.push_back(component(vertex(pair, v), axis));
  for (std::size_t i = 3; i < values.size(); ++i) {
    append_each(moved, [&](int c) { return double{coordinates(pair)[c]} - (c % 3 == axis ? double{values[i]} : 0.0); });
    if (values[i] == 0) continue;
    const int exponent = std::ilogb(values[i]);
    append_each(moved, [&](int c) { return std::ldexp(coordinates(pair)[c], c % 3 == axis ? -exponent : 0); });
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  for (unsigned vertices = 1; vertices < 64; ++vertices) {
    if (std::has_single_bit(vertices)) continue;
    for (const Real value : values) {
      BasicPair<Real> result = pair;
      for (int v = 0; v < 6; ++v) {
        if (vertices >> v & 1u) component(vertex(result, v), axis) = value;
      }
      moved.push_back(result);
    }
  }
}

// The candidates that may replace a value in its pair.
template <class Real>
std::vector<Real> replacements(const BasicPair<Real>& pair, Real value) {
  using Bits = BitsOf<Real>;
  std::vector<Real> found{0, value / 2, value * 2};
  for (int n = 1; n <= 9; ++n) found.push_back(static_cast<Real>(n));
  for (int i = 0; i < kCoordinates; ++i) found.push_back(coordinates(pair)[i]);
  const std::size_t either_sign = found.size();
  for (std::size_t i = 0; i < either_sign; ++i) found.push_back(-found[i]);

  found.push_back(std::trunc(value));
  found.push_back(std::trunc(value) + std::copysign(Real{1}, value));
  const auto bits = std::bit_cast<Bits>(value);
  for (int dropped = 1; dropped < std::numeric_limits<Real>::digits; ++dropped) {
    const Bits lower = bits >> dropped << dropped;
    found.push_back(std::bit_cast<Real>(lower));
    found.push_back(std::bit_cast<Real>(static_cast<Bits>(lower + (Bits{1} << dropped))));
  }
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  found.push_back(std::nextafter(value, kInfinity));
  found.push_back(std::nextafter(value, -kInfinity));

  const auto rank = [](Real x) { return std::rotl(std::bit_cast<Bits>(x), 1); };
  std::erase_if(found, [](Real x) { return !std::isfinite(x); });
  std::sort(found.begin(), found.end(), [&](Real l, Real r) { return rank(l) < rank(r); });
  const auto last = std::unique(found.begin(), found.end(), [&](Real l, Real r) { return rank(l) == rank(r); });
  found.erase(last, found.end());
  return found;
}

template <class Real>
void replace_value(const BasicPair<Real>& pair, int at, Pairs<Real>& moved) {
  const Real* c = coordinates(pair);
  const Real value = c[at];
  const auto same = [value](Real x) { return std::fabs(x) == std::fabs(value); };
  if (std::any_of(c, c + at, same)) return;  // already done for its first occurrence
  for (const Real with : replacements(pair, value)) {
    BasicPair<Real> result = pair;
    for (int i = at; i < kCoordinates; ++i) {
      if (same(c[i])) coordinates(result)[i] = std::signbit(c[i]) == std::signbit(value) ? with : -with;
    }
    moved.push_back(result);
  }
}

template <class Real>
void replace_coordinate(const BasicPair<Real>& pair, int at, Pairs<Real>& moved) {
  for (const Real with : replacements(pair, coordinates(pair)[at])) {
    BasicPair<Real> result = pair;
    coordinates(result)[at] = with;
    moved.push_back(result);
  }
}

template <class Real>
void rearrange(const BasicPair<Real>& pair, Pairs<Real>& moved) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    BasicPair<Real> vertices_a = pair, vertices_b = pair, axes = pair, mirrored = pair;
    std::swap(vertices_a.a[i], vertices_a.a[j]);
    std::swap(vertices_b.b[i], vertices_b.b[j]);
    for (int v = 0; v < 6; ++v) {
      std::swap(component(vertex(axes, v), i), component(vertex(axes, v), j));
      component(vertex(mirrored, v), i) *= -1;
    }
    moved.insert(moved.end(), {vertices_a, vertices_b, axes, mirrored});
    for (const int other : {j, (i + 2) % 3}) {
      for (const double times : {-2.0, -1.0, 1.0, 2.0}) {
        append_each(moved, [&](int c) {
          const double added = c % 3 == i ? times * component(vertex(pair, c / 3), other) : 0.0;
          return double{coordinates(pair)[c]} + added;
        });
      }
      shear(pair, i, other, moved);
    }
  }
  BasicPair<Real> exchanged = pair;
  std::swap(exchanged.a, exchanged.b);
  moved.push_back(exchanged);
  const auto scaled = [&](int exponent) {
    append_each(moved, [&](int i) { return std::ldexp(coordinates(pair)[i], exponent); });
  };
  scaled(1);
  scaled(-1);
  for (int i = 0; i < kCoordinates; ++i) {
    if (coordinates(pair)[i] != 0) scaled(-std::ilogb(coordinates(pair)[i]));
  }
}

// Kinds of moves, in the order of moves.h: their number, and the function that appends the moves of the i-th kind.
template <class Real>
struct Moves {
  int kinds;
  void (*append)(const BasicPair<Real>& pair, int i, Pairs<Real>& moved);
};
template <class Real>
constexpr Moves<Real> kMoves[] = {
    {7, [](const BasicPair<Real>& pair, int i, Pairs<Real>& moved) { lattices(pair, i - 1, moved); }},
    {6, replace_vertex<Real>},
    {3, change_axis<Real>},
    {kCoordinates, replace_value<Real>},
    {kCoordinates, replace_coordinate<Real>},
    {kCoordinates, replace_two<Real>},
    {1, [](const BasicPair<Real>& pair, int, Pairs<Real>& moved) { rearrange(pair, moved); }},
    {6, frames<Real>},
};

constexpr int sum_of_kinds() {
  int sum = 0;
  for (const auto& row : kMoves<float>) sum += row.kinds;
  return sum;
}
static_assert(sum_of_kinds() == kMoveKinds);

}  // namespace

template <class Real>
void append_moves(const BasicPair<Real>& pair, int kind, Pairs<Real>& moved) {
  for (const auto& row : kMoves<Real>) {
    if (kind < row.kinds) return row.append(pair, kind, moved);
    kind -= row.kinds;
  }
}

template <class Real>
Pairs<Real> simpler_moves(const BasicPair<Real>& pair, int kind, std::size_t& made) {
  thread_local Pairs<Real> moved;
  moved.clear();
  append_moves(pair, kind, moved);
  made += moved.size();
  const std::uint64_t now = simplicity_counts(pair);
  struct Simpler {
    std::uint64_t counts;
    const BasicPair<Real>* pair;
  };
  thread_local std::vector<Simpler> order;
  order.clear();
  for (const BasicPair<Real>& m : moved) {
    const std::uint64_t counts = simplicity_counts(m, now);
    if (counts < now || (counts == now && simpler_coordinates(m, pair))) order.push_back({counts, &m});
  }
  std::sort(order.begin(), order.end(), [](const Simpler& l, const Simpler& r) {
    return l.counts != r.counts ? l.counts < r.counts : simpler_coordinates(*l.pair, *r.pair);
  });
  Pairs<Real> simpler;
  simpler.reserve(order.size());
  for (const Simpler& next : order) {
    if (simpler.empty() || simpler_coordinates(simpler.back(), *next.pair) ||
        simpler_coordinates(*next.pair, simpler.back()))
      simpler.push_back(*next.pair);
  }
  return simpler;
}

template void append_moves(const Pair&, int, std::vector<Pair>&);
template void append_moves(const DoublePair&, int, std::vector<DoublePair>&);
template std::vector<Pair> simpler_moves(const Pair&, int, std::size_t&);
template std::vector<DoublePair> simpler_moves(const DoublePair&, int, std::size_t&);

}  // namespace graze
