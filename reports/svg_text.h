// SPDX-License-Identifier: Apache-2.0
// Text in the pictures that are written as SVG.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace graze::reports {

// anchor: start, middle or end. `more`: further attributes, with a space before each.
inline std::string svg_text(double x, double y, std::string_view anchor, std::string_view what,
                            std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, what);
}

}  // namespace graze::reports
