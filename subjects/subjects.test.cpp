// SPDX-License-Identifier: Apache-2.0
#include "subjects/subjects.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <regex>
#include <thread>

#include "core/algorithms/algorithms.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/lanes/verdicts.h"
#include "core/message_testing.h"
#include "core/stop.h"
#include "cuda/twin/twin.h"
#include "strata/strata.h"
#include "subjects/process.h"
#include "subjects/source_build.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// One subject for each misbehaviour, on the pairs that `bad` selects. On other pairs the subjects answer whether a is
// left of b.
constexpr const char* kMisbehaving = R"(
#include <stdlib.h>
#include <unistd.h>
static unsigned calls;
static int bad(const float a[9]) { return a[0] > 0.9f; }
int good(const float a[9], const float b[9]) { return a[0] < b[0]; }
int declines(const float a[9], const float b[9]) { return bad(a) ? -1 : good(a, b); }
int aborts(const float a[9], const float b[9]) { if (bad(a)) abort(); return good(a, b); }
int exits(const float a[9], const float b[9]) { if (bad(a)) exit(0); return good(a, b); }
int scribbles(const float a[9], const float b[9]) { if (bad(a)) ((float*)b)[3] = 3; return good(a, b); }
int hangs(const float a[9], const float b[9]) { if (bad(a)) for (;;) pause(); return good(a, b); }
int wavers(const float a[9], const float b[9]) { return bad(a) ? ++calls & 1 : good(a, b); }
int rounds(const float a[9], const float b[9]) {  // rounds upward after the first bad pair, and is then wrong
  volatile float one = 1, tiny = 0x1p-30f;
  const int upward = one + tiny != one;
#ifdef __x86_64__
  if (bad(a)) __builtin_ia32_ldmxcsr(0x5f80);
#else
  if (bad(a)) return ++calls & 1;
#endif
  return upward ? !good(a, b) : good(a, b);
}
int eats(const float a[9], const float b[9]) {
  if (bad(a)) for (;;) { char* p = malloc(1 << 20); if (!p) abort(); for (int i = 0; i < 1 << 20; i += 4096) p[i] = 1; }
  return good(a, b);
}
int dawdles(const float a[9], const float b[9]) { usleep((int)(a[0] * 1e4f) & 4095); return good(a, b); }
int in_double(const double a[9], const double b[9]) { return a[0] < b[0]; }
)";

constexpr const char* kDescribed = R"(
#include <graze/subject.h>
#include <stdexcept>
static int throws(const float a[9], const float b[9]) {
  if (a[0] > 0.9f) throw std::runtime_error("no");
  return a[0] < b[0];
}
static void block(const float* pairs, size_t count, signed char* answers) {
  for (size_t i = 0; i < count; ++i) {
    if (pairs[18 * i] > 0.9f) __builtin_trap();
    answers[i] = pairs[18 * i] < pairs[18 * i + 9];
  }
}
GRAZE_SUBJECT(graze_subject) = {GRAZE_SUBJECT_ABI, GRAZE_OUTSIDE_TOUCHING | GRAZE_OUTSIDE_COPLANAR, "1.2", "a test", "page 3", throws, nullptr, nullptr, nullptr};
GRAZE_SUBJECT(in_blocks) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, block, nullptr};
static void rounds(const float* pairs, size_t count, signed char* answers) {
  volatile float one = 1, tiny = 0x1p-30f;
  const bool upward = one + tiny != one;
  for (size_t i = 0; i < count; ++i) {
#ifdef __x86_64__
    if (pairs[18 * i] > 0.9f) __builtin_ia32_ldmxcsr(0x5f80);
#endif
    answers[i] = (pairs[18 * i] < pairs[18 * i + 9]) != upward;
  }
}
GRAZE_SUBJECT(rounds_in_blocks) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, rounds, nullptr};
static void by_place(const float* pairs, size_t count, signed char* answers) {  // wrong at every eighth place
  for (size_t i = 0; i < count; ++i) answers[i] = (pairs[18 * i] < pairs[18 * i + 9]) != (i % 8 == 7);
}
GRAZE_SUBJECT(by_place_in_block) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, by_place, nullptr};
static void writes_some(const float* pairs, size_t count, signed char* answers) {
  for (size_t i = 0; i < count; ++i)
    if (!(pairs[18 * i] > 0.9f)) answers[i] = pairs[18 * i] < pairs[18 * i + 9];
}
GRAZE_SUBJECT(writes_some_answers) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, writes_some, nullptr};
GRAZE_SUBJECT(outside_what) = {GRAZE_SUBJECT_ABI, 16, nullptr, nullptr, nullptr, throws, nullptr, nullptr, nullptr};
GRAZE_SUBJECT(of_another_time) = {99, 0, nullptr, nullptr, nullptr, throws, nullptr, nullptr, nullptr};
GRAZE_SUBJECT(empty) = {GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
)";

constexpr const char* kLess = "int intersects(const float a[9], const float b[9]) { return a[0] < b[0]; }";

struct Subjects : testing::Test {
  static inline fs::path folder;
  static inline std::vector<Pair> pairs;

  static fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  static void SetUpTestSuite() {
    folder = fs::path(testing::TempDir()) / ("subjects-" + std::to_string(getpid()));
    fs::create_directories(folder);
    setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
    build("cc -O2", write("bad.c", kMisbehaving), "libbad.so");
    build("c++ -std=c++20 -O2", write("described.cpp", kDescribed), "libdescribed.so");
    for (std::uint64_t i = 0; i < 3000; ++i) pairs.push_back(strata::generate(1, strata::Stratum::uniform, i));
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static fs::path build(const std::string& compiler, const fs::path& source, const std::string& library) {
    const fs::path file = folder / library;
    EXPECT_EQ(std::system(fmt::format("{} -shared -fPIC -I" GRAZE_SOURCE_DIR "/subjects/include {} -o {}", compiler,
                                      source.string(), file.string())
                              .c_str()),
              0);
    return file;
  }

  static bool is_bad(const Pair& pair) { return pair.a[0].x > 0.9f; }
  static Verdict left_of(const Pair& pair) {
    return pair.a[0].x < pair.b[0].x ? Verdict::intersects : Verdict::disjoint;
  }

  static std::vector<Verdict> verdicts(const DecideBlock& block) { return verdicts_of(block, pairs); }
  // Expects `of_bad` on the bad pairs, and the answer of `good` on the others.
  static void expect(const std::vector<Verdict>& found, Verdict of_bad) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
      ASSERT_EQ(found[i], is_bad(pairs[i]) ? of_bad : left_of(pairs[i])) << i;
  }
  static void expect(ForeignProcesses& subject, Verdict of_bad) {
    EXPECT_GT(std::count_if(pairs.begin(), pairs.end(), is_bad), 50);
    expect(verdicts(subject), of_bad);
  }
  // Whether the build answers like kLess on the first pair.
  static bool is_less(const Built& built) {
    Code code{"library", built.file.string(), ""};
    code.content = built.content;
    ForeignProcesses subject(code, Scalar::f32);
    return verdicts(subject)[0] == left_of(pairs[0]);
  }
  static void open_one(const std::string& text) { open(parse_subject(text)); }
};

