// SPDX-License-Identifier: Apache-2.0
// graze-subject-host runs foreign code. Only Graze starts this program. As the supervisor of foreign code:
//   graze-subject-host KIND WHAT NAME SCALAR MEMORY SECONDS DESCRIBE NAMESPACES CACHE
// The supervisor starts this program again as the process that loads the code and forks workers:
//   graze-subject-host --worker KIND WHAT NAME SCALAR MEMORY DESCRIBE
// As the supervisor of a build tool that has its temporary files in the folder SCRATCH:
//   graze-subject-host --run SECONDS SCRATCH NAMESPACES MEMORY WORD...
// With CUDA, graze-subject-device also times kernels. It prints the device's name and, for each kernel, a line with the
// nanoseconds per pair of each pass:
//   graze-subject-device --time PAIRS PASSES f32|f64 PTX [f32|f64 PTX]...
// KIND WHAT NAME SCALAR:  library FILE NAME f32|f64|any   a shared object and its export; see graze/subject.h
//                         command TEXT "" f32             a program; see subjects/README.md
//                         program RUN "" f32|f64|any      a program that RUN runs; see graze/program.h and toolchains.h
//                         device FILE "" f32|f64          PTX of cuda/subject; run by graze-subject-device with CUDA
// MEMORY: the MiB that the code may use; a device's driver has no limit. SECONDS: the time limit for a pair or a block.
// DESCRIBE: 1 asks a program to describe itself. NAMESPACES: 0 uses no process namespace. CACHE: a folder that the code
// cannot write to; may be empty.
#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <graze/subject.h>
#include <link.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#ifdef __x86_64__
#include <immintrin.h>
#endif

#include "subjects/containment.h"
#include "subjects/line_protocol.h"
#include "subjects/program_protocol.h"
#include "subjects/supervisor.h"
#include "subjects/toolchains/command_of.h"
#include "subjects/usage.h"
#ifdef GRAZE_SUBJECT_DEVICE
#include "cuda/subject/subject_device.h"
#endif

