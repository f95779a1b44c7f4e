// SPDX-License-Identifier: Apache-2.0
// Runs foreign code that attacks the processes around it. Each attack must affect only the verdict on its own pair.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "core/lanes/verdicts.h"
#include "core/message_testing.h"
#include "core/programs/child.h"
#include "core/programs/process_state.h"
#include "core/programs/run_program.h"
#include "core/stop.h"
#include "strata/strata.h"
#include "subjects/containment.h"
#include "subjects/line_protocol.h"
#include "subjects/process.h"
#include "subjects/source_build.h"
#include "subjects/usage.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::size_t count_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

struct Hostile : testing::Test {
  static inline fs::path folder, before;
  static inline std::string mark;  // set in the environment of all processes that this one starts
  static inline pid_t bystander = -1;
  static inline int terminal = -1;
  static inline std::vector<Pair> pairs;

  static void SetUpTestSuite() {
    folder = fs::path(testing::TempDir()) / ("hostile-" + std::to_string(getpid()));
    fs::create_directories(folder);
    mark = "GRAZE_HOSTILE_TEST=" + std::to_string(getpid());
    setenv("GRAZE_HOSTILE_TEST", std::to_string(getpid()).c_str(), 1);
    fs::create_directories(folder / "home/cache/graze");
    before = fs::current_path();
    fs::current_path(folder / "home");
    setenv("XDG_CACHE_HOME", (folder / "home/cache").c_str(), 1);
    for (std::uint64_t i = 0; i < 40; ++i) pairs.push_back(strata::generate(1, strata::Stratum::uniform, i));
    build("libhostile.so", GRAZE_SOURCE_DIR "/subjects/hostile.c -lpthread");
    terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (terminal >= 0 && (grantpt(terminal) != 0 || unlockpt(terminal) != 0)) terminal = -1;
    bystander = fork();
    if (bystander == 0) execlp("sleep", "sleep", "1000", nullptr);
  }
  static void TearDownTestSuite() {
    for (const char* name : {"GRAZE_HOSTILE_TEST", "XDG_CACHE_HOME"}) unsetenv(name);  // not for later suites
    kill(bystander, SIGKILL);
    waitpid(bystander, nullptr, 0);
    if (terminal >= 0) close(terminal);
    fs::current_path(before);
    fs::remove_all(folder);
  }

  static fs::path build(const std::string& library, const std::string& what) {
    const fs::path file = folder / library;
    EXPECT_EQ(std::system(("cc -O1 -w -shared -fPIC " + what + " -o " + file.string()).c_str()), 0);
    return file;
  }
  static fs::path built_from(const std::string& name, const std::string& text) {
    std::ofstream(folder / (name + ".c")) << text;
    return build(name + ".so", (folder / (name + ".c")).string());
  }

  static bool is_bad(const Pair& pair) { return pair.a[0].x > 0.9f; }
  static Verdict left_of(const Pair& pair) {
    return pair.a[0].x < pair.b[0].x ? Verdict::intersects : Verdict::disjoint;
  }
  static std::vector<Verdict> verdicts(ForeignProcesses& subject) {
    std::vector<Verdict> result = verdicts_of(subject, pairs);
    for (Verdict& verdict : result) verdict = is_failure(verdict) ? Verdict::crashed : verdict;
    return result;  // crashed stands for every failure
  }

  // Expects this verdict on the bad pairs, and the answer of `good` on the others.
  static void expect(const std::vector<Verdict>& found, Verdict of_bad) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
      EXPECT_EQ(found[i], is_bad(pairs[i]) ? of_bad : left_of(pairs[i])) << i;
  }
  static void expect_left_of(const std::vector<Verdict>& found) {
    for (std::size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(found[i], left_of(pairs[i])) << i;
  }

  static Code attack(const char* name, bool namespaces, double timeout = 0.1) {
    Code code{"library", (folder / "libhostile.so").string(), name, "f32", timeout, 256};
    code.namespaces = namespaces;
    return code;
  }

  static std::jthread stop_after(unsigned microseconds) {
    return std::jthread([microseconds] {
      usleep(microseconds);
      stop_requested = true;
    });
  }

  // The processes that this test started and that still exist, except the bystander.
  static std::set<pid_t> left_over() {
    std::set<pid_t> found;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const auto process = static_cast<pid_t>(std::atoi(entry.path().filename().c_str()));
      if (process > 0 && process != bystander && text_of(entry.path() / "environ").find(mark) != std::string::npos)
        found.insert(process);
    }
    return found;
  }
  static void expect_nothing_left() {
    for (int times = 0; times < 6000 && !left_over().empty(); ++times) usleep(10'000);
    EXPECT_TRUE(left_over().empty()) << left_over().size() << " processes are left; the first one is "
                                     << *left_over().begin();
    EXPECT_EQ(waitpid(bystander, nullptr, WNOHANG), 0) << "an unrelated process was ended";
  }
};

