// SPDX-License-Identifier: Apache-2.0
#include "reports/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "reports/viewer.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kText[] =
#include "page_template.inc"
    ;
constexpr std::string_view kPageTemplate(kText, sizeof kText - 1);

}  // namespace

std::string with_data(std::string_view text, const char* id, const Json& data) {
  const std::string start = fmt::format("<script type=\"application/json\" id=\"{}\">", id);
  const std::size_t element = text.find(start);
  const std::size_t begin = element + start.size(), end = text.find("</script>", begin);
  if (element == text.npos || end == text.npos)
    throw std::logic_error(fmt::format("expected a page with an element for the {}, found none", id));
  std::string filled(text.substr(0, begin));
  for (const char c : data.dump()) {  // the data must not contain "</script>" or "<!--"
    if (c == '<') {
      filled += "\\u003c";
    } else {
      filled += c;
    }
  }
  return filled.append(text.substr(end));
}

bool has_interactive_page() { return !kPageTemplate.empty(); }

std::string page(const Json& report, const Json& costs, const Json& choices) {
  if (!has_interactive_page()) return plain_page(report, costs, choices);
  // The viewer's parts for the coordinate types that the cards use.
  Json parts = has_viewer() ? Json::object() : Json();
  for (const Scalar type : {Scalar::f32, Scalar::f64}) {
    const auto is_of_type = [&](const Json& card) { return card.at("coordinates") == name(type); };
    const Json& cards = report.at("cards");
    if (has_viewer() && std::any_of(cards.begin(), cards.end(), is_of_type)) parts[name(type)] = viewer_parts(type);
  }
  return filled(with_data(kPageTemplate, "view", parts), report, costs, choices);
}

std::string filled(std::string_view page_template, const Json& report, const Json& costs, const Json& choices) {
  return with_data(with_data(with_data(page_template, "choices", choices), "costs", costs), "report", report);
}

}  // namespace graze::reports
