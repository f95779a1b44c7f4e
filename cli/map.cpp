// SPDX-License-Identifier: Apache-2.0
// `graze map`: draws the verdicts around a case when two of its coordinates move by single ulps.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/result_files.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "reports/ulp_map_picture.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

struct MapOptions {
  std::string name, out = "map.png", x, y;
  LaneOptions lanes;
};

int coordinate(const std::string& option, const std::string& name) {
  const std::optional<int> found = analysis::coordinate_of_name(name);
  if (!found) throw UsageError(option + ": expected a coordinate from a[0].x to b[2].z, found '" + name + "'");
  return *found;
}

// The requested coordinates, if any.
std::optional<analysis::MovedCoordinates> asked_for(const MapOptions& options) {
  if (options.x.empty() && options.y.empty()) return std::nullopt;
  if (options.x.empty() || options.y.empty())
    throw UsageError("--x and --y work only together; add the missing option");
  const analysis::MovedCoordinates moved{coordinate("--x", options.x), coordinate("--y", options.y)};
  if (moved.x == moved.y) throw UsageError("--x and --y are both " + options.x + "; choose two coordinates");
  return moved;
}

// Whether no verdict changes in the map.
bool is_plain(const analysis::UlpMap& map) {
  return std::all_of(map.panels.begin(), map.panels.end(), [](const analysis::UlpPanel& panel) {
    return std::all_of(panel.cells.begin(), panel.cells.end(),
                       [&](analysis::Cell cell) { return cell == panel.cells.front(); });
  });
}

void print_counts(const analysis::UlpMap& map) {
  using analysis::Cell;
  constexpr std::pair<Cell, const char*> kColumns[] = {{Cell::disjoint, "disjoint"},
                                                       {Cell::intersects, "intersects"},
                                                       {Cell::false_positive, "false positive"},
                                                       {Cell::false_negative, "false negative"},
                                                       {Cell::declined, "declined"},
                                                       {Cell::not_finite, "not finite"},
                                                       {Cell::crashed, "crashed"},
                                                       {Cell::timed_out, "timed out"},
                                                       {Cell::unstable, "unstable"}};
  std::array<int, analysis::kCellKinds> all{};
  for (const analysis::UlpPanel& panel : map.panels) {
    const auto counts = panel.counts();
    for (std::size_t kind = 0; kind < counts.size(); ++kind) all[kind] += counts[kind];
  }
  std::vector<reports::Column> columns{{"", reports::Align::left}};
  std::vector<Cell> shown;
  for (const auto& [cell, title] : kColumns) {
    if (cell > Cell::not_finite && all[static_cast<std::size_t>(cell)] == 0) continue;  // only for failing foreign code
    columns.push_back({title});
    shown.push_back(cell);
  }
  reports::TextTable table(columns);
  for (const analysis::UlpPanel& panel : map.panels) {
    const auto counts = panel.counts();
    std::vector<reports::Cell> row{panel.name()};
    for (const Cell cell : shown) {
      const auto count = static_cast<std::uint64_t>(counts[static_cast<std::size_t>(cell)]);
      const bool wrong =
          count > 0 && cell >= Cell::false_positive && cell != Cell::declined && cell != Cell::not_finite;
      row.emplace_back(reports::grouped(count), wrong);
    }
    table.add(std::move(row));
  }
  fmt::print("{}", table.text(output_screen(), 2));
}

// Writes one picture, or one for each panel if `out` is a directory.
void write_pictures(const analysis::UlpMap& map, const fs::path& out) {
  if (out.extension() == ".png") {
    write_result(out, reports::sheet_png(map), fuzz::NamedBy::user);
  } else {
    const ResultFolder folder(out, "truth.png");
    std::set<fs::path> panels;
    for (const analysis::UlpPanel& panel : map.panels) {
      std::string name = panel.name();
      std::replace(name.begin(), name.end(), '/', '-');
      panels.insert(out / (name + ".png"));
      write_result(out / (name + ".png"), reports::panel_png(panel));
    }
    // Removes panels of another case, which would seem to belong to this one.
    const std::string own = reports::panel_png(map.panels.front());
    for (const fs::directory_entry& file : fs::directory_iterator(out)) {
      if (file.path().extension() == ".png" && !panels.contains(file.path()) && !file.is_symlink() &&
          !fs::is_empty(file.path()))
        remove_result(file.path(), own);
    }
  }
  fmt::print("Wrote {}\n", printable(out.string()));
}

void draw_map(const MapOptions& options) {
  const std::optional<analysis::MovedCoordinates> asked = asked_for(options);
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes, options.name);
  const corpus::Entry entry = read_cases(options.name).front();
  take_doubles_of({entry}, under_test);
  const AnyPair pair = corpus::pair_of(entry);
  if (!is_finite(pair.doubles))
    throw std::runtime_error("cannot draw " + options.name + ": a coordinate of its first pair is not finite");
  const analysis::MovedCoordinates moved = asked ? *asked : analysis::liveliest_coordinates(pair, under_test.lanes);
  const analysis::UlpMap map = analysis::ulp_map(pair, under_test.lanes, moved);
  const std::string what =
      fmt::format("{}{}: {} x {} cells, {} to the right and {} upwards by an ulp each{}", printable(options.name),
                  entry.line > 0 ? fmt::format(":{}", entry.line) : "", analysis::kMapSize, analysis::kMapSize,
                  analysis::name_of_coordinate(moved.x), analysis::name_of_coordinate(moved.y),
                  asked           ? ""
                  : is_plain(map) ? "; no verdict changes"
                                  : ", along which verdicts changed most in samples");
  print_wrapped({what});
  print_counts(map);
  write_pictures(map, options.out);
  fmt::print("Next: graze repro {} --emit cpp{}\n", path_word(options.name), own_words(options.lanes));
}

}  // namespace

void add_map(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("map", "Draw the verdicts around a case as two of its coordinates move by single ulps");
  command->footer("Example: graze map mixed_scale:1:3 --lanes '*/f32/cpu'");
  auto options = std::make_shared<MapOptions>();
  command->add_option("CASE", options->name, "File of pairs, whose first pair is drawn, or STRATUM:SEED:INDEX")
      ->required();
  add_lane_options(*command, options->lanes, Executors::twins);
  add_resubject_option(*command, options->lanes);
  add_valued(*command, "--out", options->out, "FILE.png|DIR",
             "Picture with a panel for the truth and one per lane, or a directory for one picture per panel")
      ->capture_default_str();
  add_valued(*command, "--x", options->x, "b[0].x",
             "Coordinate that grows to the right; by default, --x and --y are the coordinates along which verdicts "
             "change most");
  add_valued(*command, "--y", options->y, "b[0].y", "Coordinate that grows upwards");
  command->callback([options] { draw_map(*options); });
}

}  // namespace graze::cli