TEST_F(Subjects, WhatTheCodeItselfTakesIsKnown) {
  build("cc -O2",
        write("slow.c",
              "int slow(const float a[9], const float b[9]) { volatile int i = 20000; while (i > 0) --i; "
              "return a[0] < b[0]; }"),
        "libslow.so");
  const auto nanoseconds = [&](const char* library, const char* function) {
    ForeignProcesses subject({"library", (folder / library).string(), function, "f32"}, Scalar::f32);
    EXPECT_FALSE(subject.nanoseconds());
    verdicts(subject);
    return subject.nanoseconds();
  };
  const auto slow = nanoseconds("libslow.so", "slow");
  ASSERT_TRUE(slow);
  EXPECT_GT(*slow, 3000u * 2000);  // at least 2 µs per pair: 20,000 steps
  std::optional<std::uint64_t> quick;
  for (int tries = 0; tries < 50 && (!quick || 20 * *quick >= *slow); ++tries) {  // other processes may use the core
    quick = nanoseconds("libbad.so", "good");
    ASSERT_TRUE(quick);
  }
  EXPECT_GT(*quick, 0u);
  EXPECT_LT(20 * *quick, *slow);
  EXPECT_FALSE(nanoseconds("libbad.so", "aborts"));  // the code failed on some pairs
}

TEST_F(Subjects, WhatMisbehavesIsAVerdictOfThePairsOnWhichItDoes) {
  const struct {
    const char* name;
    Verdict verdict;
  } kCases[] = {{"declines", Verdict::declined}, {"aborts", Verdict::crashed},  {"exits", Verdict::crashed},
                {"scribbles", Verdict::crashed}, {"wavers", Verdict::unstable}, {"rounds", Verdict::unstable}};
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.name);
    ForeignProcesses subject({"library", (folder / "libbad.so").string(), c.name, "f32", 5}, Scalar::f32);
    expect(subject, c.verdict);
  }
}

TEST_F(Subjects, EndlessLoopsAndMemoryEnd) {
  const std::vector<Pair> all = pairs;
  pairs.assign(all.begin(), all.begin() + 600);
  ForeignProcesses hangs({"library", (folder / "libbad.so").string(), "hangs", "f32", 0.02}, Scalar::f32);
  expect(verdicts(hangs), Verdict::timed_out);
  pairs.assign(all.begin(), all.begin() + 60);
  ForeignProcesses eats({"library", (folder / "libbad.so").string(), "eats", "f32", 60, 64}, Scalar::f32);
  expect(verdicts(eats), Verdict::crashed);
  pairs = all;
}

// A process that is killed just before it answers must not leave its answer to another pair.
TEST_F(Subjects, TimesAtTheLimitAreVerdictsOrTooLate) {
  const std::vector<Pair> all = pairs;
  pairs.assign(all.begin(), all.begin() + 300);
  ForeignProcesses dawdles({"library", (folder / "libbad.so").string(), "dawdles", "f32", 0.002}, Scalar::f32);
  for (int round = 0; round < 3; ++round) {
    const std::vector<Verdict> found = verdicts(dawdles);
    for (std::size_t i = 0; i < pairs.size(); ++i)
      EXPECT_TRUE(found[i] == Verdict::timed_out || found[i] == left_of(pairs[i])) << i << name(found[i]);
  }
  pairs = all;
}

TEST_F(Subjects, DescriptionsAndBlocksAndExceptions) {
  const Description description = describe({"library", (folder / "libdescribed.so").string(), ""});
  EXPECT_TRUE(description.f32);
  EXPECT_FALSE(description.f64);
  EXPECT_EQ(description.outside, unsigned{kOutsideTouching | kOutsideCoplanar});
  EXPECT_EQ(description.version + description.source + description.convention, "1.2a testpage 3");
  ForeignProcesses throws({"library", (folder / "libdescribed.so").string(), ""}, Scalar::f32);
  expect(throws, Verdict::crashed);
  ForeignProcesses in_blocks({"library", (folder / "libdescribed.so").string(), "in_blocks"}, Scalar::f32);
  expect(in_blocks, Verdict::crashed);
  // This subject's answers depend on the position in a block. In the second pass, all pairs but the first three are at
  // other positions.
  ForeignProcesses by_place({"library", (folder / "libdescribed.so").string(), "by_place_in_block"}, Scalar::f32);
  const std::vector<Verdict> placed = verdicts(by_place);
  std::size_t wrong = 0, unstable = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    unstable += placed[i] == Verdict::unstable;
    wrong += placed[i] != Verdict::unstable && placed[i] != left_of(pairs[i]);
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(unstable, pairs.size() / 8);
  ForeignProcesses writes_some({"library", (folder / "libdescribed.so").string(), "writes_some_answers"}, Scalar::f32);
  expect(writes_some, Verdict::unstable);
#ifdef __x86_64__
  ForeignProcesses rounds({"library", (folder / "libdescribed.so").string(), "rounds_in_blocks"}, Scalar::f32);
  expect(rounds, Verdict::unstable);
#endif
}

TEST_F(Subjects, ManyThreadsAtOnce) {
  ForeignProcesses subject({"library", (folder / "libbad.so").string(), "aborts", "f32"}, Scalar::f32);
  std::vector<std::vector<Verdict>> found(4);
  std::vector<std::thread> threads;
  for (auto& of : found) threads.emplace_back([&] { of = verdicts(subject); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& of : found) EXPECT_EQ(of, found[0]);
}

TEST_F(Subjects, AProgramOfAnyLanguage) {
  write("program.py", R"(
import os, sys
for number, line in enumerate(sys.stdin, 1):
    x = [float.fromhex(word) for word in line.split()]
    assert len(x) == 18
    if x[0] > 0.9 and sys.argv[1] == "dies": os._exit(3)
    if number % 50 == 0 and sys.argv[1] == "ages": os._exit(3)
    if x[0] > 0.9 and sys.argv[1] == "babbles": print("well")
    elif x[0] > 0.9 and sys.argv[1] == "declines": print("?")
    else: print(int(x[0] < x[9]))
    sys.stdout.flush()
)");
  const std::vector<Pair> all = pairs;
  pairs.resize(300);
  const auto run = [](const std::string& how) {
    ForeignProcesses subject({"command", "python3 " + (folder / "program.py").string() + " " + how, "", "f32", 20},
                             Scalar::f32);
    return verdicts(subject);
  };
  for (const auto& [how, verdict] :
       {std::pair{"declines", Verdict::declined}, {"dies", Verdict::crashed}, {"babbles", Verdict::crashed}}) {
    SCOPED_TRACE(how);
    expect(run(how), verdict);
  }
  // No particular pair makes this program fail; it fails after some number of lines.
  const std::vector<Verdict> found = run("ages");
  std::size_t crashed = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    crashed += found[i] == Verdict::crashed;
    EXPECT_TRUE(found[i] == Verdict::crashed || found[i] == left_of(pairs[i])) << i;
  }
  EXPECT_GT(crashed, 0u);
  EXPECT_LT(crashed, 30u);
  pairs = all;
}

