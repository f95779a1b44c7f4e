// SPDX-License-Identifier: Apache-2.0
// Decides a pair in each thread and writes its verdict as bits. Each build variant has its own namespace. Device code.
#pragma once

#include "core/vec3.h"
#include "core/verdict.h"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {
inline namespace GRAZE_FP {

template <class Real>
struct Triangles {
  Vec3<Real> a[3], b[3];
};

template <class Real, class Pairs>
__device__ Triangles<Real> widened(const Pairs& pairs, std::uint32_t i) {
  const auto* c = pairs.coordinates + i;
  const auto vertex = [&](int v) {
    return Vec3<Real>{Real(c[(3 * v) * pairs.stride]), Real(c[(3 * v + 1) * pairs.stride]),
                      Real(c[(3 * v + 2) * pairs.stride])};
  };
  return {{vertex(0), vertex(1), vertex(2)}, {vertex(3), vertex(4), vertex(5)}};
}

// Decides pair i, where i is the thread's number. Writes bit i % 32 of word i / 32 of `intersects` and `declined`.
template <class Real, class Pairs, class Decide>
__device__ void vote(const Pairs& pairs, std::uint32_t* intersects, std::uint32_t* declined, const Decide& decide) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  Verdict verdict = Verdict::disjoint;
  if (i < pairs.count) {
    const Triangles<Real> t = widened<Real>(pairs, i);
    verdict = decide(t.a, t.b);
  }
  const std::uint32_t yes = __ballot_sync(0xffffffffu, verdict == Verdict::intersects);
  const std::uint32_t no_answer = __ballot_sync(0xffffffffu, verdict == Verdict::declined);
  if (threadIdx.x % 32 == 0) {
    intersects[i / 32] = yes;
    declined[i / 32] = no_answer;
  }
}

}  // namespace GRAZE_FP
}  // namespace graze::cuda
