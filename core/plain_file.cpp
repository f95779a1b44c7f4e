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

}  // namespace

std::optional<std::string> plain_file(const std::filesystem::path& file, std::string& why, std::size_t most) {
  constexpr std::size_t kPart = std::size_t{1} << 20;
  const std::string too_large = "it is larger than " + std::to_string(most >> 20) + " MiB";
  const Descriptor in{open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
  struct stat state {};
  const auto nothing = [&why](std::string reason) {
    why = std::move(reason);
    return std::nullopt;
  };
  if (in.number < 0 || fstat(in.number, &state) != 0) return nothing(std::strerror(errno));
  if (S_ISDIR(state.st_mode)) return nothing(std::strerror(EISDIR));
  if (!S_ISREG(state.st_mode)) return nothing("it is not a regular file");
  if (static_cast<std::size_t>(state.st_size) > most) return nothing(too_large);
  std::string bytes;
  while (true) {
    if (stop_requested) throw Stopped();
    const std::size_t before = bytes.size();
    bytes.resize(before + kPart);
    const ssize_t count = read(in.number, bytes.data() + before, kPart);
    bytes.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
    if (count == 0) return bytes;
    if (count < 0 && errno != EINTR) return nothing(std::strerror(errno));
    if (bytes.size() > most) return nothing(too_large);
  }
}

}  // namespace graze
