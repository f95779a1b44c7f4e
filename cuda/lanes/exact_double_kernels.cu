// SPDX-License-Identifier: Apache-2.0
// The exact decision of pairs of doubles: the filter with one thread for each pair, then three steps for the pairs
// that it leaves open.
#include "cuda/lanes/exact_steps.cuh"

namespace graze::cuda {
namespace {

using namespace exact::detail;

__global__ void __launch_bounds__(kThreads, 2)
    decide_most_doubles(DeviceDoubles pairs, PairList left, std::uint32_t* intersects, std::uint32_t* declined,
                        unsigned long long* stages) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  Finding found = Finding::disjoint;
  if (i < pairs.count) {
    double c[kCoordinates];
    load(pairs, i, c);
    for (double x : c) finite = finite && cuda::is_finite(x);
    if (finite) found = filter(c, c + 9);
    if (found == Finding::unsure && shared_vertex(c, c + 9) >= 0) found = Finding::intersects;
  }
  const std::uint32_t yes_word = __ballot_sync(0xffffffffu, found == Finding::crosses || found == Finding::intersects);
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  const std::uint32_t decided = __ballot_sync(0xffffffffu, i < pairs.count && found != Finding::unsure);
  if (threadIdx.x % 32 == 0) {
    intersects[i / 32] = yes_word;
    declined[i / 32] = declined_word;
    count(stages, Stage::bounded, static_cast<std::uint32_t>(__popc(decided)));
  }
  add_of_block(left, left, found == Finding::unsure ? 0 : -1, i);
}

// Decides by the smallest of the numbers that holds the pair, if one does.
template <class Kinds>
__global__ void __launch_bounds__(kThreads) decide_doubles_by(DeviceDoubles pairs, PairList from, PairList left,
                                                              std::uint32_t* intersects, unsigned long long* stages) {
  decide_listed<double>(pairs, from, left, intersects, stages, [](const double* c, bool& yes) {
    const Grid grid = grid_of(c, c + 9);
    if (!Kinds::hold(grid)) return kLeft;
    return Kinds::visit(grid, [&](auto numbers) {
      yes = decide<decltype(numbers)>(c, c + 9, grid.exponent);
      return static_cast<int>(numbers.kStage);
    });
  });
}

// Decides by a bound for each determinant, and by integers of several words those that it leaves open.
template <class Kinds>
__global__ void __launch_bounds__(kThreads)
    decide_doubles_one_by_one(DeviceDoubles pairs, PairList from, PairList left, std::uint32_t* intersects,
                              unsigned long long* stages) {
  decide_listed<double>(pairs, from, left, intersects, stages, [](const double* c, bool& yes) {
    const Grid grid = grid_of(c, c + 9);
    if (!is_moderate(grid)) return kLeft;
    Stage stage = Stage::bounded;
    const Finding found = Kinds::visit(grid, [&](auto numbers) {
      return by_planes_one_by_one<BoundedNumbers, decltype(numbers)>(c, c + 9, grid.exponent, stage);
    });
    yes = found == Finding::intersects;
    return found == Finding::unsure ? kLeft : static_cast<int>(stage);
  });
}

}  // namespace

void DeviceExact::decide(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  decide_most_doubles<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], intersects, declined, stages);
  using Kinds = KindsFor<double>;
  decide_doubles_by<Kinds::Machine>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, stages);
  decide_doubles_one_by_one<Kinds::Multiword>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[1], left_[2], intersects, stages);
  decide_doubles_by<Kinds::Multiword>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[2], PairList{}, intersects, stages);
  check(cudaGetLastError());
}

}  // namespace graze::cuda
