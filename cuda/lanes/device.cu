// SPDX-License-Identifier: Apache-2.0
#include "cuda/lanes/device.h"

#include <cuda_runtime.h>

#include <algorithm>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {

// Variants without kernels lack these tables.
#define GRAZE_VARIANT(name, ...)             \
  namespace name {                           \
  extern const VariantKernels kKernels;      \
  extern const WithinKernels kPolicyKernels; \
  extern const BoundKernels kBoundKernels;   \
  extern const RecordKernels kRecordKernels; \
  }
#include "core/variants.inc"
#undef GRAZE_VARIANT

namespace {

struct KernelTables {
  const VariantKernels* kernels = nullptr;
  const WithinKernels* within = nullptr;
  const RecordKernels* record = nullptr;
  const BoundKernels* bound = nullptr;  // null for fast math, which has no valid error bound
};

const KernelTables& tables_of(Variant variant) {
#define GRAZE_KERNELS_exact(name) \
  KernelTables {}
#define GRAZE_KERNELS_flushed(name) \
  KernelTables {}
#define GRAZE_KERNELS_rounded(name) \
  KernelTables { &name::kKernels, &name::kPolicyKernels, &name::kRecordKernels, &name::kBoundKernels }
#define GRAZE_KERNELS_contracted(name) GRAZE_KERNELS_rounded(name)
#define GRAZE_KERNELS_fast(name) \
  KernelTables { &name::kKernels, &name::kPolicyKernels, &name::kRecordKernels, nullptr }
#define GRAZE_TABLES_host(name, arithmetic) \
  KernelTables {}
#define GRAZE_TABLES_program(name, arithmetic) \
  KernelTables {}
#define GRAZE_TABLES_device(name, arithmetic) GRAZE_KERNELS_##arithmetic(name)
#define GRAZE_VARIANT(name, id, runs_on, arithmetic, ...) GRAZE_TABLES_##runs_on(name, arithmetic),
  static constexpr KernelTables kBuilt[] = {
#include "core/variants.inc"
  };
#undef GRAZE_VARIANT
  const KernelTables& tables = kBuilt[static_cast<int>(variant)];
  if (!tables.kernels)
    throw std::logic_error(std::string(graze::name(variant)) + ": expected a variant with device kernels");
  return tables;
}

template <class Launch>
Launch of_lane(const DeviceKernels<Launch>& table, const Lane& lane) {
  return table[static_cast<std::size_t>(lane.algorithm)][static_cast<std::size_t>(lane.scalar)];
}

// A block's coordinates in the kernels' layout, on the host and on the device.
template <class Real>
struct Columns {
  std::vector<Real> staging;
  DeviceArray<Real> coordinates;

  // Copies the pairs to device memory.   Returns: 18 arrays of `stride` coordinates.
  const Real* copied(std::span<const BasicPair<Real>> pairs, std::size_t stride) {
    staging.resize(stride * kCoordinates);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t c = 0; c < kCoordinates; ++c) staging[c * stride + i] = graze::coordinates(pairs[i])[c];
    }
    Real* on_device = coordinates.at_least(staging.size());
    check(cudaMemcpy(on_device, staging.data(), staging.size() * sizeof(Real), cudaMemcpyHostToDevice));
    return on_device;
  }
};

std::string version(int packed) { return std::to_string(packed / 1000) + "." + std::to_string(packed % 1000 / 10); }

}  // namespace

const VariantKernels& kernels_of(Variant variant) { return *tables_of(variant).kernels; }

namespace {

// Starts the kernel for the lane's policy: `decide`, `within` or `bound`, all for pairs of one coordinate type.
template <class Decide, class Within, class Pairs>
void launch(const Lane& lane, Decide decide, Within within, Decide bound, DeviceExact& exact, Pairs pairs,
            std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream) {
  if (!lane.under) {
    decide(pairs, intersects, declined, stream);
  } else if (lane.under->kind == Policy::Kind::tolerances) {
    within(lane.under->epsilons, pairs, intersects, declined, stream);
  } else {
    bound(pairs, intersects, declined, stream);
    check(cudaGetLastError());
    if (lane.under->kind == Policy::Kind::filtered) exact.decide_declined(pairs, intersects, declined, stream);
  }
  check(cudaGetLastError());
}

}  // namespace

void launch_lane(const Lane& lane, DeviceExact& exact, DevicePairs pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream) {
  if (lane.algorithm < 0) return exact.decide(pairs, intersects, declined, nullptr, stream);
  const KernelTables& tables = tables_of(lane.variant);
  launch(lane, of_lane(tables.kernels->decide, lane), of_lane(tables.within->floats, lane),
         tables.bound ? of_lane(tables.bound->floats, lane) : nullptr, exact, pairs, intersects, declined, stream);
}

