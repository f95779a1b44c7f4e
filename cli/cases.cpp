// SPDX-License-Identifier: Apache-2.0
#include "cli/cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "analysis/signature.h"
#include "core/error.h"
#include "core/text.h"
#include "core/whole.h"
#include "fuzz/campaign/campaign_scene.h"
#include "strata/pair_source.h"

namespace graze::cli {
namespace {

std::uint64_t number(const std::string& text, const std::string& name) {
  const std::optional<std::uint64_t> value = parse_whole(text);
  if (!value || *value > kMostWhole)
    throw UsageError(name + ": expected a whole number up to 2^53, found '" + text + "'");
  return *value;
}

// "disjoint, 1e-11 apart", "they share a segment, 0.25 deep"
std::string words(const oracle::Truth& truth) {
  if (truth.verdict == Verdict::disjoint) return fmt::format("disjoint, {} apart", oracle::margin_words(truth.margin));
  const char* contact = truth.contact == Contact::point     ? "they touch in a point"
                        : truth.contact == Contact::segment ? "they share a segment"
                                                            : "they share an area";
  return truth.margin < 0 ? fmt::format("{}, {} deep", contact, oracle::margin_words(-truth.margin)) : contact;
}

}  // namespace

std::vector<corpus::Entry> read_cases(const std::string& name, bool exact_input) {
  const std::size_t first = name.find(':'), last = name.rfind(':');
  // A scene is named by a path, which may contain slashes and colons.
  const std::size_t at = std::min(name.find('@'), name.size());
  const std::size_t middle = last == std::string::npos || last == 0 ? std::string::npos : name.rfind(':', last - 1);
  std::error_code ignored;
  const std::string source = name.substr(0, at);
  const bool is_source = strata::stratum_in_doubles(source).value_or(source).find('/') == std::string::npos;
  if (at < name.size() && middle != std::string::npos && at < middle && is_source &&
      !std::filesystem::exists(name, ignored)) {
    const fuzz::SceneCase named{source, name.substr(at + 1, middle - at - 1),
                                number(name.substr(middle + 1, last - middle - 1), name),
                                number(name.substr(last + 1), name)};
    return {corpus::entry_of(fuzz::draw_again(named), {{"stratum", named.id},
                                                       {"seed", std::to_string(named.seed)},
                                                       {"index", std::to_string(named.index)},
                                                       {"scene", named.scene}})};
  }
  const std::string stratum = name.substr(0, std::min(first, name.size()));
  const bool in_doubles = strata::stratum_in_doubles(stratum).has_value();
  const bool three_numbers =
      first != std::string::npos && first != last && (in_doubles || name.find('/') == std::string::npos);
  if (!three_numbers || std::filesystem::exists(name, ignored)) {
    std::vector<corpus::Entry> entries = corpus::read_pairs(name, PairTypes::both);
    if (entries.empty()) throw std::runtime_error("there is no pair in " + name);
    for (const corpus::Entry& entry : entries) {
      if (exact_input) expect_exact_input(name, entry);
    }
    return entries;
  }
  const std::string seed = name.substr(first + 1, last - first - 1), index = name.substr(last + 1);
  const std::vector<strata::PairSource> sources =
      strata::stratum_sources(number(seed, name), 1, {stratum}, in_doubles ? PairTypes::f64 : PairTypes::f32);
  if (sources.size() != 1) throw UsageError(name + " matches several strata; name one");
  const std::vector<std::pair<std::string, std::string>> numbers = {
      {"stratum", stratum}, {"seed", seed}, {"index", index}};
  return {corpus::entry_of(sources.front().any_pair(number(index, name)), numbers)};
}

namespace {

bool alike(const oracle::Truth& l, const oracle::Truth& r) {
  return l.verdict == r.verdict && l.contact == r.contact && l.margin_sign == r.margin_sign;
}

// Returns words such as "it rounds number 2, 0.1". If several numbers are rounded, gives their count and the first one.
std::string rounded_words(std::size_t count, std::size_t first, std::string_view number) {
  return fmt::format("it rounds {}number {}, {}", count == 1 ? "" : fmt::format("{} numbers, the first is ", count),
                     first + 1, number);
}

// Returns the note about a pair of doubles. truth: the truth of the doubles.
std::string note_of_doubles(const corpus::Entry& entry, const oracle::Truth& truth) {
  const double* own = coordinates(*entry.doubles);
  const float* stored = coordinates(entry.pair);
  std::vector<std::string> parts;
  if (const auto written = entry.written.empty() ? std::nullopt : oracle::truth_as_written(entry.written, entry.pair);
      written && !alike(*written, truth))
    parts.push_back("as written: " + words(*written) + "; as doubles: " + words(truth));
  std::vector<std::size_t> rounded;
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    if (!std::isnan(own[i]) && double{stored[i]} != own[i]) rounded.push_back(i);
  }
  if (rounded.empty()) return fmt::format("{}", fmt::join(parts, "; "));
  if (const auto beyond = std::find_if(stored, stored + kCoordinates, [](float x) { return std::isinf(x); });
      is_finite(*entry.doubles) && beyond != stored + kCoordinates) {
    parts.push_back(fmt::format("float32 cannot store it: number {}, {}, is beyond its range", beyond - stored + 1,
                                own[beyond - stored]));
  } else if (const oracle::Truth in_float32 = oracle::truth(entry.pair); !alike(in_float32, truth)) {
    parts.push_back(fmt::format("as stored in float32: {} ({})", words(in_float32),
                                rounded_words(rounded.size(), rounded[0], fmt::format("{}", own[rounded[0]]))));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

std::string shown_name(const std::string& file, const corpus::Entry& entry) {
  if (const std::optional<std::string> numbers = corpus::numbers_of(entry)) return printable(*numbers);
  const std::string *kind = corpus::field(entry, "kind"), *from = corpus::field(entry, "from"),
                    *label = corpus::field(entry, "name");
  if (kind && from) return printable(*kind + " from " + *from);  // minimised from mesh:1:597
  return printable(label ? *label : entry.line > 0 ? fmt::format("{}:{}", file, entry.line) : file);
}

oracle::Truth truth_of(const corpus::Entry& entry) { return oracle::truth(corpus::pair_of(entry)); }

std::string written_note(const corpus::Entry& entry, const oracle::Truth& truth) {
  if (entry.doubles) return note_of_doubles(entry, truth);
  if (entry.written.empty()) return "";
  const std::optional<oracle::Truth> written = oracle::truth_as_written(entry.written, entry.pair);
  if (!written) return "";
  DoublePair pair;
  for (std::size_t i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = std::strtod(entry.written[i].c_str(), nullptr);
  const oracle::Truth in_doubles = is_finite(pair) ? oracle::truth(pair) : *written;
  const bool double_differs = !alike(*written, in_doubles);
  // The note uses "as doubles and as stored in float32" only if it is true for both roundings.
  const bool float_differs = !alike(in_doubles, truth) || (double_differs && words(in_doubles) != words(truth));
  if (!double_differs && !float_differs) return "";
  std::string text = "as written: " + words(*written);
  if (double_differs)
    text += fmt::format("; as doubles{}: {}", float_differs ? "" : " and as stored in float32", words(in_doubles));
  if (!float_differs) return text;
  const std::vector<std::size_t> rounded = oracle::rounded(entry.written, entry.pair);
  return fmt::format("{}; as stored in float32: {} ({})", text, words(truth),
                     rounded_words(rounded.size(), rounded.at(0), printable(entry.written[rounded.at(0)])));
}

std::vector<std::pair<std::string, Verdict>> stored_verdicts_of(const corpus::Entry& entry,
                                                                const std::vector<fuzz::LaneLeftOut>& left_out,
                                                                Verdict truth) {
  const std::string* text = corpus::field(entry, "signature");
  const std::optional<analysis::Signature> signature = text ? analysis::parse_signature(*text) : std::nullopt;
  std::vector<std::pair<std::string, Verdict>> stored;
  if (!signature || truth == Verdict::declined) return stored;
  for (const fuzz::LaneLeftOut& row : left_out) {
    const std::optional<LaneName> lane = parse_lane_name(row.id);
    if (!lane || lane->subject != signature->subject || find_lane(row.id)) continue;
    const char mark = signature->mark_of(lane->within_subject());
    // A minimised case may fail on only some of the lanes.
    if (mark == analysis::mark(truth, truth) && !corpus::text_of(entry, "kind").empty()) continue;
    for (int v = 0; v <= static_cast<int>(Verdict::unstable); ++v) {
      const auto verdict = static_cast<Verdict>(v);
      if (analysis::mark(verdict, truth) == mark) stored.emplace_back(row.id, verdict);
    }
  }
  return stored;
}

std::string stored_verdicts(const corpus::Entry& entry, const std::vector<fuzz::LaneLeftOut>& left_out, Verdict truth) {
  std::string words;
  for (const auto& [lane, verdict] : stored_verdicts_of(entry, left_out, truth))
    words += fmt::format("{}{} {}{}", words.empty() ? "stored by the campaign: " : ", ", lane, name(verdict),
                         is_wrong(verdict, truth) ? " !" : "");
  return words;
}

std::vector<corpus::Entry> read_noted_cases(const std::string& name, bool exact_input) {
  std::vector<corpus::Entry> entries = read_cases(name, exact_input);
  for (const corpus::Entry& entry : entries) {
    const std::string note = written_note(entry, truth_of(entry));
    if (!note.empty()) fmt::print("{}:{}: {}\n", printable(name), entry.line, note);
  }
  return entries;
}

CLI::Option* add_exact_input(CLI::App& command, bool& exact_input) {
  return command.add_flag("--exact-input", exact_input, "Refuse numbers that float32 cannot represent exactly");
}

void expect_exact_input(const std::string& name, const corpus::Entry& entry) {
  if (entry.written.empty()) return;
  if (const std::vector<std::size_t> rounded = oracle::rounded(entry.written, entry.pair); !rounded.empty())
    throw UsageError(fmt::format("{}:{}: float32 cannot represent number {}, {}, exactly, as --exact-input demands",
                                 name, entry.line, rounded[0] + 1, shown(entry.written[rounded[0]])));
}

void say_notes(const std::vector<std::string>& notes, const strata::Rounding& rounding, bool exact_input) {
  std::vector<std::string> once;
  for (const std::string& note : notes) {
    if (std::find(once.begin(), once.end(), note) == once.end()) once.push_back(note);
  }
  if (exact_input && rounding.rounded > 0)
    throw UsageError(fmt::format("{}; --exact-input refuses that", fmt::join(once, "; ")));
  for (const std::string& note : once) fmt::print(stderr, "graze: {}\n", note);
}

}  // namespace graze::cli