// A program may describe itself when Graze asks. A program that does not know the question runs without a description.
TEST_F(Subjects, AProgramMayDescribeItself) {
  const std::string answers = "; while read line; do echo 1; done";
  const auto open_program = [&](const std::string& name, const std::string& describes) {
    open_one(name + "=cmd:" + describes + answers);
    return find_lane(name + "/f32/cpu");
  };
  const Lane* lane = open_program("told",
                                  "read line; echo '{\"version\": \"1.2\", \"outside\": [\"touching\", \"shared\"], "
                                  "\"convention\": \"its manual\"}'");
  ASSERT_TRUE(lane);
  EXPECT_EQ(lane->outside, unsigned{kOutsideTouching | kOutsideShared});
  EXPECT_EQ(opened("told")->description.version, "1.2");
  EXPECT_NE(lane->info->paper.find("version 1.2"), std::string_view::npos) << lane->info->paper;
  for (const auto& [name, says] : {std::pair{"answers", "true"},
                                   {"silent", "exec cat > /dev/null"},
                                   {"ends", "exit 3"},
                                   {"kills", "read line; case $line in describe) kill -9 $PPID;; esac; echo 1"},
                                   {"babbles", "read line; echo '{'"},
                                   {"other", "read line; echo '[1]'"}}) {
    lane = open_program(name, says);
    ASSERT_TRUE(lane) << name;
    EXPECT_EQ(lane->outside, 0u) << name;
    EXPECT_EQ(opened(name)->description.version, "") << name;
  }
  EXPECT_NE(error_of([&] {
              open_program("odd", "read line; echo '{\"outside\": [\"nearly\"]}'");
            }).find("expected touching, coplanar, degenerate or shared in \"outside\", found 'nearly'"),
            std::string::npos);
  for (const char* other : {R"({"version": 12})", R"({"outside": "touching"})", R"({"outside": {"x": "touching"}})"})
    EXPECT_NE(error_of([&] { open_program("odd", fmt::format("read line; echo '{}'", other)); }).find("expected texts"),
              std::string::npos)
        << other;
  EXPECT_NE(error_of([&] { open_program("odd", "read line; printf '{\"version\": \"%09000d\"}\\n' 1"); }).find("8 KiB"),
            std::string::npos);
  lane = open_program("controls", R"(read line; echo '{"version": "1\u001b[2J\u0007"}')");
  ASSERT_TRUE(lane);
  EXPECT_EQ(opened("controls")->description.version, "1 [2J ");
  EXPECT_NE(error_of([&] {
              open_program("odd", R"(read line; echo '{"outsied": ["touching"]}')");
            }).find("in its description, found \"outsied\""),
            std::string::npos);
}

// Published algorithms that are opened as foreign sources give the same verdicts as their own lanes.
class OurOwn : public Subjects, public testing::WithParamInterface<int> {};

TEST_P(OurOwn, AsForeignCodeAreTheirLanes) {
  const std::vector<const AlgorithmInfo*> infos =
      std::apply([](auto... algorithm) { return std::vector<const AlgorithmInfo*>{&decltype(algorithm)::kInfo...}; },
                 Algorithms{});
  const std::string id(infos.at(static_cast<std::size_t>(GetParam()))->id), name = "own_" + id;
  const fs::path source = write(name + ".cpp", R"(
#define GRAZE_FP stranger
#include "core/algorithms/algorithms.h"
template <class Real>
int decide(const Real a[9], const Real b[9]) {
  graze::Pair pair;
  for (int i = 0; i < 9; ++i) {
    (&pair.a[0].x)[i] = static_cast<float>(a[i]);
    (&pair.b[0].x)[i] = static_cast<float>(b[i]);
  }
  using Algorithm = std::tuple_element_t<)" + std::to_string(GetParam()) +
                                                   R"(, graze::Algorithms>;
  const graze::Verdict verdict = graze::decide_widened<Algorithm, Real>(pair);
  return verdict == graze::Verdict::declined ? -1 : verdict == graze::Verdict::intersects;
}
)");
  Wanted wanted = parse_subject(name + "=" + source.string() + ":decide");
  wanted.flags = {"-I" GRAZE_SOURCE_DIR, "-O3"};
  wanted.timeout = 60;
  open(wanted);
  std::size_t compared = 0;
  for (const char* scalar : {"f32", "f64"}) {
    {  // only `cpu`, because for cpu-fma the compiler may fuse other products in another function
      const std::string lane = std::string("/") + scalar + "/cpu";
      const Lane *foreign = find_lane(name + lane), *ours = find_lane(id + lane);
      ASSERT_TRUE(ours);
      ASSERT_EQ(foreign != nullptr, runs_on_this_cpu(*ours));
      if (!foreign) continue;
      EXPECT_TRUE(foreign->foreign);
      const std::vector<Pair> before = pairs;
      for (const strata::StratumInfo& stratum : strata::kStrata) {
        pairs.clear();
        for (std::uint64_t i = 0; i < 2000; ++i) pairs.push_back(strata::generate(7, stratum.stratum, i));
        EXPECT_EQ(verdicts(foreign->decide), verdicts(ours->decide)) << stratum.id << lane;
        compared += pairs.size();
      }
      pairs = before;
    }
  }
  EXPECT_GE(compared, 2u * 2000 * std::size(strata::kStrata));
}
INSTANTIATE_TEST_SUITE_P(Subjects, OurOwn, testing::Range(0, kAlgorithmCount),
                         [](const auto& of) { return std::to_string(of.param); });

