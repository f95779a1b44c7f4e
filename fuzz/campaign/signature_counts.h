// SPDX-License-Identifier: Apache-2.0
// Counts failures by the bytes that tell them apart; each kind of failure becomes a Signature once, at the end.
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

  // Counts the pair for each subject of which a lane's verdict is wrong.
  void add(const Relation& truth, Bucket bucket, std::span<const Verdict> verdicts, const CaseKey& pair);

  // Adds all that was counted, and begins anew.
  void move_to(std::map<analysis::Signature, SignatureCount>& signatures);

 private:
  // The signature but for the lanes' verdicts, one byte each, which follow it in a key.
  struct Head {
    std::uint8_t relation;  // packed
    Bucket bucket;
    std::uint16_t first;  // of the subject's lanes
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
