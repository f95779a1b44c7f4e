// SPDX-License-Identifier: Apache-2.0
// `graze check`: prints the truth and every lane's verdict for pairs from a file or a pipe.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "analysis/convention.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/screen.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "oracle/truth.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

struct CheckOptions {
  std::string file;
  LaneOptions lanes;
  bool json = false;
  bool truth_only = false;
  bool exact_input = false;
};

void check(const CheckOptions& options) {
  const bool from_stdin = options.file == "-";
  std::ifstream file;
  if (!from_stdin) file = corpus::open_pairs(options.file);
  fuzz::SelectedLanes under_test;
  if (!options.truth_only) under_test = selected_lanes(options.lanes, options.file);
  std::string evidence = cuda_evidence(under_test);
  const std::string name_of_input = from_stdin ? "standard input" : options.file;
  corpus::PairReader reader(from_stdin ? std::cin : file, name_of_input, PairTypes::both);
  std::size_t number_of_pair = 0;
  bool wrong = false, any_doubles = false;
  for (; const auto entry = reader.next(); ++number_of_pair) {
    if (entry->doubles && !std::exchange(any_doubles, true) && !options.truth_only) {
      take_doubles(under_test);
      evidence = cuda_evidence(under_test);
    }
    if (options.exact_input) expect_exact_input(name_of_input, *entry);
    const oracle::Truth t = truth_of(*entry);
    const std::string note = written_note(*entry, t), stored = stored_verdicts(*entry, under_test.left_out, t.verdict);
    const std::vector<Verdict> verdicts =
        options.truth_only ? std::vector<Verdict>() : decide(under_test, corpus::pair_of(*entry));
    const std::vector<Verdict> counted = analysis::excused(under_test.lanes, verdicts, corpus::pair_of(*entry), t);
    wrong = wrong || some_is_wrong(counted, t.verdict);
    if (options.json) {
      nlohmann::ordered_json line = {{"pair", number_of_pair},
                                     {"truth",
                                      {{"verdict", name(t.verdict)},
                                       {"contact", name(t.contact)},
                                       {"margin", t.margin},  // null if it is not finite
                                       {"margin_ulps", t.margin_ulps}}},
                                     {"lanes", nlohmann::ordered_json::object()}};
      if (entry->doubles) line["coordinates"] = name(Scalar::f64);
      for (std::size_t l = 0; l < verdicts.size(); ++l) line["lanes"][under_test.lanes[l]->id] = name(verdicts[l]);
      if (!evidence.empty()) line["cuda"] = evidence;
      fuzz::add_left_out(line, under_test);
      if (!stored.empty()) line["stored"] = stored;
      if (!note.empty()) line["note"] = note;
      fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    } else {
      const std::string* label = corpus::field(*entry, "name");
      fmt::print("pair {}, line {}{}\n", number_of_pair, entry->line, label ? ": " + printable(*label) : "");
      std::fflush(stdout);
      reports::print_pair(std::cout, corpus::pair_of(*entry), t, under_test.lanes, verdicts, output_screen());
      if (!evidence.empty()) std::cout << reports::wrapped("CUDA lanes: " + evidence, output_screen().columns, 2, 4);
      for (const std::string& text : {stored, note})
        if (!text.empty()) std::cout << reports::wrapped(text, output_screen().columns, 2, 4);
      std::cout.flush();
    }
  }
  if (from_stdin && std::ferror(stdin))
    throw std::runtime_error(
        fmt::format("cannot read standard input after {}: an input error", reports::counted(number_of_pair, "pair")));
  if (number_of_pair == 0) throw std::runtime_error("there is no pair in " + name_of_input);
  if (wrong && !from_stdin && !options.json)
    fmt::print("Next: graze explain {}{}\n", path_word(options.file), own_words(options.lanes));
}

}  // namespace

void add_check(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand("check", "Print the truth and every lane's verdict for the pairs of a file");
  command->footer("Example: echo '0 0 0 1 0 0 0 1 0  0 0 1 1 0 1 0 1 1' | graze check -");
  auto options = std::make_shared<CheckOptions>();
  command->add_option("FILE", options->file, "File of pairs, 18 numbers per line; - is standard input")->required();
  add_lane_options(*command, options->lanes);
  add_resubject_option(*command, options->lanes);
  add_exact_input(*command, options->exact_input);
  command->add_flag("--json", options->json, "Print one JSON object per line, one line per pair");
  command->add_flag("--truth-only", options->truth_only, "Print only the truth; run no lane")
      ->excludes("--lanes")
      ->excludes("--subject")
      ->excludes("--toolchains")
      ->excludes("--resubject")
      ->excludes("--executor");
  command->callback([options] { check(*options); });
}

}  // namespace graze::cli
