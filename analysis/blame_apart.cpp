// SPDX-License-Identifier: Apache-2.0
// Searches for contractions in foreign code in a child process, which is killed if a verdict takes too long.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <mutex>
#include <stdexcept>

#include "analysis/blame.h"
#include "core/cannot.h"

namespace graze::analysis {
namespace {

// The child's messages: kAsked before each verdict; at the end kDone, then whether the set is the smallest, then its
// sites as raw memory. The sites' pointers to text are valid in both processes.
constexpr char kAsked = 0, kDone = 1;

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

[[noreturn]] void search(int pipe, const Lane& lane, const Pair& pair, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (const int caught : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) signal(caught, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  try {
    const Blame found = blame(lane, pair, [pipe] { write_all(pipe, &kAsked, 1); });
    const char head[] = {kDone, static_cast<char>(found.smallest)};
    write_all(pipe, head, sizeof head);
    write_all(pipe, found.sites.data(), found.sites.size() * sizeof(cuda::ContractionSite));
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

// Reads what the child writes, until it closes the pipe or stays silent for `seconds`.   Returns: whether it closed the
// pipe.
bool read_to_end(int pipe, double seconds, std::string& tail) {
  for (;;) {
    pollfd waits{pipe, POLLIN, 0};
    const int ready = poll(&waits, 1, static_cast<int>(std::ceil(seconds * 1000)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    char bytes[4096];
    const ssize_t count = read(pipe, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    const char* end = bytes + count;
    const char* begin = bytes;
    if (tail.empty()) {
      while (begin != end && *begin == kAsked) ++begin;
    }
    tail.append(begin, end);
  }
}

}  // namespace

Blame blame_apart(const Lane& lane, const Pair& pair, double seconds) {
  static std::mutex starting;  // no other child may inherit the write end of this pipe
  std::unique_lock lock(starting);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(
        cannot("explain", lane.id, "no pipe to another process: " + std::generic_category().message(errno)));
  const pid_t parent = getpid(), child = fork();
  const int error = errno;  // fork's errno, if it failed
  if (child == 0) search(ends[1], lane, pair, parent);
  close(ends[1]);
  lock.unlock();
  std::string tail;
  const bool in_time = child > 0 && read_to_end(ends[0], seconds, tail);
  close(ends[0]);
  if (child < 0)
    throw std::runtime_error(cannot("explain", lane.id, "no other process: " + std::generic_category().message(error)));
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  Blame result;
  if (!in_time) {
    result.why_not = "with some of its products fused it does not come back";
  } else if (tail.size() < 2 || status != 0) {
    result.why_not = "with some of its products fused it crashes";
  } else {
    result.smallest = tail[1] != 0;
    result.sites.resize((tail.size() - 2) / sizeof(cuda::ContractionSite));
    std::memcpy(result.sites.data(), tail.data() + 2, result.sites.size() * sizeof(cuda::ContractionSite));
  }
  return result;
}

}  // namespace graze::analysis
