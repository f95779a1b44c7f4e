// SPDX-License-Identifier: Apache-2.0
// A copy of code in memory that nobody can change any more: what was verified is what is loaded, whatever happens to
// the file meanwhile.
#pragma once

#include <string>
#include <string_view>

namespace graze::subjects {

class SealedCopy {
 public:
  // name: shown in the list of a process's mappings.   Throws: std::system_error.
  SealedCopy(const std::string& name, std::string_view bytes);
  ~SealedCopy();
  SealedCopy(const SealedCopy&) = delete;
  SealedCopy& operator=(const SealedCopy&) = delete;
  int fd() const { return fd_; }
  // A file name of the copy in this process, valid as long as the copy lives.
  std::string file() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

}  // namespace graze::subjects
