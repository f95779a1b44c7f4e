// SPDX-License-Identifier: Apache-2.0
// Tests a user's own code: its failures become programs that fail while the code is wrong and pass once it is fixed.
// Also tests `graze fuzz --fail-above`.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"
#include "core/simplify/simplicity.h"
#include "corpus/pair_format.h"

namespace graze::cli {
namespace {

// Two triangles that intersect.
constexpr const char* kPair = "0 0 0 4 0 0 0 4 0  1 1 -1 1 1 1 3 3 1";

struct OwnCode {
  const char* name;
  const char* write;  // writes and builds the code that answers $ANSWER
  const char* what;   // value of --subject
};

std::ostream& operator<<(std::ostream& out, const OwnCode& code) { return out << code.name; }

constexpr OwnCode kCodes[] = {
    {"Cpp", "echo \"namespace my { bool meet(const float* a, const float*) { return $ANSWER || !a; } }\" > own.cpp",
     "./own.cpp:my::meet"},
    {"C", "echo \"_Bool meet(const double a[9], const double b[9]) { return $ANSWER; }\" > own.c", "./own.c:meet"},
    {"Library",
     "echo \"int intersects(const float a[9], const float b[9]) { return $ANSWER; }\" > lib.c && "
     "cc -shared -fPIC lib.c -o libown.so",
     "./libown.so"},
    {"LibraryOfCpp",
     "echo \"int meet(const float*, const float*) { return $ANSWER; }\" > lib.cpp && "
     "c++ -shared -fPIC lib.cpp -o libown.so",
     "./libown.so:meet"},
    {"Description",
     "printf '#include <graze/subject.h>\\nstatic void f(const float* p, size_t n, signed char* says) "
     "{ for (size_t i = 0; i < n; ++i) says[i] = %s; }\\nGRAZE_SUBJECT(mine) = {.abi = 1, .block_f32 = f};' $ANSWER "
     "> lib.c && cc -shared -fPIC -I" GRAZE_SOURCE_DIR "/subjects/include lib.c -o libown.so",
     "./libown.so:mine"},
    {"DescribedSource",
     "printf '#include <graze/subject.h>\\nstatic int f(const float*, const float*) { return %s; }\\n"
     "GRAZE_SUBJECT(graze_subject) = {.abi = 1, .f32 = f};' $ANSWER > own.cpp",
     "./own.cpp"},
    {"Command", "echo \"while read line; do echo $ANSWER; done\" > own.sh", "cmd:bash own.sh"},
};

class Emitted : public testing::TestWithParam<OwnCode> {
 protected:
  Shell shell{std::string("own-") + GetParam().name};

