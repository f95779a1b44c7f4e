// SPDX-License-Identifier: Apache-2.0
#include "reports/verdicts_apart.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "fuzz/counts_json.h"
#include "reports/discrepancy_reading.h"
#include "reports/findings.h"
#include "reports/plain_figures.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kOf[] = {"of_first", "of_second"};

Json row_of(const analysis::VerdictsApart& found) {
  Json row = {{"pairs", found.pairs},
              {"differs", found.differs},
              {"only_second_wrong", found.broken},
              {"only_first_wrong", found.mended}};
  for (int lane = 0; lane < 2; ++lane) row[kOf[lane]] = fuzz::counts_json(found.of[lane], true);
  return row;
}

std::uint64_t wrong(const Json& row, int lane) { return fuzz::counts_of(row.at(kOf[lane])).wrong(); }

// "thesis:1:42"; empty if no verdict differs.
std::string simplest_in(const Json& row) {
  return row.contains("simplest") ? text_at(row.at("simplest"), "place") : "";
}

// The counts of a source line: the name in the JSON, and the member.
constexpr std::pair<const char*, std::uint64_t analysis::LineApart::*> kLineCounts[] = {
    {"compared", &analysis::LineApart::compared},   {"differs", &analysis::LineApart::differs},
    {"zero_sign", &analysis::LineApart::zero_sign}, {"not_finite", &analysis::LineApart::not_finite},
    {"sign", &analysis::LineApart::sign},           {"outcome", &analysis::LineApart::outcome},
    {"verdict", &analysis::LineApart::verdict}};

Json operands_json(const analysis::OperandsApart& found) {
  Json lines = Json::array();
  for (const analysis::LineApart& of : found.lines) {
    Json& line = lines.emplace_back(Json{{"line", line_of(of.at)}, {"within", line_of(of.from)}});
    for (const auto& [name, count] : kLineCounts) line[name] = of.*count;
    line["below"] = octaves_json(of.below);
    line["above"] = octaves_json(of.above);
  }
  return {{"pairs", found.pairs}, {"verdict", found.verdict}, {"lines", lines}};
}

// The line's location without folders, such as "mine.cu:9".
std::string place_of(const Json& line) {
  const auto short_name = [&](const char* key) {
    return std::filesystem::path(text_at(line, key)).filename().string();
  };
  const std::string within = short_name("within");
  const bool is_own = !within.empty() && !within.starts_with("graze:");  // "graze:": Graze's call of the function
  return short_name("line") + (is_own ? " in " + within : "");
}

std::string ulps_words(const Octaves& sizes, double share) {
  const std::optional<int> k = quantile(sizes, share);
  return k ? fmt::format("< 2^{}", *k + 1) : "-";
}

// The lines at which an operand differs.
std::vector<const Json*> differing_lines(const Json& of) {
  std::vector<const Json*> lines;
  if (!of.contains("operands")) return lines;
  for (const Json& line : of.at("operands").at("lines")) {
    if (number_at(line, "differs") > 0) lines.push_back(&line);
  }
  return lines;
}

std::string operands_sentence(const Json& operands) {
  std::uint64_t compared = 0, differs = 0, outcome = 0, decided = 0, most = 0;
  std::string most_at;
  for (const Json& line : operands.at("lines")) {
    compared += number_at(line, "compared");
    differs += number_at(line, "differs");
    outcome += number_at(line, "outcome");
    decided += number_at(line, "verdict");
    if (number_at(line, "verdict") <= most) continue;
    most = number_at(line, "verdict");
    most_at = place_of(line);
  }
  std::string text = fmt::format(
      "On the first {} of these pairs, an operand differs in {} of {} comparisons; {} comparisons go the other way.",
      grouped(number_at(operands, "pairs")), rate_words(differs, compared), grouped(compared), grouped(outcome));
  const std::uint64_t verdicts = number_at(operands, "verdict");
  if (most > 0)
    text += fmt::format(" The comparison at {} is the first to go the other way for {} of {} differing verdicts.",
                        most_at, grouped(most), grouped(verdicts));
  if (decided < verdicts)
    text += fmt::format(" For {} of them no observed comparison goes the other way.", grouped(verdicts - decided));
  return text;
}

// The cells after the line's location, for both tables.
std::vector<std::string> line_cells(const Json& line) {
  const Octaves sizes = sizes_of(line);
  return {grouped(number_at(line, "compared")),
          rate_words(number_at(line, "differs"), number_at(line, "compared")),
          ulps_words(sizes, 0.5),
          ulps_words(sizes, 1),
          grouped(number_at(line, "outcome")),
          grouped(number_at(line, "verdict"))};
}

}  // namespace

