// SPDX-License-Identifier: Apache-2.0
// Checks the contraction rule against ptxas, without a GPU. The tests compare each kernel's machine code in the default
// build with that of the explicit PTX, in which every contraction is written out. The counts of fused and unfused
// operations must be equal; most kernels are identical, instruction for instruction. Skipped in builds without nvcc.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/algorithms/algorithms.h"
#include "core/programs/run_program.h"
#include "cuda/subject/machine_code.h"
#include "cuda/twin/generator/ptx_writer.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {
namespace {

using Code = std::map<std::string, std::string>;  // machine code by kernel name

// Counts the floating-point operations in machine code of sm_70 to sm_120. An instruction has 16 bytes; its low nine
// bits identify the operation.
std::map<std::string, int> operations(const std::string& code) {
  static const std::map<int, std::string> kNames = {{0x20, "FMUL"}, {0x21, "FADD"}, {0x23, "FFMA"},
                                                    {0x28, "DMUL"}, {0x29, "DADD"}, {0x2b, "DFMA"}};
  std::map<std::string, int> counts;
  for (std::size_t at = 0; at + 16 <= code.size(); at += 16) {
    if (const auto name =
            kNames.find((static_cast<unsigned char>(code[at]) | static_cast<unsigned char>(code[at + 1]) << 8) & 0x1ff);
        name != kNames.end())
      ++counts[name->second];
  }
  return counts;
}

std::string generated(const std::string& name) { return std::string(GRAZE_GENERATED_DIR "/") + name; }

bool has_nvcc() { return std::filesystem::exists(GRAZE_GENERATED_DIR "/cuda_fma.cubin"); }

int same_code(const Code& a, const Code& b) {
  int same = 0;
  for (const auto& [kernel, code] : a) same += b.count(kernel) && b.at(kernel) == code;
  return same;
}

Code assembled(const std::string& ptx) {
  const Scratch scratch(testing::TempDir());
  return assemble(GRAZE_PTXAS, ptx, scratch.path());
}

class StaticCheck : public testing::TestWithParam<const char*> {};

TEST_P(StaticCheck, ExplicitPtxHasTheOperationsOfTheDefaultBuild) {
  if (!has_nvcc()) GTEST_SKIP() << "built without nvcc";
  const Code built = read_cubin(generated(std::string(GetParam()) + ".cubin")),
             written = read_cubin(generated(std::string(GetParam()) + ".ptxas.cubin"));
  ASSERT_EQ(built.size(), 6u * kAlgorithmCount);  // deciding and tracing: in float, in double, and on pairs of doubles
  ASSERT_EQ(written.size(), built.size());
  for (const auto& [kernel, code] : built) {
    EXPECT_FALSE(operations(code).empty()) << kernel;
    EXPECT_EQ(operations(code), operations(written.at(kernel))) << kernel;
  }
  RecordProperty("same_code", same_code(built, written));
  // With nvcc 13.0.88, 25 of the 30 contracted kernels are identical. The other five differ in registers and in the
  // order of instructions.
  EXPECT_GE(same_code(built, written), std::string(GetParam()) == "cuda_nofma" ? 30 : 23);
}

INSTANTIATE_TEST_SUITE_P(Variants, StaticCheck, testing::Values("cuda_fma", "cuda_nofma"),
                         [](const auto& row) { return std::string(row.param); });

TEST(StaticCheck, CatchesTheRightProductFirst) {
  if (!has_nvcc()) GTEST_SKIP() << "built without nvcc";
  const Code built = read_cubin(generated("cuda_fma.cubin")),
             wrong = read_cubin(generated("cuda_fma.right_first.cubin"));
  // Every kernel has some a*b - c*d, so the wrong rule changes the code of every kernel, but not its counts.
  EXPECT_EQ(same_code(built, wrong), 0);
}

TEST(StaticCheck, SeesContraction) {
  if (!has_nvcc()) GTEST_SKIP() << "built without nvcc";
  // Without contraction, only division and square root may contain fused operations.
  const Code contracted = read_cubin(generated("cuda_fma.cubin")),
             not_contracted = read_cubin(generated("cuda_nofma.cubin"));
  for (const auto& [kernel, code] : not_contracted) {
    if (kernel.find("decide_pairsILi2E") == std::string::npos) continue;  // moller_1997 has neither of these
    EXPECT_EQ(operations(code).count("FFMA") + operations(code).count("DFMA"), 0u) << kernel;
  }
  EXPECT_EQ(same_code(contracted, not_contracted), 0);
}

// Counts of fused operations and of products. Counts of additions show nothing, because ptxas may repeat them.
std::map<std::string, int> fused_and_products(const std::string& code) {
  std::map<std::string, int> counts = operations(code);
  counts.erase("FADD");
  counts.erase("DADD");
  return counts;
}

class KernelsUnderTolerances : public testing::TestWithParam<const char*> {};

// If ptxas contracts a kernel differently from the rule, the kernel's twin is wrong, so the lane must not have one.
// scripts/update_generated reads the messages of this test, and writes twin/contracted_otherwise.inc.
TEST_P(KernelsUnderTolerances, HaveTwinsJustWhereMachineCodeHasTheirContractions) {
  if (!has_nvcc()) GTEST_SKIP() << "built without nvcc";
  const std::string variant = GetParam();
  std::ifstream in(generated("policy_" + variant + ".ptx"));
  twin::Module module = twin::read_ptx(in, variant);
  std::ostringstream written;
  twin::write_explicit(written, module, twin::Rule::ptxas);
  in.clear();
  in.seekg(0);
  const Code built = assembled(std::string(std::istreambuf_iterator<char>(in), {})), closed = assembled(written.str());
  std::size_t kernels = 0;
  for (const Lane& lane : published_lanes()) {
    if (name(lane.variant) != (variant == "cuda_fma" ? "cuda-fma" : "cuda-nofma")) continue;
    for (const auto& [policy, function] : {std::pair{"abs:1e-6", "absolute"}, std::pair{"rel:16", "relative"}}) {
      bool as_the_rule = true;
      for (const char* pairs : {"", "_double"}) {
        if (*pairs && lane.scalar == Scalar::f32) continue;
        const std::string kernel =
            fmt::format("{}{}_pairsILi{}E{}E", function, pairs, lane.algorithm, lane.scalar == Scalar::f32 ? 'f' : 'd');
        const auto its = std::find_if(built.begin(), built.end(),
                                      [&](const auto& row) { return row.first.find(kernel) != std::string::npos; });
        ASSERT_NE(its, built.end()) << kernel;
        as_the_rule = as_the_rule && fused_and_products(its->second) == fused_and_products(closed.at(its->first));
        ++kernels;
      }
      EXPECT_EQ(bool(block_on_host(lane_under(lane, policy))), as_the_rule)
          << "kernel " << lane.id << '/' << std::string(policy, 3) << (as_the_rule ? " follows" : " breaks")
          << " the rule";
    }
  }
  EXPECT_EQ(kernels, built.size());
}

INSTANTIATE_TEST_SUITE_P(Variants, KernelsUnderTolerances, testing::Values("cuda_fma", "cuda_nofma"),
                         [](const auto& row) { return std::string(row.param); });

// A random program without branches, dead code or equal products. Operands are inputs and earlier sums; sums and fmas
// also take products, which several of them may share. The program stores every result that no other instruction reads.
std::string random_program(std::mt19937& random, const std::string& name, const std::string& type) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::string bytes = type == "f32" ? "4" : "8";
  std::string body;
  std::vector<std::string> values, products, unread;
  std::set<std::set<std::string>> factors;
  for (int i = 0; i < 8; ++i) {
    values.push_back("%a" + std::to_string(i));
    body += "ld.global." + type + " " + values.back() + ", [%rd1+" + std::to_string(std::stoi(bytes) * i) + "];\n";
  }
  const auto read = [&](const std::string& operand) {
    std::erase(unread, operand);
    return operand;
  };
  const auto pick = [&] {
    return read(!products.empty() && below(4) ? products[below(products.size())] : values[below(values.size())]);
  };
  int next = 0;
  for (std::size_t step = 0, steps = 4 + below(14); step < steps; ++step) {
    const std::string result = "%f" + std::to_string(next++);
    if (const std::size_t kind = below(20); kind < 9) {
      const std::string a = values[below(values.size())], b = values[below(values.size())];
      if (!factors.insert({a, b}).second) continue;
      body += (kind == 0 ? "mul.rn." : "mul.") + type + " " + result + ", " + read(a) + ", " + read(b) + ";\n";
      products.push_back(result);
    } else if (kind < 19) {
      body += (kind < 14 ? "add." : "sub.") + type + " " + result + ", " + pick() + ", " + pick() + ";\n";
      if (below(2)) values.push_back(result);
    } else {
      const std::string a = pick(), b = pick();
      if (!factors.insert({a, b}).second) continue;
      body += "fma.rn." + type + " " + result + ", " + a + ", " + b + ", " + pick() + ";\n";
    }
    unread.push_back(result);
  }
  int slot = 0;
  for (const std::string& result : unread)
    body += "st.global." + type + " [%rd1+" + std::to_string(256 + 8 * slot++) + "], " + result + ";\n";
  return ".visible .entry " + name + "(\n.param .u64 " + name + "_p\n)\n{\n.reg .b64 %rd<2>;\n.reg ." + type +
         " %a<9>;\n.reg ." + type + " %f<40>;\nld.param.u64 %rd1, [" + name + "_p];\n" + body + "ret;\n}\n";
}

