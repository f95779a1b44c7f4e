// SPDX-License-Identifier: Apache-2.0
#include "subjects/program_protocol.h"

#define GRAZE_PROGRAM_TYPES_ONLY
#include <graze/program.h>

#include <poll.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace graze::subjects {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

void append(std::vector<char>& bytes, const void* from, std::size_t count) {
  const char* at = static_cast<const char*>(from);
  bytes.insert(bytes.end(), at, at + count);
}

}  // namespace

ProgramProtocol::ProgramProtocol(const std::string& command, double seconds) : pipes_(start_program(command)) {
  static_assert(std::endian::native == std::endian::little);
  graze_hello hello;
  exchange({}, &hello, sizeof hello, seconds);
  if (std::memcmp(hello.greeting, "graze 1\n", sizeof hello.greeting) != 0)
    throw std::runtime_error("the program does not begin with the greeting of graze/program.h");
  if (hello.order != 1)
    throw std::runtime_error("the program's processor is not little-endian; use a little-endian one");
  has_ = hello.has;
}

ProgramProtocol::~ProgramProtocol() {
  close(pipes_.to);
  close(pipes_.from);
}

void ProgramProtocol::ask(const Question& question, const void* pairs, bool in_double, std::uint64_t* words) {
  const std::size_t size = 18 * (in_double ? sizeof(double) : sizeof(float));
  std::vector<std::uint32_t> places;
  for (const bool second : {false, true}) {
    for (std::uint32_t k = 0; k < question.count; ++k) {
      const std::uint32_t i = second ? question.count - 1 - k : k;
      if (is_chosen(second ? question.second : question.first, i)) places.push_back(i << 1 | second);
    }
  }
  const graze_question asked{question.nonce, static_cast<std::uint32_t>(places.size()), in_double};
  std::vector<char> bytes;
  bytes.reserve(sizeof asked + places.size() * (sizeof places[0] + size));
  append(bytes, &asked, sizeof asked);
  append(bytes, places.data(), places.size() * sizeof places[0]);
  for (const std::uint32_t place : places) append(bytes, static_cast<const char*>(pairs) + size * (place >> 1), size);
  std::vector<std::uint64_t> answers(places.size());
  exchange(bytes, answers.data(), answers.size() * sizeof answers[0], kForever);
  for (std::size_t i = 0; i < places.size(); ++i)
    __atomic_store_n(&words[(places[i] & 1 ? kMostAsked : 0) + (places[i] >> 1)], answers[i], __ATOMIC_RELEASE);
}

void ProgramProtocol::exchange(const std::vector<char>& bytes, void* answer, std::size_t count, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  std::size_t sent = 0, received = 0;
  while (received < count) {
    const double left = seconds - std::chrono::duration<double>(Clock::now() - start).count();
    if (left <= 0) throw std::runtime_error("the program does not answer");
    pollfd ready[] = {{sent < bytes.size() ? pipes_.to : -1, POLLOUT, 0}, {pipes_.from, POLLIN, 0}};
    if (poll(ready, 2, left == kForever ? -1 : static_cast<int>(1000 * left) + 1) < 0 && errno != EINTR)
      throw std::runtime_error("waiting for the program failed");
    if (ready[0].revents & (POLLERR | POLLHUP))
      sent = bytes.size();  // the program has closed its input, and may have ended
    if (ready[0].revents & POLLOUT) {
      const ssize_t written = write(pipes_.to, bytes.data() + sent, bytes.size() - sent);
      if (written > 0) sent += static_cast<std::size_t>(written);
    }
    if (!ready[1].revents) continue;
    const ssize_t some = read(pipes_.from, static_cast<char*>(answer) + received, count - received);
    if (some == 0 || (some < 0 && errno != EINTR)) throw std::runtime_error("the program ended");
    if (some > 0) received += static_cast<std::size_t>(some);
  }
}

}  // namespace graze::subjects