// Whether this system allows process namespaces.
bool has_namespaces() {
  int answer[2];
  EXPECT_EQ(pipe2(answer, O_CLOEXEC), 0);
  const pid_t child = fork();
  if (child == 0) {
    close_range(3, static_cast<unsigned>(answer[1]) - 1, 0);
    enter_containment(true, 1 << 20, -1);
    const char inside = getpid() == 1;
    _exit(write(answer[1], &inside, 1) == 1 ? 0 : 1);
  }
  close(answer[1]);
  char inside = 0;
  EXPECT_EQ(read(answer[0], &inside, 1), 1);
  close(answer[0]);
  EXPECT_EQ(waitpid(child, nullptr, 0), child);
  return inside;
}

// Whether "/" is a mount point. If it is not, as in a chroot, the cache cannot be protected (subjects/README.md).
bool root_is_a_mount_point() {
  std::ifstream in("/proc/self/mountinfo");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    for (int i = 0; i < 5; ++i) words >> word;
    if (word == "/") return true;
  }
  return false;
}

struct Attack {
  const char* name;
  bool without_namespaces = true;  // whether to test without a process namespace too
  bool on_others = false;          // whether other pairs may fail too
};

std::ostream& operator<<(std::ostream& out, const Attack& attack) { return out << attack.name; }

class EveryAttack : public Hostile, public testing::WithParamInterface<std::tuple<Attack, bool>> {};

TEST_P(EveryAttack, IsAVerdictOfItsPairs) {
  const auto& [attack, namespaces] = GetParam();
  if (!attack.without_namespaces && !(namespaces && has_namespaces()))
    GTEST_SKIP() << "only a process namespace contains this attack";
  if (std::string_view(attack.name).starts_with("forks_a_bomb") && !namespaces && geteuid() == 0)
    GTEST_SKIP() << "without a process namespace, root has no task limit";
  if (attack.name == std::string_view("opens_terminals") && terminal < 0)
    GTEST_SKIP() << "this system gives no terminal";
  if (attack.name == std::string_view("writes_to_cache") && !root_is_a_mount_point())
    GTEST_SKIP() << "in a chroot, code can write to the cache";
  describe(Hostile::attack(attack.name, namespaces));  // from here on, Graze keeps its own programs open
  const std::size_t maps = count_in("/proc/self/map_files"), files = count_in("/proc/self/fd");
  {
    ForeignProcesses subject(Hostile::attack(attack.name, namespaces), Scalar::f32);
    for (int times = 0; times < 2; ++times) {
      const std::vector<Verdict> found = verdicts(subject);
      std::size_t bad = 0;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        bad += is_bad(pairs[i]);
        if (is_bad(pairs[i])) {
          EXPECT_EQ(found[i], Verdict::crashed) << i;
        } else if (!attack.on_others || found[i] != Verdict::crashed) {
          EXPECT_EQ(found[i], left_of(pairs[i])) << i;
        }
      }
      EXPECT_GT(bad, 1u);
    }
  }
  expect_nothing_left();
  EXPECT_TRUE(attack.without_namespaces || !fs::exists("/dev/shm/graze-hostile"));
  EXPECT_LE(count_in("/proc/self/map_files"), maps + 2);  // the allocator may keep two mappings
  EXPECT_EQ(count_in("/proc/self/fd"), files);
}

constexpr Attack kAttacks[] = {{"writes_zeros"},
                               {"writes_ones"},
                               {"unmaps"},
                               {"truncates"},
                               {"writes_pairs"},
                               {"scribbles_always", true, true},
                               {"babbles", true, true},
                               {"steals_questions", true, true},
                               {"says_it_is_ready"},
                               {"says_it_has_answered"},
                               {"kills_parent"},
                               {"stops_parent"},
                               {"kills_grandparent", false},
                               {"kills_group"},
                               {"stops_group"},
                               {"stops_itself"},
                               {"ends_itself_quietly"},
                               {"pretends_not_ready"},
                               {"traces_parent"},
                               {"becomes_another_program"},
                               {"closes_everything"},
                               {"leaves_children"},
                               {"forks_without_end"},
                               {"forks_a_bomb"},
                               {"forks_a_bomb_of_sessions"},
                               {"forks_a_bomb_in_a_chain"},
                               {"children_eat"},
                               {"waits_uninterruptibly"},
                               {"eats_shared"},
                               {"eats_system_v"},
                               {"makes_semaphores"},
                               {"makes_message_queues"},
                               {"eats_memfd"},
                               {"eats_dev_shm", false},
                               {"lifts_limits"},
                               {"writes_a_large_file"},
                               {"limits_others"},
                               {"opens_terminals", false},
                               {"opens_devices", false},
                               {"freezes_supervisor", false},
                               {"writes_to_cache", false},
                               {"stretches_waits"},
                               {"makes_namespaces"},
                               {"raises_task_limit", false},
                               {"calls_the_kernel"},
                               {"keeps_memory"},
                               {"keeps_mapping"},
                               {"eats_page_tables"},
                               {"children_fill_sockets"},
                               {"hides_descriptors"},
                               {"raises_buffers"},
                               {"kills_all", false}};
INSTANTIATE_TEST_SUITE_P(Subjects, EveryAttack, testing::Combine(testing::ValuesIn(kAttacks), testing::Bool()),
                         [](const auto& of) {
                           return std::string(std::get<0>(of.param).name) +
                                  (std::get<1>(of.param) ? "" : "_without_namespaces");
                         });

