// SPDX-License-Identifier: Apache-2.0
// Graze's side of graze-subject-host, the supervisor of programs that graze did not write (see subjects/README.md). The
// supervisor's file is in the folder of the running program.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace graze {

// While graze waits, the supervisor sends this one-byte message at least once a second.
inline constexpr char kAlive = 1;

// A build tool's supervisor reports this value in place of an exit status.
inline constexpr int kTookTooMuchMemory = -2;

// The path of a program that is in the same folder as the running program.
std::filesystem::path beside_this(const std::string& program);

// Descriptors of the programs that a SupervisorProcess starts; -1 for a missing program. They are opened before any
// foreign code runs, so that foreign code cannot replace the programs.
const std::array<int, 2>& program_files();

class SupervisorProcess {
 public:
  // program: the supervisor's file name, in the folder of the running program. The supervisor gets one end of a socket
  // as descriptor 3, and `shared` from 4 on. output: the descriptor for its output; -1 for /dev/null.
  // Throws: std::system_error.
  SupervisorProcess(const std::string& program, const std::vector<std::string>& arguments,
                    const std::vector<int>& shared, int output);
  // Closes our end of the socket; the supervisor then ends everything that it started. Kills the supervisor if it is
  // silent for 10 s. After a request to stop, waits only 1 s and then leaves the supervisor to end by itself.
  ~SupervisorProcess();
  SupervisorProcess(const SupervisorProcess&) = delete;
  SupervisorProcess& operator=(const SupervisorProcess&) = delete;

  bool send(const void* message, std::size_t size) const;

  // Waits for a message of more than one byte.
  // Returns: the message's size; at most 0 if the supervisor ended, is stopped or is silent.   Throws: Stopped.
  ssize_t receive(void* to, std::size_t size);

  // Whether `receive` failed because the supervisor was stopped or silent.
  bool stopped() const { return stopped_ || silent_; }

  // Whether `receive` failed because the supervisor was silent for 10 s, perhaps because it is frozen.
  bool silent() const { return silent_; }

 private:
  int socket_ = -1;
  pid_t process_ = -1;
  bool stopped_ = false, silent_ = false;
};

}  // namespace graze
