// SPDX-License-Identifier: Apache-2.0
// graze_targets TARGET [libFuzzer's arguments]: runs a fuzz target under libFuzzer. Without arguments, lists the
// targets.
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "core/fuzz_target.h"

extern "C" int LLVMFuzzerRunDriver(int* count, char*** arguments, int (*one)(const std::uint8_t*, std::size_t));

namespace {

void (*one_of_target)(std::string_view) = nullptr;

int one(const std::uint8_t* data, std::size_t size) {
  one_of_target({reinterpret_cast<const char*>(data), size});
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  for (const graze::FuzzTarget& target : graze::fuzz_targets()) {
    if (count < 2) std::printf("%s\n", target.name);
    if (count >= 2 && std::strcmp(arguments[1], target.name) == 0) one_of_target = target.one;
  }
  if (count < 2) return 0;
  if (!one_of_target) {
    std::fprintf(stderr, "graze_targets: expected the name of a target, found '%s'\n", arguments[1]);
    return 2;
  }
  arguments[1] = arguments[0];
  ++arguments;
  --count;
  return LLVMFuzzerRunDriver(&count, &arguments, one);
}