// Root has no task limit without a process namespace, so the test runs as another user.
TEST_F(Hostile, ABombOfAUserWithoutANamespaceEnds) {
  if (geteuid() != 0) GTEST_SKIP() << "for users other than root, EveryAttack tests these attacks";
  fs::permissions(folder, fs::perms::all);
  const fs::path program = fs::read_symlink("/proc/self/exe");  // this program runs others in the same folder
  for (const char* bomb : {"forks_a_bomb", "forks_a_bomb_of_sessions", "forks_a_bomb_in_a_chain"}) {
    SCOPED_TRACE(bomb);
    const pid_t asking = fork();
    if (asking == 0) {
      constexpr uid_t kNobody = 65534;
      if (setgid(kNobody) != 0 || setuid(kNobody) != 0) _exit(2);
      try {
        ForeignProcesses subject(attack(bomb, false), Scalar::f32);
        const std::vector<Verdict> found = verdicts(subject);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
          if (found[i] != (is_bad(pairs[i]) ? Verdict::crashed : left_of(pairs[i]))) _exit(3);
        }
      } catch (const std::exception&) {
        _exit(access(folder.c_str(), X_OK) == 0 && access(program.c_str(), X_OK) == 0 ? 4 : 2);
      }
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(asking, &status, 0), asking);
    expect_nothing_left();
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "another user cannot reach the programs or the test's files";
    EXPECT_EQ(WEXITSTATUS(status), 0);
  }
}

// The memory of a child that does `work` and then waits, counted up to `most` bytes.
std::uint64_t usage_after(const std::function<bool()>& work, std::uint64_t most = std::uint64_t{1} << 40) {
  const Child child([&](int ready) {
    if (work() && write(ready, "y", 1) == 1) pause();
  });
  char said = 0;
  EXPECT_EQ(read(child.pipe(), &said, 1), 1);
  return usage_of_descendants({64, most, ~0ull}).bytes;
}

TEST_F(Hostile, PageTablesAreMemory) {
  constexpr std::size_t kPages = 10'000, kStep = 2 << 20;
  const auto read_pages = [] {
    void* at = mmap(nullptr, kPages * kStep, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED) return false;
    madvise(at, kPages * kStep, MADV_NOHUGEPAGE);
    for (std::size_t i = 0; i < kPages; ++i) (void)static_cast<volatile char*>(at)[i * kStep];
    return true;
  };
  for (const std::uint64_t most :
       {std::uint64_t{1} << 40, std::uint64_t{1} << 20})  // counts files' pages fully; counts only shares of them
    EXPECT_GE(usage_after(read_pages, most), std::min<std::uint64_t>(kPages * 4096, most));
}

constexpr std::size_t kEaten = 64 << 20;

char* written(int flags) {
  void* at = mmap(nullptr, kEaten, PROT_READ | PROT_WRITE, flags | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) _exit(1);
  std::fill_n(static_cast<char*>(at), kEaten, '1');
  return static_cast<char*>(at);
}

// Forks a child that waits and ends together with its parent.
bool fork_idle() {
  const pid_t parent = getpid(), idle = fork();
  if (idle == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (getppid() == parent) pause();
    _exit(0);
  }
  return idle > 0;
}

TEST_F(Hostile, SharedMemoryThatNoPageTableShowsIsMemory) {
  EXPECT_GE(usage_after([] { return madvise(written(MAP_SHARED), kEaten, MADV_DONTNEED) == 0; }), kEaten);
  EXPECT_GE(usage_after([] {
              char* at = written(MAP_SHARED);
              return madvise(at, kEaten, MADV_DONTNEED) == 0 && fork_idle() && munmap(at, kEaten) == 0;
            }),
            kEaten);
  // Memory that several processes map counts once.
  EXPECT_LT(usage_after([] { return written(MAP_SHARED) && fork_idle() && fork_idle(); }), 2 * kEaten);
}

// Only root may ask how much of the shared memory is in use; see subjects/README.md.
TEST_F(Hostile, SharedMemoryOfWhichAPartIsMappedIsMemory) {
  if (geteuid() != 0 || !fs::exists("/proc/self/map_files")) GTEST_SKIP() << "only for root";
  const std::uint64_t bytes = usage_after([] { return munmap(written(MAP_SHARED) + 4096, kEaten - 4096) == 0; });
  EXPECT_GE(bytes, kEaten);
}

TEST_F(Hostile, MemoryOfAProcessWhoseFirstThreadHasEndedIsMemory) {
  const Child child([](int ready) {
    written(MAP_PRIVATE);
    std::thread([ready] {
      while (process_state(getpid()) != 'Z') usleep(1000);
      if (write(ready, "y", 1) == 1) pause();
      _exit(1);
    }).detach();
    syscall(SYS_exit, 0);  // ends only this thread
  });
  char said = 0;
  EXPECT_EQ(read(child.pipe(), &said, 1), 1);
  EXPECT_GE(usage_of_descendants({64, std::uint64_t{1} << 40, ~0ull}).bytes, kEaten);
}

