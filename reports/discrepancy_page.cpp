// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/discrepancy_reading.h"
#include "reports/findings.h"
#include "reports/plain_figures.h"
#include "reports/snippet.h"
#include "reports/terminal.h"
#include "reports/verdicts_apart.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLinesShown = 10;

constexpr const char* kDiscrepancyStyle = R"(td.code { font-family: ui-monospace, monospace; white-space: pre; }
svg { width: 100%; height: auto; min-width: 42rem; max-width: 56rem; }
th { white-space: normal; vertical-align: bottom; }
summary { font-weight: bold; cursor: pointer; }
.paper { display: none; }
@media print {
  @page { margin: 12mm; }
  body { font-size: 10px; padding: 0; max-width: none; }
  .paper { display: block; }
  .wide { overflow: visible; }
  svg { min-width: 0; max-width: 75%; break-inside: avoid; }
  h3, p { break-after: avoid; }
  table { font-size: 7.5px; max-width: 100%; }
  th, td { white-space: normal; overflow-wrap: anywhere; padding: 0.1rem 0.3rem; }
  td.number { white-space: nowrap; }
  td.code { white-space: pre-wrap; }
  tr { break-inside: avoid; }
}
)";

std::string cell(const std::string& text, const char* kind = "number") {
  return fmt::format("<td class=\"{}\">{}</td>", kind, html(text));
}

