// SPDX-License-Identifier: Apache-2.0
#include "analysis/curves.h"

#include <fmt/format.h>

#include "core/text.h"

namespace graze::analysis {

double tolerance_of(const std::string& policy) { return *parse_float64(policy.substr(policy.rfind(':') + 1)); }

std::string tolerance(const std::string& site, bool relative, double value) {
  return fmt::format("{}{}{}:{:.3g}", site, site.empty() ? "" : "=", relative ? "rel" : "abs", value);
}

int log2_cube(Sources sources) {
  std::vector<double> sizes;
  for (const strata::PairSource& source : sources) {
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(source.pairs, 200); ++i) {
      visit(source.any_pair(i), [&]<class Real>(const BasicPair<Real>& pair) {
        Real size = 0;
        for (int c = 0; c < 3; ++c) {
          Real low = coordinates(pair)[c], high = low;
          for (int k = c; k < kCoordinates; k += 3) {
            low = std::min(low, coordinates(pair)[k]);
            high = std::max(high, coordinates(pair)[k]);
          }
          size = std::max(size, high - low);
        }
        sizes.push_back(size);
      });
    }
  }
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  const double median = sizes[sizes.size() / 2];
  constexpr int kMost = 960;  // keeps tolerances finite and above 0
  return median > 0 && std::isfinite(median) ? std::clamp(3 * std::ilogb(median), -kMost, kMost) : 0;
}

std::vector<double> steps(double low, double high, double step) {
  std::vector<double> result;
  for (double at = low; at <= high; at += step) result.push_back(at);
  return result;
}

}  // namespace graze::analysis
