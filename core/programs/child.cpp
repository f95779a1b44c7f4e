// SPDX-License-Identifier: Apache-2.0
#include "core/programs/child.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <mutex>
#include <system_error>

namespace graze {
namespace {

[[noreturn]] void run(const std::function<void(int pipe)>& work, int pipe, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  try {
    work(pipe);
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

}  // namespace

Child::Child(const std::function<void(int pipe)>& work) {
  static std::mutex starting;  // no other child may inherit the write end of this pipe
  const std::lock_guard lock(starting);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot make a pipe to another process");
  const pid_t parent = getpid();
  process_ = fork();
  const int error = errno;  // fork's errno, if it failed
  if (process_ == 0) run(work, ends[1], parent);
  close(ends[1]);
  pipe_ = ends[0];
  if (process_ > 0) return;
  close(pipe_);
  throw std::system_error(error, std::generic_category(), "cannot start another process");
}

Child::~Child() {
  close(pipe_);
  if (process_ < 0) return;
  kill();
  succeeded();
}

void Child::kill() const { ::kill(process_, SIGKILL); }

bool Child::succeeded() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status == 0;
}

void write_all(int pipe, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t count = write(pipe, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(1);
    bytes += count;
    size -= static_cast<std::size_t>(count);
  }
}

}  // namespace graze