std::string questions_table(const Json& of) {
  std::string text =
      "<div class=\"wide\"><table><tr><th>question</th><th>asked</th><th>a value differs</th><th>sign</th><th>zero on "
      "one "
      "side</th><th>outcome</th><th>decides the verdict</th><th>band, in bounds</th><th>band, as a length</th></tr>\n";
  for (const Json& question : of.at("total").at("questions")) {
    const std::uint64_t asked = number_at(question, "asked");
    if (number_at(question, "differs") == 0) continue;
    text += "<tr>" + cell(text_at(question, "question"), "name") + cell(grouped(asked));
    for (const char* count : {"differs", "sign", "zero_on_one_side", "outcome"})
      text += cell(rate_words(number_at(question, count), asked));
    text += cell(grouped(number_at(question, "verdict")));
    for (const char* largest : {"largest_in_bounds", "largest_length"}) {
      const double size = question.at(largest);
      text += cell(number_at(question, "sign") == 0 ? "-" : fmt::format("{:.3g}", size));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string shares_header(const char* of) {
  return fmt::format(
      "<div class=\"wide\"><table><tr><th>{}</th><th>pairs</th><th>a value differs</th><th>a sign</th><th>a "
      "comparison</th><th>the verdict</th></tr>\n",
      of);
}

std::string shares_row(const std::string& name, const Json& counts) {
  const std::uint64_t pairs = number_at(counts, "pairs");
  std::string row = "<tr>" + cell(name, "name") + cell(grouped(pairs));
  for (const char* count : {"differs", "sign", "outcome", "verdict"})
    row += cell(rate_words(number_at(counts, count), pairs));
  return row + "</tr>\n";
}

std::string strata_table(const Json& of) {
  std::string text = shares_header("stratum");
  for (const auto& [stratum, counts] : of.at("strata").items()) text += shares_row(stratum, counts);
  return text + "</table></div>\n";
}

std::string lanes_table(const Json& json) {
  std::string text = shares_header("lanes");
  for (const Json& of : json.at("lanes")) text += shares_row(title_of(of), of.at("total"));
  return text + "</table></div>\n";
}

// The simplest pair whose verdict the line changes, as numbers that `graze explain` reads.
std::string simplest_cell(const Json& line) {
  if (line.at("simplest").is_null()) return cell("-");
  std::string numbers;
  for (const Json& number : line.at("simplest").at("decimal"))
    numbers += (numbers.empty() ? "" : " ") + number.get<std::string>();
  return "<td><details><summary>show</summary><code>" + html(numbers) + "</code></details></td>";
}

std::string lines_table(const Json& origins) {
  std::vector<const Json*> lines = by_weight(origins);
  std::erase_if(lines,
                [](const Json* line) { return number_at(*line, "values") + number_at(*line, "verdicts_fixed") == 0; });
  std::string text = fmt::format(
      "<p>Contraction changes the verdict on {} of {} traced pairs. The source lines whose products are fused, by "
      "their effect:</p>\n<div class=\"wide\"><table><tr><th>line</th><th>source</th><th>within</th><th>values that it "
      "changes "
      "alone</th><th>verdicts, alone</th><th>verdicts that return without it</th><th>simplest pair</th></tr>\n",
      grouped(number_at(origins, "verdicts")), grouped(number_at(origins, "pairs")));
  for (std::size_t l = 0; l < std::min(lines.size(), kMostLinesShown); ++l) {
    const Json& line = *lines[l];
    text += "<tr>" + cell(text_at(line, "line"), "name") + cell(source_line(text_at(line, "line")), "code") +
            cell(text_at(line, "within"), "name") + cell(grouped(number_at(line, "values"))) +
            cell(grouped(number_at(line, "verdicts_alone"))) + cell(grouped(number_at(line, "verdicts_fixed"))) +
            simplest_cell(line) + "</tr>\n";
  }
  text +=
      "</table></div>\n<p>Each value first differs at some line, because of a single rounding there. The table shows "
      "how far the value has moved by the time it is compared; cancellation moves it further:</p>\n<div "
      "class=\"wide\"><table><tr><th>value</th><th>first line, "
      "most often</th><th>median</th><th>99 %</th><th>largest</th></tr>\n";
  for (const Json& start : origins.at("starts")) {
    const Octaves growth = octaves_at(start.at("growth"));
    std::string line = "several lines together";
    std::uint64_t most = 0;
    for (const auto& [place, count] : start.at("by_line").items()) {
      if (count.get<std::uint64_t>() > most) {
        most = count.get<std::uint64_t>();
        line = text_at(origins.at("lines").at(static_cast<std::size_t>(std::stoul(place))), "line");
      }
    }
    const auto at_most = [&](double of_all) {
      const std::optional<int> k = quantile(growth, of_all);
      return k ? fmt::format("under 2^{} ulps", *k + 1) : "-";
    };
    text += "<tr>" + cell(text_at(start, "value"), "name") + cell(line, "name") + cell(at_most(0.5)) +
            cell(at_most(0.99)) + cell(at_most(1)) + "</tr>\n";
  }
  return text + "</table></div>\n";
}

// The coordinate types of the pairs; empty if all are float32.
std::string coordinates_words(const Json& json) {
  if (!json.contains("coordinates")) return "";
  return text_at(json, "coordinates") == "f64" ? ", with coordinates in double"
                                               : ", with coordinates in float32 or in double";
}

// The build that made the results, if they record it.
std::string build_words(const Json& json) {
  if (!json.contains("build")) return "";
  const Json& build = json.at("build");
  return fmt::format(" Graze {}, commit {}; {}; {}.", text_at(build, "version"), text_at(build, "commit"),
                     text_at(build, "compiler"), build.at("cuda").is_null() ? "no nvcc" : text_at(build, "cuda"));
}

std::string comparison_section(const Json& of, bool open) {
  const Json& total = of.at("total");
  const std::string title = title_of(of);
  if (number_at(total, "differs") == 0) {
    return fmt::format("<p><b>{}</b>: all {} values on {} pairs have the same bits; {} verdicts differ.</p>\n",
                       html(title), grouped(sum_at(total, "compared")), grouped(number_at(total, "pairs")),
                       grouped(number_at(total, "verdict")));
  }
  std::string text = fmt::format("<details{}><summary>{}</summary>\n", open ? " open" : "", html(title));
  for (const std::string& figure :
       {funnel_figure(of), differences_figure(of), errors_figure(of), band_figure(of), extremes_figures(of)})
    text += "<div class=\"wide\">\n" + figure + "</div>\n";
  text += "<h3>By question</h3>\n" + questions_table(of) + "<h3>By stratum</h3>\n" + strata_table(of);
  if (!of.at("origins").is_null())
    text += "<h3>Where it starts, and how it grows</h3>\n" + lines_table(of.at("origins"));
  return text + "</details>\n";
}

}  // namespace

std::string discrepancy_page(const Json& json) {
  std::string text = page_head("Graze: CPU against GPU, value by value", kDiscrepancyStyle);
  text += "<h1>CPU against GPU, value by value</h1>\n<ol>\n";
  for (const std::string& sentence : discrepancy_answer(json)) text += "<li>" + html(sentence) + "</li>\n";
  text += fmt::format(
      "</ol>\n<p>{} pairs of triangles{} for each pair of lanes, seed {}{}. All counts are in the JSON and CSV files "
      "beside this page.{}</p>\n",
      grouped(number_at(json, "pairs")), coordinates_words(json), number_at(json, "seed"),
      json.contains("scene") ? ", scene " + html(text_at(json, "scene")) : "", html(build_words(json)));
  if (json.at("lanes").size() > 1) text += "<h2>Share of the pairs</h2>\n" + lanes_table(json);
  text += "<p class=\"paper\">Sections that are closed on the screen are not printed.</p>\n";
  const std::vector<const Json*> lanes = differing_lanes(json);
  for (const Json& of : json.at("lanes")) text += comparison_section(of, lanes.size() == 1 && &of == lanes[0]);
  for (const Json& of : json.value("verdicts", Json::array())) text += verdicts_section(of);
  return text + "</body>\n</html>\n";
}

}  // namespace graze::reports
