// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "analysis/apart.h"
#include "analysis/blame.h"

namespace graze::analysis {

Blame blame_apart(const Lane& lane, const AnyPair& pair, double seconds) {
  // The result: `smallest`, `lines_decide`, then the sites as raw memory. The sites' pointers to text are valid in both
  // processes.
  std::string bytes;
  const Ended ended = run_apart(
      lane, seconds,
      [&](const ApartFrom& apart) {
        const Blame found = blame(lane, pair, [&] { apart.alive(); });
        std::string result{static_cast<char>(found.smallest), static_cast<char>(found.lines_decide)};
        result.append(reinterpret_cast<const char*>(found.sites.data()),
                      found.sites.size() * sizeof(cuda::ContractionSite));
        apart.finish(result.data(), result.size());
      },
      bytes);
  Blame result;
  if (ended == Ended::silent) {
    result.why_not = "with some of its products fused it does not return";
  } else if (ended == Ended::crashed) {
    result.why_not = "with some of its products fused it crashes";
  } else {
    result.smallest = bytes.at(0) != 0;
    result.lines_decide = bytes.at(1) != 0;
    result.sites.resize((bytes.size() - 2) / sizeof(cuda::ContractionSite));
    std::memcpy(result.sites.data(), bytes.data() + 2, result.sites.size() * sizeof(cuda::ContractionSite));
  }
  return result;
}

}  // namespace graze::analysis
