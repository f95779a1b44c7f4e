// SPDX-License-Identifier: Apache-2.0
#include "subjects/line_protocol.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "core/text.h"
#include "subjects/channel.h"

namespace graze::subjects {
namespace {

std::string line_of(const float* pair) {
  std::string line;
  for (int i = 0; i < 18; ++i) {
    char number[40];
    std::snprintf(number, sizeof number, "%a", static_cast<double>(pair[i]));
    line += number;
    line += i < 17 ? ' ' : '\n';
  }
  return line;
}

}  // namespace

LineProtocol::LineProtocol(const std::string& command) {
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("expected a pipe, found none");
  std::signal(SIGPIPE, SIG_IGN);
  const pid_t worker = getpid();
  if (fork() == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != worker) _exit(0);
    dup2(to[0], STDIN_FILENO);
    dup2(from[1], STDOUT_FILENO);
    for (const int inherited : {kChannelFd, kPairsFd, kSocketFd}) close(inherited);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  to_ = to[1];
  from_ = from[0];
  fcntl(to_, F_SETFL, O_NONBLOCK);
}

// Writes while it reads, so that neither side waits for the other with a full pipe.
void LineProtocol::send(const std::string& lines) {
  std::size_t sent = 0;
  while (sent < lines.size()) {
    pollfd ready[] = {{to_, POLLOUT, 0}, {from_, POLLIN, 0}};
    poll(ready, 2, -1);
    if (ready[1].revents & POLLIN) {
      char bytes[4096];
      const ssize_t count = read(from_, bytes, sizeof bytes);
      if (count > 0) read_.append(bytes, static_cast<std::size_t>(count));
    }
    if (ready[0].revents & POLLOUT) {
      const ssize_t count = write(to_, lines.data() + sent, lines.size() - sent);
      if (count > 0) sent += static_cast<std::size_t>(count);
    } else if (ready[0].revents & (POLLERR | POLLHUP)) {
      return;  // it reads no more; what it has answered still counts
    }
  }
}

signed char LineProtocol::answer() {
  std::size_t end;
  while ((end = read_.find('\n')) == read_.npos) {
    char bytes[4096];
    const ssize_t count = read(from_, bytes, sizeof bytes);
    if (count <= 0) throw std::runtime_error("the program ended");
    read_.append(bytes, static_cast<std::size_t>(count));
  }
  std::string line = read_.substr(0, end);
  read_.erase(0, end + 1);
  if (line.ends_with('\r')) line.pop_back();
  if (line == "0") return kDisjoint;
  if (line == "1") return kIntersects;
  if (line == "?") return kDeclined;
  throw std::runtime_error(fmt::format("expected an answer 0, 1 or ?, found {}", shown(line)));
}

void LineProtocol::ask(bool singly, const float* pairs, std::uint64_t count, volatile std::uint64_t& next,
                       volatile std::uint32_t& second, signed char* answers) {
  if (!second) {
    for (std::uint64_t begin = next; begin < count;) {
      const std::uint64_t end = singly ? begin + 1 : count;
      std::string lines;
      for (std::uint64_t i = begin; i < end; ++i) lines += line_of(pairs + 18 * i);
      send(lines);
      for (; begin < end; ++begin) {
        next = begin;
        answers[begin] = answer();
      }
    }
    next = count - 1;
    second = 1;
  }
  for (std::uint64_t end = next + 1; end > 0;) {
    const std::uint64_t begin = singly ? end - 1 : 0;
    std::string lines;
    for (std::uint64_t i = end; i-- > begin;) {
      if (answers[i] <= kIntersects) lines += line_of(pairs + 18 * i);
    }
    send(lines);
    for (; end > begin; --end) {
      next = end - 1;
      if (answers[end - 1] > kIntersects) continue;
      if (answer() != answers[end - 1]) answers[end - 1] = kUnstable;
    }
  }
}

}  // namespace graze::subjects
