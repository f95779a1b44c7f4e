// SPDX-License-Identifier: Apache-2.0
// Tests the output of the reader and the writers, and the PTX that they refuse. twin_ops.test.cpp tests the values.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "cuda/twin/generator/cpp_writer.h"
#include "cuda/twin/generator/proofs.h"
#include "cuda/twin/generator/ptx_writer.h"
#include "cuda/twin/generator/reduce.h"

namespace graze::cuda::twin {
namespace {

Module module_of(const std::string& body) {
  std::istringstream in(
      ".version 9.0\n.target sm_75\n.address_size 64\n.visible .entry k(\n\t.param .u64 k_param_0\n)\n{\n"
      ".reg .pred %p<9>;\n.reg .b32 %r<9>;\n.reg .b64 %rd<9>;\n.reg .f32 %f<9>;\n.reg .f64 %fd<9>;\n" +
      body + "\nret;\n}\n");
  return read_ptx(in, "test.ptx");
}

// The writer's error message for a kernel with this instruction on line 13; empty if there is no error.
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
  EXPECT_EQ(complaint("fns.b32 %r1, %r2, 3, 4;"), "test.ptx:13: unknown instruction: fns.b32 %r1, %r2, 3, 4");
  EXPECT_EQ(complaint("prmt.b32.f4e %r1, %r2, 3, 4;"), "test.ptx:13: unknown instruction: prmt.b32.f4e %r1, %r2, 3, 4");
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
  EXPECT_EQ(complaint("rcp.approx.ftz.f32 %f1, %f2;"), "test.ptx:13: cannot be replayed: rcp.approx.ftz.f32 %f1, %f2");
  EXPECT_EQ(complaint("call (%rd1), %rd2, (%rd3);"),
            "test.ptx:13: a call through a function pointer cannot be replayed: call (%rd1), %rd2, (%rd3)");
  EXPECT_EQ(complaint("call.uni other, (%rd3);"),
            "test.ptx:13: a function in another file cannot be replayed: call.uni other, (%rd3)");
  EXPECT_EQ(complaint("mad.f32 %f1, %f2, %f3, %f4;"),
            "test.ptx:13: mad leaves the rounding open: mad.f32 %f1, %f2, %f3, %f4");
}

TEST(TwinGenerator, RefusesWhatItCannotRead) {
  EXPECT_THROW(module_of(".shared .align 4 .b8 memory[64];"), PtxError);
  EXPECT_THROW(module_of("add.f32 %f1, %f2,"), PtxError);
  EXPECT_NE(complaint("bra $L_nowhere;").find("expected a label of this kernel"), std::string::npos);
  const auto of_file = [](const std::string& line) -> std::string {
    std::istringstream in(".version 9.0\n" + line + "\n");
    try {
      read_ptx(in, "f.ptx");
      return "";
    } catch (const PtxError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(of_file("frobnicate"), "f.ptx:2: expected a kernel: frobnicate");
  const std::string name(200'000, 'a');  // longer than the stack of a matcher that recurses for each character
  EXPECT_LT(of_file(".visible .func " + name + "()").size(), 300u);
  EXPECT_LT(of_file(".visible" + std::string(200'000, ' ') + ".const x").size(), 300u);
  for (const std::string& line : {"mov.u32 %" + name + ", 1;", "bra " + name + ";", ".loc 1 " + name + ";",
                                  "st.global.u32 [%" + name + "], 1;", ".reg .b32 %" + name + ";"})
    EXPECT_FALSE(complaint(line).empty()) << line.substr(0, 20);
  EXPECT_EQ(of_file(".shared .align 4 .b8 memory[64];"),
            "f.ptx:2: expected a kernel: .shared .align 4 .b8 memory[64];");
  EXPECT_EQ(of_file(".const .align 8 .u64 at[1] = {other};"),
            "f.ptx:2: expected a table of numbers: .const .align 8 .u64 at[1] = {other};");
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
  // Label names contain the kernel's number in its module.
  EXPECT_EQ(hash("bra $L__BB0_7;\n$L__BB0_7:\n"), hash("bra $L__BB12_7;\n$L__BB12_7:\n"));
  EXPECT_NE(hash("bra $L__BB0_7;\n$L__BB0_7:\n"), hash("bra $L__BB0_8;\n$L__BB0_8:\n"));
}

TEST(TwinGenerator, ExplicitPtxRefusesApproximateOperations) {
  std::ostringstream out;
  EXPECT_THROW(write_explicit(out, module_of("div.approx.f32 %f1, %f2, %f3;"), Rule::ptxas), PtxError);
}

constexpr char kWithFunctions[] =
    ".version 9.0\n.target sm_75\n.address_size 64\n.const .align 4 .b8 table[8] = {1, 0, 255, 128, 0};\n"
    ".global .align 4 .f32 one = 0f3F800000;\n"
    ".func  (.param .b32 func_retval0) half\n(\n\t.param .b32 half_param_0\n)\n;\n"
    ".visible .entry other()\n{\nret;\n}\n"
    ".visible .entry k(\n\t.param .u64 k_param_0\n)\n{\n.reg .f32 %f<3>;\n.reg .b64 %rd<3>;\n.reg .pred %p<2>;\n"
    ".reg .b32 %r<2>;\n$L_again:\n.pragma \"nounroll\";\n"
    "{ // callseq 0, 0\n.reg .b32 temp_param_reg;\n.param .b32 param0;\nst.param.f32 [param0+0], %f1;\n"
    ".param .b32 retval0;\ncall.uni (retval0), \nhalf, \n(\nparam0\n);\nld.param.f32 %f2, [retval0+0];\n} // callseq "
    "0\n"
    "{ .reg .pred q; setp.gt.f32 q, %f2, %f1; mov.pred %p1, q; }\n@%p1 bra $L_again;\n"
    "$L_list: .branchtargets\n$L_again,\n$L_end;\nbrx.idx %r1, $L_list;\n$L_end:\nret;\n}\n"
    ".func  (.param .b32 func_retval0) half(\n\t.param .b32 half_param_0\n)\n{\n.reg .f32 %f<3>;\n"
    "ld.param.f32 %f1, [half_param_0];\nmul.f32 %f2, %f1, 0f3F000000;\nst.param.f32 [func_retval0+0], %f2;\nret;\n}\n";

TEST(TwinGenerator, ReadsFunctionsTablesAndScopes) {
  std::istringstream in(kWithFunctions);
  const Module module = read_ptx(in, "f.ptx");
  ASSERT_EQ(module.kernels.size(), 3u);
  ASSERT_EQ(module.tables.size(), 2u);
  EXPECT_EQ(module.tables[0].bytes, (std::vector<std::uint8_t>{1, 0, 255, 128, 0, 0, 0, 0}));
  EXPECT_EQ(module.tables[1].bytes, (std::vector<std::uint8_t>{0, 0, 0x80, 0x3f}));
  std::string values = "0f3F800000";
  for (int i = 1; i < 100'000; ++i) values += ", 0f3F800000";
  std::istringstream large(".version 9.0\n.target sm_75\n.address_size 64\n.const .align 4 .f32 table[100000] = {" +
                           values + "};\n");
  const Module of_large = read_ptx(large, "large.ptx");
  ASSERT_EQ(of_large.tables.size(), 1u);
  EXPECT_EQ(of_large.tables[0].bytes.size(), 400'000u);
  EXPECT_EQ(of_large.tables[0].bytes[399'999], 0x3f);
  const Kernel &kernel = module.kernels[1], &function = module.kernels[2];
  EXPECT_TRUE(function.is_function && function.declared_before);
  ASSERT_EQ(function.returned.size(), 1u);
  EXPECT_EQ(function.returned[0].bytes, 4);
  EXPECT_EQ(kernel.registers.at("%scope2_q"), (std::pair<std::string, int>{"pred", 0}));
  EXPECT_EQ(kernel.branch_targets.at("$L_list"), (std::vector<std::string>{"$L_again", "$L_end"}));
  const auto has = [&](const std::string& line) {
    return std::any_of(kernel.body.begin(), kernel.body.end(), [&](const Instruction& i) { return text(i) == line; });
  };
  EXPECT_TRUE(has(".pragma \"nounroll\";"));
  EXPECT_TRUE(has("call.uni (retval0), half, (param0)"));
  EXPECT_TRUE(has("mov.pred %p1, %scope2_q"));
}

TEST(TwinGenerator, AParameterHasAtMostAsManyBytesAsAnIntCounts) {
  EXPECT_EQ(parameter(".param .align 4 .b8 p[2147483647]").value().bytes, 2147483647);
  EXPECT_FALSE(parameter(".param .align 8 .b64 p[268435456]"));
}

TEST(TwinGenerator, AFunctionMayReturnNothing) {
  std::istringstream in(
      ".version 9.0\n.target sm_75\n.address_size 64\n.func leave()\n{\nret;\n}\n"
      ".weak .func  (.param .b64 out) number()\n{\nret;\n}\n");
  const Module module = read_ptx(in, "f.ptx");
  ASSERT_EQ(module.kernels.size(), 2u);
  EXPECT_EQ(module.kernels[0].name, "leave");
  EXPECT_EQ(module.kernels[0].linkage, "");
  EXPECT_TRUE(module.kernels[0].returned.empty());
  EXPECT_EQ(module.kernels[1].name, "number");
  EXPECT_EQ(module.kernels[1].linkage, ".weak ");
  ASSERT_EQ(module.kernels[1].returned.size(), 1u);
  EXPECT_EQ(module.kernels[1].returned[0].bytes, 8);
}

TEST(TwinGenerator, KeepsTheKernelThatCounts) {
  std::istringstream in(kWithFunctions);
  const Module module = read_ptx(in, "f.ptx"), small = reduced(module, "k");
  ASSERT_EQ(small.kernels.size(), 2u);
  EXPECT_THROW(reduced(module, "none"), PtxError);
  std::ostringstream cpp, ptx;
  write_cpp(cpp, small, Rule::ptxas);
  EXPECT_NE(cpp.str().find("call_half(returns, arguments, fuse);"), std::string::npos);
  EXPECT_NE(cpp.str().find("case 1: goto L_end;"), std::string::npos);
  EXPECT_EQ(cpp.str().find("struct other"), std::string::npos);
  write_explicit(ptx, small, Rule::ptxas);
  for (const char* kept : {".pragma \"nounroll\";", ".const .align 4 .b8 table[8]", "mul.rn.f32", ".branchtargets"})
    EXPECT_NE(ptx.str().find(kept), std::string::npos) << kept;
  std::istringstream again(ptx.str());  // the reader accepts the explicit PTX
  EXPECT_EQ(read_ptx(again, "again.ptx").kernels.size(), 2u);
}

TEST(TwinGenerator, AnFmaByHandIsNoContraction) {
  const std::string body = ".loc 1 3 1\nfma.rn.f32 %f1, %f2, %f3, %f4;\n.loc 1 4 1\nfma.rn.f32 %f1, %f2, %f3, %f4;\n";
  Module module = module_of(body);
  Lines lines = lines_with_fma(module);
  EXPECT_EQ(lines, (Lines{{"", 3}, {"", 4}}));
  lines.erase({"", 4});
  mark_by_hand(module, lines);
  EXPECT_EQ(contract(module, module.kernels[0]).sites.size(), 1u);
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
  EXPECT_EQ(rows_of(record(0, 0, 10)), "{\"a\", \"b\", {\"GPU\", \"13.0.88\", 100.0, 10.0}},\n");
  EXPECT_EQ(rows_of(record(1, 0, 10)), "");
  EXPECT_EQ(rows_of(record(0, 1, 10)), "");
  EXPECT_EQ(rows_of(record(0, 0, 0)), "");
  EXPECT_THROW(rows_of("{}"), PtxError);
}

}  // namespace
}  // namespace graze::cuda::twin
