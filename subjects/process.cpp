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
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "subjects/channel.h"

extern char** environ;

namespace graze::subjects {
namespace {

constexpr int kLoadSeconds = 60;
constexpr std::size_t kMostFailuresKept = std::size_t{1} << 20;

// Beside the running program.
std::filesystem::path host_program(const Code& code) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  return self.parent_path() / (code.kind == "device" ? "graze-subject-device" : "graze-subject-host");
}

int shared_memory(std::size_t bytes) {
  const int fd = memfd_create("graze-subject", MFD_CLOEXEC);
  if (fd < 0 || ftruncate(fd, static_cast<off_t>(bytes)) != 0)
    throw std::system_error(errno, std::generic_category(), "expected shared memory, found none");
  return fd;
}

void* mapped(int fd, std::size_t bytes) {
  void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (at == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "expected shared memory, found none");
  return at;
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

}  // namespace

class HostProcess {
 public:
  explicit HostProcess(const Code& code) : code_(code) {
    const int channel = shared_memory(sizeof(Channel)), pairs = shared_memory(kPairsBytes);
    channel_ = static_cast<Channel*>(mapped(channel, sizeof(Channel)));
    pairs_ = mapped(pairs, kPairsBytes);
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
      throw std::system_error(errno, std::generic_category(), "expected a socket, found none");
    socket_ = sockets[0];
    spawn(channel, pairs, sockets[1]);
    for (const int fd : {channel, pairs, sockets[1]}) close(fd);
    const char letter = wait(kLoadSeconds);
    if (letter == kReady) return;
    const std::string why = letter == kRefused ? channel_->message
                            : letter == 0      ? fmt::format("expected it loaded within {} s", kLoadSeconds)
                                               : "crashed while it was loaded";
    end();
    throw std::runtime_error(code_.kind == "library" && letter != kRefused ? code_.what + ": " + why : why);
  }
  ~HostProcess() { end(); }

  const Channel& channel() const { return *channel_; }

  // Returns: whether all went well; otherwise the process is of no use any more.
  void ask(const Pair* pairs, std::size_t count, Scalar scalar) {
    if (scalar == Scalar::f32 || code_.kind == "device") {
      std::memcpy(pairs_, pairs, count * sizeof(Pair));
    } else {
      std::copy_n(&pairs[0].a[0].x, count * 18, static_cast<double*>(pairs_));
    }
    channel_->count = count;
    channel_->next = 0;
    channel_->second = 0;
    channel_->singly = 0;
    channel_->nanoseconds = 0;
    channel_->message[0] = '\0';
    std::fill_n(channel_->answers, count, static_cast<signed char>(kDeclined));
    send_letter();
    for (;;) {
      const char letter = wait_while_it_goes_on();
      if (letter == kAnswered) return;
      const bool late = letter == 0;
      if (late) {
        kill(channel_->worker, SIGKILL);
        char next;
        bool answered = false;  // in the last moment
        while ((next = wait(kLoadSeconds)) == kAnswered) answered = true;
        if (next != kDied) throw std::runtime_error("expected a new process, found none");
        if (answered) return;
      } else if (letter != kDied) {
        throw std::runtime_error(fmt::format("{}: expected its process to go on, found that it ended", code_.what));
      }
      if (channel_->of_blocks && !channel_->singly) {
        channel_->singly = 1;  // which pair it was shows when they are asked one at a time
      } else if (!pass_over(late ? kTimedOut : kCrashed)) {
        return;
      }
      send_letter();
    }
  }

 private:
  // The pair that the worker was at has this answer.   Returns: whether there is another.
  bool pass_over(signed char answer) {
    const std::uint64_t at = channel_->next;
    channel_->answers[at] = answer;
    if (!channel_->second && at + 1 < channel_->count) {
      channel_->next = at + 1;
    } else if (!channel_->second) {
      channel_->second = 1;
      channel_->next = channel_->count - 1;
    } else if (at > 0) {
      channel_->next = at - 1;
    } else {
      return false;
    }
    return true;
  }

