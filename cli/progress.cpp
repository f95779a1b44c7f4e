// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/terminal.h"

namespace graze::cli {

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 120) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  return minutes < 120 ? fmt::format("{} min", minutes) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

std::optional<std::string> Progress::line(std::size_t done, double seconds, std::optional<double> left) {
  const std::size_t tenths = total_ == 0 ? 10 : 10 * done / total_;
  const bool due = on_terminal_ ? seconds - printed_ >= 0.2 : tenths > tenths_ && seconds - printed_ >= 10;
  if (!due) return {};
  printed_ = seconds;
  tenths_ = tenths;
  const std::string text = fmt::format("{:3}%  {} of {} {}{}", total_ == 0 ? 100 : 100 * done / total_,
                                       reports::grouped(done), reports::grouped(total_), things_,
                                       left ? fmt::format(", {} left", duration(*left)) : "");
  return on_terminal_ ? fmt::format("\r{}\033[K", text) : text + "\n";
}

}  // namespace graze::cli
