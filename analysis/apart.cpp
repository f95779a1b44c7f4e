// SPDX-License-Identifier: Apache-2.0
#include "analysis/apart.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "core/cannot.h"
#include "core/programs/child.h"

namespace graze::analysis {
namespace {

// The child's messages: kAlive before each step; kDone and the result at the end.
constexpr char kAlive = 0, kDone = 1;

// Reads the child's output until the child closes the pipe or writes nothing for `seconds`.   Returns: whether it
// closed the pipe.
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
      while (begin != end && *begin == kAlive) ++begin;
    }
    tail.append(begin, end);
  }
}

}  // namespace

void ApartFrom::alive() const { write_all(pipe_, &kAlive, 1); }

void ApartFrom::finish(const void* result, std::size_t size) const {
  write_all(pipe_, &kDone, 1);
  write_all(pipe_, result, size);
}

Ended run_apart(const Lane& lane, double seconds, const std::function<void(const ApartFrom&)>& work,
                std::string& result) {
  std::optional<Child> child;
  try {
    child.emplace([&](int pipe) {
      for (const int caught : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) signal(caught, SIG_DFL);
      const rlimit no_core{0, 0};
      setrlimit(RLIMIT_CORE, &no_core);
      work(ApartFrom(pipe));
    });
  } catch (const std::system_error& error) {
    throw std::runtime_error(cannot("examine", lane.id, error.what()));
  }
  std::string tail;
  const bool in_time = read_to_end(child->pipe(), seconds, tail);
  if (!in_time) child->kill();
  const bool succeeded = child->succeeded();
  if (!in_time) return Ended::silent;
  if (tail.empty() || !succeeded) return Ended::crashed;
  result = tail.substr(1);
  return Ended::in_order;
}

}  // namespace graze::analysis