TEST_F(Hostile, ChildrenThatAreLeftInSilenceEndWithTheSubject) {
  const auto children = 2 * static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), is_bad));
  ASSERT_GT(children, 0u);
  for (const bool namespaces : {true, false}) {
    auto subject = std::make_unique<ForeignProcesses>(attack("leaves_children_silently", namespaces, 1), Scalar::f32);
    expect_left_of(verdicts(*subject));
    // Apart from `children`, three processes remain: the supervisor, the process that loads the code, and the worker. A
    // child may still have to start.
    std::size_t left = 0;
    for (int times = 0; times < 6000 && (left = left_over().size()) < 3 + children; ++times) usleep(10'000);
    EXPECT_GE(left, 3 + children);
    subject.reset();
    expect_nothing_left();
  }
}

TEST_F(Hostile, ConstructorsThatAttackAreOneLine) {
  const struct {
    const char* name;
    const char* does;
  } kCases[] = {
      {"sends",
       "char b[10008]; memset(b, 7, sizeof b); for (int i = 0; i < 50; ++i) send(5, b, sizeof b, MSG_DONTWAIT); "
       "abort();"},
      {"lies", "char b[10008] = {0}; send(5, b, sizeof b, 0); abort();"},
      {"refuses",
       "char b[10008]; memset(b, 255, sizeof b); b[0] = 1; b[1] = b[2] = b[3] = 0; send(5, b, sizeof b, 0); pause();"},
      {"kills", "kill(getppid(), SIGKILL); abort();"},
      {"stops", "kill(getppid(), SIGSTOP); abort();"},
      {"forks", "if (fork() == 0) for (;;) pause(); abort();"},
      {"exits", "_exit(0);"}};
  for (const auto& c : kCases) {
    const fs::path file =
        built_from(c.name, std::string("#include <signal.h>\n#include <stdlib.h>\n#include <string.h>\n"
                                       "#include <sys/socket.h>\n#include <unistd.h>\n"
                                       "__attribute__((constructor)) static void f(void) { ") +
                               c.does +
                               " }\n"
                               "int intersects(const float a[9], const float b[9]) { return 0; }");
    for (const bool namespaces : {true, false}) {
      SCOPED_TRACE(c.name);
      Code code{"library", file.string(), ""};
      code.namespaces = namespaces;
      try {
        const Description description = describe(code);
        EXPECT_FALSE(description.f32 || description.f64);  // the code itself sent the message
      } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find(c.name), std::string::npos) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        EXPECT_TRUE(c.name != std::string_view("stops") || namespaces ||
                    std::string_view(error.what()).ends_with(": stopped its supervisor while it was loaded"))
            << error.what();
      }
    }
    expect_nothing_left();
  }
}

TEST_F(Hostile, CodeThatIsGoneAfterItWasReadIsLoadedAgain) {
  const fs::path file = built_from("removes",
                                   "#include <signal.h>\n#include <unistd.h>\n"
                                   "int intersects(const float a[9], const float b[9]) {\n"
                                   "  if (a[0] > 0.9f) { unlink(\"" +
                                       (folder / "removes.so").string() +
                                       "\"); kill(getppid(), SIGKILL); _exit(1); }\n  return a[0] < b[0]; }");
  ForeignProcesses subject({"library", file.string(), "intersects", "f32"}, Scalar::f32);
  for (int times = 0; times < 2; ++times) expect(verdicts(subject), Verdict::crashed);
  EXPECT_FALSE(fs::exists(file));
}

// Processes that start after the file was changed still run the code that was read, not the file's new content.
TEST_F(Hostile, CodeThatIsReplacedOrWrittenIntoIsTheCodeThatWasRead) {
  const auto text = [](const char* compare) {
    return std::string(
               "#include <stdlib.h>\nint intersects(const float a[9], const float b[9]) {\n"
               "  if (a[0] > 0.9f) abort();\n  return a[0] ") +
           compare + " b[0];\n}";
  };
  const fs::path other = built_from("replacing", text(">="));
  for (const bool in_place : {true, false}) {
    const fs::path file = built_from("replaced", text("<"));
    ForeignProcesses subject({"library", file.string(), "intersects", "f32"}, Scalar::f32);
    for (int times = 0; times < 2; ++times) {
      const std::unique_ptr<ForeignProcesses> later = subject.anew();
      expect(verdicts(times == 0 ? subject : *later), Verdict::crashed);
      if (in_place) {
        std::ofstream(file, std::ios::binary) << text_of(other);
      } else {
        fs::copy_file(other, folder / "replaced.new", fs::copy_options::overwrite_existing);
        fs::rename(folder / "replaced.new", file);
      }
    }
  }
}

// The code finds libraries in its own folder through $ORIGIN.
TEST_F(Hostile, LibrariesBesideTheCodeAreFound) {
  fs::create_directories(folder / "beside");
  std::ofstream(folder / "less.c") << "int less(float a, float b) { return a < b; }";
  std::ofstream(folder / "uses.c") << "int less(float, float);\n"
                                      "int intersects(const float a[9], const float b[9]) { return less(a[0], b[0]); }";
  build("beside/libless.so", (folder / "less.c").string());
  for (const std::string origin : {"$ORIGIN", "${ORIGIN}"}) {
    const fs::path file = build("uses.so", (folder / "uses.c").string() + " -L" + (folder / "beside").string() +
                                               " -lless -Wl,-rpath,'/none:" + origin + "/beside:/other'");
    ForeignProcesses subject({"library", file.string(), "intersects", "f32"}, Scalar::f32);
    expect_left_of(verdicts(subject));
  }
}

