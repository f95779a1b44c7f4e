// SPDX-License-Identifier: Apache-2.0
#include "analysis/signature.h"

#include <fmt/format.h>

namespace graze {

char mark(Verdict lane, Verdict truth) {
  if (lane == Verdict::declined) return truth == Verdict::declined ? '.' : '?';
  return lane == truth ? '.' : lane == Verdict::intersects ? '+' : '-';
}

std::string signature(Contact contact, const Shape& shape, Bucket bucket, Verdict truth, std::span<const Lane* const> lanes,
                      std::span<const Verdict> verdicts) {
  std::string marks(2 * kTargetCount, '_');
  bool wrong = false;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    const char m = mark(verdicts[l], truth);
    marks[static_cast<std::size_t>(lanes[l]->scalar) * kTargetCount + static_cast<std::size_t>(lanes[l]->target)] = m;
    wrong = wrong || m != '.';
  }
  if (!wrong) return {};
  return fmt::format("{}/{}{}/{}/{}/{}:{}", name(contact), shape.dimension_a, shape.dimension_b, shape.coplanar ? "coplanar" : "skew",
                     name_of_bucket(bucket), lanes.front()->info->id, marks);
}

}  // namespace graze