namespace graze::subjects {
namespace {

std::uint64_t* words;
const void* pairs;

// Sends a message to the supervisor. Exits if the supervisor is gone, because nobody needs the answer then.
void send_message(const void* message, std::size_t size) {
  if (send(kTalkFd, message, size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) _exit(0);
}

template <std::size_t size>
void put(char (&to)[size], const char* text) {
  std::snprintf(to, size, "%s", text ? text : "");
}

[[noreturn]] void refuse(const std::string& why) {
  Loaded refused{};
  refused.says = Says::refused;
  put(refused.text, why.c_str());
  send_message(&refused, sizeof refused);
  std::exit(1);
}

// The names that a shared object exports, for an error message.
std::string exported(void* library) {
  link_map* map = nullptr;
  if (dlinfo(library, RTLD_DI_LINKMAP, &map) != 0) return "nothing known";
  const char* strings = nullptr;
  const ElfW(Sym)* symbols = nullptr;
  std::size_t string_bytes = 0;
  for (const ElfW(Dyn)* entry = map->l_ld; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_STRTAB) strings = reinterpret_cast<const char*>(entry->d_un.d_ptr);
    if (entry->d_tag == DT_SYMTAB) symbols = reinterpret_cast<const ElfW(Sym)*>(entry->d_un.d_ptr);
    if (entry->d_tag == DT_STRSZ) string_bytes = entry->d_un.d_val;
  }
  std::string names;
  int count = 0;
  // Linkers place the string table right after the symbol table, so the string table marks the symbol table's end.
  for (const ElfW(Sym)* s = symbols; s && strings && reinterpret_cast<const char*>(s) < strings; ++s) {
    const int type = ELF64_ST_TYPE(s->st_info);
    if (s->st_shndx == SHN_UNDEF || (type != STT_FUNC && type != STT_OBJECT) || s->st_name >= string_bytes) continue;
    const std::string name = strings + s->st_name;
    if (name.starts_with("_")) continue;
    if (++count <= 8) names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? "none that it exports" : "only " + names + (count > 8 ? ", …" : "");
}

// The file to load: the sealed copy of the code that graze verified.
const std::string kCode = "/proc/self/fd/" + std::to_string(kCodeFd);

// Adds the folders that the code names through $ORIGIN to the library path, because the sealed copy is in no folder.
// The system reads the library path only when a program starts, so this program restarts itself.
void name_origin(const std::string& file, char** argv) {
  struct stat code {};
  if (fstat(kCodeFd, &code) != 0 || code.st_size == 0) return;
  const auto size = static_cast<std::size_t>(code.st_size);
  void* at_all = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, kCodeFd, 0);
  if (at_all == MAP_FAILED) return;
  const std::string_view bytes(static_cast<const char*>(at_all), size);
  const std::string folder = file.substr(0, file.rfind('/') + 1) + '.';
  std::string folders;
  for (const std::string word : {"$ORIGIN", "${ORIGIN}"}) {
    for (std::size_t at = bytes.find(word); at != bytes.npos; at = bytes.find(word, at + 1)) {
      const std::size_t begin = bytes.find_last_of(std::string(":\0", 2), at) + 1;  // of the list's entry
      std::string found(bytes.substr(begin, bytes.find_first_of(std::string(":\0", 2), at) - begin));
      found.replace(at - begin, word.size(), folder);
      folders += found + ':';
    }
  }
  munmap(at_all, size);
  const char* now = std::getenv("LD_LIBRARY_PATH");
  if (folders.empty() || std::string_view(now ? now : "").starts_with(folders)) return;
  if (now) folders += now;
  setenv("LD_LIBRARY_PATH", folders.c_str(), 1);
  execv("/proc/self/exe", argv);
}

graze_subject subject_of_library(const std::string& file, const std::string& name, const std::string& scalar,
                                 Loaded& loaded) {
  void* library = dlopen(kCode.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    std::string why = dlerror();
    if (why.starts_with(kCode)) why.replace(0, kCode.size(), file);
    refuse(why);
  }
  void* found = nullptr;
  for (const std::string& candidate :
       name.empty() ? std::vector<std::string>{"graze_subject", "intersects"} : std::vector<std::string>{name}) {
    if (!found && (found = dlsym(library, candidate.c_str()))) put(loaded.symbol, candidate.c_str());
    for (const char* type : {"f", "d"}) {  // a C++ function with two pointer parameters
      const std::string mangled = fmt::format("_Z{}{}PK{}{}", candidate.size(), candidate, type, "S0_");
      if (!found && (found = dlsym(library, mangled.c_str()))) {
        graze_subject subject{};
        if (*type == 'f') subject.f32 = reinterpret_cast<int (*)(const float*, const float*)>(found);
        put(loaded.symbol, mangled.c_str());
        if (*type == 'd') subject.f64 = reinterpret_cast<int (*)(const double*, const double*)>(found);
        return subject;
      }
    }
  }
  if (!found) {
    refuse(fmt::format("{}: expected a function {} or a description of type struct graze_subject, found {}", file,
                       name.empty() ? "named intersects," : "or description named " + name + ",", exported(library)));
  }
  Dl_info info;
  const ElfW(Sym)* symbol = nullptr;
  const bool known = dladdr1(found, &info, reinterpret_cast<void**>(const_cast<ElfW(Sym)**>(&symbol)), RTLD_DL_SYMENT);
  if (known && symbol && ELF64_ST_TYPE(symbol->st_info) == STT_OBJECT) {
    loaded.describes_itself = 1;
    graze_subject subject;
    std::memcpy(&subject, found, sizeof subject);
    if (subject.abi != GRAZE_SUBJECT_ABI)
      refuse(fmt::format("{}: expected a description for version {} of graze/subject.h, found {}", file,
                         GRAZE_SUBJECT_ABI, subject.abi));
    constexpr std::uint32_t kKnown =
        GRAZE_OUTSIDE_TOUCHING | GRAZE_OUTSIDE_COPLANAR | GRAZE_OUTSIDE_DEGENERATE | GRAZE_OUTSIDE_SHARED;
    if (subject.outside & ~kKnown)
      refuse(fmt::format("the description in {}: outside is {}, not a sum of GRAZE_OUTSIDE_…", file, subject.outside));
    if (!subject.f32 && !subject.f64 && !subject.block_f32 && !subject.block_f64)
      refuse(fmt::format("the description in {} names no function; set f32, f64, block_f32 or block_f64", file));
    return subject;
  }
  graze_subject subject{};
  if (scalar == "f64") {
    subject.f64 = reinterpret_cast<int (*)(const double*, const double*)>(found);
  } else {
    subject.f32 = reinterpret_cast<int (*)(const float*, const float*)>(found);
  }
  return subject;
}

// Whether foreign code forked this process from the worker: its call then returns in both processes.
bool is_copy = false;

signed char answer_of(int said) {
  if (is_copy) _exit(0);
  return said < 0 ? kDeclined : said > 0 ? kIntersects : kDisjoint;
}

// The processor time of this thread, which other load on the machine does not change.
std::uint64_t processor_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000 + static_cast<std::uint64_t>(now.tv_nsec);
}

// The processor's rounding mode, precision and treatment of subnormals after the code was loaded. A change that
// stayed in force would change the answers for later pairs.
class FloatControl {
 public:
  FloatControl() : modes_(modes()), x87_(x87()) {}

