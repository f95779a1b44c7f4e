// SPDX-License-Identifier: Apache-2.0
// A child process for work that may crash or never end. The child's output arrives through a pipe.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>

namespace graze {

class Child {
 public:
  // Runs work(pipe) in the child, which then exits with 0, or with 1 if the work throws. The child ends when this
  // process ends.   Throws: std::system_error.
  explicit Child(const std::function<void(int pipe)>& work);
  ~Child();  // kills the child, unless `succeeded` was called
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // The pipe's read end. Reads return end of file once the child has closed its end.
  int pipe() const { return pipe_; }
  void kill() const;
  // Waits for the child to end.   Returns: whether it exited with 0.
  bool succeeded();

 private:
  int pipe_ = -1;
  pid_t process_ = -1;
};

// Called in the child: writes all bytes, or exits with 1.
void write_all(int pipe, const void* data, std::size_t size);

}  // namespace graze
