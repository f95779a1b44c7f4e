// SPDX-License-Identifier: Apache-2.0
// Signatures group a subject's failures: pairs with the same signature fail in the same way.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/tally.h"
#include "core/exact/nesting.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "core/verdict.h"
#include "oracle/truth.h"

namespace graze::analysis {

// How a lane's verdict compares with the truth: '.' right, '+' false positive, '-' false negative, '?' declined.
// Foreign code also has '!' crashed, '@' timed out and '%' unstable.
char mark(Verdict lane, Verdict truth);

// A lane whose verdict is not the truth: its name within the subject, such as "f32/cpu-fma", and its mark.
struct WrongLane {
  std::string lane;
  char mark;
  auto operator<=>(const WrongLane&) const = default;
};

// One subject's failure on a pair. If several subjects fail on a pair, it has several signatures. Lanes that are right
// or did not run are not in the signature.
struct Signature {
  Contact contact = Contact::none;
  Hulls hulls;
  Nesting nesting = Nesting::none;
  Bucket bucket = 0;
  std::string subject;
  std::vector<WrongLane> wrong_lanes;  // in the order of the lane table

  bool wrong() const;  // some lane is wrong; declined does not count
  // The mark of one of the subject's lanes; '.' if the lane is right or did not run.
  char mark_of(std::string_view lane_within_subject) const;
  auto operator<=>(const Signature&) const = default;
};

// "a_in_b", "b_in_a" or "same"; empty for none.
std::string_view name(Nesting nesting);

// Requires: finite coordinates; the truth is the pair's.   Exact: always.
Nesting nesting_of(const Pair& pair, const Relation& truth);
Nesting nesting_of(const DoublePair& pair, const Relation& truth);
inline Nesting nesting_of(const AnyPair& pair, const Relation& truth) {
  return visit(pair, [&](const auto& own) { return nesting_of(own, truth); });
}

// Requires: all lanes belong to one subject; verdicts[i] is that of lanes[i].
Signature signature(const Relation& truth, Nesting nesting, Bucket bucket, std::span<const Lane* const> lanes,
                    std::span<const Verdict> verdicts);

// "point/22/skew/-2^-3/moller_1997:+f32/cpu;-f64/cuda-fma": contact, dimensions of the two hulls, coplanar or skew,
// margin bucket, subject, and the wrong lanes, each after its mark. If one triangle lies in the other, the nesting is
// added: "coplanar_b_in_a".
std::string key(const Signature& signature);

// The key with margin bucket 0: the same for all signatures that differ only in their margin bucket.
std::string coarse_key(const Signature& signature);

// The inverse of key; nothing if the text is not a key.
std::optional<Signature> parse_signature(std::string_view key);

// The subject in a key, such as "moller_1997"; empty if the text is not a key.
std::string subject_of(std::string_view key);

// Calls visit(first, count) for each run of lanes of one subject.   Requires: lanes in table order.
template <class Visit>
void for_each_subject(std::span<const Lane* const> lanes, Visit visit) {
  for (std::size_t first = 0, end; first < lanes.size(); first = end) {
    for (end = first; end < lanes.size() && lanes[end]->info == lanes[first]->info;) ++end;
    visit(first, end - first);
  }
}

}  // namespace graze::analysis