  // Sets the processor back to this state.   Returns: whether the state had changed.
  bool restore() const {
    if (modes() == modes_ && x87() == x87_) return false;
#ifdef __x86_64__
    _mm_setcsr(modes_);
    __asm__ volatile("fldcw %0" : : "m"(x87_));
#else
    fesetround(static_cast<int>(modes_));
#endif
    return true;
  }

 private:
#ifdef __x86_64__
  static unsigned modes() { return _mm_getcsr() & ~0x3fu; }  // without the exception flags
  static std::uint16_t x87() {
    std::uint16_t word;
    __asm__ volatile("fnstcw %0" : "=m"(word));
    return word;
  }
#else
  static unsigned modes() { return static_cast<unsigned>(fegetround()); }
  static std::uint16_t x87() { return 0; }
#endif
  unsigned modes_;
  std::uint16_t x87_;
};

// Asks about a question's pairs, forward and then backward.
template <class Number>
class Asking {
 public:
  using Single = int (*)(const Number*, const Number*);
  using Block = std::function<void(const Number*, std::size_t, signed char*)>;

  Asking(Single single, Block block) : single_(single), block_(std::move(block)) {}

  // Returns: the processor time of the forward pass.
  std::uint64_t ask(const Question& question) const {
    const std::uint64_t start = processor_nanoseconds();
    for (std::size_t i = 0; i < question.count; ++i) {
      if (!is_chosen(question.first, i)) continue;
      if (block_ && !question.singly) {  // then the question is about all pairs
        ask_block(question, false, 0, question.count);
        break;
      }
      put_answer(words, question, false, i, one(i, false));
    }
    const std::uint64_t taken = processor_nanoseconds() - start;
    if (block_ && !question.singly) {
      // Asks in parts that begin at odd indices, so that almost every pair gets another index in its block, modulo any
      // power of two.
      const std::size_t half = std::min<std::size_t>(question.count, question.count / 2 | 1);
      const std::size_t first = std::min<std::size_t>(half, 3);
      ask_block(question, true, half, question.count);
      ask_block(question, true, first, half);
      ask_block(question, true, 0, first);
    } else {
      for (std::size_t i = question.count; i-- > 0;) {
        if (is_chosen(question.second, i)) put_answer(words, question, true, i, one(i, true));
      }
    }
    return taken;
  }

