// SPDX-License-Identifier: Apache-2.0
// graze-subject-host, beside the running program: the supervisor of programs that graze did not write. This is graze's
// end of it; subjects/README.md has the other.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace graze {

// While graze waits for it, the supervisor sends this message at least once a second, of one byte.
inline constexpr char kAlive = 1;

class SupervisorProcess {
 public:
  // program: its file's name, in the folder of the running program. It has its end of a socket as descriptor 3, and
  // those of `shared` from 4 on. It writes to `output`, or to /dev/null for -1.   Throws: std::system_error.
  SupervisorProcess(const std::string& program, const std::vector<std::string>& arguments,
                    const std::vector<int>& shared, int output);
  // The supervisor ends all that it started when the socket closes. One that does not end within 6 s is killed; after a
  // request to stop, it is left to end by itself after 1 s.
  ~SupervisorProcess();
  SupervisorProcess(const SupervisorProcess&) = delete;
  SupervisorProcess& operator=(const SupervisorProcess&) = delete;

  bool send(const void* message, std::size_t size) const;

  // Waits for a message of more than one byte.
  // Returns: its bytes; at most 0 where the supervisor ended, is stopped or is silent.   Throws: Stopped.
  ssize_t receive(void* to, std::size_t size);

  // Whether that was so because it was silent for 10 s, as one that is frozen is.
  bool silent() const { return silent_; }

 private:
  int socket_ = -1;
  pid_t process_ = -1;
  bool silent_ = false;
};

}  // namespace graze
