// SPDX-License-Identifier: Apache-2.0
#include "analysis/signature.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/exact/exact.h"
#include "core/exact/find_nesting.h"

namespace graze::analysis {
namespace {

constexpr std::string_view kWrongMarks = "+-?!@%";

constexpr std::string_view kNestings[] = {"", "a_in_b", "b_in_a", "same"};

// Removes and returns the text before the next `end`; nothing if there is no `end`.
std::optional<std::string_view> take_until(std::string_view& rest, char end) {
  const std::size_t at = rest.find(end);
  if (at == rest.npos) return std::nullopt;
  const std::string_view part = rest.substr(0, at);
  rest.remove_prefix(at + 1);
  return part;
}

std::optional<Contact> contact_of(std::string_view word) {
  for (const Contact contact : {Contact::none, Contact::point, Contact::segment, Contact::area, Contact::unknown}) {
    if (name(contact) == word) return contact;
  }
  return std::nullopt;
}

std::optional<Bucket> bucket_of(std::string_view word) {
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    if (name_of_bucket(static_cast<Bucket>(b)) == word) return static_cast<Bucket>(b);
  }
  return std::nullopt;
}

// "+f32/cpu;-f64/cpu".
std::optional<std::vector<WrongLane>> wrong_lanes_of(std::string_view text) {
  std::vector<WrongLane> lanes;
  while (!text.empty()) {
    if (kWrongMarks.find(text.front()) == text.npos) return std::nullopt;
    const std::size_t end = std::min(text.find(';'), text.size());
    lanes.push_back({std::string(text.substr(1, end - 1)), text.front()});
    if (lanes.back().lane.empty()) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lanes;
}

}  // namespace

char mark(Verdict lane, Verdict truth) {
  if (lane == Verdict::declined) return truth == Verdict::declined ? '.' : '?';
  if (is_failure(lane)) return lane == Verdict::crashed ? '!' : lane == Verdict::timed_out ? '@' : '%';
  return lane == truth ? '.' : lane == Verdict::intersects ? '+' : '-';
}

bool Signature::wrong() const {
  return std::any_of(wrong_lanes.begin(), wrong_lanes.end(), [](const WrongLane& lane) { return lane.mark != '?'; });
}

char Signature::mark_of(std::string_view lane_within_subject) const {
  for (const WrongLane& wrong : wrong_lanes) {
    if (wrong.lane == lane_within_subject) return wrong.mark;
  }
  return '.';
}

std::string_view name(Nesting nesting) { return kNestings[static_cast<int>(nesting)]; }

namespace {

template <class Real>
Nesting exact_nesting(const BasicPair<Real>& pair, const Relation& truth) {
  const Real *a = coordinates(pair), *b = a + 9;
  const exact::detail::Grid grid = exact::detail::grid_of(a, b);
  return exact::detail::KindsFor<Real>::All::visit(grid, [&](auto numbers) {
    return exact::detail::nesting(exact::detail::triangles<decltype(numbers)>(a, b, grid.exponent), truth);
  });
}

}  // namespace

Nesting nesting_of(const Pair& pair, const Relation& truth) {
  const float* a = coordinates(pair);
  Nesting nesting;
  return exact::detail::nesting_quickly(a, a + 9, truth, nesting) ? nesting : exact_nesting(pair, truth);
}

Nesting nesting_of(const DoublePair& pair, const Relation& truth) {
  return exact::detail::may_nest(truth) ? exact_nesting(pair, truth) : Nesting::none;
}

Signature signature(const Relation& truth, Nesting nesting, Bucket bucket, std::span<const Lane* const> lanes,
                    std::span<const Verdict> verdicts) {
  Signature s{truth.contact, truth.hulls, nesting, bucket, std::string(lanes.front()->info->id), {}};
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (const char m = mark(verdicts[l], truth.verdict); m != '.')
      s.wrong_lanes.push_back({lanes[l]->lane_name().within_subject(), m});
  }
  return s;
}

std::string key(const Signature& s) {
  std::string text = fmt::format("{}/{}{}/{}{}{}/{}/{}:", name(s.contact), s.hulls.dimension_a, s.hulls.dimension_b,
                                 s.hulls.coplanar ? "coplanar" : "skew", s.nesting == Nesting::none ? "" : "_",
                                 name(s.nesting), name_of_bucket(s.bucket), s.subject);
  for (std::size_t l = 0; l < s.wrong_lanes.size(); ++l)
    text += fmt::format("{}{}{}", l > 0 ? ";" : "", s.wrong_lanes[l].mark, s.wrong_lanes[l].lane);
  return text;
}

std::string coarse_key(const Signature& signature) {
  Signature coarse = signature;
  coarse.bucket = 0;
  return key(coarse);
}

std::optional<Signature> parse_signature(std::string_view key) {
  Signature s;
  std::string_view rest = key;
  const auto contact_word = take_until(rest, '/'), dimensions = take_until(rest, '/'), shape = take_until(rest, '/'),
             margin = take_until(rest, '/'), subject = take_until(rest, ':');
  if (!contact_word || !dimensions || !shape || !margin || !subject || subject->empty()) return std::nullopt;
  const std::optional<Contact> contact = contact_of(*contact_word);
  const std::optional<Bucket> bucket = bucket_of(*margin);
  const auto is_dimension = [](char c) { return c >= '0' && c <= '2'; };
  const std::string_view planes = shape->substr(0, shape->find('_'));
  const auto nesting =
      std::find(std::begin(kNestings), std::end(kNestings), shape->substr(std::min(planes.size() + 1, shape->size())));
  const bool shaped = dimensions->size() == 2 && is_dimension((*dimensions)[0]) && is_dimension((*dimensions)[1]) &&
                      (planes == "coplanar" || planes == "skew") && nesting != std::end(kNestings);
  auto wrong_lanes = wrong_lanes_of(rest);
  if (!contact || !bucket || !shaped || !wrong_lanes) return std::nullopt;
  Signature result{*contact,
                   {(*dimensions)[0] - '0', (*dimensions)[1] - '0', planes == "coplanar"},
                   static_cast<Nesting>(nesting - kNestings),
                   *bucket,
                   std::string(*subject),
                   std::move(*wrong_lanes)};
  if (analysis::key(result) != key) return std::nullopt;  // a number is too large, or not in the notation of keys
  return result;
}

std::string subject_of(std::string_view key) {
  const std::optional<Signature> signature = parse_signature(key);
  return signature ? signature->subject : "";
}

}  // namespace graze::analysis
