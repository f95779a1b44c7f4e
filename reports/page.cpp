// SPDX-License-Identifier: Apache-2.0
#include "reports/page.h"

#include <stdexcept>

namespace graze::reports {
namespace {

constexpr char kText[] =
#include "page_template.inc"
    ;
constexpr std::string_view kPageTemplate(kText, sizeof kText - 1);

}  // namespace

bool has_interactive_page() { return !kPageTemplate.empty(); }

std::string page(const nlohmann::ordered_json& report) {
  return has_interactive_page() ? filled(kPageTemplate, report) : plain_page(report);
}

std::string filled(std::string_view page_template, const nlohmann::ordered_json& report) {
  constexpr std::string_view kElement = "<script type=\"application/json\" id=\"report\">";
  const std::size_t element = page_template.find(kElement);
  const std::size_t begin = element + kElement.size(), end = page_template.find("</script>", begin);
  if (element == page_template.npos || end == page_template.npos)
    throw std::logic_error("expected a page with an element for the report, found none");
  std::string text(page_template.substr(0, begin));
  for (const char c : report.dump()) {  // no "</script>" or "<!--" inside
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text.append(page_template.substr(end));
}

}  // namespace graze::reports
