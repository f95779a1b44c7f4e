// SPDX-License-Identifier: Apache-2.0
#include "reports/verdicts_apart.h"

#include <fmt/format.h>

#include <stdexcept>

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
  Json row = {{"pairs", found.pairs}, {"differs", found.differs}};
  for (int lane = 0; lane < 2; ++lane) row[kOf[lane]] = fuzz::counts_json(found.of[lane], true);
  return row;
}

std::uint64_t wrong(const Json& row, int lane) { return fuzz::counts_of(row.at(kOf[lane])).wrong(); }

// "thesis:1:42"; empty if no verdict differs.
std::string simplest_in(const Json& row) {
  return row.contains("simplest") ? text_at(row.at("simplest"), "place") : "";
}

struct VerdictsRow {
  std::string stratum;
  const Json& counts;
};

std::vector<VerdictsRow> rows_of(const Json& of) {
  std::vector<VerdictsRow> rows;
  for (const auto& [stratum, counts] : of.at("strata").items()) rows.push_back({stratum, counts});
  return rows;
}

}  // namespace

Json verdicts_json(const analysis::TwoDeciders& deciders, const std::vector<strata::PairSource>& sources,
                   const std::vector<analysis::VerdictsApart>& found) {
  analysis::VerdictsApart total;
  Json strata = Json::object();
  for (std::size_t s = 0; s < sources.size(); ++s) {
    total += found[s];
    Json& row = strata[sources[s].id] = row_of(found[s]);
    if (const auto& simplest = found[s].simplest)
      row["simplest"] = {{"place", fmt::format("{}:{}:{}", sources[s].id, sources[s].seed, simplest->index)},
                         {"pair", coordinates_of(sources[s].pair(simplest->index))}};
  }
  return {{"first", deciders.lanes[0]->id},
          {"second", deciders.lanes[1]->id},
          {"total", row_of(total)},
          {"strata", strata}};
}

std::string verdicts_sentence(const Json& of) {
  const Json& total = of.at("total");
  const std::uint64_t pairs = number_at(total, "pairs");
  const auto rate = [&](std::uint64_t count) { return rate_words(part_of(count, pairs)); };
  return fmt::format(
      "{0} and {1} give different verdicts on {2} of {3} pairs; {0} is wrong on {4}, {1} on {5}. Only verdicts are "
      "compared: Graze sees no values inside your own code.",
      text_at(of, "first"), text_at(of, "second"), rate(number_at(total, "differs")), grouped(pairs),
      rate(wrong(total, 0)), rate(wrong(total, 1)));
}

std::string verdicts_table(const Json& of, const Screen& screen) {
  TextTable table({{"stratum", Align::left},
                   {"pairs"},
                   {"verdict differs"},
                   {"first wrong"},
                   {"second wrong"},
                   {"simplest pair", Align::left}});
  for (const auto& [stratum, counts] : rows_of(of)) {
    const auto number = [](std::uint64_t count) { return Cell(grouped(count), count > 0); };
    const std::string simplest = simplest_in(counts);
    table.add({stratum, grouped(number_at(counts, "pairs")), number(number_at(counts, "differs")),
               number(wrong(counts, 0)), number(wrong(counts, 1)), simplest.empty() ? "-" : simplest});
  }
  return table.text(screen);
}

std::string verdicts_section(const Json& of) {
  std::string text = fmt::format("<h2>{} against {}</h2>\n<p>{}</p>\n", html(text_at(of, "first")),
                                 html(text_at(of, "second")), html(verdicts_sentence(of)));
  text +=
      "<div class=\"wide\"><table><tr><th>stratum</th><th>pairs</th><th>verdict differs</th><th>first wrong</th>"
      "<th>second wrong</th><th>simplest pair</th></tr>\n";
  for (const auto& [stratum, counts] : rows_of(of)) {
    text += "<tr><td>" + html(stratum) + "</td>";
    for (const std::uint64_t count :
         {number_at(counts, "pairs"), number_at(counts, "differs"), wrong(counts, 0), wrong(counts, 1)})
      text += fmt::format("<td class=\"number\">{}</td>", grouped(count));
    text += "<td>" + html(simplest_in(counts)) + "</td></tr>\n";
  }
  return text + "</table></div>\n";
}

std::string verdicts_csv(const Json& of) {
  std::string text;
  for (const auto& [stratum, counts] : rows_of(of)) {
    const std::string start = fmt::format("{},{},{},\"\",", text_at(of, "first"), text_at(of, "second"), stratum);
    const auto add = [&](const char* value, const std::string& count, const Json& number) {
      if (number != 0) text += fmt::format("{}\"{}\",{},,{}\n", start, value, count, number.get<std::uint64_t>());
    };
    add("", "pairs", counts.at("pairs"));
    add("", "verdict", counts.at("differs"));
    for (const char* lane : kOf) {
      for (const auto& [name, count] : counts.at(lane).items()) add(lane, name, count);
    }
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
    std::uint64_t not_true = 0;
    for (int lane = 0; lane < 2; ++lane) {
      counts.of[lane] = fuzz::counts_of(row.at(kOf[lane]));
      const std::uint64_t others = counts.of[lane].not_right() + counts.of[lane].by_convention;
      expect(others <= counts.pairs, what + ": more wrong verdicts than pairs");
      not_true += others;
    }
    expect(counts.differs <= counts.pairs && counts.differs <= not_true, what + ": more differences than errors");
    return counts;
  };
  for (const auto& [stratum, row] : of.at("strata").items()) {
    const analysis::VerdictsApart counts = read(row, stratum);
    expect((counts.differs > 0) == row.contains("simplest"), stratum + ": a simplest pair without a difference");
    sum += counts;
  }
  expect(read(of.at("total"), "total") == sum, "the total is not that of the strata");
}

}  // namespace graze::reports
