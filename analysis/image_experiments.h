// SPDX-License-Identifier: Apache-2.0
// Experiments on foreign code with images of a pair, which have the pair's truth: one for pairs on which nothing
// rounds, and one for pairs on which something may round.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/experiments.h"
#include "analysis/neighbours.h"
#include "analysis/scales.h"
#include "core/relation_of.h"

namespace graze::analysis {
namespace detail {

inline int count_of(const std::vector<bool>& right) {
  return static_cast<int>(std::count(right.begin(), right.end(), true));
}

// Whether no sum of 32 products of this many coordinates or differences rounds, for the pair times `scale`.
template <class Real>
bool holds_products(const BasicPair<Real>& pair, Scalar scalar, int factors, int scale) {
  const Size size(pair);
  const int digits = limits_of(scalar).digits;
  if (size.is_zero() || size.high - size.low > digits) return false;
  Real largest = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    for (int j = i % 3; j <= i; j += 3) {
      const Real c = coordinates(pair)[i];
      largest = std::max({largest, std::fabs(c), std::fabs(c - coordinates(pair)[j])});
    }
  }
  return std::pow(scale * std::ldexp(double{largest}, -size.low), factors) <= std::ldexp(1.0, digits - 5);
}

template <class Real>
bool is_degenerate(const BasicPair<Real>& pair) {
  const Hulls hulls = relation_of(pair).hulls;
  return hulls.dimension_a < 2 || hulls.dimension_b < 2;
}

// The pair with its triangles moved together or apart, where that changes the truth.
template <class Real>
std::vector<BasicPair<Real>> pairs_of_other_truth(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result;
  const auto add = [&, truth = relation_of(pair).verdict](const BasicPair<Real>& other) {
    if (is_finite(other) && relation_of(other).verdict != truth) result.push_back(other);
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {  // vertex j of B is moved to vertex i of A
      BasicPair<Real> together = pair;
      for (Vec3<Real>& v : together.b) v = v + (pair.a[i] - pair.b[j]);
      add(together);
    }
  }
  const Real step = std::ldexp(Real{1}, Size(pair).largest_difference + 2);
  for (int c = 0; c < 3; ++c) {
    BasicPair<Real> apart = pair;
    for (Vec3<Real>& v : apart.b) component(v, c) += step;
    add(apart);
  }
  add({{pair.a[0], pair.a[1], pair.a[2]}, {pair.a[0], pair.a[1], pair.a[2]}});
  return result;
}

// Multiplies all coordinates by `factor`, then adds axis `from` to axis `to` if they differ. The truth stays the same,
// and if the factor is 1, so does every determinant. Longer products change.
struct Image {
  int factor, from, to;
};

template <class Real>
std::vector<BasicPair<Real>> changed(std::vector<BasicPair<Real>> pairs, const Image& image) {
  for (BasicPair<Real>& pair : pairs) {
    Real* const c = coordinates(pair);
    for (int i = 0; i < kCoordinates; ++i) c[i] *= static_cast<Real>(image.factor);
    for (int i = 0; i < kCoordinates && image.from != image.to; i += 3) c[i + image.to] += c[i + image.from];
  }
  return pairs;
}

// The translations that move a vertex to the origin, if they are exact.
template <class Real>
std::vector<BasicPair<Real>> to_vertices(const BasicPair<Real>& pair, const Size& size) {
  std::vector<BasicPair<Real>> result;
  if (size.high - size.low + 1 > 53) return result;  // differences are exact in doubles only up to this size
  for (const Vec3<Real>* vertex = pair.a; vertex != pair.a + 6; ++vertex) {
    BasicPair<Real> moved;
    bool exact = true;
    for (int i = 0; i < kCoordinates; ++i) {
      const double difference = double{coordinates(pair)[i]} - (&vertex->x)[i % 3];
      coordinates(moved)[i] = static_cast<Real>(difference);
      exact = exact && coordinates(moved)[i] == difference;
    }
    if (exact) result.push_back(moved);
  }
  return result;
}

// Rounds the pair to fewer bits, if that keeps its truth and shape.
template <class Real>
std::vector<BasicPair<Real>> snapped(const BasicPair<Real>& pair, const Size& size) {
  std::vector<BasicPair<Real>> result;
  const Relation own = relation_of(pair);
  for (const int bits : {1, 2, 3, 4, 6, 8, 10, 12, 16, 20}) {
    if (bits >= size.high - size.low) break;
    BasicPair<Real> rounded = pair;
    const int unit = size.high - bits;
    for (int i = 0; i < kCoordinates; ++i)
      coordinates(rounded)[i] = std::ldexp(std::nearbyint(std::ldexp(coordinates(pair)[i], -unit)), unit);
    if (!is_finite(rounded)) continue;
    const Relation now = relation_of(rounded);
    if (now.contact == own.contact && now.hulls == own.hulls) result.push_back(rounded);
  }
  return result;
}

}  // namespace detail

// For each pair, whether the lane is right.
template <class Real>
using Ask = std::function<std::vector<bool>(const std::vector<BasicPair<Real>>&)>;

// Whether the coordinates are small integers times a power of two: up to 8 in float32, and up to 256 in float64. On
// such a pair, no sum of 32 products of up to kUsualFactors coordinates or differences rounds.
template <class Real>
bool has_small_integers(const BasicPair<Real>& pair, Scalar scalar) {
  return detail::holds_products(pair, scalar, kUsualFactors, 1);
}

