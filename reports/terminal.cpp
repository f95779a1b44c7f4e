// SPDX-License-Identifier: Apache-2.0
#include "reports/terminal.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <vector>

#include "corpus/pair_format.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t errors(const Json& counts) {
  return counts["false_positive"].get<std::uint64_t>() + counts["false_negative"].get<std::uint64_t>() +
         counts["declined"].get<std::uint64_t>();
}

// A share for a narrow column: "0", "12 %", "3.1e-05"; "-" of nothing.
std::string share(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  if (part == 0) return "0";
  const double x = static_cast<double>(part) / static_cast<double>(whole);
  return x >= 0.001 ? fmt::format("{:.3g} %", 100 * x) : fmt::format("{:.1e}", x);
}

void print_strata(std::ostream& out, const Json& summary) {
  std::vector<std::string> columns;
  for (const auto& lane : summary["spec"]["lanes"]) {
    const std::string id = lane;
    if (id.ends_with("/f32/cpu")) columns.push_back(id);
  }
  if (columns.empty()) columns = summary["spec"]["lanes"].get<std::vector<std::string>>();
  out << "Share of wrong verdicts by stratum, the f32/cpu lanes (all lanes below):\n";
  out << fmt::format("{:<20}{:>12}{:>12}", "stratum", "pairs", "intersect");
  for (const std::string& id : columns) out << fmt::format("{:>24}", id.substr(0, id.find('/')));
  out << '\n';
  for (const auto& [stratum, row] : summary["strata"].items()) {
    const std::uint64_t pairs = row["pairs"];
    out << fmt::format("{:<20}{:>12}{:>12}", stratum, grouped(pairs), share(row["intersects"], pairs));
    for (const std::string& id : columns) out << fmt::format("{:>24}", share(errors(row["lanes"][id]), pairs));
    out << '\n';
  }
}

void print_lanes(std::ostream& out, const Json& summary) {
  out << fmt::format("\n{:<36}{:>16}{:>16}{:>10}{:>18}\n", "lane, over all strata", "false positive", "false negative",
                     "declined", "differs from cpu");
  for (const auto& lane : summary["spec"]["lanes"]) {
    const std::string id = lane;
    std::uint64_t sums[4] = {};
    bool compared = false;  // with the cpu lane
    for (const auto& [stratum, row] : summary["strata"].items()) {
      int i = 0;
      for (const auto& [kind, count] : row["lanes"][id].items())
        sums[i++] += count.is_null() ? 0 : count.get<std::uint64_t>();
      compared = compared || !row["lanes"][id]["differs_from_cpu"].is_null();
    }
    out << fmt::format("{:<36}{:>16}{:>16}{:>10}{:>18}\n", id, grouped(sums[0]), grouped(sums[1]), grouped(sums[2]),
                       compared ? grouped(sums[3]) : "-");
  }
}

}  // namespace

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) digits.insert(static_cast<std::size_t>(i), 1, ',');
  return digits;
}

void print_summary(std::ostream& out, const Json& summary, const Json& oracle) {
  print_strata(out, summary);
  print_lanes(out, summary);
  std::uint64_t pairs = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) pairs += row["pairs"].get<std::uint64_t>();
  const std::uint64_t on_device = oracle["device"];
  const std::string judged = on_device == 0 ? "CGAL decided all of them"
                                            : fmt::format("the exact lane on the device decided {}, CGAL {}",
                                                          grouped(on_device), grouped(oracle["cgal"]));
  out << fmt::format("\n{} pairs: some lane is wrong on {}, in {} signatures. {}, GMP confirmed {}; apart: {}.\n",
                     grouped(pairs), grouped(summary["disagreements"]), grouped(summary["signatures"].size()), judged,
                     grouped(oracle["gmp"]), oracle["apart"].dump());
}

namespace {

// One row for each subject and scalar, one column for each variant among the lanes; '-' where a lane did not run, '!'
// where it is wrong. The exact CUDA lane stands in the columns of all device variants: it is the same in each.
void print_verdicts(std::ostream& out, Verdict truth, std::span<const Lane* const> lanes,
                    std::span<const Verdict> verdicts) {
  const auto belongs = [](const Lane& lane, const VariantInfo& column) {
    return lane.exact && lane.is_cuda() ? column.runs_on == RunsOn::device : lane.variant == column.variant;
  };
  std::vector<const VariantInfo*> columns;
  for (const VariantInfo& row : kVariants) {
    const bool shown =
        std::any_of(lanes.begin(), lanes.end(), [&](const Lane* l) { return l->variant == row.variant; });
    const bool for_exact_alone =
        row.arithmetic == Arithmetic::exact && !columns.empty() && columns.back()->runs_on == RunsOn::device;
    if (shown && !for_exact_alone) columns.push_back(&row);
  }
  const auto print_row = [&](const std::string& title, const auto& cell) {
    std::string line = fmt::format("  {:<28}", title);
    for (const VariantInfo* column : columns) line += fmt::format("{:<14}", cell(*column));
    out << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
  };
  print_row("", [](const VariantInfo& column) { return std::string(column.id); });
  for (std::size_t first = 0, end; first < lanes.size(); first = end) {
    const Lane& lane = *lanes[first];
    for (end = first; end < lanes.size() && lanes[end]->info == lane.info && lanes[end]->scalar == lane.scalar;) ++end;
    print_row(fmt::format("{}/{}", lane.info->id, name(lane.scalar)), [&](const VariantInfo& column) {
      for (std::size_t l = first; l < end; ++l) {
        if (!belongs(*lanes[l], column)) continue;
        const bool wrong = truth != Verdict::declined && verdicts[l] != truth;
        return fmt::format("{}{}", name(verdicts[l]), wrong ? " !" : "");
      }
      return std::string("-");
    });
  }
}

}  // namespace

void print_pair(std::ostream& out, const Pair& pair, const oracle::Truth& truth, std::span<const Lane* const> lanes,
                std::span<const Verdict> verdicts) {
  for (int v = 0; v < 6; ++v) {
    const Vec3<float>& p = v < 3 ? pair.a[v] : pair.b[v - 3];
    out << fmt::format("  {}[{}]  {:>15} {:>15} {:>15}   {} {} {}\n", v < 3 ? 'a' : 'b', v % 3, p.x, p.y, p.z,
                       corpus::hex_float(p.x), corpus::hex_float(p.y), corpus::hex_float(p.z));
  }
  out << fmt::format("  truth: {}, contact {}, margin {} ({} ulps)\n", name(truth.verdict), name(truth.contact),
                     truth.margin, truth.margin_ulps);
  print_verdicts(out, truth.verdict, lanes, verdicts);
}

}  // namespace graze::reports