std::string line_of(const cuda::SourceLine& line) {
  return *line.file == '\0' ? "" : fmt::format("{}:{}", line.file, line.line);
}

Json verdicts_json(const analysis::TwoDeciders& deciders, const std::vector<strata::PairSource>& sources,
                   const std::vector<analysis::VerdictsApart>& found, const analysis::OperandsApart* operands) {
  analysis::VerdictsApart total;
  Json strata = Json::object();
  for (std::size_t s = 0; s < sources.size(); ++s) {
    total += found[s];
    Json& row = strata[sources[s].id] = row_of(found[s]);
    if (const auto& simplest = found[s].simplest)
      row["simplest"] = {{"place", fmt::format("{}:{}:{}", sources[s].id, sources[s].seed, simplest->index)},
                         {"pair", coordinates_of(sources[s].any_pair(simplest->index))}};
  }
  Json of = {{"first", deciders.lanes[0]->id},
             {"second", deciders.lanes[1]->id},
             {"total", row_of(total)},
             {"strata", strata}};
  if (operands && operands->why_not.empty()) of["operands"] = operands_json(*operands);
  if (operands && !operands->why_not.empty()) of["why_no_operands"] = operands->why_not;
  return of;
}

std::string verdicts_sentence(const Json& of) {
  const Json& total = of.at("total");
  const std::uint64_t pairs = number_at(total, "pairs");
  const auto rate = [&](std::uint64_t count) { return rate_words(count, pairs); };
  std::string verdicts =
      fmt::format("{0} and {1} give different verdicts on {2} of {3} pairs; {0} is wrong on {4}, {1} on {5}. ",
                  text_at(of, "first"), text_at(of, "second"), rate(number_at(total, "differs")), grouped(pairs),
                  rate(wrong(total, 0)), rate(wrong(total, 1)));
  const auto count = [&](const char* key) { return grouped(number_at(total, key)); };
  if (number_at(total, "differs") > 0)
    verdicts += fmt::format("Where they differ, {} alone is wrong on {} pairs, {} alone on {}. ", text_at(of, "first"),
                            count("only_first_wrong"), text_at(of, "second"), count("only_second_wrong"));
  if (text_at(of, "first").ends_with("/cuda-nofma") && text_at(of, "second").ends_with("/cuda-fma"))
    verdicts += "Built with -fmad=false, your code gives the verdicts of cuda-nofma. ";
  if (of.contains("operands")) return verdicts + operands_sentence(of.at("operands"));
  return verdicts + "Only verdicts are compared: " +
         (of.contains("why_no_operands") ? text_at(of, "why_no_operands") + "."
                                         : "Graze compares values inside the lanes that it builds itself. Inside your "
                                           "own code it does so only between cuda-nofma and cuda-fma of a CUDA source, "
                                           "if they differ.");
}

std::string verdicts_table(const Json& of, const Screen& screen) {
  TextTable table({{"stratum", Align::left},
                   {"pairs"},
                   {"verdict differs"},
                   {"first wrong"},
                   {"second wrong"},
                   {"simplest pair", Align::left}});
  for (const auto& [stratum, counts] : of.at("strata").items()) {
    const auto number = [](std::uint64_t count) { return Cell(grouped(count), count > 0); };
    const std::string simplest = simplest_in(counts);
    table.add({stratum, grouped(number_at(counts, "pairs")), number(number_at(counts, "differs")),
               number(wrong(counts, 0)), number(wrong(counts, 1)), simplest.empty() ? "-" : simplest});
  }
  std::string text =
      wrapped(fmt::format("First: {}. Second: {}.", text_at(of, "first"), text_at(of, "second")), screen.columns) +
      table.text(screen);
  if (const std::vector<const Json*> differing = differing_lines(of); !differing.empty()) {
    TextTable lines({{"line", Align::left},
                     {"comparisons"},
                     {"an operand differs"},
                     {"median, ulps"},
                     {"largest, ulps"},
                     {"goes the other way"},
                     {"decides the verdict"}});
    for (const Json* line : differing) {
      std::vector<Cell> row = {place_of(*line)};
      for (const std::string& cell : line_cells(*line)) row.emplace_back(cell);
      lines.add(std::move(row));
    }
    text += lines.text(screen);
  }
  return text;
}

