// SPDX-License-Identifier: Apache-2.0
// The variants as C++ types, from the table core/variants.inc.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace graze {

enum class Variant : std::uint8_t {
#define GRAZE_VARIANT(name, ...) name,
#include "core/variants.inc"
#undef GRAZE_VARIANT
};

enum class Arithmetic : std::uint8_t { rounded, contracted, fast, flushed, exact, unknown };
enum class RunsOn : std::uint8_t { host, device, program };
enum class Twin : std::uint8_t { no_twin, twin };

struct VariantInfo {
  Variant variant;
  std::string_view id;
  RunsOn runs_on;
  Arithmetic arithmetic;
  Twin twin;
  std::string_view needs;
  std::string_view flags;
};

inline constexpr VariantInfo kVariants[] = {
#define GRAZE_VARIANT(name, id, runs_on, arithmetic, twin, needs, flags) \
  {Variant::name, id, RunsOn::runs_on, Arithmetic::arithmetic, Twin::twin, needs, flags},
#include "core/variants.inc"
#undef GRAZE_VARIANT
};

constexpr const VariantInfo& info_of(Variant variant) { return kVariants[static_cast<int>(variant)]; }
constexpr std::string_view name(Variant variant) { return info_of(variant).id; }

// Whether the published algorithms are built in this variant.
constexpr bool builds_published(const VariantInfo& row) {
  return row.arithmetic != Arithmetic::exact && row.arithmetic != Arithmetic::flushed && row.runs_on != RunsOn::program;
}

constexpr std::optional<Variant> variant_of_name(std::string_view id) {
  for (const VariantInfo& row : kVariants) {
    if (row.id == id) return row.variant;
  }
  return std::nullopt;
}

// The variant that rounds every operation as written, on the same kind of processor; for a toolchain's program, the
// host's variant.
constexpr Variant rounded_variant(Variant variant) {
  const RunsOn where = info_of(variant).runs_on == RunsOn::device ? RunsOn::device : RunsOn::host;
  for (const VariantInfo& row : kVariants) {
    if (row.runs_on == where && row.arithmetic == Arithmetic::rounded) return row.variant;
  }
  return variant;
}

}  // namespace graze
