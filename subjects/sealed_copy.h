// SPDX-License-Identifier: Apache-2.0
// An in-memory copy of code, which nobody can change. So Graze loads exactly the bytes that it verified, even if the
// file changes in the meantime.
#pragma once

#include <string>
#include <string_view>

namespace graze::subjects {

class SealedCopy {
 public:
  // name: shown for the copy in a process's list of mappings.   Throws: std::system_error.
  SealedCopy(const std::string& name, std::string_view bytes);
  ~SealedCopy();
  SealedCopy(const SealedCopy&) = delete;
  SealedCopy& operator=(const SealedCopy&) = delete;
  int fd() const { return fd_; }
  // The path at which this process can open the copy, as long as this object exists.
  std::string file() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

}  // namespace graze::subjects
