// SPDX-License-Identifier: Apache-2.0
#include "subjects/containment.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/capability.h>
#include <linux/filter.h>
#include <linux/magic.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/vfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// In a new user namespace, gives an unprivileged user privileges under the same user id.
bool map_user(uid_t user, gid_t group) {
  const auto write_to = [](const char* file, const std::string& text) {
    const int fd = open(file, O_WRONLY | O_CLOEXEC);
    const bool written = fd >= 0 && write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(fd);
    return written;
  };
  const std::string u = std::to_string(user), g = std::to_string(group);
  return write_to("/proc/self/setgroups", "deny") && write_to("/proc/self/uid_map", u + ' ' + u + " 1") &&
         write_to("/proc/self/gid_map", g + ' ' + g + " 1");
}

bool has_terminals() {
  struct statfs at {};
  return statfs("/dev/pts", &at) == 0 && at.f_type == DEVPTS_SUPER_MAGIC;
}

// In the new namespace: hides its mounts from outside. In a chroot, "/" is not a mount point, but the others are.
bool keep_mounts_private() {
  const auto keep = [](const char* place) { return mount("none", place, nullptr, MS_REC | MS_PRIVATE, nullptr) == 0; };
  return keep("/") ||
         (keep("/proc") && (keep("/dev/shm") || errno == ENOENT) && (!has_terminals() || keep("/dev/pts")));
}

// The terminals of the parent process that are not below /dev/pts, such as a console. Hiding /dev/pts leaves them.
std::vector<std::string> terminals_of_parent() {
  std::vector<std::string> found;
  for (const char* name : {"0", "1", "2"}) {
    std::error_code none;
    const fs::path file = fs::read_symlink("/proc/" + std::to_string(getppid()) + "/fd/" + name, none);
    if (!fs::is_character_file(file, none)) continue;
    const int fd = open(file.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd >= 0 && isatty(fd) && !file.string().starts_with("/dev/pts/")) found.push_back(file);
    close(fd);
  }
  return found;
}

// In the new namespace: hides the terminals. Code that stops a terminal's output or takes its input would stop graze.
bool hide_terminals(const std::vector<std::string>& others) {
  if (has_terminals() &&
      mount("tmpfs", "/dev/pts", "tmpfs", MS_RDONLY | MS_NOSUID | MS_NODEV | MS_NOEXEC, "size=4k") != 0)
    return false;
  return std::all_of(others.begin(), others.end(), [](const std::string& file) {
    const bool is_private = mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;  // fails in a chroot
    return is_private && mount("/dev/null", file.c_str(), nullptr, MS_BIND, nullptr) == 0;
  });
}

// The mount points of control groups, from the system's list of mounts, which writes spaces and similar as \040.
std::vector<std::string> control_groups() {
  std::vector<std::string> found;
  std::ifstream in("/proc/self/mountinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t type = line.find(" - cgroup");  // and cgroup2
    if (type == line.npos) continue;
    std::istringstream words(line);
    std::string skipped, written, place;
    words >> skipped >> skipped >> skipped >> skipped >> written;
    for (std::size_t i = 0; i < written.size(); ++i) {
      const bool escaped = written[i] == '\\' && i + 3 < written.size();
      place.push_back(escaped ? static_cast<char>(std::stoi(written.substr(i + 1, 3), nullptr, 8)) : written[i]);
      i += escaped ? 3 : 0;
    }
    found.push_back(place);
  }
  return found;
}

// In the new namespace: root, or a user who owns some of the groups, could use them to freeze the supervisor or take
// its memory and processor.
bool hide_control_groups() {
  for (const std::string& place : control_groups()) {
    // A mount on top of a shared mount, as in a chroot, would be visible outside.
    if (mount("none", place.c_str(), nullptr, MS_PRIVATE, nullptr) != 0 &&
        (errno == ENOENT || errno == EINVAL || errno == EACCES))
      continue;  // it is hidden by another mount, or not accessible
    if (mount("tmpfs", place.c_str(), "tmpfs", MS_RDONLY | MS_NOSUID | MS_NODEV | MS_NOEXEC, "size=4k") != 0)
      return false;
  }
  return true;
}

