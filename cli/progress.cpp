// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/terminal.h"

namespace graze::cli {

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 120) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  return minutes < 120 ? fmt::format("{} min", minutes) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

std::string fitting(const std::vector<std::string>& parts, int columns) {
  std::string line = parts.front().substr(0, static_cast<std::size_t>(std::max(columns - 1, 0)));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (reports::width_of(line) + 2 + reports::width_of(parts[i]) >= columns) break;
    line += "  " + parts[i];
  }
  return line;
}

std::optional<std::string> Progress::line(std::size_t done, double seconds, std::optional<double> left,
                                          const std::vector<std::string>& more) {
  const std::size_t tenths = total_ == 0 ? 10 : 10 * done / total_;
  const double since = seconds - printed_;
  const bool due = on_terminal_ ? since >= 0.2 : (tenths > tenths_ && since >= 10) || since >= 30;
  if (!due) return {};
  printed_ = seconds;
  tenths_ = tenths;
  const std::string time = left ? fmt::format(", {} left", duration(*left)) : "";
  const std::string percent = fmt::format("{:3}%", total_ == 0 ? 100 : 100 * done / total_);
  std::vector<std::string> parts{
      fmt::format("{}  {} of {} {}{}", percent, reports::grouped(done), reports::grouped(total_), things_, time)};
  if (!on_terminal_) return parts.front() + "\n";
  if (reports::width_of(parts.front()) >= screen_.columns) parts.front() = percent + time;
  parts.insert(parts.end(), more.begin(), more.end());
  return fmt::format("\r{}\033[K", fitting(parts, screen_.columns));
}

}  // namespace graze::cli
