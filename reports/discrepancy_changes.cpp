// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "reports/discrepancy.h"
#include "reports/discrepancy_reading.h"
#include "reports/recorded_code.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {

namespace {
using Json = nlohmann::ordered_json;

// Collects all numbers in the value by their paths. In a path, rows of a list have names instead of indices.
void add_numbers(const Json& of, const std::string& place, std::map<std::string, Json>& to) {
  if (of.is_number()) {
    to.emplace(place, of);
    return;
  }
  if (!of.is_structured()) return;
  std::map<std::string, int> seen;
  for (const auto& [key, value] : of.items()) {
    std::string name = key;
    if (of.is_array() && value.is_object()) {
      name.clear();
      for (const char* text : {"question", "line", "within", "value", "site"}) {
        if (value.contains(text) && value[text].is_string()) name += value[text].get<std::string>() + ' ';
      }
      name += '#' + std::to_string(seen[name]++);
    }
    add_numbers(value, place + '/' + name, to);
  }
}
}  // namespace

std::string discrepancy_changes(const Json& before, const Json& after, const Screen& screen) {
  std::string text;
  for (const std::string& sentence : code_differences(before, after)) text += wrapped(sentence, screen.columns);
  std::size_t differ = 0, same = 0, alone = 0;  // alone: numbers that only one of the results has
  TextTable table({{"lanes", Align::left}, {"question", Align::left}, {"count", Align::left}, {"before"}, {"after"}});
  // Calls with_both(old, now) for each comparison that is in both results.
  const auto match = [&](const char* kind, const auto& with_both) {
    const Json old_ones = before.value(kind, Json::array()), new_ones = after.value(kind, Json::array());
    const auto in = [&](const Json& list, const Json& wanted) {
      return std::find_if(list.begin(), list.end(), [&](const Json& of) { return title_of(of) == title_of(wanted); });
    };
    for (const Json& of : old_ones) {
      const auto now = in(new_ones, of);
      if (now == new_ones.end()) {
        text += wrapped(fmt::format("Only the first has {}.", title_of(of)), screen.columns);
      } else {
        with_both(of, *now);
        std::map<std::string, Json> old_numbers, new_numbers;
        add_numbers(of, "", old_numbers);
        add_numbers(*now, "", new_numbers);
        for (const auto& [place, number] : old_numbers) {
          const auto found = new_numbers.find(place);
          if (found == new_numbers.end()) {
            ++alone;
          } else {
            ++(found->second == number ? same : differ);
            new_numbers.erase(found);
          }
        }
        alone += new_numbers.size();
      }
    }
    for (const Json& of : new_ones) {
      if (in(old_ones, of) == old_ones.end())
        text += wrapped(fmt::format("Only the second has {}.", title_of(of)), screen.columns);
    }
  };
  const auto compare = [&](const Json& of, const std::string& question, const Json& old_counts,
                           const Json& new_counts) {
    for (const auto& [name, count] : old_counts.items()) {
      if (!count.is_number_unsigned() || !new_counts.contains(name)) continue;
      if (count != new_counts.at(name))
        table.add(
            {title_of(of), question, name, grouped(count.get<std::uint64_t>()), grouped(number_at(new_counts, name))});
    }
  };
  // Compares each row of the old list with the row of the new list that has the same `name` and the same `key`.
  const auto compare_rows = [&](const Json& of, const std::string& what, const Json& old_rows, const Json& new_rows,
                                const char* name, const char* key) {
    for (const Json& row : old_rows) {
      for (const Json& other : new_rows) {
        if (row.at(name) == other.at(name) && row.at(key) == other.at(key))
          compare(of, what + text_at(row, name), row, other);
      }
    }
  };
  match("lanes", [&](const Json& of, const Json& now) {
    compare(of, "", of.at("total"), now.at("total"));
    if (const bool old = !of.at("origins").is_null(); old != !now.at("origins").is_null()) {
      text += wrapped(fmt::format("Only the {} has origins of {}.", old ? "first" : "second", title_of(of)),
                      screen.columns);
    } else if (old) {
      const Json &before_origins = of["origins"], &now_origins = now["origins"];
      compare(of, "origins", before_origins, now_origins);
      compare_rows(of, "", before_origins.at("lines"), now_origins.at("lines"), "line", "within");
      compare_rows(of, "start of ", before_origins.at("starts"), now_origins.at("starts"), "value", "question");
    }
    compare_rows(of, "", of.at("total").at("questions"), now.at("total").at("questions"), "question", "question");
  });
  match("verdicts", [&](const Json& of, const Json& now) {
    compare(of, "", of.at("total"), now.at("total"));
    for (const char* lane : {"of_first", "of_second"})
      compare(of, lane, of.at("total").at(lane), now.at("total").at(lane));
    if (of.contains("operands") && now.contains("operands"))
      compare_rows(of, "", of.at("operands").at("lines"), now.at("operands").at("lines"), "line", "within");
  });
  if (table.rows() > 0) text += table.text(screen);
  std::string counts = fmt::format("{} numbers differ, {} are the same", grouped(differ), grouped(same));
  if (alone > 0) counts += fmt::format(", and {} are in only one result", grouped(alone));
  if (differ > table.rows()) counts += fmt::format("; the table has the {} that are in totals", grouped(table.rows()));
  return text + wrapped(counts + '.', screen.columns);
}

}  // namespace graze::reports
