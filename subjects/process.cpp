// SPDX-License-Identifier: Apache-2.0
#include "subjects/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "core/stop.h"
#include "subjects/process_state.h"
#include "subjects/questions.h"

extern char** environ;

namespace graze::subjects {
namespace {

constexpr int kLookEvery = 50;  // ms, whether a stop is requested
constexpr std::size_t kMostFailuresKept = std::size_t{1} << 20;

// Beside the running program.
std::filesystem::path host_program(const Code& code) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  return self.parent_path() / (code.kind == "device" ? "graze-subject-device" : "graze-subject-host");
}

// Memory that this process alone can write.
int pairs_memory(void*& at) {
  const int fd = memfd_create("graze-pairs", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  at = MAP_FAILED;
  if (fd >= 0 && ftruncate(fd, kPairsBytes) == 0)
    at = mmap(nullptr, kPairsBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (at == MAP_FAILED || fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot share memory with a subject");
  return fd;
}

Verdict verdict_of(signed char answer) {
  switch (answer) {
    case kDisjoint:
      return Verdict::disjoint;
    case kIntersects:
      return Verdict::intersects;
    case kCrashed:
      return Verdict::crashed;
    case kTimedOut:
      return Verdict::timed_out;
    case kUnstable:
      return Verdict::unstable;
    default:
      return Verdict::declined;
  }
}

// What a subject says of itself, as valid UTF-8, which results are.
std::string fit(const char* text) {
  using Json = nlohmann::json;
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

// A supervisor and its end of the socket.
class HostProcess {
 public:
  HostProcess(const Code& code, bool describe) {
    const int pairs = pairs_memory(pairs_);
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot make a socket for a subject");
    socket_ = sockets[0];
    try {
      spawn(code, describe, sockets[1], pairs);
      for (const int fd : {sockets[1], pairs}) close(fd);
      char bytes[sizeof(Loaded)] = {};
      std::string why;
      if (receive(bytes, sizeof bytes) != sizeof bytes || !read_loaded(bytes, loaded_)) {
        why = "ended its supervisor while it was loaded";
      } else if (loaded_.says == Says::refused) {
        why = loaded_.text;
      } else {
        return;
      }
      // Of a library, what the system says names the file.
      throw CannotLoad(code.kind == "library" && why.find(code.what) == why.npos ? code.what + ": " + why : why);
    } catch (...) {
      end();
      throw;
    }
  }
  ~HostProcess() { end(); }
  HostProcess(const HostProcess&) = delete;
  HostProcess& operator=(const HostProcess&) = delete;

  struct CannotLoad : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  const Loaded& loaded() const { return loaded_; }

  // Returns: the answers; nothing where the supervisor ended, and this object is of no use any more.
  std::optional<Answers> ask(const Pair* pairs, std::size_t count, bool in_double) {
    if (in_double) {
      std::copy_n(&pairs[0].a[0].x, count * 18, static_cast<double*>(pairs_));
    } else {
      std::memcpy(pairs_, pairs, count * sizeof(Pair));
    }
    const Block block{static_cast<std::uint32_t>(count)};
    Answers answers;
    if (send(socket_, &block, sizeof block, MSG_NOSIGNAL) != sizeof block ||
        receive(reinterpret_cast<char*>(&answers), sizeof answers) != sizeof answers || answers.count != count)
      return std::nullopt;
    return answers;
  }

 private:
  // Waits for a message.   Returns: its bytes; at most 0 where the supervisor ended.   Throws: Stopped.
  ssize_t receive(char* to, std::size_t size) {
    for (;;) {
      pollfd ready{socket_, POLLIN, 0};
      if (poll(&ready, 1, kLookEvery) > 0) return recv(socket_, to, size, MSG_DONTWAIT);
      if (stop_requested) throw Stopped();
      if (is_stopped(process_)) return -1;  // as a subject without a namespace of its own can do
    }
  }

  void spawn(const Code& code, bool describe, int socket, int pairs) {
    // Above the descriptors of the supervisor, so that none is closed by the next.
    int from[] = {socket, pairs};
    for (int& fd : from) fd = fcntl(fd, F_DUPFD_CLOEXEC, 16);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, from[0], kControlFd);
    posix_spawn_file_actions_adddup2(&actions, from[1], kSupervisorPairsFd);
    // A session of its own: Ctrl-C and the terminal are the asking process's business.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    sigset_t signals;
    sigfillset(&signals);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    const std::string program = host_program(code), memory = std::to_string(code.memory),
                      seconds = fmt::format("{}", code.timeout);
    const char* words[] = {
        program.c_str(), code.kind.c_str(), code.what.c_str(),    code.name.c_str(),           code.scalar.c_str(),
        memory.c_str(),  seconds.c_str(),   describe ? "1" : "0", code.namespaces ? "1" : "0", nullptr};
    const int error =
        posix_spawn(&process_, program.c_str(), &actions, &attributes, const_cast<char**>(words), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    for (const int fd : from) close(fd);
    if (error != 0) {
      process_ = -1;
      throw std::system_error(error, std::generic_category(), "cannot start " + program);
    }
  }

  // The supervisor ends all processes when the socket closes; one that does not is ended itself.
  void end() {
    if (socket_ >= 0) close(socket_);
    if (process_ > 0) {
      using Clock = std::chrono::steady_clock;
      const auto until = Clock::now() + std::chrono::seconds(is_stopped(process_) ? 0 : 6);
      int status = 0;
      pid_t ended = 0;
      for (int wait = 0; (ended = waitpid(process_, &status, WNOHANG)) == 0 && Clock::now() < until; wait = 1)
        poll(nullptr, 0, wait);
      if (ended == 0) {
        kill(process_, SIGKILL);
        while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
      }
    }
    if (pairs_ != MAP_FAILED) munmap(pairs_, kPairsBytes);
    socket_ = -1;
    process_ = -1;
    pairs_ = MAP_FAILED;
  }

  void* pairs_ = MAP_FAILED;
  int socket_ = -1;
  pid_t process_ = -1;
  Loaded loaded_{};
};

Description describe(const Code& code) {
  const HostProcess process(code, true);
  const Loaded& c = process.loaded();
  return {c.has_f32 != 0,    c.has_f64 != 0,          c.outside,     fit(c.version), fit(c.source),
          fit(c.convention), c.describes_itself != 0, fit(c.symbol), c.text};
}

ForeignProcesses::ForeignProcesses(Code code, Scalar scalar) : code_(std::move(code)), scalar_(scalar) {
  code_.scalar = name(scalar);
}

ForeignProcesses::~ForeignProcesses() = default;

std::unique_ptr<HostProcess> ForeignProcesses::idle_or_new() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<HostProcess> process = std::move(idle_.back());
      idle_.pop_back();
      return process;
    }
  }
  try {
    return std::make_unique<HostProcess>(code_, false);
  } catch (const HostProcess::CannotLoad&) {
    return nullptr;  // it could be loaded once: that it cannot now is what the code does
  }
}

void ForeignProcesses::decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects,
                              std::uint64_t* declined) {
  // Processes that share a device wait for each other: one is as fast.
  std::unique_lock alone(alone_, std::defer_lock);
  if (code_.kind == "device") alone.lock();
  const bool in_double = scalar_ == Scalar::f64 && code_.kind != "device";
  std::unique_ptr<HostProcess> process = idle_or_new();
  bool loads = process != nullptr;
  // Answers about pairs; nothing where the supervisor ended, or the code can be loaded no more.
  const auto ask = [&](const Pair* of, std::size_t size) {
    std::optional<Answers> answers;
    if (!process && loads) loads = (process = idle_or_new()) != nullptr;
    if (process) answers = process->ask(of, size, in_double);
    if (!answers) process.reset();
    return answers;
  };
  std::fill_n(intersects, (count + 63) / 64, std::uint64_t{0});
  std::fill_n(declined, (count + 63) / 64, std::uint64_t{0});
  std::optional<std::uint64_t> nanoseconds = 0;
  for (std::size_t begin = 0; begin < count; begin += kMostAsked) {
    const std::size_t size = std::min(count - begin, kMostAsked);
    std::optional<Answers> answers = ask(pairs + begin, size);
    if (!answers) {  // which pair it was shows when they are asked one at a time
      answers.emplace();
      for (std::size_t i = 0; i < size; ++i) {
        const std::optional<Answers> of_pair = ask(pairs + begin + i, 1);
        answers->answers[i] = of_pair ? of_pair->answers[0] : static_cast<signed char>(kCrashed);
      }
    }
    nanoseconds =
        nanoseconds && answers->nanoseconds > 0 ? std::optional(*nanoseconds + answers->nanoseconds) : std::nullopt;
    for (std::size_t i = 0; i < size; ++i) {
      const Verdict verdict = verdict_of(answers->answers[i]);
      const std::size_t at = begin + i;
      const std::uint64_t bit = std::uint64_t{1} << at % 64;
      if (verdict == Verdict::intersects || is_failure(verdict)) intersects[at / 64] |= bit;
      if (verdict == Verdict::declined || is_failure(verdict)) declined[at / 64] |= bit;
      if (!is_failure(verdict)) continue;
      const std::lock_guard lock(mutex_);
      if (failures_.size() == kMostFailuresKept) failures_.clear();
      failures_[std::string(reinterpret_cast<const char*>(&pairs[at]), sizeof(Pair))] = verdict;
    }
  }
  const std::lock_guard lock(mutex_);
  nanoseconds_ = nanoseconds;
  if (process) idle_.push_back(std::move(process));
}

std::optional<std::uint64_t> ForeignProcesses::nanoseconds() const {
  const std::lock_guard lock(mutex_);
  return nanoseconds_;
}

std::unique_ptr<ForeignProcesses> ForeignProcesses::anew() const {
  return std::make_unique<ForeignProcesses>(code_, scalar_);
}

Verdict ForeignProcesses::failure(const Pair& pair) {
  const std::string key(reinterpret_cast<const char*>(&pair), sizeof(Pair));
  const auto kept = [&]() -> std::optional<Verdict> {
    const std::lock_guard lock(mutex_);
    const auto found = failures_.find(key);
    if (found == failures_.end()) return std::nullopt;
    return found->second;
  };
  if (const std::optional<Verdict> verdict = kept()) return *verdict;
  std::uint64_t intersects, declined;
  decide(&pair, 1, &intersects, &declined);
  return kept().value_or(Verdict::unstable);  // it failed before, and does not now
}

}  // namespace graze::subjects
