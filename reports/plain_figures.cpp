// SPDX-License-Identifier: Apache-2.0
#include "reports/plain_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/margin/bucket.h"
#include "corpus/pair_format.h"
#include "oracle/truth.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;
using Point2 = std::array<double, 2>;

// Projects points along the space diagonal. The x axis points to the lower right, y to the lower left, and z up.
class Isometric {
 public:
  Isometric(const std::vector<std::array<double, 3>>& points, double size) : size_(size) {
    low_ = high_ = points.front();
    for (const auto& p : points) {
      for (std::size_t i = 0; i < 3; ++i) {
        low_[i] = std::min(low_[i], p[i]);
        high_[i] = std::max(high_[i], p[i]);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) extent_ = std::max(extent_, high_[i] - low_[i]);
  }

  Point2 operator()(const std::array<double, 3>& p) const {
    std::array<double, 3> q{};  // in [-1/2, 1/2], with the same scale on all axes
    for (std::size_t i = 0; i < 3; ++i)
      q[i] = extent_ > 0 ? ((p[i] - low_[i]) - (high_[i] - low_[i]) / 2) / extent_ : 0;
    const double scale = size_ * 0.55;
    return {size_ / 2 + scale * (q[0] - q[1]) * std::sqrt(3) / 2, size_ / 2 + scale * ((q[0] + q[1]) / 2 - q[2])};
  }

 private:
  double size_, extent_ = 0;
  std::array<double, 3> low_{}, high_{};
};

std::string joined(const std::vector<Point2>& points) {
  std::string text;
  for (const Point2& p : points) text += fmt::format("{:.1f},{:.1f} ", p[0], p[1]);
  return text;
}

std::array<double, 3> point_of(const Json& values, std::size_t first) {
  return {values.at(first), values.at(first + 1), values.at(first + 2)};
}

}  // namespace

std::string page_head(const std::string& title, const std::string& style) {
  return R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>)" +
         html(title) +
         R"(</title>
<style>
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 0 auto; padding: 1rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; }
th, td { padding: 0.2rem 0.5rem; border: 1px solid #8886; text-align: left; white-space: nowrap; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
)" + style +
         "</style>\n</head>\n<body>\n";
}

std::string html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

Json coordinates_of(const AnyPair& pair) {
  Json decimal = Json::array(), hex = Json::array(), value = Json::array();
  visit(pair, [&](const auto& own) {
    for (int i = 0; i < kCoordinates; ++i) {
      const auto c = coordinates(own)[i];
      decimal.push_back(fmt::format("{}", c));
      hex.push_back(corpus::hex_float(c));
      value.push_back(double{c});
    }
  });
  return {{"decimal", decimal}, {"hex", hex}, {"value", value}};
}

Json drawing_of(const AnyPair& pair) {
  const auto points = [](const std::vector<Vec3<double>>& all) {
    Json rows = Json::array();
    for (const Vec3<double>& p : all) rows.push_back({p.x, p.y, p.z});
    return rows;
  };
  return {{"contact", points(oracle::common_set(pair))}, {"planes_line", points(oracle::planes_line(pair))}};
}

std::string margin_chart(const Json& row, const char* what) {
  constexpr double kWidth = 320, kHeight = 110, kBase = 90, kTop = 8;
  constexpr int kMost = 1 - kBucketLowest;  // exponents on each side of zero
  static_assert(kBucketHighest < kMost);
  const auto x_of = [](const Json& point) {
    if (point.at("side") == "zero") return kWidth / 2;
    const double from_zero = (point.at("exponent").get<double>() + kMost) / (2 * kMost) * (kWidth / 2 - 14) + 6;
    return kWidth / 2 + (point.at("side") == "disjoint" ? from_zero : -from_zero);
  };
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" aria-label=\"share against the margin\">"
      "<path d=\"M0 {2}H{0}M{3} {4}V{2}\" stroke=\"currentColor\" stroke-opacity=\"0.4\"/>",
      kWidth, kHeight, kBase, kWidth / 2, kTop);
  for (const Json& point : row.at("points")) {
    const double share = point.at(what).at("share"), x = x_of(point), y = kBase - (kBase - kTop) * share;
    svg +=
        fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"{3}\" stroke-width=\"1.8\"/>", x, kBase,
                    share > 0 ? std::min(y, kBase - 1) : kBase, point.at("side") == "disjoint" ? "#0072b2" : "#d55e00");
  }
  return svg + fmt::format(
                   "<text x=\"2\" y=\"104\">intersects, 2^{0}…2^{1} ulps</text><text x=\"{2}\" y=\"104\" "
                   "text-anchor=\"end\">disjoint, 2^{1}…2^{0}</text></svg>",
                   kBucketHighest, kBucketLowest, kWidth - 2);
}

std::string pair_drawing(const Json& card) {
  constexpr double kSize = 220;
  const Json &values = card.at("pair").at("value"), &contact = card.at("drawing").at("contact");
  std::vector<std::array<double, 3>> vertices;
  for (std::size_t i = 0; i < 18; i += 3) vertices.push_back(point_of(values, i));
  const Isometric view(vertices, kSize);
  const auto triangle = [&](std::size_t first, const char* colour) {
    return fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"0.3\" stroke=\"{}\" stroke-width=\"1.5\"/>",
                       joined({view(vertices[first]), view(vertices[first + 1]), view(vertices[first + 2])}), colour,
                       colour);
  };
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {0}\" width=\"{0}\" height=\"{0}\" role=\"img\" aria-label=\"both triangles\">{1}{2}",
      kSize, triangle(0, "#0072b2"), triangle(3, "#e69f00"));
  const Json& line = card.at("drawing").at("planes_line");
  if (!line.empty()) {
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-dasharray=\"4 3\"/>",
                       joined({view(point_of(line.at(0), 0)), view(point_of(line.at(1), 0))}));
  }
  std::vector<Point2> points;
  for (const Json& p : contact) points.push_back(view(point_of(p, 0)));
  if (points.size() > 1)
    svg +=
        fmt::format("<polygon points=\"{}\" fill=\"#d55e00\" stroke=\"#d55e00\" stroke-width=\"3\"/>", joined(points));
  for (const Point2& p : points)
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#d55e00\"/>", p[0], p[1]);
  return svg + "</svg>";
}

}  // namespace graze::reports
