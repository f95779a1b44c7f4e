// SPDX-License-Identifier: Apache-2.0
#include "subjects/containment.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/capability.h>
#include <linux/filter.h>
#include <linux/magic.h>
#include <linux/net.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/vfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/programs/process_state.h"
#include "subjects/usage.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// In a new user namespace, keeps the user's and the group's ids, with all privileges inside that namespace.
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

// Makes the mounts below this place invisible in other namespaces.   Returns: false if the place is not a mount point;
// in a chroot, for example, "/" is not one.
bool keep_private(const char* place) { return mount("none", place, nullptr, MS_REC | MS_PRIVATE, nullptr) == 0; }

// In the new namespace: hides later mounts from outside. In a chroot, "/" is no mount point, but the other places are.
bool keep_mounts_private() {
  return keep_private("/") || (keep_private("/proc") && (keep_private("/dev/shm") || errno == ENOENT) &&
                               (!has_terminals() || keep_private("/dev/pts")));
}

// Mounts an empty, read-only folder over this place.
bool hide(const char* place) {
  return mount("tmpfs", place, "tmpfs", MS_RDONLY | MS_NOSUID | MS_NODEV | MS_NOEXEC, "size=4k") == 0;
}

// The parent process's terminals that are not below /dev/pts, such as a console. Hiding /dev/pts does not hide such
// terminals.
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

// In the new namespace: hides the terminals below /dev/pts, and `others`. Code that stops a terminal's output or takes
// its input would stop graze.
bool hide_terminals(const std::vector<std::string>& others) {
  if (has_terminals() && !hide("/dev/pts")) return false;
  return std::all_of(others.begin(), others.end(), [](const std::string& file) {
    return keep_private("/") && mount("/dev/null", file.c_str(), nullptr, MS_BIND, nullptr) == 0;
  });
}

