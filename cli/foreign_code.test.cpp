// SPDX-License-Identifier: Apache-2.0
// Runs `graze` with foreign code that hangs, floods its output or leaves processes: `graze` stops when asked to, and
// leaves nothing behind.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

class ForeignCode : public CommandTest {
 protected:
  // A sleep duration that no other process uses.
  const std::string sleeps = "sleep 9" + std::to_string(getpid());

  ForeignCode() { shell("echo '0 0 0 4 0 0 0 4 0  1 1 -1 1 1 1 3 3 1' > pair.txt"); }

  void expect_none_sleeps() const {
    EXPECT_EQ(shell("command -v pgrep || exit 1; for i in $(seq 600); do pgrep -f '^" + sleeps +
                    "' > /dev/null || exit 0; sleep 0.1; done; exit 1")
                  .status,
              0);
  }
};

// SIGTERM is sent after the campaign has begun, and the campaign must stop normally within two minutes.
TEST_F(ForeignCode, SigtermEndsACampaignInOrderWhileASubjectHangs) {
  ASSERT_EQ(shell("echo 'int intersects(const float a[9], const float b[9]) { for (;;) ; }' > h.c && cc -shared -fPIC "
                  "h.c -o h.so")
                .status,
            0);
  for (const std::string& subject :
       {std::string("h=./h.so"), "h=cmd:read l; [ \"$l\" = describe ] || exec " + sleeps}) {
    const std::string out = "out-" + std::to_string(subject.size());
    const Ran ran = signalled("timeout -s KILL 120 graze fuzz --subject '" + subject +
                                  "' --subject-timeout 3600 --lanes 'h/*' --strata uniform --pairs 100 --out " + out,
                              "TERM", "[ -s " + out + "/campaign.sqlite ] && sleep 1");
    EXPECT_EQ(ran.status, 130) << ran.err;
    EXPECT_TRUE(has(ran.err, {"interrupted"}));
  }
  expect_none_sleeps();
}

TEST_F(ForeignCode, AQueryOfASlowSubjectIsInterrupted) {
  ASSERT_EQ(shell("printf '#include <unistd.h>\nint intersects(const float a[9], const float b[9]) { usleep(200000); "
                  "return a[0] < b[0]; }' > s.c && cc -shared -fPIC s.c -o s.so && "
                  "(printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n'; for i in $(seq 900); do echo f 1 2 3; done) > many.obj && "
                  "echo 0 0 0 1 0 0 0 1 0 > one.txt")
                .status,
            0);
  const Ran ran = signalled("timeout -s KILL 120 graze query one.txt many.obj --subject s=./s.so", "INT", "sleep 1");
  EXPECT_EQ(ran.status, 130) << ran.err;
  EXPECT_TRUE(has(ran.err, {"interrupted"}));
  EXPECT_FALSE(has(ran.err, {"callback"}));
}

TEST_F(ForeignCode, NothingOutlivesACampaignOrItsKill) {
  const std::string leaves =
      "--subject 'l=cmd:setsid " + sleeps + " & while read l; do echo 1; done' --lanes 'l/*' --strata uniform";
  expect_done("graze fuzz " + leaves + " --pairs 10 --out done");
  expect_none_sleeps();
  EXPECT_EQ(shell("timeout -s KILL 1 graze fuzz --subject 'l=cmd:setsid " + sleeps + " & exec " + sleeps +
                  "' --subject-timeout 3600 --lanes 'l/*' --pairs 10 --out killed")
                .status,
            137);
  expect_none_sleeps();
}

