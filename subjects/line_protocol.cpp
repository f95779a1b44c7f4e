// SPDX-License-Identifier: Apache-2.0
#include "subjects/line_protocol.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "core/text.h"

namespace graze::subjects {
namespace {

constexpr double kDescribeSeconds = 10;  // the time for a program to start and describe itself
constexpr int kSilence = 2;              // milliseconds to wait for output after the last answer

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

void Lines::add(const char* bytes, std::size_t count) {
  bytes_.erase(0, taken_);
  taken_ = 0;
  bytes_.append(bytes, count);
  if (bytes_.size() > kMostBytes) throw std::runtime_error("the program writes output that was not requested");
}

bool Lines::take(std::string& line) {
  const std::size_t end = bytes_.find('\n', taken_);
  if (end == bytes_.npos) return false;
  line = bytes_.substr(taken_, end - taken_);
  if (line.ends_with('\r')) line.pop_back();
  taken_ = end + 1;
  return true;
}

signed char answer_of_line(const std::string& line) {
  if (line == "0") return kDisjoint;
  if (line == "1") return kIntersects;
  if (line == "?") return kDeclined;
  throw std::runtime_error(fmt::format("expected an answer 0, 1 or ?, found {}", shown(line)));
}

Pipes start_program(const std::string& command) {
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0)
    throw std::runtime_error(fmt::format("cannot make a pipe to '{}': {}", command, std::strerror(errno)));
  std::signal(SIGPIPE, SIG_IGN);
  const pid_t worker = getpid(), program = fork();
  if (program < 0) throw std::runtime_error(fmt::format("cannot start '{}': {}", command, std::strerror(errno)));
  if (program == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != worker) _exit(0);
    std::signal(SIGPIPE, SIG_DFL);
    dup2(to[0], STDIN_FILENO);
    dup2(from[1], STDOUT_FILENO);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  fcntl(to[1], F_SETFL, O_NONBLOCK);
  return {to[1], from[0]};
}

void LineProtocol::read_some() {
  char bytes[4096];
  const ssize_t count = read(pipes_.from, bytes, sizeof bytes);
  if (count == 0 || (count < 0 && errno != EINTR)) throw std::runtime_error("the program ended");
  if (count > 0) lines_.add(bytes, static_cast<std::size_t>(count));
}

// Writes the lines and reads at the same time, so that a full pipe causes no deadlock.
void LineProtocol::send(const std::string& lines) {
  expect_silence(0);
  std::size_t sent = 0;
  while (sent < lines.size()) {
    pollfd ready[] = {{pipes_.to, POLLOUT, 0}, {pipes_.from, POLLIN, 0}};
    poll(ready, 2, -1);
    if (ready[1].revents & POLLIN) read_some();
    if (ready[0].revents & (POLLERR | POLLHUP))
      return;  // the program has closed its input; its earlier answers still count
    if (!(ready[0].revents & POLLOUT)) continue;
    const ssize_t count = write(pipes_.to, lines.data() + sent, lines.size() - sent);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
}

std::string LineProtocol::line() {
  std::string line;
  while (!lines_.take(line)) read_some();
  return line;
}

void LineProtocol::expect_silence(int milliseconds) {
  pollfd more{pipes_.from, POLLIN, 0};
  if (!lines_.empty() || (poll(&more, 1, milliseconds) > 0 && more.revents & POLLIN))
    throw std::runtime_error("the program writes output that was not requested");
}

void LineProtocol::ask(const Question& question, const float* pairs, std::uint64_t* words) {
  for (const bool second : {false, true}) {
    const Chosen& chosen = second ? question.second : question.first;
    std::string asked;
    for (std::size_t k = 0; k < question.count; ++k) {
      const std::size_t i = second ? question.count - 1 - k : k;
      if (!is_chosen(chosen, i)) continue;
      asked += line_of(pairs + 18 * i);
      if (!question.singly) continue;
      send(asked);
      asked.clear();
      put_answer(words, question, second, i, answer_of_line(line()));
    }
    if (question.singly) continue;
    send(asked);
    for (std::size_t k = 0; k < question.count; ++k) {
      const std::size_t i = second ? question.count - 1 - k : k;
      if (is_chosen(chosen, i)) put_answer(words, question, second, i, answer_of_line(line()));
    }
  }
  expect_silence(kSilence);
}

std::string described_by(const std::string& command) {
  const Pipes pipes = start_program(command);
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(kDescribeSeconds);
  constexpr std::string_view kAsked = "describe\n";
  if (write(pipes.to, kAsked.data(), kAsked.size()) < 0) return "";
  close(pipes.to);
  Lines lines;
  std::string line;
  std::size_t bytes = 0;
  while (!lines.take(line)) {
    const std::chrono::duration<double> left = until - std::chrono::steady_clock::now();
    pollfd ready{pipes.from, POLLIN, 0};
    if (left.count() <= 0 || poll(&ready, 1, static_cast<int>(1000 * left.count()) + 1) <= 0) return kNoAnswer;
    char some[4096];
    const ssize_t count = read(pipes.from, some, sizeof some);
    if (count <= 0) return "";
    if ((bytes += static_cast<std::size_t>(count)) >= sizeof(Loaded::text)) return kLongAnswer;
    lines.add(some, static_cast<std::size_t>(count));
  }
  return line;
}

}  // namespace graze::subjects
