// SPDX-License-Identifier: Apache-2.0
// Tests each row of the table in contraction.cpp, in f32 and f64.
#include "cuda/twin/generator/contraction.h"

#include <gtest/gtest.h>

#include <sstream>

#include "cuda/twin/generator/flow.h"

namespace graze::cuda::twin {
namespace {

// A module with one kernel, which has these instructions. In the text, T stands for the type.
Module module_of(std::string body, const std::string& type) {
  for (auto at = body.find(".T"); at != std::string::npos; at = body.find(".T")) body.replace(at, 2, "." + type);
  std::istringstream in(
      ".version 9.0\n.target sm_75\n.address_size 64\n.visible .entry k(\n.param .u64 out\n)\n{\n"
      ".reg .pred %p<9>;\n.reg .b64 %rd<9>;\n.reg ." +
      type + " %a<9>;\n.reg ." + type + " %f<9>;\n" + body + "ret;\n}\n");
  return read_ptx(in, "test.ptx");
}

// The instructions after the pass, one per line, without `ret`.
std::string contracted(const std::string& body, const std::string& type, Rule rule = Rule::ptxas) {
  const Module module = module_of(body, type);
  std::string result;
  for (const Instruction& i : contract(module, module.kernels.at(0), rule).kernel.body) result += text(i) + "\n";
  for (auto at = result.find("." + type); at != std::string::npos; at = result.find("." + type))
    result.replace(at, 1 + type.size(), ".T");
  for (auto at = result.find("graze_" + type); at != std::string::npos; at = result.find("graze_" + type))
    result.replace(at, 6 + type.size(), 1, 't');
  return result.substr(0, result.size() - 4);
}

int fused(const std::string& body, const std::string& type) {
  const Module module = module_of(body, type);
  int count = 0;
  for (const Site& site : contract(module, module.kernels.at(0)).sites) count += site.by_ptxas;
  return count;
}

class Contraction : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Types, Contraction, testing::Values("f32", "f64"),
                         [](const auto& row) { return std::string(row.param); });

TEST(Flow, AnInstructionReadsItsGuardAndItsOperandsAndWritesTheFirst) {
  using Names = std::vector<std::string>;
  const Module module = module_of("@%p1 add.T %f1, %f2, %f3;\nst.global.T [%rd1], %f1;\n", "f32");
  const std::vector<Instruction>& body = module.kernels.at(0).body;
  EXPECT_EQ(registers_read(body.at(0)), (Names{"%p1", "%f2", "%f3"}));
  EXPECT_EQ(registers_written(body.at(0)), (Names{"%f1"}));
  EXPECT_EQ(registers_read(body.at(1)), (Names{"%rd1", "%f1"}));
  EXPECT_EQ(registers_written(body.at(1)), Names{});
}

TEST_P(Contraction, SingleProduct) {
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nneg.T %t_0, %a3\nfma.rn.T %f2, %a1, %a2, %t_0\n");
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nsub.T %f2, %a3, %f1;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nneg.T %t_0, %a1\nfma.rn.T %f2, %t_0, %a2, %a3\n");
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nadd.T %f2, %a3, %f1;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nfma.rn.T %f2, %a1, %a2, %a3\n");
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nadd.T %f2, %f1, %a3;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nfma.rn.T %f2, %a1, %a2, %a3\n");
}

TEST_P(Contraction, LeftBeforeRight) {
  const std::string body = "mul.T %f1, %a1, %a2;\nmul.T %f2, %a3, %a4;\nsub.T %f3, %f1, %f2;\n";
  const std::string products = "mul.rn.T %f1, %a1, %a2\nmul.rn.T %f2, %a3, %a4\n";
  EXPECT_EQ(contracted(body, GetParam()), products + "neg.T %t_0, %f2\nfma.rn.T %f3, %a1, %a2, %t_0\n");
  EXPECT_EQ(contracted(body, GetParam(), Rule::right_first),
            products + "neg.T %t_0, %a3\nfma.rn.T %f3, %t_0, %a4, %f1\n");
  EXPECT_EQ(contracted(body, GetParam(), Rule::none), products + "sub.rn.T %f3, %f1, %f2\n");
}

TEST_P(Contraction, ProductOfOneUseBeforeOthers) {
  // The product m1 is in both sums. The pass fuses m2 and m3, and rounds m1.
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nmul.T %f2, %a3, %a4;\nmul.T %f3, %a5, %a6;\nadd.T %f4, %f1, %f2;\nadd.T "
                       "%f5, %f1, %f3;\n",
                       GetParam()),
            "mul.rn.T %f1, %a1, %a2\nmul.rn.T %f2, %a3, %a4\nmul.rn.T %f3, %a5, %a6\nfma.rn.T %f4, %a3, %a4, "
            "%f1\nfma.rn.T %f5, %a5, %a6, %f1\n");
  // In program order m1 - x comes first, but the pass first fuses m2, whose addend is m1.
  EXPECT_EQ(
      fused("mul.T %f1, %a1, %a2;\nmul.T %f2, %a3, %a4;\nsub.T %f4, %f1, %a7;\nsub.T %f5, %f1, %f2;\n", GetParam()), 1);
}