void launch_lane(const Lane& lane, DeviceExact& exact, DeviceDoubles pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream) {
  if (lane.scalar != Scalar::f64) throw std::logic_error(lane.id + ": expected a lane in double");
  if (lane.algorithm < 0) return exact.decide(pairs, intersects, declined, nullptr, stream);
  const KernelTables& tables = tables_of(lane.variant);
  const auto algorithm = static_cast<std::size_t>(lane.algorithm);
  launch(lane, tables.kernels->decide_doubles[algorithm], tables.within->doubles[algorithm],
         tables.bound ? tables.bound->doubles[algorithm] : nullptr, exact, pairs, intersects, declined, stream);
}

void launch_record(const Lane& lane, DevicePairs pairs, void* values, std::uint64_t stride, RecordedPath* paths) {
  of_lane(tables_of(lane.variant).record->floats, lane)(pairs, values, stride, paths, nullptr);
  check(cudaGetLastError());
}

void launch_record(const Lane& lane, DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths) {
  if (lane.scalar != Scalar::f64) throw std::logic_error(lane.id + ": expected a lane in double");
  tables_of(lane.variant)
      .record->doubles[static_cast<std::size_t>(lane.algorithm)](pairs, values, stride, paths, nullptr);
  check(cudaGetLastError());
}

namespace {

class CudaDevice final : public Device {
 public:
  CudaDevice() {
    cudaDeviceProp properties;
    check(cudaSetDevice(0));
    check(cudaGetDeviceProperties(&properties, 0));
    name = properties.name;
    int driver_version = 0;
    check(cudaDriverGetVersion(&driver_version));
    driver = version(driver_version);
    toolkit = std::to_string(__CUDACC_VER_MAJOR__) + "." + std::to_string(__CUDACC_VER_MINOR__) + "." +
              std::to_string(__CUDACC_VER_BUILD__);
  }

  void decide(std::span<const Pair> pairs, std::span<const Lane* const> cuda_lanes, std::vector<VerdictBits>& bits,
              std::span<const DoublePair> doubles) override {
    bits.resize(cuda_lanes.size());
    const std::size_t size = std::max(pairs.size(), doubles.size());
    if (size == 0) return;
    check(cudaSetDevice(0));  // an engine may have made another device current
    // The stride is a whole number of thread blocks, because each block writes whole words.
    const std::size_t stride = (size + kThreads - 1) / kThreads * kThreads;
    const auto stride32 = static_cast<std::uint32_t>(stride), count = static_cast<std::uint32_t>(size);
    const DevicePairs block{pairs.empty() ? nullptr : floats_.copied(pairs, stride), stride32, count};
    const DeviceDoubles of_doubles{doubles.empty() ? nullptr : doubles_.copied(doubles, stride), stride32, count};
    const std::size_t words = stride / 64;
    std::uint64_t* intersects = intersects_.at_least(words * cuda_lanes.size());
    std::uint64_t* declined = declined_.at_least(words * cuda_lanes.size());
    for (std::size_t l = 0; l < cuda_lanes.size(); ++l) {
      const Lane& lane = *cuda_lanes[l];
      auto* yes = reinterpret_cast<std::uint32_t*>(intersects + l * words);
      auto* no_answer = reinterpret_cast<std::uint32_t*>(declined + l * words);
      if (lane.scalar == Scalar::f64 && of_doubles.coordinates) {
        launch_lane(lane, exact_, of_doubles, yes, no_answer, nullptr);
      } else {
        launch_lane(lane, exact_, block, yes, no_answer, nullptr);
      }
    }
    for (std::size_t l = 0; l < cuda_lanes.size(); ++l) {
      bits[l].intersects.resize(words);
      bits[l].declined.resize(words);
      check(cudaMemcpy(bits[l].intersects.data(), intersects + l * words, words * sizeof(std::uint64_t),
                       cudaMemcpyDeviceToHost));
      check(cudaMemcpy(bits[l].declined.data(), declined + l * words, words * sizeof(std::uint64_t),
                       cudaMemcpyDeviceToHost));
    }
  }

 private:
  Columns<float> floats_;
  Columns<double> doubles_;
  DeviceExact exact_;
  DeviceArray<std::uint64_t> intersects_, declined_;
};

}  // namespace

std::unique_ptr<Device> open_device(std::string& why_not) {
  if (count_devices() == 0) {
    why_not = "no device";
    return nullptr;
  }
  return std::make_unique<CudaDevice>();
}

}  // namespace graze::cuda