// In the new namespace, where possible. In a chroot it is not: mounts made there would be visible outside.
void make_read_only(const std::string& folder) {
  const char* at = folder.c_str();
  struct statvfs now {};
  if (folder.empty() || statvfs(at, &now) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
    return;
  unsigned long flags = MS_BIND | MS_REMOUNT | MS_RDONLY;  // plus the mount's flags, which a user may not remove
  if (now.f_flag & ST_NOSUID) flags |= MS_NOSUID;
  if (now.f_flag & ST_NODEV) flags |= MS_NODEV;
  if (now.f_flag & ST_NOEXEC) flags |= MS_NOEXEC;
  if (mount(at, at, nullptr, MS_BIND, nullptr) == 0) mount("none", at, nullptr, flags, nullptr);
}

// In the new namespace: mounts its own /proc, without which its processes could not be found.
bool mount_proc() {
  return mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr) == 0 &&
         fs::exists("/proc/thread-self/children");
}

// In the new namespace: named shared memory, of System V and of POSIX, gets a limit and ends with the namespace.
bool limit_shared_memory(std::uint64_t bytes) {
  std::ofstream("/proc/sys/kernel/shmall") << bytes / static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return mount("tmpfs", "/dev/shm", "tmpfs", MS_NOSUID | MS_NODEV, ("size=" + std::to_string(bytes)).c_str()) == 0 ||
         errno == ENOENT;
}

// Most tasks, threads included. Stops code that starts more tasks between two checks than the machine can hold.
constexpr int kMostTasks = 1024;

// Since Linux 6.14 a process namespace has its own pid_max; before, it applied to the whole machine. Root has no other
// limit. A user has a limit for all tasks in a user namespace.
void limit_tasks() {
  utsname system{};
  int major = 0, minor = 0;
  if (uname(&system) == 0 && std::sscanf(system.release, "%d.%d", &major, &minor) == 2 &&
      (major > 6 || (major == 6 && minor >= 14)))
    std::ofstream("/proc/sys/kernel/pid_max") << 300 + kMostTasks;  // the first 300 ids are used only once
  const rlimit most{kMostTasks, kMostTasks};
  if (geteuid() != 0) setrlimit(RLIMIT_NPROC, &most);
}

[[noreturn]] void guard(pid_t supervisor) {
  close_range(0, ~0u, 0);  // closes the socket, so that graze sees when the supervisor ends, and the converse
  while (waitpid(supervisor, nullptr, 0) < 0 && errno == EINTR) {
  }
  _exit(0);
}

std::vector<pid_t> read_children(const std::string& file) {
  std::ifstream in(file);
  std::vector<pid_t> found;
  for (pid_t child; in >> child;) found.push_back(child);
  return found;
}

std::vector<pid_t> own_children() { return read_children("/proc/thread-self/children"); }

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

std::uint64_t field_kib(const fs::path& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(name)) return std::strtoull(line.c_str() + name.size(), nullptr, 10);
  }
  return 0;
}

// Memory of a process. Counts whole pages first, which is fast; if that exceeds `most`, counts shares of shared pages.
std::uint64_t bytes_of(pid_t process, std::uint64_t most) {
  const fs::path folder = "/proc/" + std::to_string(process);
  const std::uint64_t resident = field_kib(folder / "status", "VmRSS:") << 10;
  return resident <= most ? resident : field_kib(folder / "smaps_rollup", "Pss:") << 10;
}

}  // namespace

