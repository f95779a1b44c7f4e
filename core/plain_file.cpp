// SPDX-License-Identifier: Apache-2.0
#include "core/plain_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/stop.h"

namespace graze {
namespace {

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

// Opens a regular file.   Returns: its descriptor; or -1, with the reason in `why`.
int opened(const std::filesystem::path& file, struct stat& state, std::string& why) {
  const int number = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (number >= 0 && fstat(number, &state) == 0 && S_ISREG(state.st_mode)) return number;
  why = number < 0 ? std::strerror(errno) : S_ISDIR(state.st_mode) ? std::strerror(EISDIR) : "it is not a regular file";
  if (number >= 0) close(number);
  return -1;
}

}  // namespace

std::optional<std::string> plain_file(const std::filesystem::path& file, std::string& why, std::size_t most) {
  constexpr std::size_t kPart = std::size_t{1} << 20;
  struct stat state {};
  const Descriptor in{opened(file, state, why)};
  if (in.number < 0) return std::nullopt;
  std::string bytes;
  bool fits = static_cast<std::size_t>(state.st_size) <= most;
  while (fits) {
    if (stop_requested) throw Stopped();
    const std::size_t before = bytes.size();
    bytes.resize(before + kPart);
    const ssize_t count = read(in.number, bytes.data() + before, kPart);
    bytes.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
    if (count == 0) return bytes;
    if (count < 0 && errno != EINTR) {
      why = std::strerror(errno);
      return std::nullopt;
    }
    fits = bytes.size() <= most;
  }
  why = "it is larger than " + std::to_string(most >> 20) + " MiB";
  return std::nullopt;
}

std::string beginning_of(const std::filesystem::path& file, std::size_t most) {
  struct stat state {};
  std::string why, bytes(most, '\0');
  const Descriptor in{opened(file, state, why)};
  const ssize_t count = in.number < 0 ? 0 : read(in.number, bytes.data(), most);
  bytes.resize(static_cast<std::size_t>(count > 0 ? count : 0));
  return bytes;
}

}  // namespace graze
