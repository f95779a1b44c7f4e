// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "reports/discrepancy.h"
#include "reports/discrepancy_reading.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {

namespace {
using Json = nlohmann::ordered_json;
}

std::string discrepancy_changes(const Json& before, const Json& after, const Screen& screen) {
  const auto lanes_of = [](const Json& of) { return text_at(of, "first") + " against " + text_at(of, "second"); };
  std::string text;
  std::size_t same = 0;
  TextTable table({{"lanes", Align::left}, {"question", Align::left}, {"count", Align::left}, {"before"}, {"after"}});
  // Calls with_both(old, now) for each comparison that is in both results.
  const auto match = [&](const char* kind, const auto& with_both) {
    const Json old_ones = before.value(kind, Json::array()), new_ones = after.value(kind, Json::array());
    const auto in = [&](const Json& list, const Json& wanted) {
      return std::find_if(list.begin(), list.end(), [&](const Json& of) { return lanes_of(of) == lanes_of(wanted); });
    };
    for (const Json& of : old_ones) {
      const auto now = in(new_ones, of);
      if (now == new_ones.end()) {
        text += wrapped(fmt::format("Only the first has {}.", lanes_of(of)), screen.columns);
      } else {
        with_both(of, *now);
      }
    }
    for (const Json& of : new_ones) {
      if (in(old_ones, of) == old_ones.end())
        text += wrapped(fmt::format("Only the second has {}.", lanes_of(of)), screen.columns);
    }
  };
  const auto compare = [&](const Json& of, const std::string& question, const Json& old_counts,
                           const Json& new_counts) {
    for (const auto& [name, count] : old_counts.items()) {
      if (!count.is_number_unsigned() || !new_counts.contains(name)) continue;
      if (count == new_counts.at(name)) {
        ++same;
      } else {
        table.add(
            {lanes_of(of), question, name, grouped(count.get<std::uint64_t>()), grouped(number_at(new_counts, name))});
      }
    }
  };
  const auto compare_origins = [&](const Json& of, const Json& old_ones, const Json& new_ones) {
    compare(of, "origins", old_ones, new_ones);
    for (const Json& line : old_ones.at("lines")) {
      for (const Json& other : new_ones.at("lines")) {
        if (line.at("line") == other.at("line") && line.at("within") == other.at("within"))
          compare(of, text_at(line, "line"), line, other);
      }
    }
    for (const Json& start : old_ones.at("starts")) {
      for (const Json& other : new_ones.at("starts")) {
        if (start.at("question") == other.at("question") && start.at("value") == other.at("value"))
          compare(of, "start of " + text_at(start, "value"), start, other);
      }
    }
  };
  match("lanes", [&](const Json& of, const Json& now) {
    compare(of, "", of.at("total"), now.at("total"));
    if (const bool old = !of.at("origins").is_null(); old != !now.at("origins").is_null()) {
      text += wrapped(fmt::format("Only the {} has origins of {}.", old ? "first" : "second", lanes_of(of)),
                      screen.columns);
    } else if (old) {
      compare_origins(of, of["origins"], now["origins"]);
    }
    for (const Json& question : of.at("total").at("questions")) {
      for (const Json& other : now.at("total").at("questions")) {
        if (question.at("question") == other.at("question"))
          compare(of, text_at(question, "question"), question, other);
      }
    }
  });
  match("verdicts", [&](const Json& of, const Json& now) {
    compare(of, "", of.at("total"), now.at("total"));
    for (const char* lane : {"of_first", "of_second"})
      compare(of, lane, of.at("total").at(lane), now.at("total").at(lane));
  });
  if (table.rows() > 0) text += table.text(screen);
  return text + wrapped(fmt::format("{} counts differ, {} are the same.", grouped(table.rows()), grouped(same)),
                        screen.columns);
}

}  // namespace graze::reports
