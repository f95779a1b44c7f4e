// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/signature_counts.h"

#include <algorithm>
#include <cstring>

namespace graze::fuzz {

void SignatureCounts::add(const Relation& truth, Nesting nesting, Bucket bucket, std::span<const Verdict> verdicts,
                          const CaseKey& pair) {
  analysis::for_each_subject(lanes_, [&](std::size_t first, std::size_t count) {
    const std::span<const Verdict> of_subject = verdicts.subspan(first, count);
    if (std::none_of(of_subject.begin(), of_subject.end(), [&](Verdict said) { return is_wrong(said, truth.verdict); }))
      return;
    const Head head{packed(truth, nesting), static_cast<std::uint16_t>(first), bucket};
    key_.assign(reinterpret_cast<const char*>(&head), sizeof head);
    key_.append(reinterpret_cast<const char*>(of_subject.data()), count);
    auto found = counts_.find(std::string_view(key_));
    if (found == counts_.end()) found = counts_.emplace(key_, SignatureCount{}).first;
    found->second.add(pair);
  });
}

void SignatureCounts::move_to(std::map<analysis::Signature, SignatureCount>& signatures) {
  for (const auto& [key, found] : counts_) {
    Head head;
    std::memcpy(&head, key.data(), sizeof head);
    const auto* verdicts = reinterpret_cast<const Verdict*>(key.data() + sizeof head);
    const std::size_t count = key.size() - sizeof head;
    const auto bucket = static_cast<Bucket>(head.bucket);
    signatures[analysis::signature(unpacked_relation(head.relation & 127, sign_of(bucket)),
                                   unpacked_nesting(head.relation), bucket,
                                   std::span(lanes_).subspan(head.first, count), {verdicts, count})]
        .add(found);
  }
  counts_.clear();
}

}  // namespace graze::fuzz
