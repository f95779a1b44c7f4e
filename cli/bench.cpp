// SPDX-License-Identifier: Apache-2.0
// `graze bench`: repeats the tables of the 2012 thesis on this machine.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "backends/backends.h"
#include "cli/bench_rows.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/query_input.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/exact_blocks/decide.h"
#include "core/stop.h"
#include "fuzz/campaign/campaign.h"
#include "query/question.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

struct Options {
  std::vector<std::string> sizes = {"10000", "100000", "1000000", "5000000", "10000000", "20000000"};
  LaneOptions lanes;  // kCommonLanes if no pattern is given
  std::string mesh, plot;
  std::vector<std::string> between;
  bool json = false;
};

const std::vector<std::string> kCommonLanes = {
    "interval_overlap/f32/cpu",      "guigue_devillers_2003/f32/cpu",      "interval_overlap/f32/cpu/filtered",
    "interval_overlap/f32/cuda-fma", "guigue_devillers_2003/f32/cuda-fma", "interval_overlap/f32/cuda-fma/filtered"};

std::string words(const BenchMachine& machine) {
  std::string text = fmt::format("{}, {} threads, {}", fuzz::machine_name(), machine.cores, exact::decide_target());
  if (machine.devices.empty()) return text + "; no CUDA device";
  return text + fmt::format("; {} x {}: copies within it {:.0f} GB/s, from the host {:.1f} GB/s",
                            machine.devices.size(), machine.devices[0], machine.copy_bytes_per_second / 1e9,
                            machine.to_device_bytes_per_second / 1e9);
}

nlohmann::ordered_json json_of(const Bench& bench) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const BenchRow& row : bench.rows) {
    nlohmann::ordered_json line = {{"array", row.array},     {"triangles", row.triangles}, {"mode", row.mode},
                                   {"lane", row.lane},       {"executor", row.executor},   {"data", row.data},
                                   {"seconds", row.seconds}, {"per_second", row.rate()},   {"hits", row.hits}};
    if (row.build_seconds > 0) line["build_seconds"] = row.build_seconds;
    if (row.processor_seconds > 0) line["processor_seconds"] = row.processor_seconds;
    if (row.mismatches) line["mismatches"] = *row.mismatches;
    rows.push_back(std::move(line));
  }
  nlohmann::ordered_json machine = {{"processor", fuzz::machine_name()},
                                    {"vectors", exact::decide_target()},
                                    {"threads", bench.machine.cores},
                                    {"devices", bench.machine.devices}};
  if (!bench.machine.devices.empty()) {
    machine["copy_bytes_per_second"] = bench.machine.copy_bytes_per_second;
    machine["to_device_bytes_per_second"] = bench.machine.to_device_bytes_per_second;
    const cuda::KernelNeeds& needs = bench.machine.exact_query;
    machine["exact_query"] = {{"threads_of_a_block", needs.threads},
                              {"registers", needs.registers},
                              {"threads_of_a_multiprocessor", needs.active_threads}};
  }
  nlohmann::ordered_json crossover = nullptr;
  if (bench.crossover > 0) crossover = bench.crossover;
  return {{"machine", machine}, {"crossover", crossover}, {"not_timed_above", bench.not_timed_above}, {"rows", rows}};
}

// Formats the rows of one array as a table.
std::string table_of(const Bench& bench, std::size_t group) {
  using reports::Align;
  std::vector<std::vector<reports::Cell>> lines;
  std::string head;
  for (const BenchRow& row : bench.rows) {
    if (row.group != group) continue;
    if (head.empty()) head = row.array + ", " + reports::grouped(row.triangles);
    lines.push_back({row.lane + (row.mode == "any" ? ", any" : ""),
                     row.by(),
                     fmt::format("{:.3f}", row.seconds * 1e3),
                     row.mode == "any" ? "" : fmt::format("{:.1f}", row.rate() / 1e6),
                     reports::grouped(row.hits),
                     {row.mismatches ? reports::grouped(*row.mismatches) : "", row.mismatches.value_or(0) > 0}});
  }
  reports::TextTable table(
      {{head, Align::left}, {"by", Align::left}, {"ms", Align::point}, {"10^6/s", Align::point}, {"hits"}, {"wrong"}});
  for (std::vector<reports::Cell>& line : lines) table.add(std::move(line));
  return table.text(output_screen());
}

// Describes the exact lane's speed as a percentage of each of the device's limits.
std::string shares(const Bench& bench) {
  std::string text;
  for (const auto& [lane, size] : {std::pair(kExact, 36), {kExactInDoubles, 72}}) {
    for (const char* data : {"resident", "host"}) {
      const BenchRow* best = nullptr;
      for (const BenchRow& row : bench.rows) {
        if (row.lane == lane && row.mode == "all" && row.executor == "one GPU" && row.data == data &&
            (!best || row.rate() > best->rate()))
          best = &row;
      }
      if (!best) continue;
      const bool resident = best->data == "resident";
      const double limit = resident ? bench.machine.copy_bytes_per_second : bench.machine.to_device_bytes_per_second;
      text += fmt::format("{}, one GPU, {}: at most {:.1f} x 10^9 triangles/s, {:.1f} GB/s, {:.0f} % of {}\n", lane,
                          data, best->rate() / 1e9, best->rate() * size / 1e9, best->rate() * size * 100 / limit,
                          resident ? "a copy within it" : "a copy from pinned memory");
    }
  }
  const cuda::KernelNeeds& needs = bench.machine.exact_query;
  if (needs.threads > 0)
    text += fmt::format(
        "exact, on a device: blocks of {} threads, {} registers per thread, {} threads at once on a "
        "multiprocessor\n",
        needs.threads, needs.registers, reports::grouped(static_cast<std::uint64_t>(needs.active_threads)));
  return text;
}

