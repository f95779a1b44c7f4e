// SPDX-License-Identifier: Apache-2.0
// `graze toolchain`: lists toolchains, or measures how a toolchain or a compiler command treats floating-point code and
// which products it fuses in a source.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/stop.h"
#include "core/text.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "subjects/contraction_plan.h"
#include "subjects/published.h"
#include "subjects/run_canaries.h"
#include "subjects/subjects.h"
#include "subjects/toolchains/canaries.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::cli {
namespace {

using reports::Align;
using reports::Cell;
using subjects::CanaryResult;
using subjects::Claim;
using subjects::ContractionPlan;
using subjects::Documented;
using subjects::Rounding;
using subjects::Toolchain;

struct Options {
  std::string what, run, list = "all", json;
  std::vector<std::string> subjects, flags;
  int claims = -1;  // index of a Rounding; negative: as documented
};

// The products that the compiler fuses in the source of a published algorithm or of a subject.
struct PlanOf {
  std::string name;
  bool published;
  ContractionPlan plan;
};

struct Findings {
  Toolchain toolchain;  // without a name if the user gave a command
  std::string command;
  Claim claim;
  std::vector<CanaryResult> results;
  std::vector<PlanOf> plans = {};

  Documented documented(const CanaryResult& result) const { return subjects::compared(result, claim); }
  std::size_t count(Documented documented) const {
    return static_cast<std::size_t>(std::count_if(results.begin(), results.end(), [&](const CanaryResult& result) {
      return result.rounding && this->documented(result) == documented;
    }));
  }
  std::size_t unanswered() const {
    return static_cast<std::size_t>(
        std::count_if(results.begin(), results.end(), [](const CanaryResult& result) { return !result.rounding; }));
  }
};

void list(const std::vector<Toolchain>& toolchains) {
  reports::TextTable table({{"toolchain", Align::left}, {"documented", Align::left}, {"on this machine", Align::left}});
  for (const Toolchain& toolchain : toolchains) {
    const std::string why_not = subjects::why_not_here(toolchain);
    table.add({toolchain.name, std::string(name(toolchain.rounding)), {why_not.empty() ? "yes" : why_not}});
  }
  fmt::print("{}", table.text(output_screen()));
}

// Throws: UsageError if the text names no toolchain and no command; std::runtime_error if the toolchain is missing.
Toolchain wanted(const Options& options) {
  const std::vector<Toolchain> all = subjects::selected_toolchains(options.list);
  const auto named = std::find_if(all.begin(), all.end(), [&](const Toolchain& t) { return t.name == options.what; });
  Toolchain toolchain = named != all.end() ? *named : Toolchain{"", options.what, ""};
  if (!options.run.empty()) toolchain.run.clear();
  std::string why_not = subjects::why_not_here(toolchain);
  if (why_not.empty() && !options.run.empty()) {  // the toolchain's packages do not contain this program
    toolchain.run = options.run;
    Toolchain emulator = toolchain;
    emulator.needs.clear();
    why_not = subjects::why_not_here(emulator);
  }
  if (why_not.empty()) return toolchain;
  const auto first_word =
      std::find_if(all.begin(), all.end(), [&](const Toolchain& t) { return options.what.starts_with(t.name + ' '); });
  if (first_word != all.end())
    throw UsageError(fmt::format("the toolchain {} takes no flags; give its command with your flags: '{}'",
                                 first_word->name, first_word->cxx));
  if (!toolchain.name.empty()) throw std::runtime_error(fmt::format("{}: {}", toolchain.name, why_not));
  std::vector<std::string> names;
  for (const Toolchain& each : all) names.push_back(each.name);
  throw UsageError(fmt::format("{}: neither a toolchain nor a compiler's command: {}{}", shown(options.what), why_not,
                               did_you_mean(options.what, names)));
}

// Returns the documented behaviour, according to --claims, the toolchain's row or the command's flags.
Claim claim_for(const Options& options, const Toolchain& toolchain, const std::string& command) {
  if (options.claims >= 0) return {static_cast<Rounding>(options.claims), true, "--claims"};
  const std::optional<Claim> of_flags = subjects::claim_of(command);
  if (!toolchain.name.empty() && (!of_flags || of_flags->rounding != toolchain.rounding))
    return {toolchain.rounding, true, "its row in the table of toolchains"};
  if (!of_flags)
    throw UsageError(
        fmt::format("{} is neither GCC nor clang, whose flags graze knows; say with --claims what its "
                    "flags are documented to do",
                    shown(command)));
  return *of_flags;
}

std::string table_of(const Findings& measured) {
  reports::TextTable table(
      {{"computation", Align::left}, {"float", Align::left}, {"double", Align::left}, {"documentation", Align::left}});
  const std::size_t half = measured.results.size() / 2;  // the results for float; those for double follow
  for (std::size_t i = 0; i < half; ++i) {
    const auto cell = [&](const CanaryResult& result) {
      return Cell(result.found, !result.rounding || measured.documented(result) == Documented::does_not_hold);
    };
    const CanaryResult &f32 = measured.results[i], &f64 = measured.results[i + half];
    const Documented f32_is = measured.documented(f32), f64_is = measured.documented(f64);
    table.add(
        {f32.code, cell(f32), cell(f64), std::string(name(f32_is == Documented::does_not_hold ? f32_is : f64_is))});
  }
  return table.text(output_screen());
}

std::string words(const Claim& claim) {
  const char* where = claim.across_statements || claim.rounding == Rounding::rounded || claim.rounding == Rounding::fast
                          ? ""
                          : " within an expression";
  return fmt::format("{}{} ({})", name(claim.rounding), where, claim.because);
}

std::string text_of(const Findings& measured) {
  const std::optional<Rounding> rounding = subjects::measured_rounding(measured.results);
  const std::string& run = measured.toolchain.run;
  std::string text =
      reports::wrapped(printable(measured.command + (run.empty() ? "" : ", run by " + run)), output_screen().columns) +
      '\n';
  text += table_of(measured);
  text += fmt::format("\nmeasured:   {}\ndocumented: {}\n", rounding ? name(*rounding) : "no answer",
                      printable(words(measured.claim)));
  const std::size_t wrong = measured.count(Documented::does_not_hold), unanswered = measured.unanswered();
  if (measured.count(Documented::no_claim) > 0)
    text += "no claim: as Graze reads the flags, they permit these results, but also others\n";
  if (wrong > 0) text += fmt::format("{} not as documented\n", reports::counted(wrong, "result"));
  if (unanswered > 0) text += fmt::format("{} without an answer\n", reports::counted(unanswered, "computation"));
  if (wrong + unanswered == 0) text += "no result contradicts the documentation\n";
  return text;
}

// Returns the fusion plan of the source as --toolchains compiles it.   Throws: std::runtime_error with the compiler's
// first error; Stopped.
PlanOf plan_of(const std::string& name, const std::filesystem::path& source, const std::string& function,
               const Findings& measured, const std::vector<std::string>& flags) {
  Toolchain toolchain = measured.toolchain;
  if (toolchain.name.empty()) {  // a command compiles one language
    toolchain.name = measured.command;
    if (!subjects::is_cxx(measured.command)) std::swap(toolchain.cxx, toolchain.cc);
  }
  return {name, function == subjects::kPublishedFunction,
          subjects::contraction_plan(source, function, subjects::recipe_of(toolchain, source), flags)};
}

std::vector<PlanOf> plans_of_subjects(const Options& options, const Findings& measured) {
  const std::vector<std::string> flags = compiler_flags(options.flags);
  std::vector<PlanOf> plans;
  for (const std::string& text : options.subjects) {
    subjects::Wanted source = subjects::parse_subject(text);
    source.flags = flags;
    subjects::open(source);
    const subjects::Opened& opened = *subjects::opened(source.name);
    if (opened.kind != "source")
      throw UsageError(fmt::format("--subject {}: expected a C or C++ source, which a toolchain compiles, found {}",
                                   source.name, shown(source.what)));
    plans.push_back(plan_of(source.name, opened.file, subjects::function_of(opened), measured, flags));
  }
  return plans;
}

std::vector<PlanOf> plans_of_published(const Findings& measured) {
  std::vector<PlanOf> plans;
  for (const Lane* lane : subjects::published_algorithms()) {
    const std::string id(lane->info->id);
    try {
      plans.push_back(plan_of(id, subjects::published_source(*lane), subjects::kPublishedFunction, measured, {}));
    } catch (const std::runtime_error& error) {  // the command does not compile C++20
      plans.push_back({id, true, {{}, {}, error.what()}});
    }
  }
  return plans;
}

// Returns the line that covers all sources, if nothing is fused in any of them.
std::optional<std::string> in_one_line(const std::vector<PlanOf>& plans) {
  const ContractionPlan& first = plans.front().plan;
  for (const PlanOf& of : plans) {
    if (!of.plan.f32.empty() || !of.plan.f64.empty() || of.plan.not_read != first.not_read) return std::nullopt;
  }
  return first.not_read.empty() ? "none" : "not read: " + printable(first.not_read);
}

// One line for each algorithm and scalar; for a subject, also one for each line of its source.
std::string text_of(const std::vector<PlanOf>& plans) {
  const bool published = plans.front().published;
  std::string text =
      fmt::format("\nproducts fused into additions{}:", published ? ", in the published algorithms" : "");
  if (const auto all = in_one_line(plans); all && published) return text + ' ' + *all + '\n';
  text += '\n';
  std::size_t width = 0;
  for (const PlanOf& of : plans) width = std::max(width, of.name.size());
  for (const PlanOf& of : plans) {
    if (!of.plan.not_read.empty()) {
      text += fmt::format("  {:{}}  not read: {}\n", of.name, width + 4, printable(of.plan.not_read));
      continue;
    }
    for (const auto& [scalar, lines] : {std::pair("f32", &of.plan.f32), std::pair("f64", &of.plan.f64)}) {
      text += fmt::format("  {:{}}  {}\n", fmt::format("{}/{}", of.name, scalar), width + 4,
                          subjects::plan_in_words(*lines));
      if (published) continue;
      for (const subjects::FusedLine& line : *lines)
        text += fmt::format("    {}: {}: {}\n", printable(line.place()), line.operations, printable(line.code));
    }
  }
  return text;
}

nlohmann::ordered_json json_of(const std::vector<PlanOf>& plans) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const PlanOf& of : plans) {
    rows.push_back({{"name", of.name}});
    if (of.plan.not_read.empty()) {
      rows.back()["f32"] = subjects::plan_json(of.plan.f32);
      rows.back()["f64"] = subjects::plan_json(of.plan.f64);
    } else {
      rows.back()["not_read"] = of.plan.not_read;
    }
  }
  return rows;
}

