// SPDX-License-Identifier: Apache-2.0
// The engine's steps as kernels. Device code only.
#pragma once

#include <cuda_runtime.h>

#include "cuda/engine/engine_block.h"

namespace graze::cuda {

// Starts all steps on the block.   Requires: truth and the lanes' words have been written, and the lists are empty.
void launch_engine(const EngineBlock& block, cudaStream_t stream);
// Requires: the words of `stored` have also been written.
void launch_engine(const DoubleEngineBlock& block, cudaStream_t stream);

}  // namespace graze::cuda