// Whether no sum of 32 products of up to three coordinates or differences, such as a determinant, rounds.
template <class Real>
bool holds_determinants(const BasicPair<Real>& pair, Scalar scalar) {
  return detail::holds_products(pair, scalar, 3, 1);
}

// Finds why the code is wrong on a pair whose sums of products, as described at has_small_integers, do not round.
// widest: the widest arithmetic in which the code is known to be wrong. Returns nothing if scaling the pair by 3 or 5
// changes the orders in which the lane is wrong, because then quotients or roots may decide. The same holds for adding
// one axis to another, if products of kMostFactors may round. Rounded quotients can still be the real cause: on such
// pairs this happened for published algorithms 18 of 18,237 times, always in interval_overlap.   Requires:
// has_small_integers; the lane is wrong on the pair at all larger scales.
template <class Real>
std::optional<Experiment> without_rounding(const BasicPair<Real>& pair, Scalar widest, const Ask<Real>& ask) {
  using Pairs = std::vector<BasicPair<Real>>;
  const Pairs in_order = orders(pair), mirror_images = mirrored(pair), in_axes = axes(pair);
  const std::vector<bool> right = ask(in_order);
  const bool nothing_rounds = detail::holds_products(pair, widest, kMostFactors, 1);
  std::vector<Pairs> images;
  for (const int factor : {3, 5}) {
    if (detail::holds_products(pair, widest, 3, factor)) images.push_back(detail::changed(in_order, {factor, 0, 0}));
  }
  if (!nothing_rounds) {
    for (const detail::Image& image : {detail::Image{1, 0, 1}, {1, 1, 2}, {1, 2, 0}, {1, 1, 0}, {1, 2, 1}, {1, 0, 2}})
      images.push_back(detail::changed(in_order, image));
  }
  for (const Pairs& image : images) {
    if (is_finite(image[0]) && ask(image) != right) return std::nullopt;
  }
  const int in_orders = detail::count_of(right), in_mirrors = detail::count_of(ask(mirror_images)),
            by_axes = detail::count_of(ask(in_axes));
  std::string text = fmt::format("no sum and no product of up to {} differences rounds in {} here, and it is wrong ",
                                 nothing_rounds ? kMostFactors : kUsualFactors, limits_of(widest).name);
  text += in_orders == 0 ? "in all 72 orders" : fmt::format("in {} of 72 orders", 72 - in_orders);
  const auto add = [&](int count, std::size_t all, std::string_view what) {
    text += count == 0 ? fmt::format(", in all {}", what)
                       : fmt::format(", in {} of {} {}", all - static_cast<std::size_t>(count), all, what);
  };
  add(in_mirrors, mirror_images.size(), "mirror images");
  add(by_axes, in_axes.size(), "orders of the axes");
  const Cause cause = detail::is_degenerate(pair) ? Cause::degenerate_input
                      : in_orders > 0             ? Cause::order_dependent
                                                  : Cause::logic;
  return Experiment{cause, true, std::move(text)};
}

// Those of the pair's other orders and mirror images on which the lane is wrong; at most kMostImages, evenly spaced.
template <class Real>
std::vector<BasicPair<Real>> wrong_images(const BasicPair<Real>& pair, const Ask<Real>& ask) {
  std::vector<BasicPair<Real>> images = orders(pair), in_mirrors = mirrored(pair), wrong, chosen;
  images.insert(images.end(), in_mirrors.begin() + 1, in_mirrors.end());
  images.erase(images.begin());
  const std::vector<bool> right = ask(images);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!right[i]) wrong.push_back(images[i]);
  }
  const std::size_t most = std::min<std::size_t>(kMostImages, wrong.size());
  for (std::size_t i = 0; i < most; ++i) chosen.push_back(wrong[i * wrong.size() / most]);
  return chosen;
}

// Guesses a cause from verdicts on images. The result is not settled.
template <class Real>
Experiment by_images(const BasicPair<Real>& pair, const Ask<Real>& ask) {
  const Size size(pair);
  struct Images {
    std::string_view what;
    std::vector<BasicPair<Real>> pairs;
  };
  const Images kinds[] = {{"orders", orders(pair)},
                          {"mirror images", mirrored(pair)},
                          {"exact translations to a vertex", detail::to_vertices(pair, size)},
                          {"roundings to fewer bits with the same truth", detail::snapped(pair, size)}};
  std::string right, wrong;
  int right_in[std::size(kinds)];
  for (std::size_t i = 0; i < std::size(kinds); ++i) {
    right_in[i] = detail::count_of(ask(kinds[i].pairs));
    if (kinds[i].pairs.empty()) continue;
    std::string& list = right_in[i] > 0 ? right : wrong;
    list += fmt::format("{}{} of {} {}", list.empty() ? "" : ", ", right_in[i], kinds[i].pairs.size(), kinds[i].what);
  }
  if (right.empty())
    return {detail::is_degenerate(pair) ? Cause::degenerate_input : Cause::logic, false, "right in " + wrong};
  const bool orders_alone = right_in[0] > 0 && right_in[1] + right_in[2] + right_in[3] == 0;
  const bool tried_others = kinds[3].pairs.size() > 1;
  return {orders_alone && tried_others ? Cause::order_dependent : Cause::rounding, false,
          "right in " + right + (wrong.empty() ? "" : ", and in " + wrong)};
}

}  // namespace graze::analysis
