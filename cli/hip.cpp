// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/text.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "subjects/hip.h"
#include "subjects/published.h"
#include "subjects/subjects.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;
using reports::Align;
using subjects::ContractionPlan;
using subjects::FusedLine;

using Plan = std::vector<FusedLine>;

constexpr std::size_t kTargets = std::size(subjects::kHipTargets);

// The products that each compiler fuses in one source, for one scalar.
struct Compared {
  std::string name;  // "moller_1997/f32"
  Plan amd[kTargets];
  std::optional<Plan> nvidia;  // nothing if unknown
};

struct Source {
  std::string name;
  fs::path file;
  std::string function;
  std::vector<std::string> flags;
};

std::optional<Plan> nvidia_plan(const std::string& subject, std::string_view scalar, const fs::path& folder) {
  const Lane* lane = find_lane(id_of({subject, std::string(scalar), std::string(name(Variant::cuda_fma)), ""}));
  if (!lane) return std::nullopt;
  Plan plan = subjects::nvidia_plan(*lane, folder);
  return plan.empty() ? std::nullopt : std::optional(plan);
}

// still_fused: increased by the number of operations that stay fused with -ffp-contract=off.   Throws:
// std::runtime_error with the compiler's first error.
std::vector<Compared> compared(const Source& source, int& still_fused) {
  std::vector<Compared> both = {{source.name + "/f32", {}, {}}, {source.name + "/f64", {}, {}}};
  std::vector<std::string> off = source.flags;
  off.emplace_back("-ffp-contract=off");
  for (std::size_t t = 0; t < kTargets; ++t) {
    const std::string_view target = subjects::kHipTargets[t];
    ContractionPlan plan = subjects::hip_plan(source.file, source.function, target, source.flags);
    both[0].amd[t] = std::move(plan.f32);
    both[1].amd[t] = std::move(plan.f64);
    const ContractionPlan strict = subjects::hip_plan(source.file, source.function, target, off);
    still_fused += subjects::operations_of(strict.f32) + subjects::operations_of(strict.f64);
  }
  const fs::path folder = fs::absolute(source.file).parent_path();
  both[0].nvidia = nvidia_plan(source.name, "f32", folder);
  both[1].nvidia = nvidia_plan(source.name, "f64", folder);
  return both;
}

std::vector<Source> sources_of(const std::vector<std::string>& texts, const std::vector<std::string>& flags) {
  std::vector<Source> sources;
  for (const std::string& text : texts) {
    subjects::Wanted wanted = subjects::parse_subject(text);
    wanted.flags = flags;
    const subjects::Opened named = subjects::named_by(wanted);
    if (named.kind != "hip" && named.kind != "cuda" && named.kind != "source")
      throw UsageError(fmt::format("--subject {}: expected a source of HIP, CUDA or C++, found {}", wanted.name,
                                   shown(wanted.what)));
    if (named.kind == "cuda") subjects::open(wanted);  // to get NVRTC's plan
    sources.push_back({wanted.name, named.file, subjects::function_of(named), flags});
  }
  if (!sources.empty()) return sources;
  for (const Lane* lane : subjects::published_algorithms())
    sources.push_back(
        {std::string(lane->info->id), subjects::published_source(*lane), subjects::kPublishedFunction, {}});
  return sources;
}

// The operations on each line, ordered by compiler: AMD's targets, then NVIDIA's.
using ByLine = std::map<std::pair<std::string, int>, std::vector<const FusedLine*>>;

ByLine by_line(const Compared& of) {
  ByLine lines;
  const auto add = [&](const Plan& plan, std::size_t place) {
    for (const FusedLine& line : plan) {
      std::vector<const FusedLine*>& row = lines[{line.file, line.line}];
      row.resize(kTargets + 1);
      row[place] = &line;
    }
  };
  for (std::size_t t = 0; t < kTargets; ++t) add(of.amd[t], t);
  if (of.nvidia) add(*of.nvidia, kTargets);
  return lines;
}

std::vector<reports::Column> columns(const char* first) {
  std::vector<reports::Column> all = {{first, Align::left}};
  for (const std::string_view target : subjects::kHipTargets) all.push_back({std::string(target)});
  all.push_back({"NVIDIA"});
  return all;
}

