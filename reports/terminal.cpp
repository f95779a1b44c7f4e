// SPDX-License-Identifier: Apache-2.0
#include "reports/terminal.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <ostream>
#include <vector>

#include "analysis/convention.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/counts_json.h"
#include "reports/counts.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

void print_strata(std::ostream& out, const Json& summary, const Screen& screen) {
  std::vector<std::string> lanes;
  for (const auto& lane : summary["spec"]["lanes"]) {
    const std::string id = lane;
    if (id.ends_with("/f32/cpu")) lanes.push_back(id);
  }
  const bool all = lanes.empty();
  if (all) lanes = summary["spec"]["lanes"].get<std::vector<std::string>>();
  out << wrapped(fmt::format("By stratum, in % of its pairs: those that intersect, and those on which {} is wrong{}.",
                             all ? "a lane" : "an f32/cpu lane", all ? "" : " (all lanes below)"),
                 screen.columns);
  std::vector<Column> columns{{"stratum", Align::left}, {"pairs"}, {"intersect", Align::point}};
  for (const std::string& id : lanes) columns.push_back({all ? id : id.substr(0, id.find('/')), Align::point});
  TextTable table(columns);
  for (const auto& [stratum, row] : summary["strata"].items()) {
    const std::uint64_t pairs = row["pairs"];
    std::vector<Cell> cells{stratum, grouped(pairs), bare_percent(row["intersects"], pairs)};
    for (const std::string& id : lanes) cells.push_back(bare_percent(fuzz::counts_of(row["lanes"][id]).wrong(), pairs));
    table.add(std::move(cells));
  }
  out << table.text(screen);
}

void print_lanes(std::ostream& out, const Json& summary, const CampaignCounts& counts, const Screen& screen) {
  const std::vector<analysis::LaneCounts>& total = counts.total.lanes;
  const bool in_doubles =
      std::any_of(counts.strata.begin(), counts.strata.end(), std::mem_fn(&StratumCounts::in_doubles));
  // Whether errors due to storing are counted. An f64 lane has none.
  const auto has_stored = [&](const ReportLane& lane) { return in_doubles && lane.name.scalar == name(Scalar::f32); };
  std::vector<Column> columns{{"lane, over all strata", Align::left}};
  std::vector<fuzz::CountField> fields;
  for (const fuzz::CountField& field : fuzz::kCountFields) {
    const auto has = [&](const Counts& lane) { return lane.*field.count > 0; };
    if (field.foreign && std::none_of(total.begin(), total.end(), has)) continue;
    fields.push_back(field);
    std::string title = field.key;
    std::replace(title.begin(), title.end(), '_', ' ');
    columns.push_back({title});
  }
  columns.push_back({"differs from cpu"});
  const bool any_stored = std::any_of(counts.lanes.begin(), counts.lanes.end(), has_stored);
  if (any_stored) columns.push_back({"wrong by storing"});
  TextTable table(columns);
  for (std::size_t l = 0; l < total.size(); ++l) {
    const ReportLane& lane = counts.lanes[l];
    std::vector<Cell> cells{lane.id};
    for (const fuzz::CountField& field : fields) {
      const bool known = !field.foreign || summary["strata"].empty() ||
                         summary["strata"].front()["lanes"][lane.id].contains(field.key);
      cells.push_back(known ? grouped(total[l].*field.count) : "-");
    }
    cells.push_back(lane.cpu ? grouped(total[l].differs_from_cpu) : "-");
    if (any_stored) cells.push_back(has_stored(lane) ? grouped(total[l].stored) : "-");
    table.add(std::move(cells));
  }
  out << '\n' << table.text(screen);
}

// Describes which exact decisions support the counts. These decisions agree, because a campaign stops if two differ.
// doubles: whether some pairs have doubles. If so, GMP also decides those with another verdict in float32.
std::string decided_by(std::uint64_t disagreements, const Json& oracle, bool doubles) {
  const std::uint64_t exact = oracle["exact"], gmp = oracle["gmp"];
  if (exact > 0) {
    return fmt::format(
        "The exact lane decided {} pairs. CGAL decided {} of them again, including all kept cases, and GMP {} of "
        "those. They agree on all.",
        grouped(exact), grouped(oracle["cgal"]), grouped(gmp));
  }
  return fmt::format(
      "CGAL decided all pairs. GMP decided {} again, the {} with a wrong lane and {}{}. They agree on all.",
      grouped(gmp), grouped(disagreements), doubles ? "" : "a sample of ", counted(gmp - disagreements, "other"));
}

}  // namespace

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) digits.insert(static_cast<std::size_t>(i), 1, ',');
  return digits;
}

std::string counted(std::uint64_t number, const char* what) {
  return fmt::format("{} {}{}", grouped(number), what, number == 1 ? "" : "s");
}

std::string bare_percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  if (part == 0) return "0";
  if (part == whole) return "100";
  const double percent = 100 * static_cast<double>(part) / static_cast<double>(whole);
  if (percent < 0.001) return "<0.001";
  if (percent > 99.9) return ">99.9";
  return fmt::format("{:.{}f}", percent, percent >= 10 ? 1 : percent >= 1 ? 2 : 3);
}

void print_summary(std::ostream& out, const Json& summary, const Json& oracle, const Screen& screen) {
  const CampaignCounts counts = counts_of(summary);
  print_strata(out, summary, screen);
  print_lanes(out, summary, counts, screen);
  const std::uint64_t disagreements = summary["disagreements"];
  const std::string found = fmt::format("{}: some lane is wrong on {}, in {}.", counted(counts.total.pairs, "pair"),
                                        grouped(disagreements), counted(summary["signatures"].size(), "signature"));
  out << '\n'
      << bold(screen, found) << '\n'
      << wrapped(decided_by(disagreements, oracle, fuzz::has_doubles(summary["spec"])), screen.columns);
}