 private:
  const Number* pair(std::size_t i) const { return static_cast<const Number*>(pairs) + 18 * i; }

  // The initial value of an answer in a block. The value differs between the passes, so a pair is unstable if the
  // function does not write its answer.
  static signed char unwritten(bool second) { return second ? kDisjoint : kDeclined; }

  // Asks about one pair. If the call changes the floating-point control, the second pass reports a different answer, so
  // the pair is unstable.
  signed char one(std::size_t i, bool second) const {
    signed char said = unwritten(second);
    if (block_) {
      block_(pair(i), 1, &said);
      said = answer_of(said);
    } else {
      said = answer_of(single_(pair(i), pair(i) + 9));
    }
    const signed char other = said == kDeclined ? int{kDisjoint} : int{kDeclined};
    return control_.restore() && second ? other : said;
  }

  void ask_block(const Question& question, bool second, std::size_t begin, std::size_t end) const {
    if (begin == end) return;
    signed char said[kMostAsked];
    std::fill_n(said, kMostAsked, unwritten(second));
    block_(pair(begin), end - begin, said);
    if (control_.restore()) _exit(1);  // the supervisor then asks about one pair at a time
    for (std::size_t i = begin; i < end; ++i) put_answer(words, question, second, i, answer_of(said[i - begin]));
  }

