// SPDX-License-Identifier: Apache-2.0
#include "core/programs/run_program.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "core/cannot.h"
#include "core/programs/supervisor_process.h"
#include "core/stop.h"
#include "core/text.h"

namespace graze {

namespace fs = std::filesystem;

namespace {

int open_folder(const fs::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

void remove_if_left(const fs::directory_entry& folder) {
  std::error_code none;
  const int lock = open_folder(folder.path());
  const bool is_locked = lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0;
  const bool has_locks = is_locked || errno == EWOULDBLOCK;
  const auto written = folder.last_write_time(none);
  const bool is_old = !none && fs::file_time_type::clock::now() - written > std::chrono::hours(24);
  if (lock >= 0 && (is_locked || (!has_locks && is_old))) fs::remove_all(folder.path(), none);
  if (lock >= 0) close(lock);
}

}  // namespace

Scratch::Scratch(const fs::path& within) {
  fs::create_directories(within);
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(within, none)) {
    if (entry.path().filename().string().starts_with("unfinished-")) remove_if_left(entry);
  }
  // Until the folder is locked, another process may remove it as a leftover.
  do {
    if (lock_ >= 0) close(lock_);
    std::string name = (within / "unfinished-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error(cannot("make the folder", name, errno));
    path_ = name;
    lock_ = open_folder(path_);
    if (lock_ >= 0) flock(lock_, LOCK_EX);
  } while (!fs::exists(path_, none));
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

int run_program(const Program& program, const fs::path& scratch, std::string& output) {
  const StopSignals stops;
  const std::string log = scratch / "output.txt";
  const int to = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (to < 0) throw std::runtime_error(cannot("write", log, errno));
  std::vector<std::string> arguments{"--run", std::to_string(program.seconds), scratch, program.namespaces ? "1" : "0",
                                     std::to_string(program.mib)};
  arguments.insert(arguments.end(), program.words.begin(), program.words.end());
  SupervisorProcess supervisor("graze-subject-host", arguments, {}, to);
  close(to);
  std::string text;  // for a message
  for (const std::string& word : program.words) text += (text.empty() ? "" : " ") + word;
  int status = -1;
  if (supervisor.receive(&status, sizeof status) != sizeof status) {
    // Ctrl+C goes to every process of the terminal. The supervisor may end before our own signal arrives.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (stop_requested) throw Stopped();
    throw std::runtime_error(shown(text) + ": its supervisor ended before it did");
  }
  if (status == kTookTooMuchMemory)
    throw std::runtime_error(shown(text) + ": used more than " + std::to_string(program.mib) +
                             " MiB of memory, so it was killed");
  if (status < 0)
    throw std::runtime_error(shown(text) + ": not finished within " + rounded_up(program.seconds, 4) +
                             " s, so it was killed");
  std::ifstream in(log, std::ios::binary);
  output.assign(std::istreambuf_iterator<char>(in), {});
  return status;
}

fs::path on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  if (!path) return {};
  std::istringstream folders(std::string(path) + ':');
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code none;
    const fs::path file = fs::path(folder) / program;
    if (fs::is_regular_file(file, none) && access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

std::string shell_output(const std::string& command, const fs::path& scratch, int& status, double seconds) {
  std::string text;
  status = run_program({{"/bin/sh", "-c", command}, seconds}, scratch, text);
  return text;
}

}  // namespace graze