TEST_F(ForeignCode, CodeThatCannotBeSeenAndTooFewDescriptorsAreRefused) {
  const std::string folder = "/dev/shm/graze-test-" + std::to_string(getpid());
  if (shell("mkdir " + folder).status != 0) GTEST_SKIP() << "no /dev/shm";
  expect_done("echo 'while read l; do echo 1; done' > " + folder + "/p.sh && ln -s " + folder +
              "/p.sh p.sh && "
              "echo 'int meet(const float* a, const float* b) { return a[0] < b[0]; }' > " +
              folder + "/m.c");
  for (const std::string& what : {"cmd:sh " + folder + "/p.sh", std::string("cmd:sh p.sh"), folder + "/m.c:meet"})
    expect_error("graze check --subject 'm=" + what + "' pair.txt", 1, {"--subject m", "/dev/shm", "copy"});
  expect_error("ulimit -n 100; cp " + folder + "/m.c . && graze check --subject m=./m.c:meet pair.txt", 1,
               {"100 descriptors", "ulimit"});
  expect_done("rm -r " + folder);
}

// The first subject replaces the program that runs subjects.
TEST_F(ForeignCode, CannotReplaceTheProgramThatRunsIt) {
  expect_done("mkdir gz && cp $(command -v graze) $(dirname $(command -v graze))/graze-subject-host gz");
  shell(
      "cat > replaces.c << 'END'\n"
      "#include <stdio.h>\n#include <unistd.h>\n"
      "int intersects(const float a[9], const float b[9]) {\n"
      "  if (rename(FOLDER \"/gz/graze-subject-host\", FOLDER \"/gz/moved\") == 0)\n"
      "    return symlink(\"/bin/false\", FOLDER \"/gz/graze-subject-host\");\n"
      "  return 0;\n}\nEND\n"
      "echo 'int intersects(const float a[9], const float b[9]) { return 0; }' > none.c");
  expect_done("cc -shared -fPIC -DFOLDER=\"\\\"$PWD\\\"\" replaces.c -o a.so && cc -shared -fPIC none.c -o b.so");
  expect_done(
      "gz/graze fuzz --subject a=./a.so --subject b=./b.so --lanes 'a/*,b/*' --strata uniform --pairs 5000 "
      "--out o && test -e gz/moved");
  const nlohmann::ordered_json lanes = shell.json("o/summary.json")["strata"]["uniform"]["lanes"];
  for (const char* lane : {"a/f32/cpu", "b/f32/cpu"}) {
    EXPECT_EQ(lanes[lane].value("crashed", 0), 0) << lane;
    EXPECT_GT(lanes[lane]["false_negative"], 0) << lane;
  }
}

// The compiler waits forever for input from the pipe. A verb that catches no signals itself must stop normally too.
TEST_F(ForeignCode, ACompilerEndsWithGraze) {
  expect_done("mkfifo pipe.h && echo '#include \"pipe.h\"' > waits.cpp");
  const std::string verbs[] = {"fuzz --lanes 'w/*' --strata uniform --pairs 10 --out o", "check pair.txt"};
  for (const std::string& verb : verbs) {
    for (const auto& [signal, status] : {std::pair{"TERM", 130}, {"INT", 130}, {"KILL", 137}}) {
      const Ran ran = shell("export XDG_CACHE_HOME=$PWD/cache; set -m; graze " + verb +
                            " --subject w=./waits.cpp & p=$!; until pgrep -f \"$PWD/cache.* -E\" > /dev/null; do "
                            "sleep 0.02; kill -0 $p || exit 99; done; kill -" +
                            signal + " $p; wait $p");
      EXPECT_EQ(ran.status, status) << verb << ran.err;
      if (status == 130) {
        EXPECT_EQ(ran.err, "graze: interrupted\n");
      }
      EXPECT_EQ(shell("for i in $(seq 600); do pgrep -f \"$PWD/cache\" > /dev/null || ls cache/graze | grep -q "
                      "unfinished || exit 0; sleep 0.1; done; exit 1")
                    .status,
                0);
    }
  }
}