  Single single_;
  Block block_;
  FloatControl control_;
};

// In the worker: answers questions until the supervisor is gone.   ask: answers a question, and returns its time.
template <class Ask>
[[noreturn]] void serve(Ask ask) {
  const Says ready = Says::ready;
  send_message(&ready, sizeof ready);
  for (Question question; recv(kTalkFd, &question, sizeof question, 0) == sizeof question;) {
    if (question.worker != getpid()) continue;  // sent to an earlier worker, which has ended
    Answered answered{Says::answered, 0, question.nonce, 0};
    try {
      answered.nanoseconds = ask(question);
    } catch (...) {
      _exit(1);
    }
    send_message(&answered, sizeof answered);
  }
  _exit(0);
}

#ifdef GRAZE_SUBJECT_DEVICE
// A build with the PTX from the file.
cuda::CudaBuild build_in(const std::string& file, std::string_view scalar) {
  cuda::CudaBuild build{};
  build.scalar = scalar == "f64" ? Scalar::f64 : Scalar::f32;
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  build.ptx = text.str();
  return build;
}
#endif

void set_limit(int resource, rlim_t most) {
  const rlimit limit{most, most};
  setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

constexpr rlim_t kMostFileBytes = rlim_t{1} << 30;

// Sets the limits that the system enforces for each process. The supervisor checks the sums over all processes.
void set_limits(const char* mib) {
#ifdef __SANITIZE_ADDRESS__
  static_cast<void>(mib);  // the sanitizer's shadow memory counts as data
#else
  set_limit(RLIMIT_DATA, std::strtoull(mib, nullptr, 10) << 20);
#endif
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_FSIZE, kMostFileBytes);
  set_limit(RLIMIT_NOFILE, kDescriptorsOfAProcess);
}

// Turns off address randomisation where possible, so that code repeats its answers even if they depend on addresses.
void fix_addresses(char** argv) {
  const int now = personality(0xffffffff);
  if (now < 0 || now & ADDR_NO_RANDOMIZE || personality(static_cast<unsigned long>(now) | ADDR_NO_RANDOMIZE) < 0)
    return;
  if (personality(0xffffffff) & ADDR_NO_RANDOMIZE) execv("/proc/self/exe", argv);
}

constexpr double kGreetingSeconds = 50;  // an emulator or another machine may be slow to start

constexpr int kNotReady = 99;  // the exit status of a worker that cannot start its program or open its device

// Becomes a worker.   subject: the library's description.   Throws: std::exception if the worker cannot start.
[[noreturn]] void work(const std::string& kind, const std::string& what, const std::string& scalar,
                       const graze_subject& subject) {
  if (kind == "command") {
    LineProtocol program(what);
    serve([&](const Question& question) {
      program.ask(question, static_cast<const float*>(pairs), words);
      return 0;
    });
  }
  if (kind == "program") {
    ProgramProtocol program(command_of(what, kCode), kGreetingSeconds);
    serve([&](const Question& question) {
      program.ask(question, pairs, scalar == "f64", words);
      return 0;
    });
  }
  const auto serve_by = [](const auto& asking) {
    serve([&](const Question& question) { return asking.ask(question); });
  };
#ifdef GRAZE_SUBJECT_DEVICE
  if (kind == "device") {
    // The device is opened here, because a forked process cannot use its parent's device.
    const std::unique_ptr<cuda::SubjectOnDevice> device = cuda::open_on_device(build_in(kCode, scalar));
    const auto decide = [&]<class Number>(const Number* from, std::size_t count, signed char* answers) {
      device->decide(std::span(reinterpret_cast<const BasicPair<Number>*>(from), count), answers);
    };
    scalar == "f64" ? serve_by(Asking<double>(nullptr, decide)) : serve_by(Asking<float>(nullptr, decide));
  }
#endif
  scalar == "f64" ? serve_by(Asking<double>(subject.f64, subject.block_f64))
                  : serve_by(Asking<float>(subject.f32, subject.block_f32));
  std::abort();  // serve does not return
}

// Loads the code, then forks a worker, and another one whenever the last has ended.
int load_and_fork(char** argv, const std::string& kind, const std::string& what, const std::string& name,
                  const std::string& scalar, const char* memory, bool describe) {
  if (kind == "library") name_origin(what, argv);
  words = static_cast<std::uint64_t*>(
      mmap(nullptr, kWords * sizeof *words, PROT_READ | PROT_WRITE, MAP_SHARED, kWordsFd, 0));
  pairs = mmap(nullptr, kPairsBytes, PROT_READ, MAP_SHARED, kPairsFd, 0);
  if (words == MAP_FAILED || pairs == MAP_FAILED) return 2;
  close(kPairsFd);
  close(kWordsFd);
  fcntl(kTalkFd, F_SETFD, FD_CLOEXEC);
  if (kind != "program") fcntl(kCodeFd, F_SETFD, FD_CLOEXEC);
  if (kind != "device") set_limits(memory);
  const pid_t self = getpid();
  Loaded loaded{};
  graze_subject subject{};
  if (kind == "library") {
    subject = subject_of_library(what, name, scalar, loaded);
    put(loaded.version, subject.version);
    put(loaded.source, subject.source);
    put(loaded.convention, subject.convention);
    loaded.outside = subject.outside;
    loaded.has_f32 = subject.f32 || subject.block_f32;
    loaded.has_f64 = subject.f64 || subject.block_f64;
    loaded.of_blocks = (scalar != "f32" && subject.block_f64) || (scalar != "f64" && subject.block_f32);
  } else if (kind == "program" && describe) {
    try {
      const ProgramProtocol program(command_of(what, kCode), kGreetingSeconds);
      loaded.has_f32 = program.has_f32();
      loaded.has_f64 = program.has_f64();
    } catch (const std::exception& error) {
      refuse(error.what());
    }
  } else {
    loaded.has_f32 = 1;
  }
  if (kind != "library") {
    loaded.of_blocks = 1;
    if (kind == "command" && describe) put(loaded.text, described_by(what).c_str());
  }
  if (getpid() != self) _exit(0);  // the code forked this copy of the process while it was loaded
  loaded.says = Says::loaded;
  send_message(&loaded, sizeof loaded);
  pthread_atfork(nullptr, nullptr, [] { is_copy = true; });
  for (;;) {
    const pid_t worker = fork();
    if (worker == 0) {
      is_copy = false;
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != self) _exit(0);
      try {
        work(kind, what, scalar, subject);
      } catch (const std::exception&) {
        _exit(kNotReady);
      }
    }
    if (worker < 0) return 1;
    int status = 0;
    // A worker can make this process its tracer (PTRACE_TRACEME), and then stops at each signal. This loop detaches the
    // worker and passes the signal on.
    while (waitpid(worker, &status, 0) < 0 ? errno == EINTR : WIFSTOPPED(status))
      ptrace(PTRACE_DETACH, worker, nullptr, WSTOPSIG(status));
    if (WIFEXITED(status) && WEXITSTATUS(status) == kNotReady) return 1;
  }
}

