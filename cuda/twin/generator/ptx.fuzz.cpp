// SPDX-License-Identifier: Apache-2.0
// Reads arbitrary bytes as PTX; the result must be a module or a one-line error.
#include <sstream>

#include "core/fuzz_target.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {
namespace {

const RegisterFuzzTarget kPtx("ptx", [](std::string_view bytes) {
  std::istringstream in{std::string(bytes)};
  try {
    const Module module = read_ptx(in, "ptx");
    for (const Kernel& kernel : module.kernels) must_hold(!kernel.name.empty(), "a kernel has a name");
  } catch (const PtxError& error) {
    must_be_one_line(error.what());
  }
});

}  // namespace
}  // namespace graze::cuda::twin
