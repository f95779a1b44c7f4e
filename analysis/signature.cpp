// SPDX-License-Identifier: Apache-2.0
#include "analysis/signature.h"

#include <fmt/format.h>

#include <algorithm>

namespace graze::analysis {

char mark(Verdict lane, Verdict truth) {
  if (lane == Verdict::declined) return truth == Verdict::declined ? '.' : '?';
  return lane == truth ? '.' : lane == Verdict::intersects ? '+' : '-';
}

bool Signature::wrong() const {
  return std::any_of(marks.begin(), marks.end(), [](char m) { return m != '.' && m != '_'; });
}

Signature signature(Contact contact, const oracle::Shape& shape, Bucket bucket, Verdict truth,
                    std::span<const Lane* const> lanes, std::span<const Verdict> verdicts) {
  Signature s{contact, shape, bucket, lanes.front()->algorithm, {}};
  s.marks.fill('_');
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    s.marks[static_cast<std::size_t>(lanes[l]->scalar) * kTargetCount + static_cast<std::size_t>(lanes[l]->target)] =
        mark(verdicts[l], truth);
  }
  return s;
}

std::string key(const Signature& s) {
  const auto first_lane = static_cast<std::size_t>(s.algorithm) * 2 * kTargetCount;
  return fmt::format("{}/{}{}/{}/{}/{}:{}", name(s.contact), s.shape.dimension_a, s.shape.dimension_b,
                     s.shape.coplanar ? "coplanar" : "skew", name_of_bucket(s.bucket), lanes()[first_lane].info->id,
                     std::string_view(s.marks.data(), s.marks.size()));
}

std::string algorithm_of(const std::string& key) {
  const std::size_t colon = key.rfind(':'), slash = key.rfind('/', colon);
  return key.substr(slash + 1, colon - slash - 1);
}

}  // namespace graze::analysis