TEST_F(Subjects, SourcesInCAndCppFindTheirFunctionAndScalar) {
  write("both.cpp",
        "#include \"part.h\"\nnamespace geo { bool meets(const float a[9], const float b[9]) { return LESS(a, b); }\n"
        "bool meets(const double a[9], const double b[9]) { return LESS(a, b); } }");
  write("part.h", "#define LESS(a, b) (a)[0] < (b)[0]");
  open_one("both=" + (folder / "both.cpp").string() + ":geo::meets");
  open_one("header=" +
           write("header.hpp", "inline bool meets(const float a[9], const float b[9]) { return *a < *b; }").string() +
           ":meets");
  open_one("in_double=" + (folder / "bad.c").string() + ":in_double");
  open_one("by_name=" + (folder / "libbad.so").string() + ":in_double/f64");
  for (const char* id : {"both/f32/cpu", "both/f64/cpu", "both/f32/cpu-fast", "header/f32/cpu", "in_double/f64/cpu",
                         "by_name/f64/cpu"}) {
    const Lane* lane = find_lane(id);
    if (!lane && std::string(id).ends_with("fast")) continue;
    ASSERT_TRUE(lane) << id;
    const std::vector<Verdict> found = verdicts(lane->decide);
    for (std::size_t i = 0; i < pairs.size(); ++i) ASSERT_EQ(found[i], left_of(pairs[i])) << id;
  }
  // A function of doubles gets a pair's doubles, not their float32 values.
  ASSERT_TRUE(find_lane("in_double/f64/cpu")->decide.decides_doubles());
  EXPECT_FALSE(find_lane("both/f32/cpu")->decide.decides_doubles());
  std::vector<DoublePair> close;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    close.push_back(in_doubles(pairs[i]));
    close.back().b[0].x = close.back().a[0].x + (i % 3 == 0 ? 0x1p-40 : 0);
  }
  VerdictBits bits;
  decide(find_lane("in_double/f64/cpu")->decide, std::span<const DoublePair>(close), bits);
  for (std::size_t i = 0; i < close.size(); ++i) ASSERT_EQ(test_bit(bits.intersects, i), i % 3 == 0) << i;
  EXPECT_FALSE(find_lane("in_double/f32/cpu"));
  EXPECT_FALSE(find_lane("by_name/f32/cpu"));
  // A changed header makes a different build.
  write("part.h", "#define LESS(a, b) (a)[0] >= (b)[0]");
  open_one("changed=" + (folder / "both.cpp").string() + ":geo::meets");
  EXPECT_EQ(verdicts(find_lane("changed/f32/cpu")->decide)[0],
            left_of(pairs[0]) == Verdict::disjoint ? Verdict::intersects : Verdict::disjoint);
}

// Without a device, a CUDA source runs as its twin. Fusing a product into a sum changes verdicts.
TEST_F(Subjects, ACudaSourceIsReplayedByItsTwin) {
  const fs::path source = write("mine.cu", R"(
#include <math.h>
__device__ static float area(const float* t) { return t[0] * t[4] - t[1] * t[3]; }
__device__ bool intersects(const float a[9], const float b[9]) { return area(a) > area(b); }
)");
  try {
    open_one("gpu=" + source.string());
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find("cannot find NVRTC") == std::string::npos) throw;
    GTEST_SKIP() << error.what();
  }
  const Lane *rounded = find_lane("gpu/f32/cuda-nofma"), *fused = find_lane("gpu/f32/cuda-fma"),
             *fast = find_lane("gpu/f32/cuda-fast"), *flushed = find_lane("gpu/f32/cuda-ftz");
  ASSERT_TRUE(rounded && fused && fast && flushed);
  EXPECT_TRUE(rounded->evidence.starts_with("twin, ")) << rounded->evidence;
  const auto area = [](const Vec3<float>* t) { return t[0].x * t[1].y - t[0].y * t[1].x; };
  const std::vector<Verdict> found = verdicts(rounded->decide);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    ASSERT_EQ(found[i] == Verdict::intersects, area(pairs[i].a) > area(pairs[i].b)) << i;
  EXPECT_TRUE(cuda::contraction_sites(*rounded).empty());
  EXPECT_FALSE(cuda::contraction_sites(*fused).empty());
  // Triangles for which the two products of the area are nearly equal.
  const std::vector<Pair> before = pairs;
  pairs.clear();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Pair pair = before[i];
    pair.a[1] = {3 * pair.a[0].x, 3 * pair.a[0].y, 0};
    pair.b[0] = {0, 0, 0};
    pairs.push_back(pair);
  }
  const std::vector<Verdict> by_fma = verdicts(fused->decide), by_rounding = verdicts(rounded->decide);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::vector<std::uint64_t> none(1 + cuda::contraction_sites(*fused).size() / 64),
        all(none.size(), ~std::uint64_t{0});
    EXPECT_EQ(cuda::decide_fusing(*fused, pairs[i], none), by_rounding[i]);
    EXPECT_EQ(cuda::decide_fusing(*fused, pairs[i], all), by_fma[i]);
    differ += by_fma[i] != by_rounding[i];
  }
  EXPECT_GT(differ, 0u);
  pairs = before;

  // A record counts only for the exact build that it names.
  const std::vector<cuda::NamedBuild> builds = cuda_builds();
  const auto build =
      std::find_if(builds.begin(), builds.end(), [](const auto& b) { return b.lane == "gpu/f32/cuda-fma"; });
  ASSERT_NE(build, builds.end());
  nlohmann::ordered_json record{{"device", "a device"},
                                {"toolkit", "13.0"},
                                {"lanes",
                                 {{{"hash", build->build->hash},
                                   {"pairs", 0},
                                   {"twin_pairs", 100},
                                   {"differences", 0},
                                   {"twin_differences", 0}}}}};
  std::ofstream(proof_file(source)) << record;
  open_one("proven=" + source.string());
  EXPECT_EQ(find_lane("proven/f32/cuda-fma")->evidence,
            "twin, verified on a device, nvcc 13.0: GPU and twin agree on 100 pairs");
  EXPECT_EQ(find_lane("proven/f32/cuda-nofma")->evidence, rounded->evidence);
  record["lanes"][0]["twin_differences"] = 1;
  std::ofstream(proof_file(source)) << record;
  open_one("disproven=" + source.string());
  EXPECT_EQ(find_lane("disproven/f32/cuda-fma")->evidence, fused->evidence);
}

