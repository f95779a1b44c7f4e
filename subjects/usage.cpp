// SPDX-License-Identifier: Apache-2.0
#include "subjects/usage.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <system_error>

#include "core/programs/process_state.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

std::vector<pid_t> read_children(const std::string& file) {
  std::ifstream in(file);
  std::vector<pid_t> found;
  for (pid_t child; in >> child;) found.push_back(child);
  return found;
}

// The children of all threads of the process.
std::vector<pid_t> children_of(pid_t process) {
  std::vector<pid_t> found;
  std::error_code error;
  for (fs::directory_iterator task("/proc/" + std::to_string(process) + "/task", error), end; !error && task != end;
       task.increment(error)) {
    for (const pid_t child : read_children(task->path() / "children")) found.push_back(child);
  }
  return found;
}

// The sum, in bytes, of fields that the file gives in KiB.
std::uint64_t bytes_in(const fs::path& file, std::initializer_list<std::string_view> names) {
  std::ifstream in(file);
  std::uint64_t kib = 0;
  for (std::string line; std::getline(in, line);) {
    for (const std::string_view name : names) {
      if (line.starts_with(name)) kib += std::strtoull(line.c_str() + name.size(), nullptr, 10);
    }
  }
  return kib << 10;
}

// The folder in /proc that shows a process's memory: another thread's if the first thread has ended.
fs::path memory_folder(pid_t process) {
  const fs::path folder = "/proc/" + std::to_string(process);
  std::error_code error;
  if (process_state(process) == 'Z') {
    for (fs::directory_iterator task(folder / "task", error), end; !error && task != end; task.increment(error)) {
      const std::string thread = task->path().filename();
      if (process_state(std::stoi(thread)) != 'Z') return "/proc/" + thread;
    }
  }
  return folder;
}

// Memory that several processes can map, such as MAP_SHARED | MAP_ANONYMOUS: bytes by inode. All memory of an inode
// stays allocated while any part is mapped, even if no page table shows it.
using Shared = std::map<std::uint64_t, std::uint64_t>;

// The device number of the file system that holds shared memory, including files of memfd_create.
dev_t shared_device() {
  struct stat file {};
  const int fd = memfd_create("graze-device", MFD_CLOEXEC);
  if (fd < 0 || fstat(fd, &file) != 0) file.st_dev = 0;
  if (fd >= 0) close(fd);
  return file.st_dev;
}

// Adds to `shared` the shared memory that the process maps.   Returns: the bytes that were not counted before.
std::uint64_t add_shared(std::ifstream& maps, const fs::path& folder, Shared& shared) {
  static const dev_t device = shared_device();
  std::uint64_t more = 0;
  for (std::string line; std::getline(maps, line);) {
    unsigned long from = 0, to = 0, offset = 0, inode = 0;
    unsigned of_major = 0, of_minor = 0;
    char flags[5] = {};
    if (std::sscanf(line.c_str(), "%lx-%lx %4s %lx %x:%x %lu", &from, &to, flags, &offset, &of_major, &of_minor,
                    &inode) != 7 ||
        flags[3] != 's' || makedev(of_major, of_minor) != device)
      continue;
    // Only root may ask for the bytes in use. If another user runs Graze, all bytes up to the end of the mapping count.
    struct stat file {};
    char name[64];
    std::snprintf(name, sizeof name, "map_files/%lx-%lx", from, to);
    const std::uint64_t bytes = stat((folder / name).c_str(), &file) == 0
                                    ? 512 * static_cast<std::uint64_t>(file.st_blocks)
                                    : offset + (to - from);
    std::uint64_t& known = shared[inode];
    more += bytes - std::min(bytes, known);
    known = std::max(bytes, known);
  }
  return more;
}

// A process's memory, with page tables but without shared memory. Counts files' pages fully, which is fast. If the sum
// exceeds `most`, counts only the process's share of each page.
std::uint64_t bytes_of(const fs::path& folder, std::uint64_t most) {
  const std::uint64_t whole = bytes_in(folder / "status", {"RssAnon:", "RssFile:", "VmSwap:", "VmPTE:"});
  if (whole <= most) return whole;
  return bytes_in(folder / "smaps_rollup", {"Pss_Anon:", "Pss_File:", "SwapPss:"}) +
         bytes_in(folder / "status", {"VmPTE:"});
}

// The number of descriptors in a folder of /proc. If the process hides the folder, assumes the limit.
std::uint64_t descriptors_in(const fs::path& folder) {
  std::error_code error;
  std::uint64_t count = 0;
  for (fs::directory_iterator file(folder, error), end; !error && file != end; file.increment(error)) ++count;
  return error == std::errc::permission_denied ? kDescriptorsOfAProcess : count;
}

}  // namespace

std::vector<pid_t> own_children() { return read_children("/proc/thread-self/children"); }

std::vector<pid_t> descendants(std::uint64_t most, pid_t except) {
  std::vector<pid_t> all = own_children();
  std::erase(all, except);
  for (std::size_t next = 0; next < all.size() && all.size() <= most; ++next) {
    for (const pid_t child : children_of(all[next])) all.push_back(child);
  }
  return all;
}

double processor_seconds(pid_t process) {
  clockid_t clock;
  timespec taken{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &taken) != 0) return 0;
  return static_cast<double>(taken.tv_sec) + 1e-9 * static_cast<double>(taken.tv_nsec);
}

Activity activity_of_descendants(std::uint64_t most) {
  Activity activity;
  for (const pid_t process : descendants(most)) {
    activity.wants_processor |= process_state(process) == 'R';
    activity.seconds += processor_seconds(process);
  }
  return activity;
}

Usage usage_of_descendants(const Usage& most) {
  // Checks the number of processes first, because reading the memory of a thousand running processes would take too
  // long.
  const std::vector<pid_t> all = descendants(most.processes);
  Usage usage{all.size(), 0, 0};
  Shared shared;
  for (const pid_t process : all) {
    if (!usage.within(most)) break;
    const fs::path folder = memory_folder(process);
    usage.descriptors += descriptors_in(folder / "fd");
    std::ifstream maps(folder / "maps");
    if (!maps && errno == EACCES) {  // if a process hides its mappings, its whole address space counts
      usage.bytes += bytes_in(folder / "status", {"VmSize:", "VmSwap:", "VmPTE:"});
    } else {
      usage.bytes += add_shared(maps, folder, shared);
      // Counts only shares of files' pages if whole pages would take more than half of the remaining limit.
      usage.bytes += bytes_of(folder, most.bytes > usage.bytes ? (most.bytes - usage.bytes) / 2 : 0);
    }
  }
  return usage;
}

}  // namespace graze::subjects
