// SPDX-License-Identifier: Apache-2.0
// The 64-bit hash FNV-1a (Fowler, Noll and Vo), used to identify texts. FNV-1a does not detect deliberate changes.
#pragma once

#include <cstdint>
#include <string_view>

namespace graze {

// The hash of the bytes. To hash several texts in turn, pass the previous result as `hash`.
constexpr std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325u) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

// Whether the text looks like a hash in names and records: 16 hexadecimal digits.
constexpr bool is_hash(std::string_view text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

}  // namespace graze
