// SPDX-License-Identifier: Apache-2.0
#include "reports/extremes.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/text.h"
#include "reports/findings.h"
#include "reports/tables.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

using analysis::ErrorsAt;
using analysis::RightRange;
using analysis::RightSide;
using Json = nlohmann::ordered_json;

std::string power(int exponent) { return exponent == 0 ? "1" : fmt::format("2^{}", exponent); }

// "from 2^-40 to 2^44", "up to 2^44", "everywhere, 2^-152 to 2^128"
std::string range_words(const RightRange& range, int step) {
  const auto& [origin, settled, down, up] = range;
  const bool whole = down.right == down.last && up.right == up.last;
  const std::string end = power(up.right + step);
  if (whole) return fmt::format("everywhere, {} to {}", power(down.right), end);
  return down.last == origin.exponent ? "up to " + end : fmt::format("from {} to {}", power(down.right), end);
}

// Describes where the lane is less often right, and where this is not settled.
std::string rest_words(const RightRange& range, int step) {
  std::vector<std::string> worse, open;
  const auto add = [&](const RightSide& side, const std::string& beyond) {
    if (side.worse) {
      worse.push_back(power(*side.worse));
    } else if (side.right != side.last) {
      open.push_back(beyond);
    }
  };
  add(range.down, "below " + power(range.down.right));
  add(range.up, "above " + power(range.up.right + step));
  return (worse.empty() ? "" : fmt::format("; errs more at {}", fmt::join(worse, " and "))) +
         (open.empty() ? "" : fmt::format("; not settled {}", fmt::join(open, " and ")));
}

// The ratio of a share to the origin's share, with bounds that use the worst ends of both 95 % intervals.
Json times_json(const Share& share, const Share& origin) {
  constexpr int kDigits = 3;
  const auto ratio = [](double left, double right) { return right > 0 ? left / right : 0; };
  const double low = ratio(share.low, origin.high), middle = ratio(share.share, origin.share),
               high = ratio(share.high, origin.low);
  return {origin.count == 0 ? Json() : Json(std::stod(fmt::format("{:.{}g}", middle, kDigits))),
          std::stod(rounded_down(low, kDigits)), origin.low > 0 ? Json(std::stod(rounded_up(high, kDigits))) : Json()};
}

}  // namespace

std::string right_words(std::span<const ErrorsAt> points, int step) {
  const std::optional<RightRange> range = analysis::right_range(points);
  if (!range) return "not settled: too few pairs";
  std::uint64_t errors = 0, pairs = 0;
  for (const ErrorsAt& at : points) {
    errors += at.errors;
    pairs += at.pairs;
  }
  const ErrorsAt& origin = range->origin;
  const auto holds_zero = [&](const ErrorsAt& at) { return at.exponent <= 0 && 0 < at.exponent + std::max(step, 1); };
  const std::string text = holds_zero(origin)                                      ? ""
                           : std::any_of(points.begin(), points.end(), holds_zero) ? "few pairs at 1; "
                                                                                   : "no pairs at 1; ";
  if (errors == 0) {
    return fmt::format("{}errs on none of {}, {} to {}", text, counted(pairs, "pair"), power(points.front().exponent),
                       power(points.back().exponent + step));
  }
  if (!range->settled)
    return fmt::format("{}not settled: errs on {} of {} at {}, too few to compare with", text, grouped(origin.errors),
                       counted(origin.pairs, "pair"), power(origin.exponent));
  return fmt::format("{}as right as at {} (errs on {}) {}{}", text, power(origin.exponent),
                     rate_words(origin.errors, origin.pairs), range_words(*range, step), rest_words(*range, step));
}

void add_right_range(Json& row) {
  std::vector<ErrorsAt> points;
  for (const Json& cell : row.at("cells"))
    points.push_back({cell.at("exponent"), cell.at("wrong").at("count"), cell.at("wrong").at("of")});
  const std::optional<RightRange> range = analysis::right_range(points);
  const Share origin = range ? share_of(range->origin.errors, range->origin.pairs) : Share{};
  row["origin"] = range ? Json(range->origin.exponent) : Json();
  row["says"] = right_words(points, row.at("step"));
  for (std::size_t i = 0; i < points.size(); ++i) {
    Json& cell = row["cells"][i];
    cell.erase("times");
    if (points[i].errors > 0) cell["times"] = times_json(share_of(points[i].errors, points[i].pairs), origin);
  }
}

}  // namespace graze::reports
