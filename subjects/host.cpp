// SPDX-License-Identifier: Apache-2.0
// graze-subject-host: loads foreign code and asks it, in a process of its own. Started by graze, not by a person:
//   graze-subject-host library FILE NAME f32|f64|any LIMIT    (a shared object, and what it exports; see graze/subject.h)
//   graze-subject-host command TEXT "" f32 LIMIT              (a program; see subjects/README.md)
//   graze-subject-device device FILE "" f32|f64 LIMIT         (PTX of cuda/subject; the same program, with CUDA)
// LIMIT: MiB of memory that the code may take; a device's driver takes what it wants.
#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <graze/subject.h>
#include <link.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <typeinfo>
#include <vector>

#include "subjects/channel.h"
#include "subjects/line_protocol.h"
#ifdef GRAZE_SUBJECT_DEVICE
#include "cuda/subject/subject_device.h"
#endif

namespace graze::subjects {
namespace {

Channel* channel;
const void* pairs;

void send_letter(char letter) {
  if (send(kSocketFd, &letter, 1, MSG_NOSIGNAL) != 1) _exit(0);  // nobody is there any more
}

template <std::size_t size>
void put(char (&to)[size], const char* text) {
  std::snprintf(to, size, "%s", text ? text : "");
}

[[noreturn]] void refuse(const std::string& why) {
  put(channel->message, why.c_str());
  send_letter(kRefused);
  std::exit(1);
}

// The names that a shared object exports, for a message.
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
  // The table of symbols ends where that of strings begins, as linkers write them.
  for (const ElfW(Sym)* s = symbols; s && strings && reinterpret_cast<const char*>(s) < strings; ++s) {
    const int type = ELF64_ST_TYPE(s->st_info);
    if (s->st_shndx == SHN_UNDEF || (type != STT_FUNC && type != STT_OBJECT) || s->st_name >= string_bytes) continue;
    const std::string name = strings + s->st_name;
    if (name.starts_with("_")) continue;
    if (++count <= 8) names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? "none that it exports" : "only " + names + (count > 8 ? ", …" : "");
}

graze_subject subject_of_library(const std::string& file, const std::string& name, const std::string& scalar) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) refuse(dlerror());
  void* found = nullptr;
  for (const std::string& candidate :
       name.empty() ? std::vector<std::string>{"graze_subject", "intersects"} : std::vector<std::string>{name}) {
    if (!found && (found = dlsym(library, candidate.c_str()))) put(channel->symbol, candidate.c_str());
    for (const char* type : {"f", "d"}) {  // a C++ function of two pointers
      const std::string mangled = fmt::format("_Z{}{}PK{}{}", candidate.size(), candidate, type, "S0_");
      if (!found && (found = dlsym(library, mangled.c_str()))) {
        graze_subject subject{GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
        if (*type == 'f') subject.f32 = reinterpret_cast<int (*)(const float*, const float*)>(found);
        put(channel->symbol, mangled.c_str());
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
    channel->describes_itself = 1;
    graze_subject subject;
    std::memcpy(&subject, found, sizeof subject);
    if (subject.abi != GRAZE_SUBJECT_ABI)
      refuse(fmt::format("{}: expected a description for version {} of graze/subject.h, found {}", file,
                         GRAZE_SUBJECT_ABI, subject.abi));
    if (!subject.f32 && !subject.f64 && !subject.block_f32 && !subject.block_f64)
      refuse(fmt::format("{}: expected a description with a function, found one without", file));
    return subject;
  }
  graze_subject subject{GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
  if (scalar == "f64") {
    subject.f64 = reinterpret_cast<int (*)(const double*, const double*)>(found);
  } else {
    subject.f32 = reinterpret_cast<int (*)(const float*, const float*)>(found);
  }
  return subject;
}

signed char answer_of(int said) { return said < 0 ? kDeclined : said > 0 ? kIntersects : kDisjoint; }

// Of this thread, so that it does not depend on what else the machine does.
std::uint64_t processor_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000 + static_cast<std::uint64_t>(now.tv_nsec);
}

// Asks about the pairs, each twice: forward, then backward, so that what one call leaves behind shows in another.
template <class Number>
class Asking {
 public:
  using Single = int (*)(const Number*, const Number*);
  using Block = std::function<void(const Number*, std::size_t, signed char*)>;

  Asking(Single single, Block block) : single_(single), block_(std::move(block)) {}

  void ask() {
    if (!channel->second) {
      const bool whole = channel->next == 0;
      const std::uint64_t start = processor_nanoseconds();
      first();
      channel->nanoseconds = whole ? processor_nanoseconds() - start : 0;
      channel->next = channel->count - 1;
      channel->second = 1;
    }
    again();
  }

 private:
  const Number* pair(std::uint64_t i) const { return static_cast<const Number*>(pairs) + 18 * i; }

  signed char one(std::uint64_t i) const {
    if (!block_) return answer_of(single_(pair(i), pair(i) + 9));
    signed char answer = kDeclined;
    block_(pair(i), 1, &answer);
    return answer_of(answer);
  }

  void first() {
    if (block_ && !channel->singly) {
      const std::uint64_t begin = channel->next;
      block_(pair(begin), channel->count - begin, channel->answers + begin);
      for (std::uint64_t i = begin; i < channel->count; ++i) channel->answers[i] = answer_of(channel->answers[i]);
      return;
    }
    for (std::uint64_t i = channel->next; i < channel->count; ++i) {
      channel->next = i;
      channel->answers[i] = one(i);
    }
  }

  void again() {
    if (block_ && !channel->singly) {
      const std::uint64_t middle = channel->count / 2;
      signed char answers[kMostAsked];
      std::fill_n(answers, kMostAsked, static_cast<signed char>(kDeclined));
      if (middle < channel->count) block_(pair(middle), channel->count - middle, answers + middle);
      if (middle > 0) block_(pair(0), middle, answers);
      for (std::uint64_t i = 0; i < channel->count; ++i) compare(i, answer_of(answers[i]));
      return;
    }
    for (std::uint64_t i = channel->next + 1; i-- > 0;) {
      channel->next = i;
      if (channel->answers[i] <= kIntersects) compare(i, one(i));
    }
  }

  void compare(std::uint64_t i, signed char answer) {
    if (channel->answers[i] <= kIntersects && channel->answers[i] != answer) channel->answers[i] = kUnstable;
  }

  Single single_;
  Block block_;
};

// In the worker: asks whenever there is something to ask, for ever.
template <class Ask>
[[noreturn]] void serve(Ask ask) {
  for (char letter; read(kSocketFd, &letter, 1) == 1;) {
    try {
      ask();
    } catch (const std::exception& error) {
      put(channel->message, fmt::format("threw {}: {}", typeid(error).name(), error.what()).c_str());
      _exit(1);
    } catch (...) {
      put(channel->message, "threw");
      _exit(1);
    }
    send_letter(kAnswered);
  }
  _exit(0);
}

#ifdef GRAZE_SUBJECT_DEVICE
// The worker's own device: what a process had before it forked is of no use afterwards.
class OnDevice {
 public:
  OnDevice(const std::string& file, const std::string& scalar) {
    cuda::CudaBuild build{};
    build.scalar = scalar == "f64" ? Scalar::f64 : Scalar::f32;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    build.ptx = text.str();
    device_ = cuda::open_on_device(build);
  }

  // Pairs are float32 here, whatever the scalar.
  void operator()(const float* from, std::size_t count, signed char* answers) const {
    device_->decide({reinterpret_cast<const Pair*>(from), count}, answers);
  }

 private:
  std::unique_ptr<cuda::SubjectOnDevice> device_;
};
#endif

void limit_memory(const char* mib) {
  const rlim_t bytes = std::strtoull(mib, nullptr, 10) << 20;
  const rlimit data{bytes, bytes}, none{0, 0};
  setrlimit(RLIMIT_DATA, &data);
  setrlimit(RLIMIT_CORE, &none);
}

// Waits for the worker's end, or for that of the process that asks.
int wait_for(pid_t worker) {
  const int handle = static_cast<int>(syscall(SYS_pidfd_open, worker, 0));
  for (;;) {
    pollfd waiting[] = {{handle, POLLIN, 0}, {kSocketFd, POLLRDHUP, 0}};
    poll(waiting, 2, -1);
    if (waiting[1].revents & (POLLRDHUP | POLLHUP | POLLERR)) {
      kill(worker, SIGKILL);
      std::_Exit(0);
    }
    int status = 0;
    if (waitpid(worker, &status, WNOHANG) == worker) {
      close(handle);
      return status;
    }
  }
}

}  // namespace

// Addresses are the same in every process, where that may be had: code whose answers depend on them says the same again.
void fix_addresses(char** argv) {
  const int now = personality(0xffffffff);
  if (now < 0 || now & ADDR_NO_RANDOMIZE || personality(static_cast<unsigned long>(now) | ADDR_NO_RANDOMIZE) < 0) return;
  if (personality(0xffffffff) & ADDR_NO_RANDOMIZE) execv("/proc/self/exe", argv);
}

int host(int argc, char** argv) {
  if (argc != 6) {
    fmt::print(stderr, "graze-subject-host: is started by graze\n");
    return 2;
  }
  fix_addresses(argv);
  channel = static_cast<Channel*>(mmap(nullptr, sizeof(Channel), PROT_READ | PROT_WRITE, MAP_SHARED, kChannelFd, 0));
  pairs = mmap(nullptr, kPairsBytes, PROT_READ, MAP_SHARED, kPairsFd, 0);
  if (channel == MAP_FAILED || pairs == MAP_FAILED) return 2;
  const std::string kind = argv[1], what = argv[2];
  graze_subject subject{GRAZE_SUBJECT_ABI, 0, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
  if (kind == "library") {
    limit_memory(argv[5]);
    subject = subject_of_library(what, argv[3], argv[4]);
    put(channel->version, subject.version);
    put(channel->source, subject.source);
    put(channel->convention, subject.convention);
    channel->outside = subject.outside;
    channel->has_f32 = subject.f32 || subject.block_f32;
    channel->has_f64 = subject.f64 || subject.block_f64;
    channel->of_blocks = std::strcmp(argv[4], "f64") == 0 ? !!subject.block_f64 : !!subject.block_f32;
  } else {
    channel->has_f32 = channel->of_blocks = 1;
  }
  send_letter(kReady);
  const pid_t self = getpid();
  for (;;) {
    const pid_t worker = fork();
    if (worker == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != self) _exit(0);
      if (kind == "command") {
        limit_memory(argv[5]);
        LineProtocol program(what);
        serve([&] {
          program.ask(channel->singly != 0, static_cast<const float*>(pairs), channel->count, channel->next,
                      channel->second, channel->answers);
        });
      }
#ifdef GRAZE_SUBJECT_DEVICE
      if (kind == "device") {
        const auto device = std::make_shared<OnDevice>(what, argv[4]);
        serve([&] { Asking<float>(nullptr, [device](auto... asked) { (*device)(asked...); }).ask(); });
      }
#endif
      if (std::strcmp(argv[4], "f64") == 0) serve([&] { Asking<double>(subject.f64, subject.block_f64).ask(); });
      serve([&] { Asking<float>(subject.f32, subject.block_f32).ask(); });
    }
    channel->worker = worker;
    channel->status = worker < 0 ? 0 : wait_for(worker);
    channel->worker = 0;
    // A question that the worker did not come to read must not be left to the next one, which would answer twice.
    for (char letter; recv(kSocketFd, &letter, 1, MSG_DONTWAIT) == 1;) {
    }
    if (worker < 0) refuse("expected another process, found that none can be had");
    send_letter(kDied);
  }
}

}  // namespace graze::subjects

int main(int argc, char** argv) { return graze::subjects::host(argc, argv); }
