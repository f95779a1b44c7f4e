// SPDX-License-Identifier: Apache-2.0
// Counts failures by a compact key, and converts each key to a Signature only at the end.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "fuzz/campaign/batch_result.h"

namespace graze::fuzz {

class SignatureCounts {
 public:
  // Requires: lanes in table order.
  explicit SignatureCounts(std::vector<const Lane*> lanes) : lanes_(std::move(lanes)) {}

  // Counts the pair once for each subject with a wrong lane.
  void add(const Relation& truth, Nesting nesting, Bucket bucket, std::span<const Verdict> verdicts,
           const CaseKey& pair);

  // Adds all counts to `signatures` and resets them.
  void move_to(std::map<analysis::Signature, SignatureCount>& signatures);

 private:
  // The first part of a key; the second part is the lanes' verdicts, one byte each.
  struct Head {
    std::uint16_t relation;  // truth and nesting, packed
    std::uint16_t first;     // index of the subject's first lane
    std::int16_t bucket;
  };
  static_assert(std::has_unique_object_representations_v<Head>);

  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };

  std::vector<const Lane*> lanes_;
  std::unordered_map<std::string, SignatureCount, Hash, std::equal_to<>> counts_;
  std::string key_;
};

}  // namespace graze::fuzz
