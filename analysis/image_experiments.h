// SPDX-License-Identifier: Apache-2.0
// Experiments on foreign code with images of a pair, which have the pair's truth: one for pairs on which nothing
// rounds, and one for pairs on which something may round.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "analysis/experiments.h"
#include "analysis/scales.h"

namespace graze::analysis {

// For each pair, whether the lane is right.
template <class Real>
using Ask = std::function<std::vector<bool>(const std::vector<BasicPair<Real>>&)>;

// Whether the coordinates are small integers times a power of two: up to 8 in float32, and up to 256 in float64. On
// such a pair, no sum of 32 products of up to kUsualFactors coordinates or differences rounds.
template <class Real>
bool has_small_integers(const BasicPair<Real>& pair, Scalar scalar);

// Whether no sum of 32 products of up to three coordinates or differences, such as a determinant, rounds.
template <class Real>
bool holds_determinants(const BasicPair<Real>& pair, Scalar scalar);

// Finds why the code is wrong on a pair whose sums of products, as described at has_small_integers, do not round.
// widest: the widest arithmetic in which the code is known to be wrong. Returns nothing if scaling the pair by 3 or 5
// changes the orders in which the lane is wrong, because then quotients or roots may decide. The same holds for adding
// one axis to another, if products of kMostFactors may round. Rounded quotients can still be the real cause: on such
// pairs this happened for published algorithms 18 of 18,237 times, always in interval_overlap.   Requires:
// has_small_integers; the lane is wrong on the pair at all larger scales.
template <class Real>
std::optional<Experiment> without_rounding(const BasicPair<Real>& pair, Scalar widest, const Ask<Real>& ask);

// Those of the pair's other orders and mirror images on which the lane is wrong; at most kMostImages, evenly spaced.
template <class Real>
std::vector<BasicPair<Real>> wrong_images(const BasicPair<Real>& pair, const Ask<Real>& ask);

// Guesses a cause from verdicts on images. The result is not settled.
template <class Real>
Experiment by_images(const BasicPair<Real>& pair, const Ask<Real>& ask);

}  // namespace graze::analysis