// The mount points of file systems whose type begins with this text, from the system's list of mounts. The list writes
// a space as \040, and other special characters in the same way.
std::vector<std::string> mount_points(const std::string& type_begins) {
  std::vector<std::string> found;
  std::ifstream in("/proc/self/mountinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.find(" - " + type_begins) == line.npos) continue;
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

// In the new namespace: hides the control groups. Through them, root or a user who owns some could freeze the
// supervisor, or take its memory and processor time.
bool hide_control_groups() {
  for (const std::string& place : mount_points("cgroup")) {  // this finds cgroup2 too
    // A mount on top of a shared mount, as in a chroot, would be visible outside.
    if (mount("none", place.c_str(), nullptr, MS_PRIVATE, nullptr) != 0 &&
        (errno == ENOENT || errno == EINVAL || errno == EACCES))
      continue;  // another mount hides this one, or it is not accessible
    if (!hide(place.c_str())) return false;
  }
  return true;
}

// Makes a mount of this namespace read-only. Keeps the mount's other flags, because a user may not remove them.
bool make_mount_read_only(const char* place, unsigned long more_flags = 0) {
  struct statvfs now {};
  if (statvfs(place, &now) != 0) return false;
  unsigned long flags = MS_BIND | MS_REMOUNT | MS_RDONLY | more_flags;
  if (now.f_flag & ST_NOSUID) flags |= MS_NOSUID;
  if (now.f_flag & ST_NODEV) flags |= MS_NODEV;
  if (now.f_flag & ST_NOEXEC) flags |= MS_NOEXEC;
  return mount("none", place, nullptr, flags, nullptr) == 0;
}

// Whether the device stores nothing or only computes. Other devices are terminals, or create devices or memory that
// outlive the namespace.
bool is_harmless(const fs::path& device) {
  const std::string name = device.filename(), folder = device.parent_path();
  constexpr const char* kNames[] = {"null", "zero", "full", "random", "urandom", "kfd", "dxg"};
  return folder == "/dev/dri" || folder == "/dev/nvidia-caps" || name.starts_with("nvidia") ||
         std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

// In the new namespace: lets the code open only harmless devices. Mounts each harmless device over itself, then makes
// /dev a read-only mount without devices. /dev is read-only because files in it would be memory that no limit counts.
void limit_devices() {
  const std::vector<std::string> places = mount_points("");
  // On a shared mount, as in a chroot, these mounts would be visible outside.
  if (std::find(places.begin(), places.end(), "/dev") == places.end() ||
      mount("none", "/dev", nullptr, MS_PRIVATE, nullptr) != 0)
    return;
  const auto put = [](const fs::path& device, const fs::path& at) {
    std::error_code none;
    if (fs::is_character_file(at, none)) mount(device.c_str(), at.c_str(), nullptr, MS_BIND, nullptr);
  };
  for (const std::string& place : places) {
    if (place.starts_with("/dev/") && !is_harmless(place)) put("/dev/null", place);
  }
  for (const char* folder : {"/dev", "/dev/nvidia-caps", "/dev/dri"}) {
    std::error_code none;
    for (fs::directory_iterator file(folder, none), end; !none && file != end; file.increment(none)) {
      if (is_harmless(file->path())) put(file->path(), file->path());
    }
  }
  make_mount_read_only("/dev", MS_NODEV);
}

// In the new namespace: makes the system's settings read-only, and hides files that create a device when they are read.
void limit_settings() {
  for (const std::string& place : mount_points("")) {
    if (place != "/sys" && !place.starts_with("/sys/")) continue;
    if (place == "/sys" && mount("none", "/sys", nullptr, MS_PRIVATE, nullptr) == 0) hide("/sys/class/zram-control");
    make_mount_read_only(place.c_str());
  }
  for (const char* place : {"/proc/sys", "/proc/sysrq-trigger", "/proc/irq", "/proc/bus", "/proc/fs"}) {
    if (mount(place, place, nullptr, MS_BIND, nullptr) == 0) make_mount_read_only(place);
  }
}

// In the new namespace: makes the folder read-only, except in a chroot, where the mount would be visible outside.
void make_read_only(const std::string& given) {
  std::error_code none;
  const std::string folder = fs::canonical(given, none), here = fs::current_path(none);
  const char* at = folder.c_str();
  if (folder.empty() || !keep_private("/")) return;
  // A folder with a mount on it can be neither renamed nor removed.
  for (std::size_t end = folder.find('/', 1); end != folder.npos; end = folder.find('/', end + 1)) {
    const std::string above = folder.substr(0, end);
    mount(above.c_str(), above.c_str(), nullptr, MS_BIND | MS_REC, nullptr);
  }
  if (mount(at, at, nullptr, MS_BIND, nullptr) == 0) make_mount_read_only(at);
  fs::current_path(here, none);  // enters the same folder again, through the new mounts
}

// In the new namespace: mounts a new /proc, which shows only the namespace's processes.
bool mount_proc() {
  return mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr) == 0 &&
         fs::exists("/proc/thread-self/children");
}

// In the new namespace: sets limits on System V memory, semaphores and message queues, which end with the namespace.
// Returns: whether the limits are set. Before Linux 6.10 only root may set these limits.
bool limit_system_v(std::uint64_t bytes) {
  const auto set = [](const char* name, const std::string& value) {
    return bool(std::ofstream(std::string("/proc/sys/kernel/") + name) << value << std::flush);
  };
  const std::string pages = std::to_string(bytes / static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
  return set("shmall", pages) && set("sem", "250 32000 32 128") && set("msgmni", "32");
}

// In the new namespace: mounts a new /dev/shm, which limits POSIX shared memory and ends with the namespace.
bool limit_shared_memory(std::uint64_t bytes) {
  return mount("tmpfs", "/dev/shm", "tmpfs", MS_NOSUID | MS_NODEV, ("size=" + std::to_string(bytes)).c_str()) == 0 ||
         errno == ENOENT;
}

// The most tasks, threads included. This limit stops code that would exhaust the machine between two checks.
constexpr int kMostTasks = 1024;
// The limit is lower without a process namespace, where tasks are found and killed one by one while the others compete
// for the processors.
constexpr int kMostTasksWithoutNamespace = 256;

// Limits the tasks in the new namespace. Since Linux 6.14 a process namespace has its own pid_max; before, pid_max
// applied to the whole machine. For root there is no other task limit. For other users, RLIMIT_NPROC counts the tasks
// in a user namespace.
void limit_tasks() {
  utsname system{};
  int major = 0, minor = 0;
  if (uname(&system) == 0 && std::sscanf(system.release, "%d.%d", &major, &minor) == 2 &&
      (major > 6 || (major == 6 && minor >= 14)))
    std::ofstream("/proc/sys/kernel/pid_max") << kMostTasks;
  const rlimit most{kMostTasks, kMostTasks};
  if (geteuid() != 0) setrlimit(RLIMIT_NPROC, &most);
}

// The user's current number of tasks.
rlim_t tasks_of(uid_t user) {
  rlim_t tasks = 0;
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end; process.increment(error)) {
    std::error_code gone;
    struct stat owner {};
    if (stat(process->path().c_str(), &owner) != 0 || owner.st_uid != user) continue;
    for (fs::directory_iterator task(process->path() / "task", gone); !gone && task != end; task.increment(gone))
      ++tasks;
  }
  return tasks;
}

// The guardian waits for the supervisor to end, or kills it. Foreign code cannot reach the guardian, but may delay the
// supervisor's waits.
[[noreturn]] void guard(pid_t supervisor, int control) {
  constexpr int kMostMilliseconds = 6000;  // the time in which the supervisor must end
  const int process = open_process(supervisor);
  for (int fd = 0; fd < 1024; ++fd) {
    if (fd != control && fd != process) close(fd);
  }
  pollfd news[] = {{control, POLLRDHUP, 0}, {process, POLLIN, 0}};
  while (process >= 0 && poll(news, 2, -1) < 0 && errno == EINTR) {
  }
  if (process >= 0 && !news[1].revents) poll(news + 1, 1, kMostMilliseconds);
  if (process >= 0) kill(supervisor, SIGKILL);  // until waitpid, no other process can get this id
  while (waitpid(supervisor, nullptr, 0) < 0 && errno == EINTR) {
  }
  _exit(0);
}

}  // namespace

bool enter_containment(bool namespaces, std::uint64_t shared_bytes, int control, const std::string& read_only) {
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
      limit_devices();
      const bool limited = limit_system_v(shared_bytes);
      limit_tasks();
      limit_settings();  // last, because the calls above change settings
      close(answer[1]);
      return limited;
    }
    close(answer[1]);
    char ready = 0;
    const bool contained = supervisor > 0 && read(answer[0], &ready, 1) == 1;
    close(answer[0]);
    if (contained) guard(supervisor, control);
    if (supervisor > 0) waitpid(supervisor, nullptr, 0);
  }
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const rlim_t tasks = kMostTasksWithoutNamespace + tasks_of(user);
  const rlimit most{tasks, tasks};
  if (user != 0) setrlimit(RLIMIT_NPROC, &most);
  return false;
}

