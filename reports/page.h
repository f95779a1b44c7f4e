// SPDX-License-Identifier: Apache-2.0
// The page of a report: one HTML file that needs nothing else.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Whether this build has the page of reports/web, which takes Node to build.
bool has_interactive_page();

// The report in the page of reports/web if this build has that, else in a plain one; with what the viewer takes. costs:
// what make_costs returns. choices: what make_choices returns.
std::string page(const nlohmann::ordered_json& report, const nlohmann::ordered_json& costs,
                 const nlohmann::ordered_json& choices);

// Tables and drawings without any script; says what it lacks.
std::string plain_page(const nlohmann::ordered_json& report, const nlohmann::ordered_json& costs,
                       const nlohmann::ordered_json& choices);

// The template's text with data in place of what stands in its element <script type="application/json" id="…">.
// Throws: std::logic_error for a text without that element.
std::string with_data(std::string_view page_template, const char* id, const nlohmann::ordered_json& data);

// All inside a template, in its elements <script type="application/json" id="report">, id="costs" and id="choices".
// Throws: std::logic_error for a text without them.
std::string filled(std::string_view page_template, const nlohmann::ordered_json& report,
                   const nlohmann::ordered_json& costs, const nlohmann::ordered_json& choices);

}  // namespace graze::reports