  void spawn(int channel, int pairs, int socket) {
    // Above the descriptors of the host, so that none is closed by the next.
    int from[] = {channel, pairs, socket};
    for (int& fd : from) fd = fcntl(fd, F_DUPFD_CLOEXEC, 16);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int to[] = {kChannelFd, kPairsFd, kSocketFd};
    for (int i = 0; i < 3; ++i) posix_spawn_file_actions_adddup2(&actions, from[i], to[i]);
    // Ctrl-C is the asking process's business.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const std::string program = host_program(code_), memory = std::to_string(code_.memory);
    const char* words[] = {program.c_str(),      code_.kind.c_str(), code_.what.c_str(), code_.name.c_str(),
                           code_.scalar.c_str(), memory.c_str(),     nullptr};
    const int error =
        posix_spawn(&process_, program.c_str(), &actions, &attributes, const_cast<char**>(words), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    for (const int fd : from) close(fd);
    if (error != 0)
      throw std::system_error(error, std::generic_category(), program + ": expected the program, found none");
  }

  void send_letter() {
    const char letter = kAsk;
    if (send(socket_, &letter, 1, MSG_NOSIGNAL) != 1)
      throw std::runtime_error(fmt::format("{}: expected its process to go on, found that it ended", code_.what));
  }

  // Returns: a letter; 0 after so many seconds; -1 where the process ended.
  char wait(double seconds) {
    pollfd ready{socket_, POLLIN, 0};
    int found;
    while ((found = poll(&ready, 1, static_cast<int>(seconds * 1000))) < 0 && errno == EINTR) {
    }
    if (found == 0) return 0;
    char letter;
    return read(socket_, &letter, 1) == 1 ? letter : static_cast<char>(-1);
  }

  // Processor seconds that the worker took so far.
  double worker_seconds() const {
    clockid_t clock;
    timespec taken{};
    if (clock_getcpuclockid(channel_->worker, &clock) != 0 || clock_gettime(clock, &taken) != 0) return 0;
    return static_cast<double>(taken.tv_sec) + 1e-9 * static_cast<double>(taken.tv_nsec);
  }

  // Whether it would go on if the machine let it: it waits for nothing but a processor.
  bool worker_is_held_up() const {
    std::ifstream in(fmt::format("/proc/{}/stat", int{channel_->worker}));
    std::string line;
    std::getline(in, line);
    const std::size_t name_end = line.rfind(") ");
    return name_end != line.npos && name_end + 2 < line.size() && (line[name_end + 2] == 'R' || line[name_end + 2] == 'D');
  }

  // The same, but 0 only where the worker stayed at one pair for all of its time: time that it had, so that a busy
  // machine makes no verdicts.
  char wait_while_it_goes_on() {
    constexpr int kMostTimes = 100;
    double before = worker_seconds();
    for (int times = 1;; ++times) {
      const std::uint64_t at = channel_->next, second = channel_->second;
      const char letter = wait(code_.timeout);
      if (letter != 0) return letter;
      if (channel_->worker <= 0 || channel_->next != at || channel_->second != second) {  // it went on, or another begins
        before = worker_seconds();
        times = 0;
      } else if (times == kMostTimes || !worker_is_held_up() || worker_seconds() - before >= 0.9 * code_.timeout) {
        return 0;
      }
    }
  }

  void end() {
    if (socket_ >= 0) close(socket_);
    if (process_ > 0) {
      kill(process_, SIGKILL);
      int status;
      while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
      }
    }
    if (channel_) munmap(channel_, sizeof(Channel));
    if (pairs_) munmap(pairs_, kPairsBytes);
    socket_ = -1;
    process_ = -1;
    channel_ = nullptr;
    pairs_ = nullptr;
  }

  const Code& code_;
  Channel* channel_ = nullptr;
  void* pairs_ = nullptr;
  int socket_ = -1;
  pid_t process_ = -1;
};

Description describe(const Code& code) {
  const HostProcess process(code);
  const Channel& c = process.channel();
  return {c.has_f32 != 0, c.has_f64 != 0, c.outside, c.version, c.source, c.convention,
          c.describes_itself != 0, c.symbol};
}

ForeignProcesses::ForeignProcesses(Code code, Scalar scalar) : code_(std::move(code)), scalar_(scalar) {
  code_.scalar = name(scalar);
}

ForeignProcesses::~ForeignProcesses() = default;

void ForeignProcesses::decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects,
                              std::uint64_t* declined) {
  // Processes that share a device wait for each other: one is as fast.
  std::unique_lock alone(alone_, std::defer_lock);
  if (code_.kind == "device") alone.lock();
  std::unique_ptr<HostProcess> process;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      process = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!process) process = std::make_unique<HostProcess>(code_);
  std::fill_n(intersects, (count + 63) / 64, std::uint64_t{0});
  std::fill_n(declined, (count + 63) / 64, std::uint64_t{0});
  std::optional<std::uint64_t> nanoseconds = 0;
  for (std::size_t begin = 0; begin < count; begin += kMostAsked) {
    const std::size_t size = std::min(count - begin, kMostAsked);
    process->ask(pairs + begin, size, scalar_);
    const std::uint64_t taken = process->channel().nanoseconds;
    nanoseconds = nanoseconds && taken > 0 ? std::optional(*nanoseconds + taken) : std::nullopt;
    for (std::size_t i = 0; i < size; ++i) {
      const Verdict verdict = verdict_of(process->channel().answers[i]);
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
  idle_.push_back(std::move(process));
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