int open_process(pid_t process) { return static_cast<int>(syscall(SYS_pidfd_open, process, 0)); }

bool is_descendant(pid_t process) {
  for (int steps = 0; steps < 1000 && process > 1; ++steps) {
    process = process_status(process).parent;
    if (process == getpid()) return true;
  }
  return false;
}

namespace {

// Kills all descendants except the child `except` and its descendants.   Returns: whether any descendant that it killed
// was still running.
bool kill_descendants(pid_t except, void (*tell_alive)()) {
  bool found = false;
  std::set<pid_t> known{getpid()};  // parents are listed before their children
  for (const pid_t process : descendants(~std::uint64_t{0}, except)) {
    tell_alive();                          // this loop is slow if all these processes compete with it for the processor
    const int fd = open_process(process);  // opened first, so that no other process gets the id during the checks
    const ProcessStatus status = process_status(process);
    if (fd >= 0 && known.contains(status.parent)) {
      known.insert(process);
      if (status.state != 'Z' && syscall(SYS_pidfd_send_signal, fd, SIGKILL, nullptr, 0) == 0) found = true;
    }
    close(fd);
  }
  return found;
}

}  // namespace

bool end_children(pid_t except, void (*tell_alive)()) {
  const bool in_namespace = getpid() == 1;
  // Counts rounds of a millisecond instead of time, because the other processes may leave this one little processor
  // time. Without a namespace there are more rounds, because a process that is left over would never end.
  for (int rounds = in_namespace ? 4'000 : 40'000; rounds > 0; --rounds) {
    tell_alive();
    if (except < 0 && in_namespace) kill(-1, SIGKILL);  // kills all processes at once, even new ones
    bool left = false;
    for (const pid_t child : own_children()) {
      if (child == except) continue;
      left = true;
      // The child's id stays valid until waitpid, which only this process can call. If the child leads a process group,
      // this ends the whole group.
      kill(-child, SIGKILL);
      kill(child, SIGKILL);
    }
    if (!left) return true;
    // A process that has ended counts towards the task limit until it is reaped. So nothing is reaped while any process
    // still runs, and soon the code cannot start another process.
    const bool running = kill_descendants(except, tell_alive);
    poll(nullptr, 0, 1);
    if (running) continue;
    for (const pid_t child : own_children()) {
      if (child != except) waitpid(child, nullptr, WNOHANG);
    }
  }
  return false;
}