TEST_F(Hostile, AProgramWhoseFileChangesEndsTheRunWithItsName) {
  const fs::path script = folder / "changes.sh";
  const auto write = [&](const char* text) { std::ofstream(script) << text; };
  write("while read l; do echo 1; done\n");
  const std::string command = "exec sh " + script.string();
  const CodeHash hash = hash_of_command(command);
  Code code{"command", command, "", "f32", 5, 256};
  code.files = hash.files;
  ForeignProcesses subject(code, Scalar::f32);
  const std::vector<Verdict> all(pairs.size(), Verdict::intersects);
  EXPECT_EQ(verdicts(subject), all);
  write("while read l; do echo 1; done\n");  // the same content again
  EXPECT_EQ(verdicts(subject), all);
  write("while read l; do echo 0; done\n");
  const std::unique_ptr<ForeignProcesses> later = subject.anew();
  for (ForeignProcesses* of : {&subject, later.get()}) {
    const std::string error = error_of([&] { verdicts(*of); });
    EXPECT_NE(error.find(script.string()), std::string::npos) << error;
  }
  fs::remove(script);
  EXPECT_THROW(verdicts(subject), std::runtime_error);
  write("while read l; do echo 1; done\n");
  EXPECT_EQ(verdicts(subject), all);
}

TEST_F(Hostile, ProgramsThatFloodOrHangOrLeaveChildrenAreVerdicts) {
  for (const std::string program :
       {"yes", "cat /dev/zero", "sleep 1000 & read l; trap '' TERM; sleep 1000", "exec sleep 1000",
        "while read l; do echo 7; done", "exit 3", "setsid sleep 1000 & setsid sleep 1001; wait"}) {
    SCOPED_TRACE(program);
    for (const bool namespaces : {true, false}) {
      const std::vector<Pair> all = pairs;
      pairs.resize(2);
      Code code{"command", program, "", "f32", 0.05, 256};
      code.namespaces = namespaces;
      {
        ForeignProcesses subject(code, Scalar::f32);
        const std::vector<Verdict> found = verdicts(subject);
        EXPECT_EQ(found, std::vector<Verdict>(2, Verdict::crashed));
      }
      pairs = all;
      expect_nothing_left();
    }
  }
}

TEST_F(Hostile, DescriptionsOfProgramsAreBounded) {
  const auto said = [](const std::string& program) {
    Code code{"command", program, "", "f32", 20, 256};
    return describe(code).said;
  };
  EXPECT_EQ(said("read l; echo \"$l, you say\""), "describe, you say");
  EXPECT_EQ(said("cat /dev/zero"), kLongAnswer);
  EXPECT_EQ(said("head -c 9000 /dev/zero | tr '\\0' x; echo"), kLongAnswer);
  EXPECT_EQ(said("sleep 1000 & exec echo"), "");
  EXPECT_EQ(said("python3 -c 'x = bytearray(10**9)'"), "");
  expect_nothing_left();
}

