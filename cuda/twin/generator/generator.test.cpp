// SPDX-License-Identifier: Apache-2.0
// Reader and writers: what they make of PTX, and what they refuse. Values are in cuda/twin/twin_ops.test.cpp.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "cuda/twin/generator/cpp_writer.h"
#include "cuda/twin/generator/proofs.h"
#include "cuda/twin/generator/ptx_writer.h"

namespace graze::cuda::twin {
namespace {

Module module_of(const std::string& body) {
  std::istringstream in(
      ".version 9.0\n.target sm_75\n.address_size 64\n.visible .entry k(\n\t.param .u64 k_param_0\n)\n{\n"
      ".reg .pred %p<9>;\n.reg .b32 %r<9>;\n.reg .b64 %rd<9>;\n.reg .f32 %f<9>;\n.reg .f64 %fd<9>;\n" +
      body + "\nret;\n}\n");
  return read_ptx(in, "test.ptx");
}

// What the writer says of a kernel whose line 13 is this instruction; empty when it writes it.
std::string complaint(const std::string& instruction) {
  try {
    std::ostringstream out;
    write_cpp(out, module_of(instruction), Rule::ptxas);
    return "";
  } catch (const PtxError& error) {
    return error.what();
  }
}

TEST(TwinGenerator, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(complaint("bfe.u32 %r1, %r2, 3, 4;"), "test.ptx:13: unknown instruction: bfe.u32 %r1, %r2, 3, 4");
  EXPECT_EQ(complaint("bar.sync 0;"), "test.ptx:13: unknown instruction: bar.sync 0");
  EXPECT_EQ(complaint("add.f16x2 %r1, %r2, %r3;"), "test.ptx:13: unknown instruction: add.f16x2 %r1, %r2, %r3");
  EXPECT_EQ(complaint("setp.lt.what.f32 %p1, %f1, %f2;"),
            "test.ptx:13: unknown modifier .what: setp.lt.what.f32 %p1, %f1, %f2");
  EXPECT_EQ(complaint("min.xorsign.abs.f32 %f1, %f2, %f3;"),
            "test.ptx:13: unknown modifier .xorsign: min.xorsign.abs.f32 %f1, %f2, %f3");
  EXPECT_EQ(complaint("ld.shared.f32 %f1, [%rd1];"),
            "test.ptx:13: unknown modifier .shared: ld.shared.f32 %f1, [%rd1]");
  EXPECT_EQ(complaint("mov.u32 %r1, %clock;"), "test.ptx:13: unknown register %clock: mov.u32 %r1, %clock");
  EXPECT_EQ(complaint("mov.u32 %r1, %r9;"), "test.ptx:13: unknown register %r9: mov.u32 %r1, %r9");
}

TEST(TwinGenerator, RefusesWhatCannotBeReplayed) {
  EXPECT_EQ(complaint("ex2.approx.f32 %f1, %f2;"), "test.ptx:13: cannot be replayed: ex2.approx.f32 %f1, %f2");
  EXPECT_EQ(complaint("div.approx.f32 %f1, %f2, %f3;"),
            "test.ptx:13: cannot be replayed: div.approx.f32 %f1, %f2, %f3");
  EXPECT_EQ(complaint("div.full.f32 %f1, %f2, %f3;"), "test.ptx:13: cannot be replayed: div.full.f32 %f1, %f2, %f3");
  EXPECT_EQ(complaint("sqrt.approx.ftz.f32 %f1, %f2;"),
            "test.ptx:13: cannot be replayed: sqrt.approx.ftz.f32 %f1, %f2");
  EXPECT_EQ(complaint("add.rz.f32 %f1, %f2, %f3;"), "test.ptx:13: cannot be replayed: add.rz.f32 %f1, %f2, %f3");
  EXPECT_EQ(complaint("cvt.rm.f32.f64 %f1, %fd1;"), "test.ptx:13: cannot be replayed: cvt.rm.f32.f64 %f1, %fd1");
  EXPECT_EQ(complaint("mad.f32 %f1, %f2, %f3, %f4;"),
            "test.ptx:13: mad leaves the rounding open: mad.f32 %f1, %f2, %f3, %f4");
}

TEST(TwinGenerator, RefusesWhatItCannotRead) {
  EXPECT_THROW(module_of(".shared .align 4 .b8 memory[64];"), PtxError);
  EXPECT_THROW(module_of("add.f32 %f1, %f2,"), PtxError);
  EXPECT_NE(complaint("bra $L_nowhere;").find("expected a label of this kernel"), std::string::npos);
  std::istringstream function(".version 9.0\n.func f()\n");
  try {
    read_ptx(function, "f.ptx");
    FAIL();
  } catch (const PtxError& error) {
    EXPECT_STREQ(error.what(), "f.ptx:2: expected a kernel: .func f()");
  }
}

TEST(TwinGenerator, ReadsSourceLines) {
  const Module module = module_of(
      ".loc 2 19 58, function_name $L__info_string9, inlined_at 1 21 5\nfma.rn.f32 %f1, %f2, %f3, %f4;\n.loc 1 3 "
      "4\nfma.rn.f32 %f1, %f2, %f3, %f4;");
  EXPECT_EQ(module.kernels[0].body[0].source, (Source{{2, 19, 58}, {1, 21, 5}}));
  EXPECT_EQ(module.kernels[0].body[1].source, (Source{{1, 3, 4}, {}}));
}

TEST(TwinGenerator, StoredPtxReadsAsTheSame) {
  Module module = module_of(
      ".loc 2 19 58, function_name $L__info_string9, inlined_at 1 21 5\nfma.rn.f32 %f1, %f2, %f3, %f4;\n@!%p1 bra "
      "$L__BB0_1;\n"
      "st.global.v2.f32 [%rd1+4], {%f1, %f2};\n$L__BB0_1:\nmov.f32 %f3, 0f3F800000;");
  module.toolkit = "13.0.88";
  module.files = {{1, "/home/me/graze/cuda/lanes/kernels.cu"},
                  {2, "/home/me/graze/./core/vec3.h"},
                  {3, "/usr/include/c++/12/cmath"}};
  std::ostringstream first, second;
  write_stored(first, module, "/home/me/graze");
  std::istringstream in(first.str());
  const Module again = read_ptx(in, "stored.ptx");
  EXPECT_EQ(again.files, (std::map<int, std::string>{{1, "cuda/lanes/kernels.cu"}, {2, "core/vec3.h"}, {3, "cmath"}}));
  EXPECT_EQ(again.toolkit, "13.0.88");
  ASSERT_EQ(again.kernels.size(), 1u);
  ASSERT_EQ(again.kernels[0].body.size(), module.kernels[0].body.size());
  for (std::size_t i = 0; i < again.kernels[0].body.size(); ++i)
    EXPECT_EQ(text(again.kernels[0].body[i]), text(module.kernels[0].body[i]));
  EXPECT_EQ(again.kernels[0].body[0].source, module.kernels[0].body[0].source);
  const auto hash = [](const Module& m) { return kernel_hash(m.kernels[0], contract(m, m.kernels[0])); };
  EXPECT_EQ(hash(again), hash(module));
}

TEST(TwinGenerator, HashKnowsInstructionsButNoLines) {
  const auto hash = [](const std::string& body, Rule rule = Rule::ptxas) {
    const Module m = module_of(body);
    return kernel_hash(m.kernels[0], contract(m, m.kernels[0], rule));
  };
  const std::string body = "mul.f32 %f1, %f2, %f3;\nmul.f32 %f4, %f5, %f6;\nsub.f32 %f7, %f1, %f4;\n";
  EXPECT_EQ(hash(body), hash(".loc 1 2 3\n" + body));
  EXPECT_NE(hash(body), hash(body + "mov.f32 %f1, %f2;"));
  EXPECT_NE(hash(body), hash(body, Rule::right_first));
  // The number of the kernel in its module is in the names of labels.
  EXPECT_EQ(hash("bra $L__BB0_7;\n$L__BB0_7:\n"), hash("bra $L__BB12_7;\n$L__BB12_7:\n"));
  EXPECT_NE(hash("bra $L__BB0_7;\n$L__BB0_7:\n"), hash("bra $L__BB0_8;\n$L__BB0_8:\n"));
}

TEST(TwinGenerator, ExplicitPtxLeavesNothingOpen) {
  const Module module =
      module_of("mul.f32 %f1, %f2, %f3;\nmul.f64 %fd1, %fd2, %fd3;\nsub.f32 %f4, %f1, %f5;\nadd.f64 %fd4, %fd5, %fd6;");
  std::ostringstream out;
  write_explicit(out, module, Rule::ptxas);
  for (const char* open : {"mul.f", "add.f", "sub.f"}) EXPECT_EQ(out.str().find(open), std::string::npos) << open;
}

std::string rows_of(const std::string& record) {
  const std::string path = testing::TempDir() + "record.json";
  std::ofstream(path) << record;
  std::ostringstream out;
  write_proofs(out, {path});
  return out.str();
}

TEST(TwinGenerator, ProofsWithoutDifferencesBecomeRows) {
  const auto record = [](int differences, int twin_differences, int twin_pairs) {
    return R"({"device": "GPU", "toolkit": "13.0.88", "lanes": [{"hash": "a", "trace_hash": "b", "pairs": 100, "differences": )" +
           std::to_string(differences) + R"(, "twin_pairs": )" + std::to_string(twin_pairs) +
           R"(, "twin_differences": )" + std::to_string(twin_differences) + "}]}";
  };
  EXPECT_EQ(rows_of(record(0, 0, 10)), "{\"a\", \"b\", \"GPU\", \"13.0.88\", 100.0},\n");
  EXPECT_EQ(rows_of(record(1, 0, 10)), "");
  EXPECT_EQ(rows_of(record(0, 1, 10)), "");
  EXPECT_EQ(rows_of(record(0, 0, 0)), "");
  EXPECT_THROW(rows_of("{}"), PtxError);
}

}  // namespace
}  // namespace graze::cuda::twin
