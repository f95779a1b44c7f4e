// SPDX-License-Identifier: Apache-2.0
#include "cli/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "cli/screen.h"

namespace graze::cli {
namespace {

constexpr int kNarrow = 64;  // columns; below this, a description starts on its own line

// Formats a name with its description to the right, or below if there is no room.
std::string row(const std::string& name, const std::string& meaning, int columns) {
  const int aside = columns < kNarrow ? 6 : 26;
  const std::string text = reports::wrapped(meaning, columns, aside, aside);
  if (const int used = 2 + reports::width_of(name); used + 2 <= aside)
    return "  " + name + text.substr(static_cast<std::size_t>(used));
  return reports::wrapped(name, columns, 2, 4) + text;
}

std::string placeholder(const CLI::Option& option) {
  if (!option.get_option_text().empty()) return option.get_option_text();
  if (option.get_positional()) return option.get_name(true);
  return option.get_type_size() == 0 ? "" : option.get_type_name();
}

std::string name_of(const CLI::Option& option) {
  if (option.get_positional()) return placeholder(option);
  std::string name = option.get_name(false, true);
  if (const std::size_t comma = name.find(','); comma != name.npos) name.insert(comma + 1, " ");
  const std::string value = placeholder(option);
  return value.empty() ? name : name + ' ' + value;
}

std::string meaning_of(const CLI::Option& option) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) text += fmt::format(" (default: {})", option.get_default_str());
  if (option.get_required() && !option.get_positional()) text += " (required)";
  return text;
}

// Formats the options that `asked` selects.
std::string rows_of(const CLI::App& app, int columns, const std::function<bool(const CLI::Option*)>& asked) {
  std::string text;
  for (const CLI::Option* option : app.get_options(asked)) text += row(name_of(*option), meaning_of(*option), columns);
  return text;
}

// Every verb, option and argument is a row; empty lines separate the sections.
class Help : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    const int columns = output_screen().columns;
    const auto section = [](const std::string& title, const std::string& rows) {
      return rows.empty() ? "" : fmt::format("\n{}:\n{}", title, rows);
    };
    const std::vector<const CLI::App*> verbs = app->get_subcommands([](const CLI::App*) { return true; });
    const auto is_argument = [](const CLI::Option* option) { return option->get_positional(); };
    std::string usage = "Usage: " + name + (verbs.empty() ? "" : " VERB") + " [OPTIONS]";
    for (const CLI::Option* option : app->get_options(is_argument))
      usage +=
          (option->get_required() ? ' ' + placeholder(*option) : " [" + placeholder(*option) + ']') +
          (option->get_items_expected_max() > 2 && option->get_option_text().find(' ') == std::string::npos ? "…" : "");
    std::string text =
        reports::wrapped(app->get_description(), columns) + '\n' + reports::wrapped(usage, columns, 0, 4);
    text += section("Arguments", rows_of(*app, columns, is_argument));
    std::vector<std::string> tasks;
    for (const CLI::App* verb : verbs) {
      if (std::find(tasks.begin(), tasks.end(), verb->get_group()) == tasks.end()) tasks.push_back(verb->get_group());
    }
    for (const std::string& task : tasks) {
      std::string rows;
      for (const CLI::App* verb : verbs) {
        if (verb->get_group() == task) rows += row(verb->get_name(), verb->get_description(), columns);
      }
      text += section(task, rows);
    }
    for (const std::string& group : app->get_groups()) {
      text += section(group, rows_of(*app, columns, [&](const CLI::Option* option) {
                        return !is_argument(option) && option->get_group() == group;
                      }));
    }
    // The example is not wrapped, so that it can be copied.
    return app->get_footer().empty() ? text : text + '\n' + app->get_footer() + '\n';
  }
};

}  // namespace

void format_help(CLI::App& app) { app.formatter(std::make_shared<Help>()); }

}  // namespace graze::cli