nlohmann::ordered_json json_of(const Findings& measured) {
  const std::optional<Rounding> rounding = subjects::measured_rounding(measured.results);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (const CanaryResult& result : measured.results) {
    nlohmann::ordered_json bits = nlohmann::ordered_json::array();
    for (const std::uint64_t word : result.bits) bits.push_back(fmt::format("{:x}", word));
    nlohmann::ordered_json line = {{"name", result.name},
                                   {"scalar", result.scalar},
                                   {"code", result.code},
                                   {"bits", bits},
                                   {"found", result.found}};
    if (result.rounding) {
      line["rounding"] = name(*result.rounding);
      line["documentation"] = name(measured.documented(result));
    }
    results.push_back(std::move(line));
  }
  nlohmann::ordered_json json = {{"toolchain", measured.toolchain.name}, {"command", measured.command}};
  json["run"] = measured.toolchain.run;
  json["documented"] = {{"rounding", name(measured.claim.rounding)},
                        {"across_statements", measured.claim.across_statements},
                        {"because", measured.claim.because}};
  if (rounding) json["measured"] = name(*rounding);
  json["not_as_documented"] = measured.count(Documented::does_not_hold);
  json["without_answer"] = measured.unanswered();
  json["results"] = std::move(results);
  json["plans"] = json_of(measured.plans);
  return json;
}