std::string table_of_all(const std::vector<Compared>& all) {
  std::vector<reports::Column> head = columns("fused operations");
  for (const char* text : {"lines of both", "of AMD alone", "of NVIDIA alone"}) head.push_back({text});
  reports::TextTable table(std::move(head));
  for (const Compared& of : all) {
    std::vector<reports::Cell> row = {of.name};
    for (const Plan& plan : of.amd) row.emplace_back(std::to_string(subjects::operations_of(plan)));
    row.emplace_back(of.nvidia ? std::to_string(subjects::operations_of(*of.nvidia)) : "-");
    int both = 0, amd = 0, nvidia = 0;
    for (const auto& [place, lines] : by_line(of)) {
      const bool by_amd = std::any_of(lines.begin(), lines.end() - 1, [](const FusedLine* line) { return line; });
      ++(by_amd && lines.back() ? both : by_amd ? amd : nvidia);
    }
    for (const int count : {both, amd, nvidia}) row.emplace_back(of.nvidia ? std::to_string(count) : "-");
    table.add(std::move(row));
  }
  return table.text(output_screen());
}

std::string table_of_lines(const Compared& of) {
  std::vector<reports::Column> head = columns("line");
  head.push_back({"", Align::left});
  reports::TextTable table(std::move(head));
  for (const auto& [place, lines] : by_line(of)) {
    std::vector<reports::Cell> row = {printable(fmt::format("{}:{}", place.first, place.second))};
    std::string code;
    for (const FusedLine* line : lines) {
      row.emplace_back(line ? std::to_string(line->count) : "");
      if (line) code = line->code;
    }
    row.emplace_back(printable(code));
    table.add(std::move(row));
  }
  return fmt::format("\n{}{}\n{}", of.name, of.nvidia ? "" : " (NVIDIA's plan is not known)",
                     table.rows() == 0 ? "  no fused product\n" : table.text(output_screen(), 2));
}

nlohmann::ordered_json json_of(const std::vector<Compared>& all, int still_fused) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Compared& of : all) {
    nlohmann::ordered_json row = {{"name", of.name}};
    for (std::size_t t = 0; t < kTargets; ++t)
      row[std::string(subjects::kHipTargets[t])] = subjects::plan_json(of.amd[t]);
    row["nvidia"] = of.nvidia ? subjects::plan_json(*of.nvidia) : nlohmann::ordered_json();
    rows.push_back(std::move(row));
  }
  return {{"toolchain", "hip"}, {"plans", std::move(rows)}, {"fused_with_contract_off", still_fused}};
}

}  // namespace

int list_hip_plans(const std::vector<std::string>& subjects, const std::vector<std::string>& flags,
                   const std::string& json) {
  if (const std::string why = subjects::why_no_hip(); !why.empty())
    throw std::runtime_error("cannot compile for AMD's GPUs: " + why);
  const StopSignals stops;
  std::vector<Compared> all;
  int still_fused = 0;
  for (const Source& source : sources_of(subjects, flags)) {
    for (Compared& of : compared(source, still_fused)) all.push_back(std::move(of));
  }
  if (!json.empty()) write_result(json, json_of(all, still_fused).dump(1) + '\n', fuzz::NamedBy::user);
  fmt::print(
      "Products that hipcc fuses into additions for AMD's GPUs, and nvcc with ptxas for NVIDIA's. They are read\nfrom "
      "machine code; nothing ran, and no verdict is claimed.\n\n{}",
      table_of_all(all));
  if (!subjects.empty()) {
    for (const Compared& of : all) fmt::print("{}", table_of_lines(of));
  }
  if (still_fused == 0) {
    fmt::print("\nWith -ffp-contract=off hipcc fuses none.\n");
  } else {
    fmt::print(
        "\nWith -ffp-contract=off {} fused. Calls of fma() may stay fused; any other operation means that the flag "
        "does not work.\n",
        still_fused == 1 ? "1 operation stays" : fmt::format("{} operations stay", still_fused));
  }
  return still_fused == 0 ? 0 : 1;
}

}  // namespace graze::cli
