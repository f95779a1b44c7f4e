// SPDX-License-Identifier: Apache-2.0
// Searches for contractions in foreign code in a child process, which is killed if a verdict takes too long.
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "analysis/blame.h"
#include "core/cannot.h"
#include "core/programs/child.h"

namespace graze::analysis {
namespace {

// The child's messages: kAsked before each verdict; at the end kDone, then whether the set is the smallest, then its
// sites as raw memory. The sites' pointers to text are valid in both processes.
constexpr char kAsked = 0, kDone = 1;

// In the child.
void search(int pipe, const Lane& lane, const Pair& pair) {
  for (const int caught : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) signal(caught, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const Blame found = blame(lane, pair, [pipe] { write_all(pipe, &kAsked, 1); });
  const char head[] = {kDone, static_cast<char>(found.smallest)};
  write_all(pipe, head, sizeof head);
  write_all(pipe, found.sites.data(), found.sites.size() * sizeof(cuda::ContractionSite));
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
  std::optional<Child> child;
  try {
    child.emplace([&](int pipe) { search(pipe, lane, pair); });
  } catch (const std::system_error& error) {
    throw std::runtime_error(cannot("explain", lane.id, error.what()));
  }
  std::string tail;
  const bool in_time = read_to_end(child->pipe(), seconds, tail);
  if (!in_time) child->kill();
  const bool succeeded = child->succeeded();
  Blame result;
  if (!in_time) {
    result.why_not = "with some of its products fused it does not return";
  } else if (tail.size() < 2 || !succeeded) {
    result.why_not = "with some of its products fused it crashes";
  } else {
    result.smallest = tail[1] != 0;
    result.sites.resize((tail.size() - 2) / sizeof(cuda::ContractionSite));
    std::memcpy(result.sites.data(), tail.data() + 2, result.sites.size() * sizeof(cuda::ContractionSite));
  }
  return result;
}

}  // namespace graze::analysis
