// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "cli/commands.h"
#include "core/error.h"
#include "core/text.h"

namespace graze::cli {

namespace {

// Parses "1000000", "1_000_000", "1e6", "2.5e6" or "10M".   Returns: null if the number is not whole or is too large.
std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::string digits;
  int power = 0;
  bool fraction = false;
  while (!text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '.' || text[0] == '_')) {
    const char c = text[0];
    text.remove_prefix(1);
    if (c == '_' && (digits.empty() || fraction || text.empty() || !std::isdigit(static_cast<unsigned char>(text[0]))))
      return std::nullopt;
    if (c == '.' && (fraction || digits.empty() || text.empty())) return std::nullopt;
    if (c == '.') fraction = true;
    if (c == '_' || c == '.') continue;
    digits += c;
    power -= fraction;
  }
  if (digits.empty()) return std::nullopt;
  if (text.size() == 1 && std::string_view("kMGT").find(text[0]) != text.npos) {
    power += 3 * (1 + static_cast<int>(std::string_view("kMGT").find(text[0])));
  } else if (text.starts_with('e') || text.starts_with('E')) {
    const std::optional<std::uint64_t> exponent = parse_whole(text.substr(1));
    if (!exponent || *exponent > 99) return std::nullopt;
    power += static_cast<int>(*exponent);
  } else if (!text.empty()) {
    return std::nullopt;
  }
  for (; power < 0 && digits.ends_with('0'); ++power) digits.pop_back();
  if (power < 0) return std::nullopt;
  return parse_whole(digits + std::string(static_cast<std::size_t>(power), '0'));
}

}  // namespace

CLI::Option* add_globs(CLI::App& command, const char* name, std::vector<std::string>& globs, const char* description) {
  const auto split = [name, &globs](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      for (std::size_t begin = 0, end; begin <= text.size(); begin = end + 1) {
        end = std::min(text.find(',', begin), text.size());
        if (begin == end)
          throw UsageError(fmt::format("{}: expected patterns separated by commas, found '{}'", name, text));
        std::string part = text.substr(begin, end - begin);
        // A comma may also continue a lane's policy: "moller_1997/f32/cpu/plane_distance=abs:1e-6,separation=rel:8".
        if (const bool goes_on = part.find('=') < part.find('/') && !globs.empty(); goes_on) {
          globs.back() += ',' + part;
        } else {
          globs.push_back(std::move(part));
        }
      }
    }
  };
  return command.add_option_function<std::vector<std::string>>(name, split, description)
      ->allow_extra_args(false)
      ->option_text("GLOB,…")
      ->default_str("all");
}

void add_shard_option(CLI::App& command, fuzz::Shard& shard, const char* description) {
  const auto check = [](const std::string& text) {
    return fuzz::parse_shard(text)
               ? ""
               : fmt::format("expected K/N with 1 <= K <= N <= {}, found '{}'", fuzz::kMostShards, printable(text));
  };
  command
      .add_option_function<std::string>(
          "--shard", [&shard](const std::string& text) { shard = *fuzz::parse_shard(text); }, description)
      ->check(CLI::Validator(check, ""))
      ->option_text("K/N");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](std::string& text) -> std::string {
    const std::optional<std::uint64_t> value = parse_count(text);
    if (!value || *value < least || *value > most)
      return fmt::format("expected a whole number from {} to {}, found '{}'", least, most, printable(text));
    text = std::to_string(*value);
    return {};
  };
  return CLI::Validator(check, "");
}

CLI::Option* add_threads_option(CLI::App& command, int& threads) {
  return add_count(command, "--threads", threads, 0, kMostThreads,
                   "Number of threads, which does not affect results; 0 means one per core");
}

CLI::Validator number(double least, double most) {
  const auto check = [least, most](std::string& text) -> std::string {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value >= least && value <= most) return {};
    return fmt::format("expected a number from {} to {}, found '{}'", least, most, printable(text));
  };
  return CLI::Validator(check, "");
}

CLI::Validator one_of(std::vector<std::string> words, Chosen chosen) {
  const auto check = [words = std::move(words), chosen](std::string& text) -> std::string {
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end()) {
      return fmt::format("expected {} or {}, found '{}'", fmt::join(words.begin(), words.end() - 1, ", "), words.back(),
                         printable(text));
    }
    if (chosen == Chosen::place) text = std::to_string(found - words.begin());
    return {};
  };
  return CLI::Validator(check, "");
}

void expect_utf8(const std::string& what, const std::string& file) {
  const std::string text = fuzz::Json(file).dump(-1, ' ', false, fuzz::Json::error_handler_t::replace);
  if (fuzz::Json::parse(text) != file)
    throw UsageError(what + ": the file name " + text + " is not UTF-8, as the results must be; rename the file");
}

const Lane& published_lane(const std::string& id) {
  const Lane* lane = find_lane(id);
  if (lane && lane->algorithm >= 0) return *lane;
  std::vector<std::string> ids;
  for (const Lane& row : published_lanes()) ids.push_back(row.id);
  throw UsageError("there is no published lane '" + printable(id) + "'; `graze lanes` lists them" +
                   did_you_mean(id, ids));
}

std::vector<Verdict> decide(const fuzz::SelectedLanes& under_test, const AnyPair& pair) {
  std::vector<const Lane*> apart;
  std::vector<Verdict> verdicts = decide(under_test, pair, apart);
  for (const Lane* lane : apart) fmt::print(stderr, "graze: {}: device and twin differ\n", lane->id);
  return verdicts;
}

bool some_is_wrong(const std::vector<Verdict>& verdicts, Verdict truth) {
  return truth != Verdict::declined &&
         std::any_of(verdicts.begin(), verdicts.end(), [&](Verdict verdict) { return is_wrong(verdict, truth); });
}

std::string cuda_evidence(const fuzz::SelectedLanes& under_test) {
  std::set<std::string> kinds;
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    if (const std::string by = under_test.evidence(l); !by.empty()) kinds.insert(by);
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace graze::cli
