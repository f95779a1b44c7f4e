// SPDX-License-Identifier: Apache-2.0
// `graze toolchain` on the commands of several compilers. Some flags have the documented effect, and some do not.
#include <gtest/gtest.h>

#include <set>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

struct Case {
  const char* name;
  const char* arguments;  // of `graze toolchain`
  const char* measured;
  const char* wrong = "";  // names of canaries that are not as documented; may be empty
  bool needs_fma = false;  // on this machine's processor
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

const char* const kUnroundedProducts = "difference dot expression inlined loop statements";

const Case kCases[] = {
    {"Gcc", "'x86_64-linux-gnu-gcc -O2'", "rounded"},
    {"GccFma", "'x86_64-linux-gnu-g++ -O2 -march=x86-64-v3'", "contracted", "", true},
    {"GccFmaOff", "'x86_64-linux-gnu-g++ -O2 -march=x86-64-v3 -ffp-contract=off'", "rounded", "", true},
    {"GccFmaIsoC", "'x86_64-linux-gnu-gcc -O2 -march=x86-64-v3 -std=c11'", "rounded", "", true},
    {"GccFast", "'x86_64-linux-gnu-gcc -O2 -ffast-math'", "fast"},
    {"GccX87", "'x86_64-linux-gnu-g++ -O2 -mfpmath=387'", "excess"},
    {"GccX87Standard", "'x86_64-linux-gnu-gcc -O2 -mfpmath=387 -fexcess-precision=standard'", "excess"},
    {"ClangFma", "'clang-14 --target=x86_64-linux-gnu -O2 -march=x86-64-v3'", "contracted", "", true},
    {"ClangFmaFast", "'clang-14 --target=x86_64-linux-gnu -O2 -march=x86-64-v3 -ffp-contract=fast'", "contracted", "",
     true},
    {"Arm64", "'aarch64-linux-gnu-g++ -O2 -static' --run qemu-aarch64", "contracted"},
    {"Arm64Off", "arm64-gcc-off", "rounded"},
    {"Arm64Clang", "arm64-clang", "contracted"},
    {"Riscv64", "riscv64-gcc", "contracted"},
    {"Ppc64le", "ppc64le-gcc", "contracted"},
    // Flags without the documented effect: GCC and clang flush subnormals although -fno-fast-math follows.
    {"GccFlushes", "'x86_64-linux-gnu-gcc -Ofast -fno-fast-math'", "fast",
     "fma subnormal_input subnormal_nearest subnormal_result"},
    {"ClangFlushes", "'clang-14 --target=x86_64-linux-gnu -Ofast -fno-fast-math'", "fast",
     "fma subnormal_input subnormal_nearest subnormal_result"},
    // clang's fast math fuses in spite of a later flag.
    {"ClangFastOff", "'clang-14 --target=x86_64-linux-gnu -O2 -march=x86-64-v3 -ffast-math -ffp-contract=off'", "fast",
     kUnroundedProducts, true},
    // The following claims are false on purpose: the flags contradict them.
    {"ClaimedRounded",
     "'x86_64-linux-gnu-gcc -O2 -march=x86-64-v3 -ffp-contract=off -ffp-contract=fast' --claims rounded", "contracted",
     kUnroundedProducts, true},
    {"X87ClaimedRounded", "'x86_64-linux-gnu-g++ -O2 -mfpmath=387' --claims rounded", "excess",
     "difference division dot expression inlined loop nearest range range_assigned root statements subnormal_nearest "
     "sum "
     "sum_in_loop"},
    {"X87Stored", "'x86_64-linux-gnu-gcc -O2 -mfpmath=387 -ffloat-store' --claims rounded", "excess",
     "division nearest root subnormal_nearest"},
    // Compiler wrappers that drop or replace the contraction flag.
    {"FlagDropped", "'./dropping -O2 -march=x86-64-v3 -ffp-contract=off'", "contracted", kUnroundedProducts, true},
    {"FlagReplaced", "'./replacing --target=x86_64-linux-gnu -O2 -march=x86-64-v3 -ffp-contract=on'", "contracted",
     "inlined statements", true},
};

class ToolchainCommand : public testing::TestWithParam<Case> {
 protected:
  ToolchainCommand() {
    // Compilers that ignore a flag.
    shell(
        "printf '%s\\n' '#!/bin/bash' 'exec x86_64-linux-gnu-gcc \"${@/-ffp-contract=off/-O2}\"' > dropping\n"
        "printf '%s\\n' '#!/bin/bash' 'exec clang-14 \"${@/-ffp-contract=on/-ffp-contract=fast}\"' > replacing\n"
        "chmod +x dropping replacing");
  }
  Shell shell{std::string("toolchain-") + GetParam().name};
};

// Returns the names of the canaries whose "documentation" field is this word.
std::string names_with(const nlohmann::json& json, const std::string& word) {
  std::set<std::string> names;
  for (const auto& result : json["results"]) {
    if (result.value("documentation", "") == word) names.insert(result["name"]);
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

TEST_P(ToolchainCommand, IsMeasured) {
  const Case& c = GetParam();
  if (c.needs_fma && shell("grep -qw fma /proc/cpuinfo").status != 0) GTEST_SKIP() << "the processor has no FMA";
  const Ran ran = shell(std::string("graze toolchain ") + c.arguments + " --json r.json");
  if (ran.out.empty() && (ran.err.find(": no ") != std::string::npos || ran.err.find("not found") != std::string::npos))
    GTEST_SKIP() << ran.err;
  ASSERT_EQ(ran.status, *c.wrong ? 1 : 0) << ran.out << ran.err;
  const nlohmann::json json = shell.json("r.json");
  EXPECT_EQ(json["measured"], c.measured) << ran.out;
  EXPECT_EQ(names_with(json, "does not hold"), c.wrong) << ran.out;
  EXPECT_EQ(json["without_answer"], 0);
  EXPECT_TRUE(has(ran.out, {std::string("measured:   ") + c.measured}));
}

INSTANTIATE_TEST_SUITE_P(cli, ToolchainCommand, testing::ValuesIn(kCases),
                         [](const testing::TestParamInfo<Case>& test) { return test.param.name; });

using Toolchain = CommandTest;

// Emulators compute quotients and roots in software.
TEST_F(Toolchain, EmulatorsDivideAndTakeRootsExactly) {
  int emulated = 0;
  for (const std::string name : {"arm64-gcc", "riscv64-gcc", "ppc64le-gcc"}) {
    if (shell("graze toolchain | grep -q '^" + name + " .* yes$'").status != 0) continue;
    ++emulated;
    EXPECT_EQ(shell("graze toolchain " + name + " --json " + name + ".json").status, 0) << name;
    const nlohmann::json json = shell.json(name + ".json");
    for (const auto& result : json["results"]) {
      const std::string canary = result["name"];
      if (canary == "division" || canary == "root" || canary == "fma" || canary == "nearest" ||
          canary.starts_with("subnormal")) {
        EXPECT_EQ(result["found"], "as written") << name << ' ' << result;
      }
    }
  }
  if (emulated == 0) GTEST_SKIP() << "no cross compiler with an emulator";
}

// fmaf() in Debian 12's wasi-libc rounds wrongly near the midpoint of two numbers. All other checks of wasm pass.
TEST_F(Toolchain, TheLibrarysOwnFmaIsTested) {
  if (shell("graze toolchain | grep -q '^wasm .* yes$'").status != 0) GTEST_SKIP() << "no wasm";
  const Ran ran = shell("graze toolchain wasm --json r.json");
  ASSERT_TRUE(std::filesystem::exists(shell.folder / "r.json")) << ran.out << ran.err;
  const nlohmann::json json = shell.json("r.json");
  EXPECT_EQ(json["measured"], "rounded");
  for (const auto& result : json["results"]) {
    if (result["name"] == "fma" && result["scalar"] == "f32") continue;
    EXPECT_EQ(result["documentation"], "holds") << result;
  }
}

TEST_F(Toolchain, ListsToolchains) {
  expect_out("graze toolchain", {"\nx86-gcc "});
  shell("printf '[[toolchain]]\\nname = \"mine\"\\ncxx = \"no-such-c++\"\\nrounding = \"rounded\"\\n' > mine.toml");
  const std::string list = shell("graze toolchain --toolchains mine.toml").out;
  EXPECT_TRUE(has(list, {"\nmine ", "no no-such-c++"}));
  expect_error("graze toolchain mine --toolchains mine.toml", 1, {"mine", "no-such-c++"});
}

// The command lists the fused products in a source, under the given flags, and in the published algorithms.
TEST_F(Toolchain, ListsFusedProducts) {
  if (shell("command -v x86_64-linux-gnu-g++").status != 0) GTEST_SKIP() << "no x86_64-linux-gnu-g++";
  if (shell("grep -qw fma /proc/cpuinfo").status != 0) GTEST_SKIP() << "the processor has no FMA";
  std::ofstream(shell.folder / "mine.cpp") << "bool intersects(const float* a, const float* b) {\n"
                                              "  const float sum = a[0] * b[1] + a[2];\n"
                                              "  return sum < b[0];\n}\n";
  const std::string subject = " --subject mine=./mine.cpp ";
  Ran ran = shell("graze toolchain x86-gcc-v3 --json r.json" + subject);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(
      has(ran.out, {"\n    mine.cpp:2: madd f32", ": const float sum = a[0] * b[1] + a[2];\n", " on 1 line, plan "}));
  const nlohmann::json plan = shell.json("r.json")["plans"][0];
  EXPECT_EQ(plan["name"], "mine");
  EXPECT_GT(plan["f32"]["operations"], 0);
  EXPECT_EQ(plan["f64"]["operations"], 0);
  EXPECT_EQ(plan["f32"]["lines"][0]["place"], "mine.cpp:2");
  ran = shell("graze toolchain x86-gcc-v3 --flags=-ffp-contract=off" + subject);
  EXPECT_TRUE(has(ran.out, {"mine/f32  no fused operation"}));
  ran = shell("graze toolchain 'x86_64-linux-gnu-g++ -O2 -march=x86-64-v3 -flto'" + subject);
  EXPECT_TRUE(has(ran.out, {"not read: with -flto"}));

  ran = shell("graze toolchain x86-gcc-v3");
  EXPECT_TRUE(has(ran.out, {"moller_1997/f32 "}));
  ran = shell("graze toolchain x87");
  EXPECT_TRUE(has(ran.out, {"in the published algorithms: none\n"}));
  ran = shell("graze toolchain 'x86_64-linux-gnu-gcc -O2'");
  EXPECT_TRUE(has(ran.out, {"not read: the toolchain x86_64-linux-gnu-gcc -O2 has no compiler for C++"}));
  expect_error("graze toolchain x86-gcc --subject 'mine=cmd:cat'", 2, {"mine", "cmd:cat"});
  expect_error("graze toolchain --subject mine=./mine.cpp", 2, {"--subject"});
}

// A script that compiles with contraction, and later without it, simulates two versions of a compiler.
TEST_F(Toolchain, ACampaignWhosePlanChangedSaysSo) {
  if (shell("command -v x86_64-linux-gnu-g++").status != 0) GTEST_SKIP() << "no x86_64-linux-gnu-g++";
  if (shell("grep -qw fma /proc/cpuinfo").status != 0) GTEST_SKIP() << "the processor has no FMA";
  const auto write = [&](const std::string& flag) {
    std::ofstream(shell.folder / "v3++") << "#!/bin/sh\nexec x86_64-linux-gnu-g++ " << flag << " \"$@\"\n";
  };
  std::ofstream(shell.folder / "v3.toml")
      << "[[toolchain]]\nname = \"v3\"\ncxx = \"" << (shell.folder / "v3++").string()
      << " -O2 -march=x86-64-v3\"\nrounding = \"contracted\"\n";
  const std::string fuzz =
      "graze fuzz --toolchains v3.toml --lanes 'moller_1997/f32/cpu,moller_1997/f32/v3' --strata shared_vertex "
      "--pairs 2000 ";
  write("");
  expect_done("chmod +x v3++ && " + fuzz + "--out a > /dev/null && " + fuzz + "--out same > /dev/null");
  const nlohmann::json recorded = shell.json("a/summary.json")["spec"]["subjects"][0]["toolchains"][0]["contraction"];
  const std::string then = recorded["f32"]["plan"];
  EXPECT_GT(recorded["f32"]["operations"], 0);
  Ran ran = shell("graze report --compare a same");
  EXPECT_FALSE(has(ran.out, {"fuses"})) << ran.err;
  write("-ffp-contract=off");
  expect_done(fuzz + "--out b > /dev/null");
  ran = shell("graze report --compare a b");
  EXPECT_EQ(ran.status, 0) << ran.err;
  std::string said;  // without line breaks
  for (const char c : ran.out) {
    if (c != '\n' && c != ' ') said += c;
    if ((c == '\n' || c == ' ') && !said.ends_with(' ')) said += ' ';
  }
  EXPECT_TRUE(has(said, {"moller_1997/f32 (v3): the compiler fuses other products (plan " + then + " before, "}))
      << ran.out;
  EXPECT_TRUE(has(said, {" after); "}));
  const auto report = shell.json("b/compare.json");
  std::uint64_t changed = 0;
  for (const auto& row : report["compare"]["verdicts"]) {
    if (row["lane"] == "moller_1997/f32/v3") changed += row["most"].get<std::uint64_t>();
  }
  EXPECT_GT(changed, 0u);
  // The folder holds a campaign with another contraction plan.
  expect_error(fuzz + "--out a", 2, {"contraction/f32/plan", then});
}

// AMD's compiler and NVIDIA's fuse the same lines here. hipcc needs no GPU.
TEST_F(Toolchain, ListsWhatHipFuses) {
  std::ofstream(shell.folder / "k.cu") << "__device__ bool meets(const float* a, const float* b) {\n"
                                          "  const float u = a[0] * b[0] + a[1];\n"
                                          "  return u / a[3] > b[3];\n"
                                          "}\n";
  const bool has_hip = shell("command -v hipcc").status == 0;
  if (has_hip) {
    const auto run = shell("graze toolchain hip --subject mine=./k.cu:meets --json h.json");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(has(run.out, {"no verdict is claimed", "k.cu:2       1        1       1  const float u"}));
    EXPECT_FALSE(has(run.out, {"k.cu:3"}));
    const auto json = shell.json("h.json");
    EXPECT_EQ(json.at("fused_with_contract_off"), 0);
    EXPECT_EQ(json.at("plans").at(0).at("nvidia").at("operations"), 1);
    std::ofstream(shell.folder / "l.hip") << "__device__ bool meets(const float* a, const float*) {\n"
                                             "  return __builtin_fmaf(a[0], a[1], a[2]) > 0;\n"
                                             "}\n";
    const auto called = shell("graze toolchain hip --subject mine=./l.hip:meets");
    EXPECT_EQ(called.status, 1) << "a call of fma() stays fused: " << called.out;
  } else {
    expect_error("graze toolchain hip", 1, {"hipcc", "install"});
  }
  std::ofstream(shell.folder / "m.hip") << "\n";
  expect_error("graze fuzz --subject mine=./m.hip --pairs 10", 2, {"graze toolchain hip --subject mine="});
  if (!has_hip) GTEST_SKIP() << "no hipcc";
}

TEST_F(Toolchain, SaysWhatIsWrong) {
  expect_error("graze toolchain no-such-compiler", 2, {"no-such-compiler"});
  expect_error("graze toolchain x86-gc", 2, {"x86-gc", "did you mean 'x86-gcc'?"});
  expect_error("graze toolchain ''", 2, {"''"});
  expect_error("graze toolchain x86-gcc --claims slow", 2, {"slow"});
  expect_error("graze toolchain --claims fast", 2, {"--claims"});
  if (shell("command -v x86_64-linux-gnu-gcc").status != 0) GTEST_SKIP() << "no x86_64-linux-gnu-gcc";
  expect_error("graze toolchain 'x86_64-linux-gnu-gcc -no-such-flag'", 1, {"-no-such-flag"});
  expect_error("graze toolchain 'x86_64-linux-gnu-gcc -O2' --run false", 1, {"exit status 1"});
  // One program gives no answer, and another forges a line.
  EXPECT_EQ(shell("graze toolchain 'x86_64-linux-gnu-gcc -O2' --run 'true {}' --json r.json").status, 1);
  EXPECT_EQ(shell.json("r.json")["without_answer"], 54);
  const Ran forged = shell("graze toolchain 'x86_64-linux-gnu-gcc -O2' --run 'echo expression f32 7; {}'");
  EXPECT_EQ(forged.status, 1);
  EXPECT_TRUE(has(forged.out, {"1 computation without an answer"}));
}

}  // namespace
}  // namespace graze::cli
