// SPDX-License-Identifier: Apache-2.0
// The page of a report: one self-contained HTML file.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Whether this build has the page of reports/web, which is built with Node.
bool has_interactive_page();

// Returns the report as the page of reports/web with the viewer's data, or as a plain page if this build has no such
// page.
// costs: the result of make_costs.   choices: the result of make_choices.
std::string page(const nlohmann::ordered_json& report, const nlohmann::ordered_json& costs,
                 const nlohmann::ordered_json& choices);

// Returns a page of tables and drawings without scripts, with a note about the parts that it lacks.
std::string plain_page(const nlohmann::ordered_json& report, const nlohmann::ordered_json& costs,
                       const nlohmann::ordered_json& choices);

// Returns the template after replacing the contents of its element <script type="application/json" id="ID"> by `data`.
// Throws: std::logic_error if the text has no such element.
std::string with_data(std::string_view page_template, const char* id, const nlohmann::ordered_json& data);

// Fills the template's elements <script type="application/json"> with the ids "report", "costs" and "choices".
// Throws: std::logic_error if the text lacks one of them.
std::string filled(std::string_view page_template, const nlohmann::ordered_json& report,
                   const nlohmann::ordered_json& costs, const nlohmann::ordered_json& choices);

}  // namespace graze::reports
