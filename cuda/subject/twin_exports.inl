// SPDX-License-Identifier: Apache-2.0
// The last part of the source of a twin's shared library, after subjects/include/graze/subject.h and
// cuda/twin/twin_ops*.h. It has the kernels that the generator writes, and the exported functions; see
// cuda/twin/twin_library.h. The kernel is graze_subject_kernel, which cuda_subject.cpp appends to the user's source.
#include <cstddef>
#include <iterator>
#include <string_view>
#include <tuple>

namespace graze::cuda {

enum class Scalar { f32, f64 };
struct SourceLine {
  const char* file;
  int line;
};
struct ContractionSite {
  SourceLine at, from;
  bool by_ptxas;
  int ptx_line;
};
struct ComparisonSite {
  SourceLine at, from;
  int ptx_line;
};
struct Comparison {  // the same struct as in cuda/twin/twin.h
  double left, right;
  int ptx_line, outcome;
};

inline namespace GRAZE_FP {
namespace ptx {
namespace {

#include GRAZE_TWIN_KERNELS

using Kernel = std::tuple_element_t<0, Kernels>;

// Fuses some sites, and stores the first `most` comparisons.
struct Watched : SomeFused {
  Comparison* made;
  std::size_t most;
  std::size_t* count;

  template <class T>
  bool compared(int ptx_line, T left, T right, bool outcome) const {
    if (*count < most) made[(*count)++] = {static_cast<double>(left), static_cast<double>(right), ptx_line, outcome};
    return outcome;
  }
};

constexpr int kNoAnswer = 2;  // means that the kernel ended before it wrote an answer

// Decides one pair as a block of one pair. With stride 1, the pair's coordinates serve as the 18 arrays.
template <class Fuse>
int decide(const Real* pair, const Fuse& fuse) {
  const u32 one = 1;
  signed char answer = kNoAnswer;
  signed char* const answer_at = &answer;
  const auto bytes = [](const void* object) { return static_cast<const unsigned char*>(object); };
  const unsigned char* const parameters[] = {bytes(&pair), bytes(&one), bytes(&one), bytes(&answer_at)};
  Kernel::run(parameters, fuse);
  return answer;
}

void decide_block(const Real* pairs, std::size_t count, signed char* answers) {
  for (std::size_t i = 0; i < count; ++i) {
    if (const int said = decide(pairs + 18 * i, AllFused{}); said != kNoAnswer)
      answers[i] = static_cast<signed char>(said);
  }
}

}  // namespace
}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda

extern "C" {

using namespace graze::cuda;

int graze_twin_site_count(void) { return ptx::Kernel::kSiteCount; }
const ContractionSite* graze_twin_sites(void) { return ptx::Kernel::kSites; }
void graze_twin_decide_block(const ptx::Real* pairs, std::size_t count, signed char* answers) {
  ptx::decide_block(pairs, count, answers);
}
int graze_twin_is_f64(void) { return sizeof(ptx::Real) == 8; }
int graze_twin_decide_fusing(const ptx::Real* pair, const std::uint64_t* fused, Comparison* made, std::size_t most,
                             std::size_t* count) {
  const int said = ptx::decide(pair, ptx::Watched{{fused}, made, most, count});
  return said == ptx::kNoAnswer ? -1 : said;
}
int graze_twin_comparison_count(void) { return static_cast<int>(std::size(ptx::Kernel::kComparisons)) - 1; }
const ComparisonSite* graze_twin_comparisons(void) { return ptx::Kernel::kComparisons; }
}

GRAZE_SUBJECT(graze_subject) = {GRAZE_SUBJECT_ABI, 0,       GRAZE_TWIN_VERSION, nullptr, nullptr,
                                nullptr,           nullptr, GRAZE_TWIN_BLOCKS};