// The program replaces its own file at the first pair. No record mixes verdicts from the old and the new file.
TEST_F(ForeignCode, ACampaignWhoseProgramChangesFailsAndGoesOnWithTheOldOne) {
  ASSERT_EQ(shell("printf 'while read l; do [ \"$l\" = describe ] && { echo; continue; }; echo 1; [ -e swap ] || "
                  "continue; rm swap; cp other.sh next.sh; mv next.sh m.sh; done\n' > m.sh && cp m.sh old.sh && "
                  "sed 's/echo 1/echo 0/' m.sh > other.sh && touch swap")
                .status,
            0);
  const std::string run = "graze fuzz --subject 'm=cmd:sh m.sh' --lanes 'm/*' --strata uniform --pairs 200 --out ";
  const std::vector<std::string> changed{"m.sh", "changed while", "restore the file"};
  expect_error(run + "whole", 1, changed);
  EXPECT_TRUE(has(shell("graze status whole --json").out, {"changed while"}));
  EXPECT_EQ(shell("touch swap; cp old.sh m.sh; " + run + "shard --shard 1/2").status, 1);
  expect_error("graze merge shard --out merged", 1, {"m.sh", "has changed"});
  expect_error("graze report whole", 1, {"whole"});
  EXPECT_EQ(shell(run + "whole").status, 2);  // the new code is not the campaign's
  expect_done("cp old.sh m.sh; " + run + "whole && " + run + "straight");
  expect_done("cmp whole/summary.json straight/summary.json");
}

TEST_F(ForeignCode, ACampaignIsNotDoneIfItsCodeOverwritesTheDatabase) {
  std::ofstream(shell.folder / "w.c") << "#include <stdio.h>\n#define DATABASE \"" +
                                             (shell.folder / "c/campaign.sqlite").string() + R"("
int intersects(const float a[9], const float b[9]) {
  static int calls;
  FILE* f = ++calls == 90 && !remove(DATABASE) ? fopen(DATABASE, "w") : 0;
  if (f) fclose(f);
  return a[0] < b[0];
}
)";
  expect_error("graze fuzz --subject w=./w.c --lanes 'w/f32/cpu' --strata uniform --pairs 100 --out c", 1,
               {"c/campaign.sqlite"});
  expect_done("graze fuzz --lanes 'moller_1997/f32/cpu' --strata uniform --pairs 100 --out d");
}

// The results of `graze minimize` become part of the campaign, so they must come from the code that the campaign ran.
TEST_F(ForeignCode, MinimizeRefusesCodeThatTheCampaignDidNotRun) {
  const std::string always = "echo 'int meet(const float a[9], const float b[9]) { return 1; }' > a.c";
  expect_done(always +
              " && graze fuzz --subject m=./a.c:meet --lanes m/f32/cpu --strata uniform --pairs 200 --out c "
              "&& sed 's/1;/a[0] == 0;/' a.c > b.c && mv b.c a.c && cp -r c before");
  const Ran refused = shell("graze minimize c --subject m=./a.c:meet");
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(has(refused.err, {"cannot minimise c: "}));
  expect_done("diff -r before c && " + always + " && graze minimize c");
}

// NVRTC takes minutes to compile this, and catches signals itself.
TEST_F(ForeignCode, ACompilationByNvrtcStops) {
  std::ofstream(shell.folder / "small.cu")
      << "__device__ bool meet(const float a[9], const float b[9]) { return a[0] > b[0]; }\n";
  if (shell("graze lanes --subject s=./small.cu:meet").status != 0) GTEST_SKIP() << "no NVRTC";
  std::ofstream(shell.folder / "heavy.cu")
      << "template <int N, int M> struct T { static __device__ float f(float x) {\n"
         "  return T<N - 1, 2 * M>::f(x * 1.01f) + T<N - 1, 2 * M + 1>::f(x - 0.5f); } };\n"
         "template <int M> struct T<0, M> { static __device__ float f(float x) { return x * M; } };\n"
         "__device__ bool meet(const float a[9], const float b[9]) { return T<15, 1>::f(a[0]) > b[0]; }\n";
  for (const char* signal : {"TERM", "INT"}) {
    const Ran ran =
        shell(std::string("set -m; graze check pair.txt --subject s=./heavy.cu:meet & p=$!; until [ $(pgrep -c -P $p) "
                          "-gt 0 ]; do sleep 0.02; kill -0 $p || exit 99; done; kill -") +
              signal + " $p; wait $p");
    EXPECT_EQ(ran.status, 130) << ran.err;
    EXPECT_EQ(ran.err, "graze: interrupted\n");
  }
}

