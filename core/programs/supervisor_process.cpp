// SPDX-License-Identifier: Apache-2.0
#include "core/programs/supervisor_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <system_error>

#include "core/programs/process_state.h"
#include "core/stop.h"

extern char** environ;

namespace graze {
namespace {

constexpr int kLookEvery = 50;  // ms between checks for a request to stop
// Counts checks, not time: if the machine is so busy that the supervisor has to wait, this process waits as well.
constexpr int kMostSilentLooks = 10'000 / kLookEvery;

constexpr int kAboveShared = 64;            // above the descriptors that a supervisor gets
constexpr rlim_t kFewestDescriptors = 128;  // that a process with foreign code needs

int open_program(const char* name) {
  const int file = open(beside_this(name).c_str(), O_PATH | O_CLOEXEC),
            above = fcntl(file, F_DUPFD_CLOEXEC, kAboveShared);
  if (file >= 0) close(file);
  return above;
}

}  // namespace

std::filesystem::path beside_this(const std::string& program) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
}

const std::array<int, 2>& program_files() {
  static const std::array<int, 2> files{open_program("graze-subject-host"), open_program("graze-subject-device")};
  return files;
}

SupervisorProcess::SupervisorProcess(const std::string& program, const std::vector<std::string>& arguments,
                                     const std::vector<int>& shared, int output) {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < kFewestDescriptors)
    throw std::runtime_error("a limit of " + std::to_string(files.rlim_cur) + " descriptors is too low for " + program +
                             "; raise it: ulimit -n 1024");
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot make a socket for " + program);
  socket_ = sockets[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  // Moves the descriptors above those that the supervisor gets, so that no dup2 overwrites one of them.
  std::vector<int> from{output, sockets[1]};
  from.insert(from.end(), shared.begin(), shared.end());
  for (int& fd : from) fd = fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, 16);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    if (output < 0) {
      posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    } else {
      posix_spawn_file_actions_adddup2(&actions, from[0], stream);
    }
  }
  for (std::size_t i = 1; i < from.size(); ++i)
    posix_spawn_file_actions_adddup2(&actions, from[i], static_cast<int>(i) + 2);
  // The supervisor gets its own session, so that Ctrl-C and the terminal affect only the calling process.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  sigset_t signals;
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  const std::string file = beside_this(program);
  std::vector<char*> words{const_cast<char*>(file.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const int opened = program_files()[program == "graze-subject-device"];
  const std::string start = opened < 0 ? file : "/proc/self/fd/" + std::to_string(opened);
  const int error = posix_spawn(&process_, start.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(sockets[1]);
  for (const int fd : from) {
    if (fd >= 0) close(fd);
  }
  if (error != 0) {
    close(socket_);
    throw std::system_error(error, std::generic_category(), "cannot start " + file);
  }
}

SupervisorProcess::~SupervisorProcess() {
  using Clock = std::chrono::steady_clock;
  shutdown(socket_, SHUT_WR);  // the supervisor still reports that it is alive
  const Clock::time_point start = Clock::now();
  const auto has_ended = [&] {
    const pid_t ended = waitpid(process_, nullptr, WNOHANG);
    return ended != 0 && !(ended < 0 && errno == EINTR);
  };
  bool ended = has_ended(), left = false, closed = false;
  const bool hangs = silent_ || is_stopped(process_);
  for (int looks = 0; !ended && !left && !hangs && looks < kMostSilentLooks; ++looks) {
    pollfd news{closed ? -1 : socket_, POLLIN, 0};
    char alive;
    if (poll(&news, 1, closed ? 1 : kLookEvery) > 0) {
      closed = recv(socket_, &alive, sizeof alive, MSG_DONTWAIT) <= 0;
      looks = 0;
    }
    ended = has_ended();
    left = stop_requested && Clock::now() - start > std::chrono::seconds(1);
  }
  close(socket_);
  if (ended || left) return;
  kill(process_, SIGKILL);
  for (int times = 0; times < 1000 && !has_ended(); ++times) poll(nullptr, 0, 1);  // a frozen supervisor does not end
}

bool SupervisorProcess::send(const void* message, std::size_t size) const {
  return ::send(socket_, message, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

ssize_t SupervisorProcess::receive(void* to, std::size_t size) {
  for (int looks = 0; looks < kMostSilentLooks;) {
    pollfd ready{socket_, POLLIN, 0};
    if (poll(&ready, 1, kLookEvery) > 0) {
      const ssize_t received = recv(socket_, to, size, MSG_DONTWAIT);
      if (received != sizeof kAlive) return received;
      looks = 0;
    } else {
      ++looks;
    }
    if (stop_requested) throw Stopped();
    stopped_ = is_stopped(process_);  // a subject without a separate namespace can stop it
    if (stopped_) return -1;
  }
  silent_ = true;
  return -1;
}

}  // namespace graze