void enter_containment(bool namespaces, std::uint64_t shared_bytes, const std::string& read_only) {
  const uid_t user = geteuid();
  const gid_t group = getegid();
  const std::vector<std::string> terminals = terminals_of_parent();
  int answer[2];
  if (namespaces && pipe2(answer, O_CLOEXEC) == 0) {
    const unsigned long flags = CLONE_NEWPID | CLONE_NEWNS | CLONE_NEWIPC | (user == 0 ? 0 : CLONE_NEWUSER) | SIGCHLD;
    const auto supervisor = static_cast<pid_t>(syscall(SYS_clone, flags, nullptr, nullptr, nullptr, nullptr));
    if (supervisor == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      close(answer[0]);
      const bool ready = (user == 0 || map_user(user, group)) && keep_mounts_private() && mount_proc() &&
                         limit_shared_memory(shared_bytes) && hide_terminals(terminals) && hide_control_groups();
      if (!ready || write(answer[1], "y", 1) != 1) _exit(0);
      make_read_only(read_only);
      limit_tasks();
      close(answer[1]);
      return;
    }
    close(answer[1]);
    char ready = 0;
    const bool contained = supervisor > 0 && read(answer[0], &ready, 1) == 1;
    close(answer[0]);
    if (contained) guard(supervisor);
    if (supervisor > 0) waitpid(supervisor, nullptr, 0);
  }
  prctl(PR_SET_CHILD_SUBREAPER, 1);
}

int open_process(pid_t process) { return static_cast<int>(syscall(SYS_pidfd_open, process, 0)); }

bool is_descendant(pid_t process) {
  for (int steps = 0; steps < 1000 && process > 1; ++steps) {
    std::ifstream in("/proc/" + std::to_string(process) + "/stat");
    std::string line;
    std::getline(in, line);
    const std::size_t name_end = line.rfind(") ");
    if (name_end == line.npos || line.size() < name_end + 5) return false;
    process = static_cast<pid_t>(std::strtol(line.c_str() + name_end + 4, nullptr, 10));  // after ") S "
    if (process == getpid()) return true;
  }
  return false;
}

Usage usage_of_descendants(std::uint64_t most_bytes, std::uint64_t most_processes) {
  Usage usage{};
  for (std::vector<pid_t> left = own_children(); !left.empty();) {
    const pid_t process = left.back();
    left.pop_back();
    ++usage.processes;
    // Counts shares of shared pages once whole pages would exceed the limit.
    usage.bytes += bytes_of(process, most_bytes > usage.bytes ? (most_bytes - usage.bytes) / 2 : 0);
    if (usage.processes > most_processes || usage.bytes > most_bytes) break;
    for (const pid_t child : children_of(process)) left.push_back(child);
  }
  return usage;
}

bool end_children(pid_t except) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::seconds(5);
  for (;;) {
    if (except < 0 && getpid() == 1) kill(-1, SIGKILL);  // all processes at once, even those started meanwhile
    bool left = false;
    for (const pid_t child : own_children()) {
      if (child == except) continue;
      left = true;
      kill(child, SIGKILL);  // its id stays valid until we wait for it, which only we can do
    }
    if (!left) return true;
    if (Clock::now() > deadline) return false;
    poll(nullptr, 0, 1);
    for (const pid_t child : own_children()) {
      if (child != except) waitpid(child, nullptr, WNOHANG);
    }
  }
}

void forbid_calls() {
  // prlimit64 with a process id, and memfd_create, for each system call table of the processor. i386 has other numbers
  // for them, and x32 sets an additional bit.
  constexpr std::uint32_t kI386Prlimit = 340, kI386MemfdCreate = 356, kX32 = 0x40000000;
  constexpr std::uint32_t kArch = offsetof(seccomp_data, arch), kNumber = offsetof(seccomp_data, nr);
  constexpr std::uint32_t kProcess = offsetof(seccomp_data, args);
  sock_filter steps[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArch),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_I386, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kI386MemfdCreate, 8, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kI386Prlimit, 4, 6),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber),
      BPF_STMT(BPF_ALU | BPF_AND | BPF_K, ~kX32),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_memfd_create, 4, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_prlimit64, 0, 2),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kProcess),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
  };
  const sock_fprog program{std::size(steps), steps};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

void drop_rights() {
  for (const int right :
       {CAP_SYS_PTRACE, CAP_SYS_ADMIN, CAP_SYS_RESOURCE, CAP_SYS_BOOT, CAP_SYS_MODULE, CAP_SYS_RAWIO, CAP_NET_ADMIN})
    prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
}

}  // namespace graze::subjects