int toolchain(const Options& options) {
  if (options.what.empty()) {
    list(subjects::selected_toolchains(options.list));
    return 0;
  }
  if (options.what == "hip") return list_hip_plans(options.subjects, compiler_flags(options.flags), options.json);
  Findings measured{wanted(options), "", {}, {}, {}};
  measured.command = measured.toolchain.cxx.empty() ? measured.toolchain.cc : measured.toolchain.cxx;
  measured.claim = claim_for(options, measured.toolchain, measured.command);
  measured.results = subjects::judge_canaries(subjects::run_canaries(measured.command, measured.toolchain.run));
  const StopSignals stops;
  measured.plans = options.subjects.empty() ? plans_of_published(measured) : plans_of_subjects(options, measured);
  if (!options.json.empty()) write_result(options.json, json_of(measured).dump(1) + '\n', fuzz::NamedBy::user);
  fmt::print("{}", text_of(measured));
  fmt::print("{}", text_of(measured.plans));
  return measured.count(Documented::does_not_hold) + measured.unanswered() > 0 ? 1 : 0;
}

}  // namespace

void add_toolchain(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("toolchain",
                                         "List toolchains, or measure how code from a toolchain or a compiler command "
                                         "rounds, and list the products that it fuses; exit with 1 if a result is not "
                                         "as documented");
  command->footer("Example: graze toolchain 'g++ -O2 -march=haswell'");
  auto options = std::make_shared<Options>();
  add_valued(*command, "toolchain", options->what, "NAME|COMMAND|hip",
             "Name of a toolchain, the command of a compiler with its flags, or hip: what hipcc fuses for AMD's "
             "GPUs (default: list the toolchains)");
  CLI::Option* run = add_valued(*command, "--run", options->run, "COMMAND",
                                "Command that runs the result, such as qemu-aarch64; {} is the result");
  CLI::Option* claims =
      add_valued(
          *command, "--claims", options->claims, "WORD",
          "What the compiler's flags are documented to do: rounded, contracted, excess or fast (default: from the "
          "table of toolchains, else from the flags of GCC or clang)")
          ->transform(one_of({"rounded", "contracted", "excess", "fast"}, Chosen::place));
  command
      ->add_option_function<std::string>(
          "--toolchains", [options](const std::string& file) { options->list += ',' + file; },
          "File with further toolchains; see docs/toolchains.md")
      ->option_text("FILE.toml");
  CLI::Option* json = add_valued(*command, "--json", options->json, "FILE", "File for the results");
  CLI::Option* subject = add_valued(*command, "--subject", options->subjects, "NAME=FILE[:FUNCTION]",
                                    "C or C++ source whose fused products are listed instead of those of the "
                                    "published algorithms. May be repeated")
                             ->allow_extra_args(false);
  CLI::Option* flags = add_valued(*command, "--flags", options->flags, "TEXT", "Compiler flags for the source")
                           ->allow_extra_args(false)
                           ->needs(subject);
  for (CLI::Option* option : {run, claims, json, subject, flags}) option->needs(command->get_option("toolchain"));
  command->callback([options, &status] { status = toolchain(*options); });
}

}  // namespace graze::cli