TEST_F(ForeignCode, OptionsOfSubjectsAreWithinBounds) {
  for (const std::string seconds : {"nan", "inf", "-1", "0", "1e9", "1s"})
    expect_error("graze check pair.txt --subject s=cmd:true --subject-timeout=" + seconds, 2, {"0.001", "86400"});
  expect_error("graze check pair.txt --subject s=$(printf 'x%.0s' $(seq 100000)).so", 1, {"File name too long"});
}

TEST_F(ForeignCode, FlagsAreForCodeThatGrazeCompiles) {
  expect_done(
      "printf 'int intersects(const float* a, const float* b) { return a[0] < b[0] + EPS; }' > m.c && "
      "cc -shared -fPIC -DEPS=1 m.c -o m.so");
  for (const std::string what : {"./m.so", "'cmd:while read l; do echo 1; done'"})
    expect_error("graze fuzz --pairs 20 --subject m=" + what + " --flags=-DEPS=1 --out none", 2, {"--flags"});
  expect_done(
      "graze fuzz --pairs 20 --subject m=./m.so --subject s=./m.c --flags=-DEPS=2 --lanes '[ms]/f32/cpu' --out c");
  const Json subjects = shell.json("c/summary.json")["spec"]["subjects"];
  EXPECT_EQ(subjects[0]["flags"], Json::array());
  EXPECT_EQ(subjects[1]["flags"], Json::array({"-DEPS=2"}));
}

TEST_F(ForeignCode, ALongTableOrNameInCudaCodeIsNoCrash) {
  std::string table = "__constant__ float t[4000] = {0";
  for (int i = 1; i < 4000; ++i) table += ", " + std::to_string(i % 10) + ".5f";
  std::ofstream(shell.folder / "t.cu") << table +
                                              "};\n__device__ bool meet(const float a[9], const float b[9]) { "
                                              "return a[0] <= b[0] + t[(int)a[1] & 1023]; }\n";
  std::ofstream(shell.folder / "e.cu") << "#error " << std::string(200'000, 'a') << '\n';
  std::ofstream(shell.folder / "small.cu")
      << "__device__ bool meet(const float a[9], const float b[9]) { return a[0] > b[0]; }\n";
  if (shell("graze lanes --subject s=./small.cu:meet").status != 0) GTEST_SKIP() << "no NVRTC";
  expect_done("graze fuzz --pairs 20 --subject t=./t.cu:meet --lanes 't/*' --executor twin --out t");
  expect_error("graze fuzz --pairs 20 --subject e=./e.cu:meet --lanes 'e/*' --executor twin --out e", 2, {"e.cu"});
}

TEST_F(ForeignCode, WhatCannotBeWrittenForACompilerIsSaidWithItsReason) {
  expect_error(
      "set -o pipefail; export XDG_CACHE_HOME=$PWD/cache; echo 'int intersects(const float* a, const float* b) "
      "{ return 1; }' > a.c; (ulimit -f 1; graze check pair.txt --subject s=./a.c) 2>&1 | cat >&2",
      1, {"cache/graze/include/graze/cuda_host.h", "File too large"});
}

// If a constructor sends garbage instead of describing the functions, one line names the code.
TEST_F(ForeignCode, ASubjectWithoutAFunctionIsNamed) {
  ASSERT_EQ(
      shell(
          "printf '#include <string.h>\\n#include <sys/socket.h>\\n#include <unistd.h>\\n__attribute__((constructor)) "
          "static void f(void) { char b[10008] = {0}; send(5, b, sizeof b, 0); pause(); }' > c.c && cc -shared -fPIC "
          "c.c -o c.so")
          .status,
      0);
  expect_error("graze check pair.txt --subject s=./c.so --lanes 's/*'", 1, {"--subject s"});
}

}  // namespace
}  // namespace graze::cli
