// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/records.h"

#include "core/lanes/host_blocks.h"

namespace graze {

RecordBlock host_record(const Lane& lane) {
#define GRAZE_RECORDS_host(name) &name::kHostRecords
#define GRAZE_RECORDS_device(name) nullptr
#define GRAZE_RECORDS_program(name) nullptr
#define GRAZE_VARIANT(name, id, runs_on, ...) GRAZE_RECORDS_##runs_on(name),
  static constexpr const BlockTable<RecordBlock>* kRecords[] = {
#include "core/variants.inc"
  };
#undef GRAZE_VARIANT
#undef GRAZE_RECORDS_host
#undef GRAZE_RECORDS_device
#undef GRAZE_RECORDS_program
  const auto* records = lane.algorithm < 0 || lane.under ? nullptr : kRecords[static_cast<int>(lane.variant)];
  return records ? (*records)[static_cast<std::size_t>(lane.algorithm)][static_cast<std::size_t>(lane.scalar)]
                 : nullptr;
}

}  // namespace graze
