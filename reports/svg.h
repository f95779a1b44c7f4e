// SPDX-License-Identifier: Apache-2.0
// Common parts of the SVG pictures, which are 900 x 420 and readable on light and dark backgrounds.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace graze::reports {

inline constexpr std::array<const char*, 8> kSvgColours = {"#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00",
                                                           "#56b4e9", "#8c6bb1", "#a6761d"};  // Okabe and Ito 2008

// The start of the picture, which must end with "</svg>\n".
inline std::string svg_begin(std::string_view title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 420\" width=\"900\" height=\"420\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#777\">\n<title>{}</title>\n",
      title);
}

inline std::string svg_level(double left, double right, double y) {
  return fmt::format(
      "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#888\" stroke-opacity=\"0.35\"/>\n", left,
      right, y);
}

// anchor: start, middle or end. `more`: further attributes, each with a leading space.
inline std::string svg_text(double x, double y, std::string_view anchor, std::string_view what,
                            std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, what);
}

// A logarithmic axis of rates: 1 at `top`, 10^least and all smaller rates at `bottom`.
struct RateAxis {
  double top, bottom;
  int least;

  double y(double rate) const {
    return bottom + (top - bottom) * (std::log10(std::max(rate, std::pow(10.0, least))) - least) / -least;
  }

  // A grid line for each power of ten, with its label to the left. none: the label of the lowest line.
  std::string levels(double left, double right, std::string_view none) const {
    std::string svg;
    for (int power = least; power <= 0; ++power) {
      const double at = y(std::pow(10.0, power));
      svg += svg_level(left, right, at);
      svg += svg_text(left - 8, at + 4, "end",
                      power == least ? std::string(none)
                      : power == 0   ? "all"
                                     : fmt::format("1e{}", power));
    }
    return svg;
  }
};

}  // namespace graze::reports