namespace {

// The numbers of system calls in one processor mode. A filter sees only call numbers and register arguments, so it
// cannot check calls whose arguments are in memory.
struct Calls {
  std::uint32_t prlimit, clone, clone3, prctl, setsockopt, socketcall;
  // memfd_create, memfd_secret and io_uring_setup allocate memory that no limit counts. With vmsplice, a 4 KiB page in
  // a pipe may keep 2 MiB allocated. bpf and perf_event_open reach other processes. unshare and setns enter namespaces.
  // add_key, request_key and keyctl make keys that outlive the code.
  std::array<std::uint32_t, 11> forbidden;
  std::vector<std::uint32_t> system_v;  // calls that make System V objects
};

void append_rules(std::vector<sock_filter>& steps, const Calls& calls, bool system_v) {
  constexpr std::uint32_t kX32 = 0x40000000, kArgument = offsetof(seccomp_data, args);
  constexpr std::uint32_t kCloseRange = 436, kUnshareFiles = 2;  // older headers lack them
  constexpr std::uint32_t kNamespaces =
      CLONE_NEWUSER | CLONE_NEWNS | CLONE_NEWPID | CLONE_NEWNET | CLONE_NEWIPC | CLONE_NEWUTS | CLONE_NEWCGROUP;
  const auto add = [&](std::initializer_list<sock_filter> more) { steps.insert(steps.end(), more); };
  const sock_filter refuse = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
                    allow = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  add({BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)), BPF_STMT(BPF_ALU | BPF_AND | BPF_K, ~kX32)});
  for (const std::uint32_t number : calls.forbidden) add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, 0, 1), refuse});
  for (const std::uint32_t number : calls.system_v) {
    if (!system_v) add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, 0, 1), refuse});
  }
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.prlimit, 0, 4), BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0), refuse, allow});
  // A thread with its own descriptors could hide them, because /proc shows only the first thread's.
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.clone, 0, 6), BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument),
       BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kNamespaces, 2, 0),
       BPF_STMT(BPF_ALU | BPF_AND | BPF_K, CLONE_THREAD | CLONE_FILES),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, CLONE_THREAD, 0, 1), refuse, allow});
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kCloseRange, 0, 4),
       BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument + 2 * sizeof(std::uint64_t)),
       BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kUnshareFiles, 0, 1), refuse, allow});
  // Huge pages must stay off, because part of a huge page in a socket's buffer would keep the whole page allocated.
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.prctl, 0, 4), BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PR_SET_THP_DISABLE, 0, 1), refuse, allow});
  // The system's own limit for a socket's buffer may be many MiB.
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.setsockopt, 0, 7),
       BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument + sizeof(std::uint64_t)),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SOL_SOCKET, 0, 4),
       BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument + 2 * sizeof(std::uint64_t)),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SO_SNDBUF, 1, 0), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SO_SNDBUFFORCE, 0, 1),
       refuse, allow});
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.socketcall, 0, 4), BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kArgument),
       BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_SETSOCKOPT, 0, 1), refuse, allow});
  // Without clone3, the C library uses clone.
  add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls.clone3, 0, 1), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS),
       allow});
}

}  // namespace

// The code must not make a user namespace, in which it could mount control groups and in-memory file systems. No limit
// counts such file systems.
void forbid_calls(bool system_v) {
  constexpr std::uint32_t kMemfdSecret = 447;  // older headers lack SYS_memfd_secret
  std::vector<sock_filter> i386, steps{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch))};
  // The last four numbers are those of ipc (which makes all three kinds of objects), semget, shmget and msgget.
  append_rules(
      i386,
      {340, 120, 435, 172, 366, 102, {356, 447, 425, 316, 357, 336, 310, 346, 286, 287, 288}, {117, 393, 395, 399}},
      system_v);
  steps.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_I386, 0, static_cast<std::uint8_t>(i386.size())));
  steps.insert(steps.end(), i386.begin(), i386.end());
  append_rules(steps,
               {SYS_prlimit64,
                SYS_clone,
                SYS_clone3,
                SYS_prctl,
                SYS_setsockopt,
                ~0u,  // there is no socketcall
                {SYS_memfd_create, kMemfdSecret, SYS_io_uring_setup, SYS_vmsplice, SYS_bpf, SYS_perf_event_open,
                 SYS_unshare, SYS_setns, SYS_add_key, SYS_request_key, SYS_keyctl},
                {SYS_shmget, SYS_semget, SYS_msgget}},
               system_v);
  const sock_fprog program{static_cast<unsigned short>(steps.size()), steps.data()};
  prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

void drop_rights() {
  constexpr int kKept[] = {CAP_CHOWN,  CAP_DAC_OVERRIDE, CAP_FOWNER,          CAP_FSETID,
                           CAP_SETGID, CAP_SETUID,       CAP_NET_BIND_SERVICE};
  for (int right = 0; prctl(PR_CAPBSET_READ, right, 0, 0, 0) >= 0; ++right) {
    if (std::find(std::begin(kKept), std::end(kKept), right) == std::end(kKept)) prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
  }
}

}  // namespace graze::subjects