  Ran run_command() const { return shell("head -n 1 case.cpp | cut -c 4- > run.sh; rm -f case; bash run.sh"); }
  void write(int answer) const { shell.done("ANSWER=" + std::to_string(answer) + "; " + GetParam().write); }
  void emit(const std::string& kind) const {
    shell.done("export XDG_CACHE_HOME=$PWD/cache; echo '" + std::string(kPair) +
               "' > p; graze repro p --subject 'own=" + GetParam().what + "' --lanes 'own/*/cpu' --emit " + kind +
               " > case.cpp");
  }
};

TEST_P(Emitted, GtestFailsAndPassesWhenTheCodeIsMended) {
  write(0);
  emit("gtest");
  const Ran wrong = run_command();
  EXPECT_EQ(wrong.status, 1) << wrong.out << wrong.err << shell.file("case.cpp");
  EXPECT_TRUE(has(wrong.out, {" 1 FAILED TEST"})) << wrong.err;
  write(1);
  const Ran right = run_command();
  EXPECT_EQ(right.status, 0) << right.out << right.err;
  EXPECT_TRUE(has(right.out, {"[  PASSED  ] 1 test."}));
}

TEST_P(Emitted, CppSaysBothVerdicts) {
  write(0);
  emit("cpp");
  const Ran wrong = run_command();
  EXPECT_EQ(wrong.status, 1) << wrong.out << wrong.err;
  EXPECT_TRUE(has(wrong.out, {"/cpu: disjoint; truth: intersects\n"})) << wrong.err;
  write(1);
  EXPECT_EQ(run_command().status, 0);
}

INSTANTIATE_TEST_SUITE_P(cli, Emitted, testing::ValuesIn(kCodes),
                         [](const testing::TestParamInfo<OwnCode>& code) { return code.param.name; });

class OwnCodeTest : public CommandTest {};

// The user's code comes first in the sentences and in the table, and each lane's row has its own verdict.
TEST_F(OwnCodeTest, ExplainShowsEachLanesOwnVerdict) {
  std::ofstream(shell.folder / "own.c") << "int zero(const float* a, const float* b) { return 0; }\n"
                                           "int none(const float* a, const float* b) { return -1; }\n";
  expect_done("cc -shared -fPIC own.c -o own.so");
  std::ofstream(shell.folder / "p.pairs") << "0 0 0  4 0 0  0 4 0   1 1 -1  1 1 1  3 3 1\n";
  for (const auto& [function, says] : {std::pair("zero", "disjoint"), {"none", "declined"}}) {
    const std::string of = std::string(" p.pairs --subject own=./own.so:") + function;
    const Ran ran = shell("graze explain" + of + " --lanes 'own/f32/cpu,moller_1997/f32/cpu,exact/f32/cpu'");
    const auto row = [&](const char* lane) {
      std::istringstream lines(ran.out);
      for (std::string line; std::getline(lines, line);) {
        if (line.find(lane) != line.npos && line.find("says") == line.npos) return line;
      }
      return std::string();
    };
    EXPECT_TRUE(has(row("own/f32 "), {says})) << ran.out << ran.err;
    for (const char* lane : {"moller_1997/f32 ", "exact/f32 "}) {
      EXPECT_TRUE(has(row(lane), {"intersects"})) << ran.out;
      EXPECT_EQ(row(lane).find('!'), std::string::npos) << ran.out;
    }
  }
}

TEST_F(OwnCodeTest, TheExactLaneRunsBesideItUnlessALaneOptionLeavesItOut) {
  std::ofstream(shell.folder / "own.c") << "int intersects(const float a[9], const float b[9]) { return 1; }\n";
  const std::string graze = "export XDG_CACHE_HOME=$PWD/cache; graze ",
                    fuzz = graze + "fuzz --subject own=./own.c --pairs 40 --strata uniform --json ";
  const auto lanes_of = [&](const std::string& options) {
    const Ran ran = shell.done(fuzz + options);
    return nlohmann::json::parse(ran.out)["spec"]["lanes"].get<std::vector<std::string>>();
  };
  using Lanes = std::vector<std::string>;
  EXPECT_EQ(lanes_of("--out a --lanes own/f32/cpu"), (Lanes{"exact/f32/cpu", "own/f32/cpu"}));
  EXPECT_EQ(lanes_of("--out b --lanes 'own/f32/cpu,!exact/*'"), Lanes{"own/f32/cpu"});
  EXPECT_EQ(lanes_of("--out c --lanes 'own/f32/cpu*,!*fast,!*fma'"), (Lanes{"exact/f32/cpu", "own/f32/cpu"}));
  expect_error(fuzz + "--out d --lanes 'own/*,!exakt/*'", 2, {"exakt/*"});
  // The command in the message about a missing shard leaves out the exact lane as well.
  expect_done(fuzz + "--out s1 --lanes 'own/f32/cpu,!exact/*' --shard 1/2");
  const Ran gap = shell(graze + "merge s1 --out m");
  const std::size_t at = gap.err.find("graze fuzz ");
  ASSERT_NE(at, std::string::npos) << gap.err;
  EXPECT_TRUE(has(gap.err, {"!exact/f32/cpu"}));
}

// Tries code that hangs and code that crashes.
TEST_F(OwnCodeTest, FailuresAreEmittedToo) {
  for (const char* does : {"for (;;) pause();", "abort();"}) {
    shell(
        "printf '#include <stdlib.h>\\n#include <unistd.h>\\nint intersects(const float a[9], const float b[9]) "
        "{ " +
        std::string(does) + " return 0; }' > own.c");
    expect_done("export XDG_CACHE_HOME=$PWD/cache; echo '" + std::string(kPair) +
                "' > p; graze repro p --subject own=./own.c --lanes 'own/*/cpu' --emit gtest "
                "--subject-timeout 0.3 > case.cpp");
    const Ran ran = shell("head -n 1 case.cpp | cut -c 4- > run.sh; rm -f case; bash run.sh");
    EXPECT_EQ(ran.status, 1) << does << ran.out;
    EXPECT_TRUE(has(ran.out, {" 1 FAILED TEST"})) << does << ran.err;
    shell("echo 'int intersects(const float a[9], const float b[9]) { return 1; }' > own.c");
    expect_out("bash run.sh", {"[  PASSED  ] 1 test."});
  }
}

// For a CUDA source, the emitted test asks graze, which runs the twin if there is no device.
TEST_F(OwnCodeTest, CudaSourcesAreEmittedToo) {
  const auto write = [&](const char* answer) {
    shell(
        "printf '__device__ bool answer(const float*) { return %s; }\\nnamespace my { __device__ bool meet(const "
        "double "
        "a[9], const double b[9]) { return %s && a != b; } }' false " +
        std::string(answer) + " > own.cu");
  };
  write("false");
  const std::string again = "export XDG_CACHE_HOME=$PWD/cache; ", subject = " --subject own=./own.cu:my::meet ";
  if (const Ran lanes = shell(again + "graze lanes" + subject);
      lanes.status != 0 && lanes.err.find("NVRTC") != std::string::npos)
    GTEST_SKIP() << lanes.err;
  shell("echo '" + std::string(kPair) + "' > p");
  const auto emit = [&](const std::string& kind, const std::string& file) {
    expect_done(again + "graze repro p" + subject + "--lanes 'own/*/cuda-fma' --emit " + kind + " > " + file);
    ASSERT_TRUE(has(shell.file(file), {"own/f64/cuda-fma"}));
    shell("head -n 1 " + file + " | cut -c 4- > run.sh; rm -f case");
  };
  emit("gtest", "case.cpp");
  const Ran wrong = shell(again + "bash run.sh");
  EXPECT_EQ(wrong.status, 1) << wrong.out << wrong.err;
  EXPECT_TRUE(has(wrong.out, {" 1 FAILED TEST"})) << wrong.err;
  EXPECT_TRUE(has(wrong.out, {"\"cuda\":\"", "Which is: \"disjoint\""}));
  write("true");
  const Ran right = shell(again + "./case");
  EXPECT_TRUE(has(right.out, {"[  PASSED  ] 1 test."})) << right.err;
  const Ran alone = shell("PATH=/nowhere ./case");
  EXPECT_FALSE(has(alone.out, {"PASSED"}));
  EXPECT_TRUE(has(alone.out, {"must be on the PATH"})) << alone.err;
  expect_error(again + "graze repro p" + subject + "--lanes 'own/*/cuda-fma' --emit cuda", 1,
               {"CUDA lanes", "--lanes"});
#ifdef GRAZE_NVCC_DIR
  write("false");
  emit("cuda", "case.cu");
  const Ran ran = shell("PATH=$PATH:" GRAZE_NVCC_DIR "\nbash run.sh");
  ASSERT_TRUE(std::filesystem::exists(shell.folder / "case")) << ran.err;
  if (shell("graze lanes | grep -q 'available (device)'").status != 0) {
    EXPECT_EQ(ran.status, 2) << ran.out;  // because there is no device
    return;
  }
  EXPECT_EQ(ran.status, 1) << ran.err;
  EXPECT_EQ(ran.out, "own/f64/cuda-fma: disjoint; truth: intersects\n");
#endif
}

// The search for the relevant products runs in a separate process, because this code loops for seconds if only some of
// them are fused.
TEST_F(OwnCodeTest, ContractionsOfCudaSourcesAreNamed) {
  shell(
      "cat > own.cu <<'EOF'\n"
      "__device__ float product(const float* t) {\n"
      "  return t[0] * t[1] - t[3] * t[4];\n"
      "}\n"
      "__device__ bool one(const float* a, const float* b) {\n"
      "  return product(a) != 0;\n"
      "}\n"
      "__device__ bool both(const float* a, const float* b) {\n"
      "  unsigned n = 1;\n"
      "  if (a[2] == 1 && b[2] == 9 && a[0] < a[3] && b[0] < b[3] && (product(a) != 0) != (product(b) != 0))\n"
      "    for (unsigned i = 0; i != 4000000000u; ++i) n = n * n + i;\n"
      "  return product(a) != 0 && n != 0;\n"
      "}\nEOF\n"
      // In each triangle, two products of coordinates are equal after rounding.
      "echo '0x1.000002p+0 0x1.000002p+0 1 0x1.000004p+0 1 1 3 3 1  0x1.000006p+0 0x1.000006p+0 9 0x1.00000cp+0 1 9 0 "
      "2 9' > p");
  const std::string explain =
      "export XDG_CACHE_HOME=$PWD/cache; graze explain p --subject-timeout 0.5 --lanes 'own/*/cuda-*fma' ";
  const Ran named = shell(explain + "--subject own=./own.cu:one | tr -s ' \\n' ' '");
  if (shell(explain + "--subject own=./own.cu:one").err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  EXPECT_TRUE(
      has(named.out, {"nvcc fuses the product into the addition at own.cu:2 (inlined at own.cu:5) (built without "
                      "contraction it is right)."}))
      << named.err;
  EXPECT_TRUE(has(named.out, {"own.cu:2, inlined at "}));
  const Ran late = shell(explain + "--subject own=./own.cu:both | tr -s ' \\n' ' '");
  EXPECT_TRUE(has(late.out, {"the compiler fuses products into additions (built without contraction it is right; which "
                             "products matter is not known: with some of its products fused it does not return)."}))
      << late.err;
}

// Like CudaAgainstCpuIsExplained, but on a pair of doubles.
TEST_F(OwnCodeTest, CudaInDoubleIsExplainedOnDoubles) {
  shell(
      "cat > own.cu <<'EOF'\n"
      "__host__ __device__ inline double product(const double* t) {\n"
      "  return t[0] * t[1] - t[3] * t[4];\n"
      "}\n"
      "__host__ __device__ bool both(const double* a, const double* b) {\n"
      "  return product(a) != 0;\n"
      "}\nEOF\n"
      "echo '0x1.0000000000001p+0 0x1.0000000000001p+0 1 0x1.0000000000002p+0 1 1 3 3 1  0x1.0000000000003p+0 1 9 "
      "0x1.0000000000006p+0 1.5 9 0 2 9' > p");
  const std::string cached = "export XDG_CACHE_HOME=$PWD/cache; ", both = " --subject own=./own.cu:both ";
  const Ran named = shell(cached + "graze explain p --lanes 'own/*'" + both + "| tr -s ' \\n' ' '");
  if (named.err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  EXPECT_TRUE(
      has(named.out, {"own/f64/cuda-fma differs from cpu by contraction at own.cu:2 (inlined at own.cu:5): with the "
                      "products there rounded it says disjoint, as cpu does."}))
      << named.err;
  // Differing operands are counted for each line with a comparison.
  expect_done(cached +
              "graze discrepancy own/f64/cuda-nofma own/f64/cuda-fma --coordinates f64 --strata exact_contact --pairs "
              "300 --executor twin --out d" +
              both);
  const auto found = shell.json("d/discrepancy.json");
  const auto& operands = found["verdicts"][0]["operands"];
  EXPECT_GT(operands["lines"][0]["differs"].get<int>(), 50) << operands;
  EXPECT_TRUE(has(operands["lines"][0]["line"].get<std::string>(), {"own.cu:5"})) << operands;
}

// CUDA lanes of a __host__ __device__ function are compared with its cpu lane.
TEST_F(OwnCodeTest, CudaAgainstCpuIsExplained) {
  shell(
      "cat > own.cu <<'EOF'\n"
      "__host__ __device__ inline float product(const float* t) {\n"
      "  return t[0] * t[1] - t[3] * t[4];\n"
      "}\n"
      "__host__ __device__ bool both(const float* a, const float* b) {\n"
      "  return product(a) != 0;\n"
      "}\n"
      "__device__ bool one(const float* a, const float* b) {\n"
      "  return both(a, b);\n"
      "}\nEOF\n"
      // Two products of a's coordinates are equal after rounding, and the triangles are disjoint.
      "echo '0x1.000002p+0 0x1.000002p+0 1 0x1.000004p+0 1 1 3 3 1  0x1.000006p+0 0x1.000006p+0 9 0x1.00000cp+0 1 9 0 "
      "2 9' > p");
  const std::string cached = "export XDG_CACHE_HOME=$PWD/cache; ", both = " --subject own=./own.cu:both ";
  const auto explained = [&](const std::string& rest) {
    return shell(cached + "graze explain p " + rest + " | tr -s ' \\n' ' '");
  };
  if (shell(cached + "graze lanes" + both).err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  const char said[] =
      "own/f32/cuda-fma differs from cpu by contraction at own.cu:2 (inlined at own.cu:5): with the products there "
      "rounded it says disjoint, as cpu does. Build with -fmad=false. Cost of ";
  const Ran named = explained(both + "--lanes 'own/*'");
  EXPECT_TRUE(has(named.out, {said})) << named.err;
  const Ran device_only = explained("--subject own=./own.cu:one --lanes 'own/*'");
  EXPECT_TRUE(has(device_only.out, {"cuda-fma"})) << device_only.err;
  EXPECT_FALSE(has(device_only.out, {"differs from cpu"}));
  // Checks the explanation's claim: if only the products on that line are rounded, the verdict is that of cpu.
  shell("sed '2s/.*/  return __fsub_rn(__fmul_rn(t[0], t[1]), __fmul_rn(t[3], t[4]));/' own.cu > rounded.cu");
  const Ran rounded =
      shell(cached + "graze check p --json --executor twin --lanes 'own/*/cuda-fma' --subject own=./rounded.cu:one");
  EXPECT_TRUE(has(rounded.out, {R"("own/f32/cuda-fma":"disjoint")"})) << rounded.err;
  // fuzz counts differences from cpu.
  expect_done(cached + "graze fuzz --executor twin --pairs 300 --strata exact_contact --out c --lanes 'own/*'" + both);
  const auto summary = shell.json("c/summary.json");
  EXPECT_TRUE(summary["spec"]["subjects"][0].contains("host")) << summary["spec"];
  expect_done(cached + "graze report c");
  EXPECT_TRUE(has(shell.file("c/differs.csv"), {"own/f32/cuda-fma"}));
  const Ran test = shell(cached + "graze repro p --emit gtest --lanes own/f32/cpu-fma" + both +
                         " > case.cpp && eval \"$(grep -o 'g++ .*' case.cpp | head -1)\"");
  EXPECT_TRUE(has(test.out, {"1 FAILED TEST"})) << test.err;
}

// Requested lanes that do not run are named, recorded and reported. A pattern that matches no lane is an error.
TEST_F(OwnCodeTest, LanesThatDoNotRunAreNamedEverywhere) {
  const std::string lanes = " --lanes 'moller_1997/f32/c*' ";
  const Ran ran = shell.done("graze fuzz --executor twin --pairs 200 --strata uniform --out c" + lanes);
  EXPECT_EQ(ran.err, "graze: left out (no twin; a CUDA device runs it): moller_1997/f32/cuda-fast\n");
  EXPECT_TRUE(has(shell.file("c/summary.json"), {R"("moller_1997/f32/cuda-fast": "no twin")"}));
  expect_done("graze report c");
  for (const char* file : {"c/report.json", "c/report.html"})
    EXPECT_TRUE(
        has(shell.file(file), {"did not run: left out (no twin; a CUDA device runs it): moller_1997/f32/cuda-fast."}))
        << file;
  shell("echo '" + std::string(kPair) + "' > p");
  for (const char* verb : {"check p --executor twin", "explain p", "invariants --pairs 19 --out l",
                           "plan --executor twin", "corpus verify --executor twin"})
    EXPECT_TRUE(shell(std::string("graze ") + verb + lanes).err.starts_with(ran.err)) << verb;
  // If all requested lanes run, nothing is reported or recorded.
  const Ran all =
      shell("graze fuzz --pairs 200 --strata uniform --out d --executor twin --lanes 'moller_1997/f32/c*fma'");
  EXPECT_EQ(all.err, "");
  EXPECT_FALSE(has(shell.file("d/summary.json"), {"left_out"}));
  // --subject requests the user's code even without a pattern.
  std::ofstream(shell.folder / "own.cu") << "__device__ bool meet(const float a[9], const float b[9]) "
                                            "{ return expf(a[0]) > b[0]; }\n";
  const Ran own = shell(
      "export XDG_CACHE_HOME=$PWD/cache; graze fuzz --pairs 20 --subject own=./own.cu:meet --executor twin --out e");
  if (own.err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  EXPECT_EQ(own.status, 2);
  EXPECT_TRUE(names(own.err.substr(0, own.err.find_last_not_of('\n') + 1), {"'own/*'", "no twin"}));
}

TEST_F(OwnCodeTest, FailAboveFailsWithTheSmallestCase) {
  shell("echo 'int intersects(const float a[9], const float b[9]) { return a[0] > b[0]; }' > own.c");
  const std::string fuzz =
      "export XDG_CACHE_HOME=$PWD/cache; graze fuzz --subject own=./own.c --pairs 400 "
      "--lanes 'own/f32/cpu,moller*/f32/cpu' --out c --fail-above ";
  expect_error(fuzz + "0", 1, {"own", "0", "--fail-above"});
  const Ran ran = shell(fuzz + "0");
  const std::size_t again = ran.err.find("to replay it: ");
  ASSERT_NE(again, std::string::npos) << ran.err;
  const Ran repro = shell(ran.err.substr(again + 14) + " ");
  EXPECT_TRUE(has(repro.out, {"own/f32"})) << repro.err;
  EXPECT_TRUE(has(repro.out, {"!"}));
  expect_done(fuzz + "400");  // moller is wrong too, but was not requested
  // The file contains the smallest of all minimised cases, which need not come from the smallest kept pair.
  const auto pairs_of = [&](const std::string& command) {
    shell(command + " > some.pairs");
    std::vector<Simplicity> found;
    for (const corpus::Entry& entry : corpus::read_pairs(shell.folder / "some.pairs"))
      found.push_back(simplicity(entry.pair));
    return found;
  };
  const std::size_t begin = ran.err.find("smallest is ") + 12;
  const std::string pair = ran.err.substr(begin, ran.err.find(';', begin) - begin);
  const std::vector<Simplicity> smallest = pairs_of("echo '" + pair + "'"),
                                minimised = pairs_of("grep -h kind=minimised c/cases/*.pairs");
  ASSERT_EQ(smallest.size(), 1u);
  EXPECT_GE(minimised.size(), 4u);
  EXPECT_LE(minimised.size(), 8u);
  EXPECT_EQ(smallest[0], *std::min_element(minimised.begin(), minimised.end())) << ran.err;
  EXPECT_EQ(shell(fuzz + "0").err, ran.err);
  // If no subject is named, any lane counts.
  const std::string ours = "graze fuzz --pairs 400 --out d --fail-above ";
  expect_error(ours + "0 --lanes 'moller*/f32/cpu'", 1, {"moller_1997", "0", "--fail-above"});
  expect_done("graze fuzz --pairs 400 --out e --lanes 'exact/f32/cpu' --fail-above 0");
  // If no lane of a subject is selected, that is an error.
  expect_error("export XDG_CACHE_HOME=$PWD/cache; graze fuzz --subject own=./own.c --lanes 'exact/f32/cpu' --out f", 2,
               {"own", "--lanes"});
}

// Runs all verbs on campaigns with code that crashes, hangs or is unstable on some pairs.
TEST_F(OwnCodeTest, EveryVerbTakesWhatMisbehaves) {
  shell(
      "cat > own.c <<'EOF'\n"
      "#include <stdlib.h>\n#include <unistd.h>\n"
      "static int calls;\n"
      "static int bad(const float* a) { return a[0] > 0.9f && a[0] < 0.95f; }\n"
      "static int good(const float* a, const float* b) { return a[0] < b[0]; }\n"
      "int crashes(const float a[9], const float b[9]) { if (bad(a)) abort(); return good(a, b); }\n"
      "int hangs(const float a[9], const float b[9]) { if (bad(a)) for (;;) pause(); return good(a, b); }\n"
      "int wavers(const float a[9], const float b[9]) { return bad(a) ? ++calls & 1 : good(a, b); }\n"
      "EOF\ncc -shared -fPIC own.c -o libown.so");
  const struct {
    const char *name, *cause, *mark;
  } kWays[] = {{"crashes", "crash", "!"}, {"hangs", "no answer in time", "@"}, {"wavers", "unstable", "%"}};
  for (const auto& way : kWays) {
    SCOPED_TRACE(way.name);
    const std::string name = way.name;
    expect_done("graze fuzz --subject " + name + "=./libown.so:" + name + " --subject-timeout 0.1 --lanes '" + name +
                "/*' --strata uniform --pairs 50 --out " + name);
    expect_done("graze minimize " + name + " > minimized");
    expect_done("graze report " + name);
    const Ran kinds = shell("graze failures " + name);
    EXPECT_TRUE(has(kinds.out, {name + ": " + way.cause + ", "})) << kinds.err;
    EXPECT_TRUE(has(contents(shell.folder / name / "report.json"), {way.cause}));
    const std::string found =
        "$(grep -l '" + name + ":" + std::string(way.mark) + "' " + name + "/cases/*.pairs | head -n 1)";
    const Ran explained = shell("graze explain --all " + found);
    EXPECT_TRUE(has(explained.out, {std::string("cause: ") + way.cause + "\n"})) << explained.err;
    expect_done("graze repro " + found);
    expect_done("graze map " + found + " --out m.png");
    expect_done("graze corpus add " + found + " --corpus corpus-" + name);
  }
}

// Code that fails at first, but not when it runs again.
TEST_F(OwnCodeTest, CodeThatChangesItsAnswersKeepsItsReport) {
  std::ofstream(shell.folder / "alt.cpp")
      << "static int n; bool intersects(const float* a, const float* b) { return n++ >> 3 & 1; }\n";
  std::ofstream(shell.folder / "rnd.cpp")
      << "#include <cstdlib>\nbool intersects(const float* a, const float* b) { return rand() & 1; }\n";
  expect_done(
      "export XDG_CACHE_HOME=$PWD/cache; for name in alt rnd; do graze fuzz --subject s=./$name.cpp --lanes 's/*' "
      "--strata uniform,near_edge_edge --pairs 100 --threads 1 --out $name > /dev/null && graze minimize $name > "
      "/dev/null && graze report $name > /dev/null && graze failures $name > $name.txt && grep -q kind-1 $name.txt && "
      "graze try $name.cpp --pairs 100 --threads 1 --out try-$name > /dev/null || exit 1; done");
}

}  // namespace
}  // namespace graze::cli