constexpr int kPrograms = 500;

// Tests on random programs. share_of_same_code: the share of programs whose explicit PTX gives the same machine code,
// instruction for instruction.
class RandomPrograms : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!has_nvcc()) GTEST_SKIP() << "built without nvcc";
  }
  double share_of_same_code(twin::Rule rule) const {
    const std::string type = GetParam();
    std::mt19937 random(5);
    std::string ptx = ".version 9.0\n.target sm_75\n.address_size 64\n";
    for (int i = 0; i < kPrograms; ++i) {
      std::string name = "k";
      name += std::to_string(i);
      ptx += random_program(random, name, type);
    }
    std::istringstream in(ptx);
    twin::Module module = twin::read_ptx(in, "random.ptx");
    std::ostringstream out;
    twin::write_explicit(out, module, rule);
    const Code open = assembled(ptx), closed = assembled(out.str());
    if (rule == twin::Rule::ptxas) {
      for (const auto& [kernel, code] : open) EXPECT_EQ(operations(code), operations(closed.at(kernel))) << kernel;
    }
    const double share = same_code(open, closed) / static_cast<double>(kPrograms);
    RecordProperty("share_of_same_code", std::to_string(share));
    return share;
  }
};

TEST_P(RandomPrograms, AreContractedAsPtxasDoes) {
  // With nvcc 13.0.88 the share is 1.
  EXPECT_GT(share_of_same_code(twin::Rule::ptxas), 0.97);
}

TEST_P(RandomPrograms, ShowAWrongRule) {
  EXPECT_LT(share_of_same_code(twin::Rule::right_first), 0.95);
  EXPECT_LT(share_of_same_code(twin::Rule::none), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Types, RandomPrograms, testing::Values("f32", "f64"),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace graze::cuda