TEST_P(Contraction, SharedByAdditionsAloneIsDuplicated) {
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nadd.T %f2, %f1, %a3;\nadd.T %f3, %f1, %a4;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nfma.rn.T %f2, %a1, %a2, %a3\nfma.rn.T %f3, %a1, %a2, %a4\n");
  // m1 - m2, m2 - m3, m3 - m1: each product is shared.
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nmul.T %f2, %a3, %a4;\nmul.T %f3, %a5, %a6;\nadd.T %f4, %f1, %f2;\nadd.T "
                       "%f5, %f2, %f3;\nadd.T %f6, %f3, %f1;\n",
                       GetParam()),
            "mul.rn.T %f1, %a1, %a2\nmul.rn.T %f2, %a3, %a4\nmul.rn.T %f3, %a5, %a6\n"
            "fma.rn.T %f4, %a1, %a2, %f2\nfma.rn.T %f5, %a5, %a6, %f2\nfma.rn.T %f6, %a5, %a6, %f1\n");
  // The pass fuses the product with fewer uses: m2 has two uses, and m1 has three.
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nmul.T %f2, %a3, %a4;\nsub.T %f4, %f1, %f2;\nadd.T %f5, %f1, %f2;\nadd.T %f6, "
                  "%f1, %a7;\n",
                  GetParam()),
            2);
}

TEST_P(Contraction, NotWhenTheProductIsNeededElsewhere) {
  for (const char* use : {"st.global.T [%rd1], %f1;\n", "setp.gt.T %p1, %f1, %a4;\n", "mul.T %f5, %f1, %a4;\n",
                          "fma.rn.T %f5, %a4, %a5, %f1;\n", "abs.T %f5, %f1;\n", "selp.T %f5, %f1, %a4, %p1;\n",
                          "div.rn.T %f5, %f1, %a4;\n"}) {
    EXPECT_EQ(fused(std::string("mul.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\n") + use, GetParam()), 0) << use;
  }
}

TEST_P(Contraction, NotASumOfEqualProducts) {
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nadd.T %f2, %f1, %f1;\n", GetParam()), 0);
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nmul.T %f3, %a2, %a1;\nadd.T %f2, %f1, %f3;\n", GetParam()), 0);
}

TEST_P(Contraction, ThroughNegationAndCopyButNotAbs) {
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nneg.T %f2, %f1;\nadd.T %f3, %f2, %a3;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nneg.T %f2, %f1\nneg.T %t_0, %a1\nfma.rn.T %f3, %t_0, %a2, %a3\n");
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nneg.T %f2, %f1;\nsub.T %f3, %a3, %f2;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nneg.T %f2, %f1\nfma.rn.T %f3, %a1, %a2, %a3\n");
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nmov.T %f2, %f1;\nadd.T %f3, %f2, %a3;\n", GetParam()), 1);
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nabs.T %f2, %f1;\nadd.T %f3, %f2, %a3;\n", GetParam()), 0);
}

TEST_P(Contraction, NotAcrossBlocks) {
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\n@%p1 bra $L;\nsub.T %f2, %f1, %a3;\n$L:\n", GetParam()), 0);
  EXPECT_EQ(
      fused("mul.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\n@%p1 bra $L;\nst.global.T [%rd1], %f1;\n$L:\n", GetParam()),
      0);
  // A label with an unconditional jump as its only predecessor does not end a block.
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nbra $L;\n$L:\nsub.T %f2, %f1, %a3;\n", GetParam()), 1);
  // The product does not change in the loop, but it is in another block.
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\n$L:\nsub.T %f2, %f1, %f2;\n@%p1 bra $L;\n", GetParam()), 0);
  EXPECT_EQ(fused("$L:\nmul.T %f1, %a1, %f2;\nsub.T %f2, %f1, %a3;\n@%p1 bra $L;\n", GetParam()), 1);
}