std::string not_timed(const Bench& bench) {
  std::map<std::uint64_t, std::vector<std::string>> by_size;
  for (const auto& [lane, most] : bench.not_timed_above) by_size[most].push_back(lane);
  std::string text;
  for (const auto& [most, lanes] : by_size)
    text += fmt::format("not timed above {} triangles: {}\n", reports::grouped(most), fmt::join(lanes, ", "));
  return text;
}

void bench(const Options& options, int& status) {
  BenchOptions wanted;
  for (const std::string& size : options.sizes) wanted.sizes.push_back(std::stoull(size));
  const QueryLanes lanes = query_lanes(options.lanes, kCommonLanes);
  wanted.lanes = lanes.ids;
  query::on_cores = backends::on_host;  // includes twins
  if (!options.mesh.empty()) {
    wanted.mesh_name = std::filesystem::path(options.mesh).filename().string();
    const strata::MeshPairs mesh = strata::read_triangles(options.mesh);
    say_notes(mesh.notes, mesh.rounding, false);
    for (const auto& t : mesh.triangles)
      wanted.mesh.push_back({t[0].x, t[0].y, t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z});
  }
  const std::atomic<bool>& interrupted = catch_interrupts();
  const bool on_terminal = isatty(STDERR_FILENO);
  std::size_t printed = 0;  // arrays whose tables are already printed
  const auto print_table = [&](const Bench& bench) {
    if (on_terminal) fmt::print(stderr, "\r\033[K");
    if (options.json) return;
    fmt::print("{}{}\n", printed == 0 ? words(bench.machine) + "\n\n" : "", table_of(bench, printed));
    ++printed;
    std::fflush(stdout);
  };
  Bench result;
  const auto told = [&](const Bench& bench) {
    const BenchRow& row = bench.rows.back();
    if (row.group > printed) print_table(bench);
    if (on_terminal)
      fmt::print(stderr, "\r{} triangles, {}, {}, {}\033[K", reports::grouped(row.triangles), row.lane, row.executor,
                 row.data);
    return !interrupted;
  };
  try {
    result = measure(wanted, told);
    if (!options.between.empty()) measure_between(options.between, result, told);
    print_table(result);
  } catch (const Stopped&) {
  } catch (const std::runtime_error&) {
    if (!interrupted) throw;
  }
  if (interrupted) {
    status = kInterrupted;
    return;
  }
  if (!options.plot.empty()) write_result(options.plot, bench_plot(result, words(result.machine)), fuzz::NamedBy::user);
  if (options.json) {
    nlohmann::ordered_json json = json_of(result);
    fuzz::add_left_out(json, lanes.under_test);
    fmt::print("{}\n", json.dump(1));
    return;
  }
  fmt::print("{}{}", not_timed(result), shares(result));
  if (std::any_of(lanes.under_test.lanes.begin(), lanes.under_test.lanes.end(),
                  [](const Lane* lane) { return lane->foreign; }))
    print_wrapped(
        {"Times of your own code include the exchange with its process, which decides each pair twice; for host lanes, "
         "`graze pareto` times only the code."});
  if (!result.machine.devices.empty() && !options.sizes.empty()) {
    fmt::print("crossover: {}\n", result.crossover == 0
                                      ? "none; with copies included, all cores are faster"
                                      : fmt::format("with copies included, one GPU is faster than all cores from {} "
                                                    "triangles on",
                                                    reports::grouped(result.crossover)));
  }
}

}  // namespace

void add_bench(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "bench", "Time one triangle against arrays of triangles, on all cores and GPUs of this machine");
  command->footer("Example: graze bench --triangles 1e4,1e5");
  auto options = std::make_shared<Options>();
  add_valued(*command, "--triangles", options->sizes, "N,…", "Sizes of the arrays of random triangles")
      ->delimiter(',')
      ->transform(whole_number(1, std::uint64_t{1} << 34))
      ->default_str("1e4,1e5,1e6,5e6,1e7,2e7");
  add_valued(*command, "--mesh", options->mesh, "FILE",
             "Mesh to test as well: all its triangles against the one in the middle of the file");
  add_valued(*command, "--between", options->between, "MESH MESH",
             "Two meshes to test against each other, with the exact test and with CGAL's do_intersect; nothing "
             "else is timed unless --triangles or --mesh is given")
      ->expected(2);
  add_globs(*command, "--lanes", options->lanes.globs,
            "Patterns of the lanes to time besides the exact one: host lanes on cores, CUDA lanes on GPUs, or as "
            "twins if there is no GPU")
      ->default_str("six common lanes, and those of --subject");
  add_subject_options(*command, options->lanes);
  add_valued(*command, "--plot", options->plot, "FILE.svg", "Picture to write: verdicts per second against array size");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &status, command] {
    if (!options->between.empty() && command->count("--triangles") == 0) {
      for (const char* option : {"--lanes", "--subject", "--toolchains", "--plot"}) {
        if (command->count(option) > 0 && options->mesh.empty())
          throw UsageError(fmt::format(
              "{} applies only to arrays of triangles, but --between without --triangles and --mesh times no arrays; "
              "add --triangles or --mesh, or omit this option",
              option));
      }
      options->sizes.clear();
    }
    bench(*options, status);
  });
}

}  // namespace graze::cli