std::string verdicts_section(const Json& of) {
  std::string text = fmt::format("<h2>{} against {}</h2>\n<p>{}</p>\n", html(text_at(of, "first")),
                                 html(text_at(of, "second")), html(verdicts_sentence(of)));
  text +=
      "<div class=\"wide\"><table><tr><th>stratum</th><th>pairs</th><th>verdict differs</th><th>first wrong</th>"
      "<th>second wrong</th><th>simplest pair</th></tr>\n";
  for (const auto& [stratum, counts] : of.at("strata").items()) {
    text += "<tr><td>" + html(stratum) + "</td>";
    for (const std::uint64_t count :
         {number_at(counts, "pairs"), number_at(counts, "differs"), wrong(counts, 0), wrong(counts, 1)})
      text += fmt::format("<td class=\"number\">{}</td>", grouped(count));
    text += "<td>" + html(simplest_in(counts)) + "</td></tr>\n";
  }
  text += "</table></div>\n";
  if (const std::vector<const Json*> differing = differing_lines(of); !differing.empty()) {
    text +=
        "<h3>By line</h3>\n<div class=\"wide\"><table><tr><th>line of your source</th><th>comparisons</th><th>an "
        "operand differs</th>"
        "<th>median, ulps</th><th>largest, ulps</th><th>goes the other way</th><th>decides the verdict</th></tr>\n";
    for (const Json* line : differing) {
      text += "<tr><td>" + html(place_of(*line)) + "</td>";
      for (const std::string& cell : line_cells(*line)) text += "<td class=\"number\">" + html(cell) + "</td>";
      text += "</tr>\n";
    }
    text += "</table></div>\n";
  }
  return text;
}

std::string verdicts_csv(const Json& of) {
  std::string text;
  for (const auto& [stratum, counts] : of.at("strata").items()) {
    const std::string start = fmt::format("{},{},{},\"\",", text_at(of, "first"), text_at(of, "second"), stratum);
    const auto add = [&](const char* value, const std::string& count, const Json& number) {
      if (number != 0) text += fmt::format("{}\"{}\",{},,{}\n", start, value, count, number.get<std::uint64_t>());
    };
    add("", "pairs", counts.at("pairs"));
    add("", "verdict", counts.at("differs"));
    for (const char* key : {"only_second_wrong", "only_first_wrong"}) add("", key, counts.at(key));
    for (const char* lane : kOf) {
      for (const auto& [name, count] : counts.at(lane).items()) add(lane, name, count);
    }
  }
  for (const Json* line : differing_lines(of)) {
    text += csv_rows(fmt::format("{},{},,\"{}\",\"\",", text_at(of, "first"), text_at(of, "second"), place_of(*line)),
                     *line);
  }
  return text;
}

void expect_possible_verdicts(const Json& of) {
  const auto expect = [](bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error("impossible counts of verdicts: " + what);
  };
  analysis::VerdictsApart sum;
  const auto read = [&](const Json& row, const std::string& what) {
    analysis::VerdictsApart counts;
    counts.pairs = number_at(row, "pairs");
    counts.differs = number_at(row, "differs");
    counts.broken = number_at(row, "only_second_wrong");
    counts.mended = number_at(row, "only_first_wrong");
    std::uint64_t not_true = 0;
    for (int lane = 0; lane < 2; ++lane) {
      counts.of[lane] = fuzz::counts_of(row.at(kOf[lane]));
      const std::uint64_t others = counts.of[lane].not_true();
      expect(others <= counts.pairs, what + ": more wrong verdicts than pairs");
      not_true += others;
    }
    expect(counts.differs <= counts.pairs && counts.differs <= not_true, what + ": more differences than errors");
    expect(counts.broken <= counts.differs && counts.mended <= counts.differs - counts.broken &&
               counts.broken <= counts.of[1].wrong() && counts.mended <= counts.of[0].wrong(),
           what + ": more wrong verdicts of one lane alone than it has");
    return counts;
  };
  for (const auto& [stratum, row] : of.at("strata").items()) {
    const analysis::VerdictsApart counts = read(row, stratum);
    expect((counts.differs > 0) == row.contains("simplest"), stratum + ": a simplest pair without a difference");
    sum += counts;
  }
  expect(read(of.at("total"), "total") == sum, "the total is not that of the strata");
  if (!of.contains("operands")) return;
  const Json& operands = of.at("operands");
  std::uint64_t decided = 0;
  for (const Json& line : operands.at("lines")) {
    const auto all = [&](const char* name) { return number_at(line, name); };
    std::uint64_t sizes = all("zero_sign") + all("not_finite");
    for (const auto& [k, count] : sizes_of(line)) sizes += count;
    expect(all("verdict") <= all("outcome") && all("outcome") <= all("sign") && all("sign") <= all("differs") &&
               all("differs") <= all("compared") && all("differs") == sizes,
           text_at(line, "line") + ": a part is more than the whole");
    decided += all("verdict");
  }
  expect(decided <= number_at(operands, "verdict") && number_at(operands, "verdict") <= number_at(operands, "pairs") &&
             number_at(operands, "pairs") <= sum.pairs,
         "more operands decide than verdicts differ");
}

}  // namespace graze::reports