namespace {

// Prints a row for each subject, scalar and policy, and a column for each of the lanes' variants. '-': the lane did not
// run; '!': it is wrong. The exact CUDA lane appears under all device variants, because it is the same for all of them.
void print_verdicts(std::ostream& out, const AnyPair& pair, const oracle::Truth& true_of_pair,
                    std::span<const Lane* const> lanes, std::span<const Verdict> verdicts, const Screen& screen) {
  const Verdict truth = true_of_pair.verdict;
  struct Target {
    const VariantInfo& row;
    std::string_view name;
  };
  const auto belongs = [](const Lane& lane, const Target& column) {
    const VariantInfo& its = info_of(lane.variant);
    return its.arithmetic == Arithmetic::exact ? column.row.runs_on == its.runs_on : lane.variant_name() == column.name;
  };
  const auto is_another = [](const Lane& l, const Lane& r) {
    return l.info != r.info || l.scalar != r.scalar || l.policy != r.policy;
  };
  std::vector<Target> variants;
  for (const VariantInfo& row : kVariants) {
    const bool for_exact_alone =
        row.arithmetic == Arithmetic::exact && !variants.empty() && variants.back().row.runs_on == RunsOn::device;
    for (const Lane* lane : lanes) {
      const bool is_there = std::any_of(variants.begin(), variants.end(),
                                        [&](const Target& column) { return column.name == lane->variant_name(); });
      if (lane->variant == row.variant && !is_there && !for_exact_alone)
        variants.push_back({row, lane->variant_name()});
    }
  }
  if (variants.empty()) return;
  std::vector<Column> columns{{"", Align::left}};
  for (const Target& variant : variants) columns.push_back({std::string(variant.name), Align::left});
  TextTable table(columns);
  for (std::size_t first = 0; first < lanes.size(); ++first) {
    const Lane& lane = *lanes[first];
    if (std::any_of(lanes.begin(), lanes.begin() + static_cast<std::ptrdiff_t>(first),
                    [&](const Lane* before) { return !is_another(*before, lane); }))
      continue;
    std::vector<Cell> cells{
        fmt::format("{}/{}{}{}", lane.info->id, name(lane.scalar), lane.policy.empty() ? "" : " ", lane.policy)};
    for (const Target& variant : variants) {
      Cell& cell = cells.emplace_back("-");
      for (std::size_t l = first; l < lanes.size() && cell.text == "-"; ++l) {
        if (is_another(*lanes[l], lane) || !belongs(*lanes[l], variant)) continue;
        const bool wrong = truth != Verdict::declined && is_wrong(verdicts[l], truth);
        const bool convention = wrong && analysis::by_convention(*lanes[l], verdicts[l], pair, true_of_pair);
        cell = {fmt::format("{}{}", name(verdicts[l]),
                            convention ? " (convention)"
                            : wrong    ? " !"
                                       : ""),
                wrong && !convention};
      }
    }
    table.add(std::move(cells));
  }
  out << table.text(screen, 2);
}

// Prints decimals and hex floats in one row, or each hex float below its decimal if the screen is too narrow.
template <class Real>
void print_coordinates(std::ostream& out, const BasicPair<Real>& pair, const Screen& screen) {
  std::string cells[6][6];  // by vertex: x, y, z as decimals, then as hex floats
  int widths[6] = {};
  for (int v = 0; v < 6; ++v) {
    const Vec3<Real>& p = v < 3 ? pair.a[v] : pair.b[v - 3];
    int c = 0;
    for (const Real x : {p.x, p.y, p.z}) {
      cells[v][c] = fmt::format("{}", x);
      cells[v][c + 3] = corpus::hex_float(x);
      ++c;
    }
    for (c = 0; c < 6; ++c) widths[c] = std::max(widths[c], width_of(cells[v][c]));
  }
  const int total = 6 + std::accumulate(widths, widths + 6, 6 * 2);
  for (int v = 0; v < 6; ++v) {
    std::string line = fmt::format("  {}[{}]", v < 3 ? 'a' : 'b', v % 3), below = "      ";
    for (int c = 0; c < 3; ++c) {
      const int width = total <= screen.columns ? widths[c] : std::max(widths[c], widths[c + 3]);
      line += fmt::format("  {:>{}}", cells[v][c], width);
      below += fmt::format("  {:>{}}", cells[v][c + 3], width);
    }
    if (total <= screen.columns) {
      for (int c = 3; c < 6; ++c) line += fmt::format("  {:>{}}", cells[v][c], widths[c]);
    }
    out << line << '\n';
    if (total > screen.columns) out << below << '\n';
  }
}

}  // namespace

void print_pair(std::ostream& out, const AnyPair& pair, const oracle::Truth& truth, std::span<const Lane* const> lanes,
                std::span<const Verdict> verdicts, const Screen& screen) {
  visit(pair, [&](const auto& own) { print_coordinates(out, own, screen); });
  out << "  "
      << bold(screen, fmt::format("truth: {}, contact {}, margin {:.7g} ({:.7g} ulps)", name(truth.verdict),
                                  name(truth.contact), truth.margin, truth.margin_ulps))
      << '\n';
  print_verdicts(out, pair, truth, lanes, verdicts, screen);
}

}  // namespace graze::reports
