// SPDX-License-Identifier: Apache-2.0
// The exact decision of pairs of doubles: the filter with one thread per pair, then four steps for the pairs that it
// leaves open.
#include "cuda/lanes/exact_steps.cuh"

namespace graze::cuda {
namespace {

using namespace exact::detail;

// Decides with an error bound for each determinant. If the bound leaves a determinant's sign open, computes the
// sign in multiword integers.
template <class Kinds>
__global__ void __launch_bounds__(kThreads) decide_each_closely(ArrayPairs pairs, PairList from, PairList left,
                                                                std::uint32_t* intersects, unsigned long long* stages) {
  decide_listed(pairs, from, left, intersects, stages, [](const double* c, bool& yes) {
    const Grid grid = grid_of(c, c + 9);
    if (!exact::detail::is_moderate(grid)) return kLeft;
    Stage stage = Stage::bounded;
    const Finding found = Kinds::visit(grid, [&](auto numbers) {
      return by_planes_one_by_one<DoubleDoubleNumbers, decltype(numbers)>(c, c + 9, grid.exponent, stage);
    });
    yes = found == Finding::intersects;
    return found == Finding::unsure ? kLeft : static_cast<int>(stage);
  });
}

ArrayPairs arrays_of(const DeviceDoubles& pairs) {
  ArrayPairs arrays{};
  for (TriangleArray* array : {&arrays.a, &arrays.b}) {
    array->layout = Layout::columns;
    array->stride = sizeof(double);
    array->count = pairs.count;
    const double* column = pairs.coordinates + (array == &arrays.b ? 9 * std::size_t{pairs.stride} : 0);
    for (std::size_t k = 0; k < 9; ++k) array->columns[k] = reinterpret_cast<const char*>(column + k * pairs.stride);
  }
  return arrays;
}

}  // namespace

void launch_double_steps(const ArrayPairs& pairs, const PairList* lists, std::uint32_t* intersects,
                         unsigned long long* stages, cudaStream_t stream) {
  using Kinds = KindsFor<double>;
  decide_by<Kinds::Machine, 1><<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, lists[0], lists[1], intersects, stages);
  decide_closely<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, lists[1], lists[2], intersects, stages);
  decide_each_closely<Kinds::Multiword>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, lists[2], lists[3], intersects, stages);
  decide_by<Kinds::Multiword, 1>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, lists[3], PairList{}, intersects, stages);
  check(cudaGetLastError());
}

void DeviceExact::decide(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  decide_most<2>
      <<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined, stages);
  launch_double_steps(arrays_of(pairs), left_ + 1, intersects, stages, stream);
}

void DeviceExact::decide_declined(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined,
                                  cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  list_declined<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined);
  launch_double_steps(arrays_of(pairs), left_ + 1, intersects, nullptr, stream);
}

}  // namespace graze::cuda