// The stop is requested while the subject hangs. Without the request, each pair would take an hour.
TEST_F(Hostile, ARequestToStopEndsEveryWait) {
  const fs::path file = built_from("hangs", "int intersects(const float a[9], const float b[9]) { for (;;) ; }");
  for (const bool namespaces : {true, false}) {
    Code code{"library", file.string(), "intersects", "f32", 3600};
    code.namespaces = namespaces;
    ForeignProcesses subject(code, Scalar::f32);
    const std::jthread request = stop_after(200'000);
    EXPECT_THROW(verdicts(subject), Stopped);
    stop_requested = false;
    expect_nothing_left();
  }
  const fs::path slow =
      built_from("slow", "#include <unistd.h>\n__attribute__((constructor)) static void f(void) { for (;;) pause(); }");
  const std::jthread request = stop_after(200'000);
  EXPECT_THROW(describe({"library", slow.string(), ""}), Stopped);
  stop_requested = false;
  expect_nothing_left();
}

// A control group that can freeze processes; empty if this user has none.
fs::path freezing_group(const std::string& name) {
  for (const fs::path root : {"/sys/fs/cgroup/freezer", "/sys/fs/cgroup/unified", "/sys/fs/cgroup"}) {
    const fs::path group = root / ("graze-hostile-" + name);
    std::error_code none;
    if (!fs::create_directory(group, none)) continue;
    if (access((group / "freezer.state").c_str(), W_OK) == 0 || access((group / "cgroup.freeze").c_str(), W_OK) == 0)
      return group;
    fs::remove(group, none);
  }
  return {};
}

// Without a mount namespace, root can freeze the supervisor. A frozen supervisor sends nothing and cannot be killed.
TEST_F(Hostile, AFrozenSupervisorIsAVerdictAndIsLeft) {
  const fs::path group = freezing_group(std::to_string(getpid()));
  if (group.empty()) GTEST_SKIP() << "this user has no control groups";
  const std::vector<Pair> all = pairs;
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [](const Pair& pair) { return !is_bad(pair); }), pairs.end());
  ASSERT_FALSE(pairs.empty());
  pairs.resize(1);
  {
    ForeignProcesses subject(attack("freezes_supervisor", false), Scalar::f32);
    EXPECT_EQ(verdicts(subject), std::vector<Verdict>{Verdict::crashed});  // crashed stands for every failure
    EXPECT_EQ(subject.failure(pairs[0]), Verdict::timed_out);
    const std::jthread request = stop_after(500'000);
    EXPECT_THROW(verdicts(subject), Stopped);
    stop_requested = false;
  }
  pairs = all;
  EXPECT_FALSE(left_over().empty());
  // Thaws the processes repeatedly, because a thawed process may freeze them all again.
  for (int times = 0; times < 1000 && rmdir(group.c_str()) != 0; ++times) {
    const bool second = fs::exists(group / "cgroup.freeze");
    std::ofstream(group / (second ? "cgroup.freeze" : "freezer.state")) << (second ? "0" : "THAWED") << std::flush;
    usleep(10'000);
  }
  EXPECT_FALSE(fs::exists(group));
  expect_nothing_left();
}

// Foreign code can delay its supervisor, but not the guardian, which is outside the code's namespace.
TEST_F(Hostile, ASupervisorThatCannotEndIsEndedWithGraze) {
  if (!has_namespaces()) GTEST_SKIP() << "only a process namespace has a guardian";
  for (const bool program : {false, true}) {
    SCOPED_TRACE(program);
    std::optional<Child> asking;
    asking.emplace([&](int) {
      if (program) {
        const Scratch scratch(folder / "never");
        std::string said;
        run_program({{"sleep", "1000"}}, scratch.path(), said);
      }
      ForeignProcesses subject({"library", (folder / "libhostile.so").string(), "stops_itself", "f32", 3600},
                               Scalar::f32);
      verdicts(subject);
    });
    std::vector<pid_t> supervisors;  // each is process 1 of its namespace
    while (supervisors.empty()) {
      usleep(300'000);  // by then the supervisor waits
      for (const pid_t process : left_over()) {
        const std::string status = text_of("/proc/" + std::to_string(process) + "/status");
        const std::size_t numbers = status.find("NSpid:");
        const std::string line = status.substr(numbers, status.find('\n', numbers) - numbers);
        if (numbers != std::string::npos && line.ends_with("\t1")) supervisors.push_back(process);
      }
    }
    for (const pid_t supervisor : supervisors) EXPECT_EQ(kill(supervisor, SIGSTOP), 0);
    asking.reset();  // kills it
    expect_nothing_left();
  }
}

// If a header is a pipe, the compiler waits for ever. If included data is a pipe, the assembler waits for ever.
TEST_F(Hostile, WhatBuildsASubjectEndsWithARequestToStopAndWithGraze) {
  for (const char* name : {"pipe.h", "pipe.bin"}) ASSERT_EQ(mkfifo((folder / name).c_str(), 0600), 0);
  std::ofstream(folder / "header.c") << "#include \"pipe.h\"\nint intersects(const float*, const float*);";
  std::ofstream(folder / "data.c") << "__asm__(\".incbin \\\"" + (folder / "pipe.bin").string() +
                                          "\\\"\");\nint intersects(const float* a, const float* b) { return 1; }";
  const auto unfinished = [] {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(cache_folder()))
      count += entry.path().filename().string().starts_with("unfinished-");
    return count;
  };
  for (const char* source : {"header.c", "data.c"}) {
    SCOPED_TRACE(source);
    const auto build = [&] {
      build_source(folder / source, "intersects", recipe_of(kVariants[0], folder / source), {});
    };
    std::jthread request([&] {
      while (unfinished() == 0) usleep(1000);
      usleep(300'000);
      stop_requested = true;
    });
    EXPECT_THROW(build(), Stopped);
    stop_requested = false;
    expect_nothing_left();
    EXPECT_EQ(unfinished(), 0u);

    const pid_t asking = fork();
    if (asking == 0) {
      build();
      _exit(0);
    }
    while (unfinished() == 0) usleep(1000);
    usleep(300'000);
    EXPECT_EQ(kill(asking, SIGKILL), 0);
    int status = 0;
    waitpid(asking, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    expect_nothing_left();
    EXPECT_EQ(unfinished(), 0u);
  }
}

TEST_F(Hostile, FilesThatAKilledBuildLeftAreRemovedByTheNext) {
  const fs::path cache = folder / "old";
  fs::create_directories(cache / "kept/part");
  const auto unfinished = [&] {
    std::set<fs::path> found;
    for (const auto& entry : fs::directory_iterator(cache)) {
      if (entry.path().filename() != "kept") found.insert(entry.path());
    }
    return found;
  };
  std::optional<Child> owner;
  owner.emplace([&](int) {
    const Scratch scratch(cache);
    fs::create_directories(scratch.path() / "part");
    for (;;) pause();
  });
  while (unfinished().empty() || !fs::exists(*unfinished().begin() / "part")) usleep(1000);
  const fs::path of_owner = *unfinished().begin();
  fs::last_write_time(of_owner, fs::file_time_type::clock::now() - std::chrono::hours(25));
  {
    const Scratch scratch(cache);
    EXPECT_EQ(unfinished(), (std::set{of_owner, scratch.path()}));
  }
  owner.reset();  // kills it
  EXPECT_EQ(unfinished(), std::set{of_owner});
  const Scratch scratch(cache);
  EXPECT_EQ(unfinished(), std::set{scratch.path()});
  EXPECT_TRUE(fs::exists(cache / "kept/part"));
}

TEST_F(Hostile, ProgramsThatBuildLeaveNothing) {
  const Scratch scratch(folder);
  for (const bool namespaces : {true, false}) {
    std::string said;
    const auto run = [&](const std::string& command, double seconds) {
      return run_program({{"sh", "-c", command}, seconds, namespaces}, scratch.path(), said);
    };
    EXPECT_EQ(run("setsid sleep 1000 & echo one; echo two >&2; exit 3", 600), 3);
    EXPECT_EQ(said, "one\ntwo\n");
    EXPECT_EQ(run("kill -9 $$", 600), 128 + SIGKILL);
    EXPECT_EQ(run("kill -9 0", 600), 128 + SIGKILL);  // kills its process group
    EXPECT_EQ(run("echo $TMPDIR", 600), 0);
    EXPECT_EQ(said, scratch.path().string() + '\n');
    EXPECT_EQ(run("echo 4000000000000 2>&1 > /proc/$PPID/timerslack_ns || echo refused", 600), 0);
    EXPECT_TRUE(said.ends_with("refused\n")) << said;
    EXPECT_EQ(run_program({{"no-such-program"}, 600, namespaces}, scratch.path(), said), 127);
    EXPECT_EQ(said, "No such file or directory\n");
    EXPECT_THROW(run("setsid sleep 1000 & sleep 1001", 0.2), std::runtime_error);
    const std::string error = error_of([&] {  // tail keeps the last line, which here has 300 MiB, and then waits
      run_program({{"sh", "-c", "{ head -c 300M /dev/zero; sleep 1000; } | tail -n 1"}, 600, namespaces, 100},
                  scratch.path(), said);
    });
    EXPECT_TRUE(names(error, {"head -c 300M", "100 MiB", "memory"}));
    EXPECT_NE(run("truncate -s 2G large", 600), 0);  // a sparse file
    EXPECT_FALSE(fs::exists("large") && fs::file_size("large") > (std::uint64_t{1} << 30));
    fs::remove("large");
    {
      const Child asking([&](int) {
        const Scratch own(folder / "killed");
        run_program({{"sh", "-c", "setsid sleep 1000 & echo > " + (folder / "started").string() + "; sleep 1001"},
                     600,
                     namespaces},
                    own.path(), said);
      });
      while (!fs::exists(folder / "started")) usleep(1000);
    }
    expect_nothing_left();
    fs::remove(folder / "started");
    EXPECT_EQ(count_in(folder / "killed"), 0u);
  }
}

// If each call forks, each pair leaves one more process. Still, there must be neither a second worker nor a second
// process that loads the code and starts workers.
TEST_F(Hostile, CodeThatForksAndReturnsTwiceAnswersOnce) {
  const std::string includes = "#include <signal.h>\n#include <unistd.h>\n",
                    function = "int intersects(const float a[9], const float b[9]) {\n";
  const fs::path kFiles[] = {
      built_from("forks_twice", includes + function + "  signal(SIGCHLD, SIG_IGN); fork(); return a[0] < b[0]; }"),
      built_from("forks_loading", includes + "__attribute__((constructor)) static void load(void) { fork(); }\n" +
                                      function + "  return a[0] < b[0]; }")};
  for (const fs::path& file : kFiles) {
    for (int run = 0; run < 3; ++run) {
      SCOPED_TRACE(file);
      ForeignProcesses subject({"library", file.string(), "intersects", "f32"}, Scalar::f32);
      expect_left_of(verdicts(subject));
    }
    expect_nothing_left();
  }
}

// The code is not in the process groups of the supervisor, the guardian and graze.
TEST_F(Hostile, CodeThatStopsItsProcessGroupStopsOnlyItself) {
  const auto bad = std::find_if(pairs.begin(), pairs.end(), is_bad);
  ASSERT_NE(bad, pairs.end());
  for (const bool namespaces : {true, false}) {
    Code code = attack("stops_group", namespaces);
    // The verdict would be `crashed` if the supervisor or the guardian stopped.
    EXPECT_EQ(ForeignProcesses(code, Scalar::f32).failure(*bad), Verdict::timed_out);
    expect_nothing_left();

    code.timeout = 3600;
    const auto one_is_stopped = [] {
      const std::set<pid_t> all = left_over();
      return std::any_of(all.begin(), all.end(), is_stopped);
    };
    {
      const Child asking([&](int) { ForeignProcesses(code, Scalar::f32).failure(*bad); });
      while (!one_is_stopped()) usleep(1000);
    }
    expect_nothing_left();
  }
}

// A traced process stops at each signal. Here, the process that forks the workers traces one of them. If it mistook the
// worker's stop for an end, it would fork another worker too early, and the code would be loaded again.
TEST_F(Hostile, AWorkerThatIsTracedByItsParentIsAVerdictAndTheCodeStaysLoaded) {
  const fs::path loads = folder / "loads";
  const struct {
    const char *name, *does;
    Verdict expected;
  } kCases[] = {{"traced_stop", "raise(SIGSTOP)", Verdict::timed_out},
                {"traced_signal", "raise(SIGUSR1)", Verdict::crashed},
                {"traced_abort", "abort()", Verdict::crashed},
                {"traced_exec", "execl(\"/bin/sleep\", \"sleep\", \"1000\", (char*)0)", Verdict::crashed},
                {"traced_kill", "raise(SIGKILL)", Verdict::crashed},
                {"traced_exit", "_exit(0)", Verdict::crashed},
                {"traced_loop", "for (;;)", Verdict::timed_out},
                {"traced_return", "", Verdict::disjoint}};
  for (const auto& c : kCases) {
    const fs::path file = built_from(c.name,
                                     "#include <fcntl.h>\n#include <signal.h>\n#include <stdlib.h>\n"
                                     "#include <sys/ptrace.h>\n#include <unistd.h>\n"
                                     "__attribute__((constructor)) static void f(void) {\n  write(open(\"" +
                                         loads.string() + "\", O_WRONLY | O_CREAT | O_APPEND, 0600), \"l\", 1); }\n" +
                                         "int intersects(const float a[9], const float b[9]) {\n  if (a[0] > 0.9f) { "
                                         "ptrace(PTRACE_TRACEME, 0, 0, 0); " +
                                         c.does + "; return 0; }\n  return a[0] < b[0]; }");
    for (const bool namespaces : {true, false}) {
      SCOPED_TRACE(c.name);
      fs::remove(loads);
      Code code{"library", file.string(), "intersects", "f32", 0.1, 256};
      code.namespaces = namespaces;
      {
        ForeignProcesses subject(code, Scalar::f32);
        const std::vector<Verdict> found = verdicts(subject);
        EXPECT_EQ(text_of(loads), "l");
        for (std::size_t i = 0; i < pairs.size(); ++i) {
          const bool fails = is_bad(pairs[i]) && c.expected != Verdict::disjoint;
          EXPECT_EQ(found[i], fails ? Verdict::crashed : is_bad(pairs[i]) ? c.expected : left_of(pairs[i])) << i;
          EXPECT_TRUE(!fails || subject.failure(pairs[i]) == c.expected) << i;
        }
      }
      expect_nothing_left();
    }
  }
}

// An unexpected line shifts all later answers. Asking about single pairs shows which pair caused the line.
TEST_F(Hostile, LinesThatWereNotAskedForAreVerdictsOfTheirPairs) {
  std::ofstream(folder / "extra.c") << R"(#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
int main(int count, char** words) {
  static char line[4096], more[6001];
  const int extra = atoi(words[1]), apart = words[2][0] == 'a';
  for (int i = 0; i < extra; ++i) strcat(more, "1\n");
  if (words[2][0] == 'b') write(1, more, strlen(more));
  while (fgets(line, sizeof line, stdin)) {
    char *at = line, text[6010];
    float a[18];
    for (int i = 0; i < 18; ++i) a[i] = strtof(at, &at);
    strcpy(text, a[0] < a[9] ? "1\n" : "0\n");
    const int bad = a[0] > 0.9f && words[2][0] != 'b';
    if (bad && !apart) strcat(text, more);
    write(1, text, strlen(text));
    if (bad && apart) write(1, more, strlen(more));
  }
})";
  const fs::path program = folder / "extra";
  ASSERT_EQ(std::system(("cc -O1 -w " + (folder / "extra.c").string() + " -o " + program.string()).c_str()), 0);
  for (const std::string how : {"1 together", "1 apart", "3 together", "3000 apart", "1 before", "3 before"}) {
    SCOPED_TRACE(how);
    for (int times = 0; times < 2; ++times) {
      ForeignProcesses subject({"command", program.string() + ' ' + how, "", "f32", 3600}, Scalar::f32);
      std::vector<Verdict> expected;
      for (const Pair& pair : pairs)
        expected.push_back(is_bad(pair) || how.ends_with("before") ? Verdict::crashed : left_of(pair));
      // A line that is written separately counts for its pair only if it arrives in time, and load on the machine may
      // delay it.
      std::vector<Verdict> found;
      for (int tries = how.ends_with("apart") ? 20 : 1; tries > 0 && found != expected; --tries)
        found = verdicts(subject);
      EXPECT_EQ(found, expected);
    }
  }
  expect_nothing_left();
}

// The verdict is always the same, even if the program ends before it gets its input.
TEST_F(Hostile, ProgramsThatEndAtOnceCrashOnEveryPair) {
  for (int times = 0; times < 5; ++times) {
    ForeignProcesses subject({"command", "exit 1", "", "f32", 3600}, Scalar::f32);
    EXPECT_EQ(verdicts(subject), std::vector<Verdict>(pairs.size(), Verdict::crashed));
  }
}

// The asking process may be killed at any time, and all other processes must end with it.
TEST_F(Hostile, NothingOutlivesTheProcessThatAsks) {
  for (const char* name : {"leaves_children_silently", "forks_without_end", "stops_itself"}) {
    for (const bool namespaces : {true, false}) {
      {
        const Child asking([&](int) {
          ForeignProcesses subject(attack(name, namespaces, 3600), Scalar::f32);
          verdicts(subject);
          pause();
        });
        usleep(300'000);
      }
      expect_nothing_left();
    }
  }
}

}  // namespace
}  // namespace graze::subjects
