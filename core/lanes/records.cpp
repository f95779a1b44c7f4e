// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/records.h"

#include "core/lanes/host_blocks.h"

namespace graze {
namespace {

// The tables of a lane's variant; null if the lane does not record.
struct HostRecords {
  const BlockTable<RecordBlock>* floats = nullptr;
  const HostDoubleRecords* doubles = nullptr;
};

const HostRecords& records_of(const Lane& lane) {
#define GRAZE_RECORDS_host(name) \
  { &name::kHostRecords, &name::kHostDoubleRecords }
#define GRAZE_RECORDS_device(name) \
  {}
#define GRAZE_RECORDS_program(name) \
  {}
#define GRAZE_VARIANT(name, id, runs_on, ...) GRAZE_RECORDS_##runs_on(name),
  static constexpr HostRecords kNone, kRecords[] = {
#include "core/variants.inc"
                                      };
#undef GRAZE_VARIANT
#undef GRAZE_RECORDS_host
#undef GRAZE_RECORDS_device
#undef GRAZE_RECORDS_program
  return lane.algorithm < 0 || lane.under ? kNone : kRecords[static_cast<int>(lane.variant)];
}

}  // namespace

RecordBlock host_record(const Lane& lane) {
  const auto* records = records_of(lane).floats;
  return records ? (*records)[static_cast<std::size_t>(lane.algorithm)][static_cast<std::size_t>(lane.scalar)]
                 : nullptr;
}

RecordFunction<DoublePair> host_record_of_doubles(const Lane& lane) {
  const auto* records = records_of(lane).doubles;
  return records && lane.scalar == Scalar::f64 ? (*records)[static_cast<std::size_t>(lane.algorithm)] : nullptr;
}

}  // namespace graze