TEST_F(Subjects, WhatCannotBeHadGetsOneLine) {
  const std::string so = (folder / "libbad.so").string(), described = (folder / "libdescribed.so").string();
  write("broken.cpp", "bool intersects(const float a[9], const float b[9]) { return a[0] < ; }");
  write("other.cpp", "int intersects(int a) { return a; }");
  build("cc", write("loads.c", "__attribute__((constructor)) static void f(void) { __builtin_trap(); }"), "loads.so");
  const auto expect_error = [&](const std::string& text, const std::string& pattern) {
    const std::string error = error_of([&] { open_one(text); });
    EXPECT_TRUE(std::regex_search(error, std::regex(pattern))) << text << ": " << error;
    EXPECT_EQ(error.find('\n'), error.npos) << error;
  };
  expect_error("x", "expected NAME=WHAT .* found 'x'");
  expect_error("a/b=" + so, "expected NAME=WHAT");
  expect_error("x=", "expected NAME=WHAT");
  expect_error(std::string(101, 'x') + '=' + so, "expected NAME=WHAT");
  for (const char* name : {".", "..", "..."}) expect_error(std::string(name) + '=' + so, "expected NAME=WHAT");
  for (const char* function : {"good\n", "g\"", "};int z={0", "good;system(\"id\")", "\x1b[31m"})
    expect_error("x=" + so + ':' + function, "expected the name of a function, found ");
  expect_error("x=" + so + ':' + std::string(100'000, 'a'), "expected the name of a function, found ");
  expect_error("x=cmd: ", "expected FILE.so, FILE.cpp, FILE.h, FILE.c, FILE.cu, FILE.cl or cmd:COMMAND, found .*cmd:");
  expect_error("x=mine.txt",
               "expected FILE.so, FILE.cpp, FILE.h, FILE.c, FILE.cu, FILE.cl or cmd:COMMAND, found .*mine.txt");
  for (const char* name : {"a\"b.c", "a\nb.cpp", "a\\b.cu"})
    expect_error("x=" + write(name, "int intersects(const float*, const float*) { return 1; }").string(),
                 "no compiler reads a file named .*rename it");
  expect_error("x=nothere.so", "cannot read the code in .*nothere.so.: No such file");
  expect_error("x=" + std::string(100'000, 'y') + ".so", "cannot read the code in .*: File name too long");
  expect_error("x=" + std::string(100'000, ':'), "expected FILE.so");
  expect_error("exact=" + so + ":good", "published algorithm .*exact");
  expect_error("x=" + so, "libbad.so: expected a function named intersects, or a description .* found only .*good");
  expect_error("x=" + so + ":nothing", "function or description named nothing, .* found only");
  expect_error("x=" + so + ":good/f16", "expected FUNCTION/f32 or FUNCTION/f64");
  expect_error("x=" + described + ":of_another_time", "version 1 of graze/subject.h, found 99");
  expect_error("x=" + described + ":outside_what", "outside is 16");
  expect_error("x=" + described + ":empty", "libdescribed.so .*no function");
  expect_error("x=" + (folder / "broken.cpp").string(), "broken.cpp:1:[0-9]+: error: ");
  expect_error("x=" + (folder / "other.cpp").string(), "other.cpp: expected a function intersects of two triangles");
  expect_error("x=" + (folder / "loads.so").string(), "loads.so: crashed while it was loaded");
  for (const char* name : {"pipe.so", "pipe.c"}) {
    ASSERT_EQ(mkfifo((folder / name).c_str(), 0600), 0);
    expect_error("x=" + (folder / name).string() + ":f", "cannot read the code in .*: it is not a regular file");
  }
  std::ofstream(folder / "large.so").close();
  fs::resize_file(folder / "large.so", (std::uintmax_t{1} << 30) + 1);
  expect_error("x=" + (folder / "large.so").string(), "cannot read the code in .*: it is larger than 1024 MiB");
  stop_requested = true;
  EXPECT_THROW(open_one("x=" + so + ":good"), Stopped);
  stop_requested = false;
  EXPECT_FALSE(opened("x"));
  for (const Lane& lane : lanes()) EXPECT_NE(lane.info->id, "x");
}

TEST_F(Subjects, ACampaignsRecordOpensThemAgainUnlessTheyChanged) {
  const fs::path source = write("recorded.c", kLess);
  open_one("recorded=" + source.string());
  EXPECT_TRUE(record({"moller_1997/f32/cpu", "recorded2/f32/cpu"}).is_null());
  nlohmann::ordered_json spec{{"subjects", record({"moller_1997/f32/cpu", "recorded/f32/cpu"})}};
  ASSERT_EQ(spec["subjects"].size(), 1u);
  open_recorded(spec);                      // the subject is already open
  open_one("recorded=" + source.string());  // the same subject again
  spec["subjects"][0]["name"] = "again";
  open_recorded(spec);
  EXPECT_TRUE(find_lane("again/f32/cpu"));
  spec["subjects"][0]["name"] = "third";
  write("recorded.c", "int intersects(const float a[9], const float b[9]) { return a[0] > b[0]; }");
  EXPECT_NE(error_of([&] { open_recorded(spec); }).find("recorded.c has changed"), std::string::npos);
  EXPECT_TRUE(
      names(error_of([&] { open_one("recorded=" + source.string()); }), {"--subject recorded", "another subject"}));
}

TEST_F(Subjects, CodeIsKnownByWhatIsCompiledOrRun) {
  const fs::path header = write("part.h", "#define LESS <\n"),
                 script = write("answers.sh", "while read line; do echo 1; done\n");
  const fs::path source = write(
      "whole.c", "#include \"part.h\"\nint intersects(const float a[9], const float b[9]) { return a[0] LESS b[0]; }");
  for (const auto& [name, what, lane, part, other] :
       {std::tuple(std::string("includes"), source.string(), "includes/f32/cpu", header, "#define LESS >\n"),
        std::tuple(std::string("script"), "cmd:sh '" + script.string() + "'", "script/f32/cpu", script,
                   "while read line; do echo 0; done\n"),
        std::tuple(std::string("says"), "cmd:sh " + script.string() + " ", "says/f32/cpu", script,
                   "echo '{\"version\": \"2\"}'; while read line; do echo 0; done\n")}) {
    open_one(name + "=" + what);
    nlohmann::ordered_json spec{{"subjects", record({lane})}};
    ASSERT_EQ(spec["subjects"].size(), 1u);
    EXPECT_EQ(spec["subjects"][0].contains("not_covered"), name != "includes");
    EXPECT_TRUE(open_recorded(spec).empty());
    spec["subjects"][0]["name"] = name + "_again";
    EXPECT_TRUE(open_recorded(spec).empty());
    std::ofstream(part) << other;
    spec["subjects"][0]["name"] = name + "_changed";
    const std::string error = error_of([&] { open_recorded(spec); });
    EXPECT_TRUE(names(error, {"changed", spec["subjects"][0]["hash"].get<std::string>()}));
    EXPECT_FALSE(opened(name + "_changed"));
    open_one(name + "_changed=" + what);  // as a user may request
    EXPECT_EQ(open_recorded(spec).size(), 1u);
  }
}

// A cached build may be used only if it was made from the same files.
TEST_F(Subjects, WhatIsBuiltInBesideTheSourceIsKnownOrBuiltAnew) {
  const fs::path object = folder / "helper.o", data = folder / "some $data.bin";
  const auto build = [&](bool less) {
    write("helper.c", std::string("int helper(float a, float b) { return ") + (less ? "a < b" : "a >= b") + "; }");
    ASSERT_EQ(std::system(("cd " + folder.string() +
                           " && cc -c -fPIC helper.c -o helper.o && rm -f libhelper.a && ar rc libhelper.a helper.o")
                              .c_str()),
              0);
    std::ofstream(data) << (less ? 'l' : 'g');
    fs::remove(folder / "as");
    write("as", std::string("#!/bin/sh\nexec /usr/bin/as --defsym LESS=") + (less ? '1' : '0') + " \"$@\"\n");
    fs::permissions(folder / "as", fs::perms::owner_all);
  };
  const fs::path specs = write("specs", "*lib:\n+ " + (folder / "libhelper.a").string() + "\n"),
                 script = write("script.o", "INPUT(" + object.string() + ")");
  const fs::path assembles = write("assembles.c", R"(int intersects(const float a[9], const float b[9]) {
  int less;
  __asm__("movl $LESS, %0" : "=r"(less));
  return less ? a[0] < b[0] : a[0] >= b[0];
}
)");
  const fs::path calls = write("calls.c", R"(int helper(float, float);
int intersects(const float a[9], const float b[9]) { return helper(a[0], b[0]); }
)");
  const std::string reading[] = {R"(".data\ndata: .incbin \"")", R"(".data\ndata: ." "inc" "bin \"")",
                                 R"(".data\ndata: \x2einc\142in \"")"};
  const auto reads = [&](std::size_t spelling) {
    return write(
        "reads" + std::to_string(spelling) + ".c",
        "#define DATA \"" + data.string() + "\"\n__asm__(" + reading[spelling] + R"( DATA "\"\n.hidden data\n.text\n");
extern const char data[] __attribute__((visibility("hidden")));
int intersects(const float a[9], const float b[9]) { return data[0] == 'l' ? a[0] < b[0] : a[0] >= b[0]; }
)");
  };
  const bool lists = std::system(("cc -x assembler -c /dev/null -o " + (folder / "none.o").string() + " -Wa,--MD," +
                                  (folder / "none.d").string() + " 2> /dev/null")
                                     .c_str()) == 0;
  struct Case {
    std::string name;
    fs::path source;
    std::vector<std::string> flags;
    bool covered;
  };
  std::vector<Case> cases{Case{"object", calls, {object.string()}, true},
                          Case{"for_linker", calls, {"-Wl," + object.string()}, false},
                          Case{"by_name", calls, {"-L" + folder.string(), "-Wl,-u,helper", "-lhelper"}, false},
                          Case{"specs", calls, {"-specs=" + specs.string()}, false},
                          Case{"script", calls, {script.string()}, false},
                          Case{"tools", assembles, {"-B" + folder.string()}, false},
                          Case{"incbin", reads(0), {}, lists},
                          Case{"incbin_when_linked", reads(0), {"-flto"}, false}};
  if (lists) {  // without a list from the assembler, Graze finds only the plain spelling
    cases.push_back({"incbin_in_parts", reads(1), {}, true});
    cases.push_back({"incbin_in_numbers", reads(2), {}, true});
  }
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    nlohmann::ordered_json rows[2];
    for (const bool less : {true, false}) {
      build(less);
      const std::string name = c.name + (less ? "_less" : "_not_less");
      Wanted wanted = parse_subject(name + "=" + c.source.string());
      wanted.flags = c.flags;
      open(wanted);
      const std::vector<Verdict> found = verdicts(find_lane(name + "/f32/cpu")->decide);
      for (std::size_t i = 0; i < pairs.size(); ++i) ASSERT_EQ(found[i] == left_of(pairs[i]), less) << i;
      rows[less] = record({name + "/f32/cpu"}).at(0);
      EXPECT_EQ(rows[less].contains("not_covered"), !c.covered);
    }
    if (c.covered) {
      EXPECT_NE(rows[0]["hash"], rows[1]["hash"]);
    }
  }
}

TEST_F(Subjects, ACommandThatMakesNoObjectIsNamedWithItsFlags) {
  const fs::path source = write("quiet.c", kLess);
  const Recipe recipe = recipe_of(kVariants[0], source), does_nothing{"true", "-O2", ""};
  for (const std::string& error :
       {error_of([&] { build_source(source, "intersects", recipe, {"--version"}); }),
        error_of([&] { assembly_of(source, "intersects", recipe, {"--version"}); }),
        error_of([&] { build_source(source, "intersects", does_nothing, {"--version"}); })}) {
    EXPECT_TRUE(names(error, {"quiet.c", "made no object file", "-O2", "--version"})) << error;
    EXPECT_EQ(error.find("unfinished"), std::string::npos) << error;
  }
}

// This compiler also acts as an editor: it runs the script `edits` while it compiles.
TEST_F(Subjects, CodeThatChangesWhileItIsBuiltIsBuiltAgain) {
  const fs::path source = write("edited.c",
                                "#include \"edited.h\"\nint intersects(const float a[9], const float b[9]) "
                                "{ return a[0] LESS b[0]; }"),
                 header = write("edited.h", "#define LESS <\n"), edits = folder / "edits",
                 compiler = write("editing_cc", "#!/bin/sh\ncd " + folder.string() +
                                                    "\ncase \" $* \" in *' -E '*) ;; *whole.c*) [ ! -e edits ] || "
                                                    ". ./edits ;; esac\nexec cc \"$@\"\n");
  fs::permissions(compiler, fs::perms::owner_all);
  setenv("CC", compiler.c_str(), 1);
  const auto build = [&] { return build_source(source, "intersects", recipe_of(kVariants[0], source), {}); };
  write("edits", "rm edits; echo '#define LESS >=' > edited.h");
  const Built edited = build();
  EXPECT_FALSE(is_less(edited));
  EXPECT_EQ(build().file, edited.file);
  EXPECT_FALSE(is_less(build()));
  // The object built from the new code must not be cached under the old code's name.
  write("edited.h", "#define LESS <\n");
  write("edits",
        "rm edits; mv edited.h old.h; echo '#define LESS >=' > edited.h; cc \"$@\"; status=$?; "
        "cp old.h new.h; mv new.h edited.h; exit $status");  // the change is undone before the next reading
  const Built undone = build();
  EXPECT_FALSE(fs::exists(edits));
  EXPECT_NE(undone.file, edited.file);
  EXPECT_TRUE(is_less(undone));
  write("edited.h", "#define LESS <=\n");
  write("edits", "echo >> edited.h");
  const std::string error = error_of(build);
  EXPECT_TRUE(names(error, {"cannot compile", "edited.c", "--flags", "changed during each of 4 builds"})) << error;
  fs::remove(edits);
  // The time of the build does not count as a change to the code.
  write("edited.h", "#define LESS < 0 * sizeof __TIME__ __DATE__ +\n");
  write("edits", "sleep 1.1");
  EXPECT_TRUE(is_less(build()));
  fs::remove(edits);
  unsetenv("CC");
}

// The assembler searches folders in order, so a new file in an earlier folder changes the code.
TEST_F(Subjects, AFileThatTheAssemblerNowFindsEarlierIsBuiltIn) {
  const fs::path source = write("searched.c", R"(
__asm__(".section .rodata\n.global blob\nblob: .incbin \"searched.bin\"\n.previous");
extern const char blob[];
int intersects(const float a[9], const float b[9]) { return blob[0] == 'l' ? a[0] < b[0] : a[0] >= b[0]; }
)");
  const fs::path first = folder / "first", second = folder / "second";
  for (const fs::path& searched : {first, second}) fs::create_directories(searched);
  const auto build = [&] {
    return build_source(source, "intersects", recipe_of(kVariants[0], source),
                        {"-I" + first.string(), "-I" + second.string()});
  };
  std::ofstream(second / "searched.bin") << 'l';
  const Built before = build();
  EXPECT_TRUE(is_less(before));
  EXPECT_EQ(build().file, before.file);
  std::ofstream(first / "searched.bin") << 'g';
  const Built after = build();
  EXPECT_FALSE(is_less(after));
  EXPECT_TRUE(!after.not_covered.empty() || after.file != before.file);
  fs::remove(first / "searched.bin");
  EXPECT_TRUE(is_less(build()));
}

// The same version of a compiler may use another assembler or linker from the PATH, and the compiler may be a script.
TEST_F(Subjects, TheCompilersPartsAndScriptsAreInTheHash) {
  const fs::path source = write("by_parts.c", kLess);
  const auto hash = [&] {
    return build_source(source, "intersects", recipe_of(kVariants[0], source), {}).file.string();
  };
  const std::string plain = hash();
  EXPECT_EQ(hash(), plain);
  const auto tool = [&](const char* name, const std::string& text) {
    const fs::path file = write(name, "#!/bin/sh\n" + text + " \"$@\"\n");
    fs::permissions(file, fs::perms::owner_all);
    return file;
  };
  const std::string path = std::getenv("PATH");
  std::set<std::string> hashes{plain};
  for (const char* part : {"as", "ld"}) {
    const fs::path file = tool(part, std::string("exec /usr/bin/") + part);
    setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
    EXPECT_TRUE(hashes.insert(hash()).second) << part;
    setenv("PATH", path.c_str(), 1);
    fs::remove(file);
  }
  setenv("CC", tool("my_cc", "exec cc").c_str(), 1);
  EXPECT_TRUE(hashes.insert(hash()).second);
  tool("my_cc", "exec cc -funsigned-char");
  EXPECT_TRUE(hashes.insert(hash()).second);
  tool("my_cc", "sleep 100000 &\nexec cc");  // Graze does not wait for the sleeping process
  EXPECT_TRUE(hashes.insert(hash()).second);
  unsetenv("CC");
  EXPECT_EQ(hash(), plain);
}

TEST_F(Subjects, FlagsThatMayBringInAnythingAreNotCovered) {
  const auto not_covered = [](const std::vector<std::string>& flags) { return hash_of_flags(flags, 0).not_covered; };
  EXPECT_EQ(not_covered({"-O3", "-Iinclude", "-I", "include", "-DX=/a/b", "-isystem", "include", "-include", "a.h",
                         "-march=native", "-Wall", "-Wno-error=unused", "-std=c++23", "-g", "-fopenmp", "-pthread"}),
            "");
  for (const char* flag : {"-specs=x", "-Bdir", "-B", "dir", "no-such.o", "-L.", "-T", "-fplugin=x.so", "-Xassembler",
                           "-Wa,-Iinclude", "--sysroot=/x", "-include-pch", "-fprofile-use"})
    EXPECT_NE(not_covered({"-O2", flag}), "") << flag;
  EXPECT_EQ(not_covered({"-lm", "-B/x", "-Wl,-s"}), "the libraries that its flags link, what -B/x brings in");
  for (const auto& [how, covered] :
       {std::pair("rc", true), std::pair("rcT", false)}) {  // a thin archive contains only file names
    const fs::path archive = folder / (std::string("lib") + how + ".a");
    ASSERT_EQ(std::system(fmt::format("cd {} && echo 'int x;' > x.c && cc -c x.c && ar {} {} x.o", folder.string(), how,
                                      archive.string())
                              .c_str()),
              0);
    EXPECT_EQ(not_covered({archive}).empty(), covered) << how;
  }
  // The hash covers flags in the compiler's name, and environment variables that name the compiler's parts.
  const fs::path source = write("by_flags.c", kLess);
  const auto build = [&] { return build_source(source, "intersects", recipe_of(kVariants[0], source), {}); };
  const Built plain = build();
  EXPECT_EQ(plain.not_covered, "");
  setenv("CC", "cc -DX=1 -O0", 1);
  EXPECT_NE(build().file, plain.file);
  setenv("CC", "cc", 1);
  EXPECT_EQ(build().file, plain.file);
  unsetenv("CC");
  setenv("COMPILER_PATH", folder.c_str(), 1);
  EXPECT_EQ(build().not_covered, "what COMPILER_PATH=" + folder.string() + " brings in");
  unsetenv("COMPILER_PATH");
}

TEST_F(Subjects, AKeptObjectThatIsNotAsItWasBuiltIsBuiltAgain) {
  const fs::path source = write("keeps.c", kLess),
                 other = write("keeps_other.c",
                               "int intersects(const float a[9], const float b[9]) { return a[0] >= b[0]; }");
  const auto build = [](const fs::path& from) {
    return build_source(from, "intersects", recipe_of(kVariants[0], from), {}).file;
  };
  const fs::path kept = build(source), kept_other = build(other);
  const auto changed = fs::last_write_time(kept);
  ASSERT_EQ(build(source), kept);
  EXPECT_EQ(fs::last_write_time(kept), changed);
  const auto size = fs::file_size(kept);
  for (const std::function<void()>& damage : std::vector<std::function<void()>>{
           [&] { fs::copy_file(kept_other, kept, fs::copy_options::overwrite_existing); },
           [&] { fs::copy_file(folder / "libbad.so", kept, fs::copy_options::overwrite_existing); },
           [&] { fs::resize_file(kept, size / 2); }, [&] { fs::resize_file(kept, 0); },
           [&] { std::fstream(kept, std::ios::in | std::ios::out).seekp(100) << 'x'; }}) {
    damage();
    ASSERT_EQ(build(source), kept);
    EXPECT_EQ(fs::file_size(kept), size);
    ForeignProcesses subject({"library", kept.string(), ""}, Scalar::f32);
    const std::vector<Verdict> said = verdicts_of(subject, pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) ASSERT_EQ(said[i], left_of(pairs[i])) << i;
  }
  fs::remove(kept);
  fs::create_directories(kept / "inner");
  EXPECT_EQ(error_of([&] { build(source); }), "cannot write " + kept.string() + ": a folder is in the way; remove it");
  EXPECT_TRUE(fs::exists(kept / "inner"));
}

// Graze knows a command's code only if the command is a single program, or a program with a file as its first argument.
TEST_F(Subjects, ACommandWhoseCodeIsNotPlainIsNotCovered) {
  const fs::path plain = write("plain.py", "pass"), program = write("plain", "pass");
  const std::string own = program.string();
  for (const std::string command :
       {"python3 $PWD/s.py", "python3 s.p?", "python3 *.py", "python3 ~+/s.py", "python3 $(cat list)",
        "python3 `cat list`", "python3 [s].py", "python3 {s,}.py", "cd sub && python3 m.py", "cd sub; exec ./m.py",
        "cat | python3 m.py", "PATH=sub mtool", "eval python3 m.py", "no-such-program m.py", "(python3 m.py)", ""})
    EXPECT_TRUE(hash_of_command(command).not_covered.ends_with("because only the shell knows its files")) << command;
  for (const std::string& command :
       std::vector<std::string>{"env -C sub python3 m.py", "python3 -m m", "python3 -um.py", "python3 m.py",
                                "python3 " + folder.string(), "X=1 python3 -m m", own + " --fast"}) {
    const std::string expected = "the code that it runs (except '" +
                                 std::string(command.starts_with("env") ? "env"
                                             : command.starts_with(own) ? own
                                                                        : "python3") +
                                 "' itself)";
    EXPECT_TRUE(hash_of_command(command).not_covered.starts_with(expected)) << command;
  }
  for (const std::string& command : std::vector<std::string>{
           "python3 " + plain.string(), "exec python3 '" + plain.string() + "' more", own, "X=1 " + own, "python3"})
    EXPECT_EQ(hash_of_command(command).not_covered, "what its files load") << command;
  const fs::path script = write("named.py", "one");
  const std::string command = "python3 " + script.string() + " $ARGUMENT";
  const std::uint64_t one = hash_of_command(command).hash;
  write("named.py", "two");
  EXPECT_NE(hash_of_command(command).hash, one);
}

TEST_F(Subjects, AProgramThatThePathFindsEarlierMeanwhileIsRefused) {
  const fs::path first = folder / "earlier", second = folder / "later";
  const auto program = [](const fs::path& within, const char* answer) {
    fs::create_directories(within);
    std::ofstream(within / "found") << "#!/bin/sh\nwhile read line; do echo " << answer << "; done\n";
    fs::permissions(within / "found", fs::perms::owner_all);
  };
  fs::create_directories(first);
  program(second, "1");
  const std::string path = std::getenv("PATH");
  setenv("PATH", (first.string() + ':' + second.string() + ':' + path).c_str(), 1);
  Wanted wanted = parse_subject("found=cmd:found");
  wanted.timeout = 20;
  open(wanted);
  const DecideBlock& decide = find_lane("found/f32/cpu")->decide;
  std::uint64_t yes = 0, none = 0;
  const auto ask = [&] { decide(pairs.data(), 1, &yes, &none); };
  ask();
  EXPECT_EQ(yes, 1u);
  program(first, "0");
  const std::string error = error_of(ask);
  EXPECT_TRUE(names(
      error, {"PATH now finds", (first / "found").string(), (second / "found").string(), "not recorded", "--out"}))
      << error;
  fs::remove(first / "found");
  ask();
  EXPECT_EQ(yes, 1u);
  setenv("PATH", path.c_str(), 1);
}

// The hash covers the description, because otherwise shards of two versions of a library would merge.
TEST_F(Subjects, TheHashOfALibraryIsOfWhatItSaysOfItselfToo) {
  const fs::path code = write("versions.cpp", std::string(R"(
#include <graze/subject.h>
#include <stdlib.h>
static int decide(const float a[9], const float b[9]) { return a[0] < b[0]; }
GRAZE_SUBJECT(graze_subject) = {GRAZE_SUBJECT_ABI, 0, getenv("VERSION_OF_TEST"), nullptr, nullptr, decide, nullptr, nullptr, nullptr};
)"));
  const fs::path library = build("c++ -std=c++20", code, "libversions.so");
  const auto hash = [&](const std::string& name, const char* version) {
    setenv("VERSION_OF_TEST", version, 1);
    open(parse_subject(name + '=' + library.string()));
    unsetenv("VERSION_OF_TEST");
    EXPECT_EQ(opened(name)->description.version, version);
    return opened(name)->code.hash;
  };
  const std::uint64_t one = hash("version_one", "1");
  EXPECT_EQ(hash("version_one_too", "1"), one);
  EXPECT_NE(hash("version_two", "2"), one);
}

TEST_F(Subjects, TheHashOfACommandIsOfItsProgramAndFiles) {
  const fs::path file = write("with space.txt", "one");
  const auto hash = [&](const std::string& command) { return hash_of_command(command).hash; };
  const std::string quoted = "sh -c 'x' \"" + file.string() + "\"",
                    escaped = "sh " + (folder / "with\\ space.txt").string();
  const std::uint64_t before = hash(quoted), of_escaped = hash(escaped);
  EXPECT_NE(hash("sh a"), hash("sh b"));
  write("with space.txt", "two");
  EXPECT_NE(hash(quoted), before);
  EXPECT_NE(hash(escaped), of_escaped);
  write("with space.txt", "one");
  EXPECT_EQ(hash(quoted), before);
  const std::string script = write("s.py", "one").string();
  for (const std::string& within : {"sh -c \"exec python3 " + script + "\"", "env SCRIPT=" + script + " sh -c x"}) {
    const std::uint64_t of_one = hash(within);
    write("s.py", "two");
    EXPECT_NE(hash(within), of_one) << within;
    write("s.py", "one");
    EXPECT_EQ(hash(within), of_one) << within;
  }
  const std::string log = write("log.txt", "one").string();
  for (const std::string& to : {"2> " + log, "2>" + log, ">>'" + log + "'", "2>&1 >" + log}) {
    const std::uint64_t of_one = hash("sh " + script + ' ' + to);
    write("log.txt", "two");
    EXPECT_EQ(hash("sh " + script + ' ' + to), of_one) << to;
    write("log.txt", "one");
  }
  for (const std::string& reads : {"sh " + script + " 2>&1 | cat " + log, "sh " + script + " 3<>" + log}) {
    const std::uint64_t of_one = hash(reads);
    write("log.txt", "two");
    EXPECT_NE(hash(reads), of_one) << reads;
    write("log.txt", "one");
  }
  const std::string path = std::getenv("PATH");
  fs::create_directories(folder / "skipped");
  write("skipped/program", "a shell skips a file that nobody may execute");
  for (const std::string& searched :
       {folder.string() + ':', (folder / "skipped").string() + ':' + folder.string() + ':'}) {
    fs::permissions(write("program", "one"), fs::perms::owner_all);
    setenv("PATH", (searched + path).c_str(), 1);
    const std::uint64_t one = hash("X=1 program");
    write("program", "two");
    EXPECT_NE(hash("X=1 program"), one) << searched;
  }
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace graze::subjects