TEST_P(Contraction, Guards) {
  EXPECT_EQ(fused("@%p1 mul.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\n", GetParam()), 0);
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\n@%p1 sub.T %f2, %f1, %a3;\n", GetParam()),
            "mul.rn.T %f1, %a1, %a2\nneg.T %t_0, %a3\n@%p1 fma.rn.T %f2, %a1, %a2, %t_0\n");
}

TEST_P(Contraction, NotWhereTheRoundingIsWritten) {
  EXPECT_EQ(fused("mul.rn.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\n", GetParam()), 0);
  EXPECT_EQ(fused("mul.T %f1, %a1, %a2;\nsub.rn.T %f2, %f1, %a3;\n", GetParam()), 0);
}

TEST(Contraction, FlushAndSaturate) {
  EXPECT_EQ(fused("mul.ftz.f32 %f1, %a1, %a2;\nsub.f32 %f2, %f1, %a3;\n", "f32"), 0);
  EXPECT_EQ(fused("mul.f32 %f1, %a1, %a2;\nsub.ftz.f32 %f2, %f1, %a3;\n", "f32"), 0);
  EXPECT_EQ(contracted("mul.ftz.f32 %f1, %a1, %a2;\nadd.ftz.f32 %f2, %f1, %a3;\n", "f32"),
            "mul.rn.ftz.T %f1, %a1, %a2\nfma.rn.ftz.T %f2, %a1, %a2, %a3\n");
  EXPECT_EQ(contracted("mul.f32 %f1, %a1, %a2;\nadd.sat.f32 %f2, %f1, %a3;\n", "f32"),
            "mul.rn.T %f1, %a1, %a2\nfma.rn.sat.T %f2, %a1, %a2, %a3\n");
  EXPECT_EQ(fused("mul.sat.f32 %f1, %a1, %a2;\nadd.f32 %f2, %f1, %a3;\n", "f32"), 0);
}

TEST_P(Contraction, FactorsOverwrittenInBetweenAreKept) {
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nmov.T %a1, %a5;\nadd.T %f2, %f1, %a3;\n", GetParam()),
            "mov.T %t_0, %a1\nmul.rn.T %f1, %a1, %a2\nmov.T %a1, %a5\nfma.rn.T %f2, %t_0, %a2, %a3\n");
  EXPECT_EQ(contracted("mul.T %f1, %f1, %a2;\nadd.T %f2, %f1, %a3;\n", GetParam()),
            "mov.T %t_0, %f1\nmul.rn.T %f1, %f1, %a2\nfma.rn.T %f2, %t_0, %a2, %a3\n");
  // The pass also keeps an overwritten second factor.
  EXPECT_EQ(contracted("mul.T %f1, %a1, %a2;\nmov.T %a2, %a5;\nadd.T %f2, %f1, %a3;\n", GetParam()),
            "mov.T %t_0, %a2\nmul.rn.T %f1, %a1, %a2\nmov.T %a2, %a5\nfma.rn.T %f2, %a1, %t_0, %a3\n");
  EXPECT_EQ(contracted("mul.T %f1, %a1, %f1;\nadd.T %f2, %f1, %a3;\n", GetParam()),
            "mov.T %t_0, %f1\nmul.rn.T %f1, %a1, %f1\nfma.rn.T %f2, %a1, %t_0, %a3\n");
}

TEST_P(Contraction, AProductWrittenAgainIsAnother) {
  EXPECT_EQ(
      fused("mul.T %f1, %a1, %a2;\nsub.T %f2, %f1, %a3;\nmul.T %f1, %a4, %a5;\nsub.T %f3, %f1, %a6;\n", GetParam()), 2);
}

TEST_P(Contraction, SitesAreTheFrontEndsAndPtxass) {
  const Module module =
      module_of("fma.rn.T %f1, %a1, %a2, %a3;\nmul.T %f2, %a1, %a2;\nsub.T %f3, %f2, %f1;\n", GetParam());
  const auto sites = contract(module, module.kernels.at(0)).sites;
  ASSERT_EQ(sites.size(), 2u);
  EXPECT_FALSE(sites[0].by_ptxas);
  EXPECT_TRUE(sites[1].by_ptxas);
}

}  // namespace
}  // namespace graze::cuda::twin