#ifdef GRAZE_SUBJECT_DEVICE
int print_times(int count, char** arguments) try {
  std::vector<cuda::CudaBuild> builds;
  for (int i = 2; i + 1 < count; i += 2) builds.push_back(build_in(arguments[i + 1], arguments[i]));
  const auto pairs_timed = static_cast<std::uint32_t>(std::strtoul(arguments[0], nullptr, 10));
  const cuda::SubjectCosts costs = cuda::time_subjects(builds, pairs_timed, std::atoi(arguments[1]));
  fmt::print("{}\n", costs.device);
  for (const std::vector<double>& of : costs.nanoseconds) fmt::print("{}\n", fmt::join(of, " "));
  return 0;
} catch (const std::exception& error) {
  fmt::print("{}\n", error.what());
  return 1;
}
#endif

int host(int argc, char** argv) {
#ifdef GRAZE_SUBJECT_DEVICE
  if (argc > 5 && std::strcmp(argv[1], "--time") == 0) return print_times(argc - 2, argv + 2);
#endif
  if (argc == 8 && std::strcmp(argv[1], "--worker") == 0)
    return load_and_fork(argv, argv[2], argv[3], argv[4], argv[5], argv[6], *argv[7] == '1');
  if (argc > 6 && std::strcmp(argv[1], "--run") == 0) {
    fcntl(kControlFd, F_SETFD, FD_CLOEXEC);
    close_range(kControlFd + 1, ~0u, 0);
    setenv("TMPDIR", argv[3], 1);
    setenv("LC_ALL", "C", 1);  // so that compilers write messages with ASCII quotes
    enter_containment(*argv[4] == '1', std::uint64_t{1} << 30, kControlFd);
    set_limit(RLIMIT_FSIZE, kMostFileBytes);
    return supervise_program(std::strtod(argv[2], nullptr), std::strtoull(argv[5], nullptr, 10) << 20, argv[3],
                             argv + 6);
  }
  if (argc != 10) {
    fmt::print(stderr, "graze-subject-host: only graze starts this program\n");
    return 2;
  }
  fix_addresses(argv);
  const bool on_device = std::strcmp(argv[1], "device") == 0;
  Limits limits;
  limits.has_code = std::strcmp(argv[1], "command") != 0;
  limits.program = !limits.has_code || std::strcmp(argv[1], "program") == 0;
  fcntl(kControlFd, F_SETFD, FD_CLOEXEC);
  close_range(limits.has_code ? kSupervisorCodeFd + 1 : kSupervisorCodeFd, ~0u, 0);
  limits.seconds = std::strtod(argv[6], nullptr);
  limits.bytes = on_device ? 0 : std::strtoull(argv[5], nullptr, 10) << 20;
  limits.system_v = enter_containment(!on_device && *argv[8] == '1', limits.bytes, kControlFd, argv[9]);
  char worker[] = "--worker";
  char* const arguments[] = {argv[0], worker, argv[1], argv[2], argv[3], argv[4], argv[5], argv[7], nullptr};
  return supervise(limits, arguments);
}

}  // namespace
}  // namespace graze::subjects

int main(int argc, char** argv) { return graze::subjects::host(argc, argv); }
