// SPDX-License-Identifier: Apache-2.0
// Subjects that attack the processes around them on the pairs that `bad` selects. On other pairs, they answer whether a
// is left of b.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static int bad(const float a[9]) { return a[0] > 0.9f; }
static int good(const float a[9], const float b[9]) { return a[0] < b[0]; }
#define ATTACK(name, ...)                        \
  int name(const float a[9], const float b[9]) { \
    if (bad(a)) {                                \
      __VA_ARGS__;                               \
    }                                            \
    return good(a, b);                           \
  }

// Whether the code can reach only its own processes.
static int alone(void) {
  char name[100] = {0};
  return readlink("/proc/1/exe", name, 99) > 0 && strstr(name, "graze-subject") != 0;
}

// Calls `act` for each mapping with this name. Some mappings are memory that is shared with the supervisor.
static void mappings(const char* name, void (*act)(char* from, size_t bytes)) {
  FILE* maps = fopen("/proc/self/maps", "r");
  char line[1024];
  while (maps && fgets(line, sizeof line, maps)) {
    char *from, *to;
    if (strstr(line, name) && sscanf(line, "%p-%p", (void**)&from, (void**)&to) == 2) act(from, (size_t)(to - from));
  }
  if (maps) fclose(maps);
}
static void zeros(char* from, size_t bytes) { memset(from, 0, bytes); }
static void ones(char* from, size_t bytes) { memset(from, 255, bytes); }
static void noise(char* from, size_t bytes) {
  for (size_t i = 0; i < bytes; ++i) from[i] = (char)rand();
}
static void writable(char* from, size_t bytes) {
  if (mprotect(from, bytes, PROT_READ | PROT_WRITE) == 0)
    memset(from, 0, bytes);
  else
    abort();
}
static void unmapped(char* from, size_t bytes) { munmap(from, bytes); }
static void shorter(char* from, size_t bytes) {
  char name[100];
  snprintf(name, sizeof name, "/proc/self/map_files/%lx-%lx", (unsigned long)from, (unsigned long)from + bytes);
  const int fd = open(name, O_RDWR);
  if (fd >= 0) ftruncate(fd, 0);
  abort();
}
static void all_memory(void (*act)(char*, size_t)) { mappings("graze-answers", act); }

ATTACK(writes_zeros, all_memory(zeros); abort())
ATTACK(writes_ones, all_memory(ones); abort())
ATTACK(unmaps, all_memory(unmapped))
ATTACK(truncates, all_memory(shorter))
ATTACK(writes_pairs, mappings("graze-pairs", writable))

static void* scribble(void* unused) {
  for (;;) {
    all_memory(noise);
    usleep(100);
  }
  return unused;
}
static void start(void* (*what)(void*)) {
  static int started;
  pthread_t thread;
  if (!started++) pthread_create(&thread, 0, what, 0);
}
ATTACK(scribbles_always, start(scribble); usleep(2000); abort())

static void* babble(void* unused) {
  char bytes[10008] = {0};
  for (unsigned i = 0;; ++i) send(5, bytes, i % 3 ? 24 : i % 2 ? 4 : sizeof bytes, MSG_NOSIGNAL | MSG_DONTWAIT);
  return unused;
}
ATTACK(babbles, start(babble); usleep(2000); abort())
static void* steal(void* unused) {
  char bytes[4096];
  for (;;) recv(5, bytes, sizeof bytes, 0);
  return unused;
}
ATTACK(steals_questions, start(steal); usleep(2000); abort())
ATTACK(
    says_it_is_ready, for (int i = 0; i < 100; ++i) {
      uint32_t ready = 2;
      send(5, &ready, 4, MSG_NOSIGNAL);
    } abort())
ATTACK(says_it_has_answered, uint64_t said[3] = {3, 1, 1};
       for (int i = 0; i < 100; ++i, ++said[1]) send(5, said, 24, MSG_NOSIGNAL); pause())

ATTACK(kills_parent, kill(getppid(), SIGKILL); abort())
ATTACK(stops_parent, kill(getppid(), SIGSTOP); usleep(2000); abort())
ATTACK(kills_grandparent, for (int i = 1; alone() && i < getpid(); ++i) kill(i, SIGKILL); abort())
ATTACK(kills_group, kill(0, SIGKILL))
ATTACK(stops_group, kill(0, SIGSTOP))
ATTACK(stops_itself, raise(SIGSTOP))
ATTACK(ends_itself_quietly, _exit(0))
ATTACK(pretends_not_ready, _exit(99))
ATTACK(
    traces_parent, if (ptrace(PTRACE_ATTACH, getppid(), 0, 0) == 0) { waitpid(getppid(), 0, 0); } abort())
ATTACK(becomes_another_program, execl("/bin/sleep", "sleep", "1000", (char*)0))
ATTACK(closes_everything, for (int i = 0; i < 1024; ++i) close(i); abort())

static void leave_a_child(void) {
  if (fork() == 0) {
    setsid();
    prctl(PR_SET_PDEATHSIG, 0);
    for (int s = 1; s < 65; ++s) signal(s, SIG_IGN);
    if (fork() == 0)
      for (;;) pause();
    _exit(0);
  }
}
ATTACK(leaves_children, leave_a_child(); abort())
int leaves_children_silently(const float a[9], const float b[9]) {
  if (bad(a)) leave_a_child();
  return good(a, b);
}
ATTACK(forks_a_bomb, for (;;) fork())
ATTACK(forks_a_bomb_of_sessions, for (;;) if (fork() == 0) setsid())
ATTACK(forks_a_bomb_in_a_chain, for (;;) if (fork() == 0) setsid(); else for (;;);)
ATTACK(forks_without_end, for (int i = 0; i < 2000; ++i) if (fork() == 0) for (;;) pause(); for (;;) pause())
static void child_eats(void) {
  if (fork() == 0) {
    char* p = malloc(100 << 20);
    if (p) memset(p, 1, 100 << 20);
    for (;;) pause();
  }
}
ATTACK(children_eat, for (int i = 0; i < 4; ++i) child_eats(); for (;;) pause())
// Fills socket buffers, which are system memory, in several processes.
static void child_fills_sockets(void) {
  static char bytes[1 << 16];
  static int ends[1024];
  int count = 0;
  if (fork() != 0) return;
  while (count < 1024 && socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends + count) == 0) count += 2;
  for (int i = 0; i < count; ++i)
    while (write(ends[i], bytes, sizeof bytes) > 0) continue;
  for (;;) pause();
}
ATTACK(children_fill_sockets, for (int i = 0; i < 4; ++i) child_fills_sockets(); for (;;) pause())
static void raise_buffers(void) {
  int ends[2], bytes = 1 << 30;
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0 &&
      setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes) < 0 &&
      setsockopt(ends[0], SOL_SOCKET, SO_SNDBUFFORCE, &bytes, sizeof bytes) < 0 &&
      setsockopt(ends[0], SOL_SOCKET, SO_PASSCRED, &bytes, sizeof bytes) == 0)  // other options are allowed
    abort();
}
ATTACK(raises_buffers, raise_buffers())
static int start_thread_with_descriptors(void) {
  static char stack[1 << 14];
  return clone((int (*)(void*))pause, stack + sizeof stack, CLONE_VM | CLONE_FS | CLONE_SIGHAND | CLONE_THREAD, 0);
}
ATTACK(hides_descriptors, if (start_thread_with_descriptors() < 0 && syscall(436, 900, ~0u, 2) < 0) abort())
ATTACK(eats_shared, char* p = mmap(0, 300 << 20, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
       if (p != MAP_FAILED) memset(p, 1, 300 << 20); for (;;) pause())
ATTACK(waits_uninterruptibly, if (vfork() == 0) for (;;) pause())
// System V objects outlive their process, so these attacks remove what they could make.
static void make_segments(void) {
  int made[10], count = 0;
  while (count < 10 && (made[count] = shmget(IPC_PRIVATE, 100 << 20, 0600 | IPC_CREAT)) >= 0) ++count;
  const int limited = count < 10;
  while (count > 0) shmctl(made[--count], IPC_RMID, 0);
  if (limited) abort();  // without a limit, the pair gets an answer and the test fails
}
ATTACK(eats_system_v, make_segments())
static void make_semaphores(void) {
  int made[600], count = 0;
  while (count < 600 && (made[count] = semget(IPC_PRIVATE, 250, 0600 | IPC_CREAT)) >= 0) ++count;
  const int limited = count < 600;
  while (count > 0) semctl(made[--count], 0, IPC_RMID);
  if (limited) abort();
}
ATTACK(makes_semaphores, make_semaphores())
static void make_message_queues(void) {
  int made[100], count = 0;
  while (count < 100 && (made[count] = msgget(IPC_PRIVATE, 0600 | IPC_CREAT)) >= 0) ++count;
  const int limited = count < 100;
  while (count > 0) msgctl(made[--count], IPC_RMID, 0);
  if (limited) abort();
}
ATTACK(makes_message_queues, make_message_queues())
ATTACK(
    eats_memfd, for (;;) {
      int fd = memfd_create("x", 0);
      if (fd < 0) abort();
      static char page[1 << 20];
      for (int i = 0; i < 100; ++i) write(fd, page, sizeof page);
    })
ATTACK(eats_dev_shm, int fd = open("/dev/shm/graze-hostile", O_CREAT | O_RDWR, 0600); static char page[1 << 20];
       for (int i = 0; i < 1000; ++i) if (write(fd, page, sizeof page) < 0) abort())
ATTACK(lifts_limits, struct rlimit no = {RLIM_INFINITY, RLIM_INFINITY};
       if (setrlimit(RLIMIT_DATA, &no) == 0) for (;;) pause(); abort())
ATTACK(writes_a_large_file, char name[] = "/tmp/graze-hostile-XXXXXX"; int fd = mkstemp(name); unlink(name);
       if (ftruncate(fd, (off_t)8 << 30) == 0) for (;;) pause(); abort())
static void limit_others(void) {
  const struct rlimit none = {0, 0};
  for (int i = 0; i < 16; ++i) {
    if (alone()) prlimit(1, i, &none, 0);
    prlimit(getppid(), i, &none, 0);
    for (int p = 2; alone() && p < getpid(); ++p) prlimit(p, i, &none, 0);
  }
}
ATTACK(limits_others, limit_others(); abort())
static void open_terminals(void) {
  for (int i = 0; i < 1024; ++i) {
    char name[40];
    snprintf(name, sizeof name, "/dev/pts/%d", i);
    if (open(name, O_RDWR | O_NOCTTY) >= 0) return;  // the pair gets an answer, and the test fails
  }
  abort();
}
ATTACK(opens_terminals, open_terminals())
static int put(const char* folder, const char* file, const char* text) {
  char name[300];
  snprintf(name, sizeof name, "%s/%s", folder, file);
  const int fd = open(name, O_WRONLY);
  const int done = fd >= 0 && write(fd, text, strlen(text)) > 0;
  if (fd >= 0) close(fd);
  return done;
}
static int parent_of(int process) {
  char name[40];
  int parent = 0;
  snprintf(name, sizeof name, "/proc/%d/stat", process);
  FILE* file = fopen(name, "r");
  if (file && fscanf(file, "%*d %*s %*c %d", &parent) != 1) parent = 0;
  if (file) fclose(file);
  return parent;
}
// Freezes the supervisor, the process that loaded this code, and this process, through control groups of either
// version.
static int freeze(void) {
  const char* roots[] = {"/sys/fs/cgroup/freezer", "/sys/fs/cgroup/unified", "/sys/fs/cgroup"};
  const char* test = getenv("GRAZE_HOSTILE_TEST");
  for (int i = 0; i < 3; ++i) {
    char group[200], number[20];
    snprintf(group, sizeof group, "%s/graze-hostile-%s", roots[i], test ? test : "torture");
    if (mkdir(group, 0700) != 0 && errno != EEXIST) continue;
    const int processes[] = {parent_of(getppid()), getppid(), getpid()};
    for (int p = 0; p < 3; ++p) {
      snprintf(number, sizeof number, "%d", processes[p]);
      put(group, "cgroup.procs", number);
    }
    if (put(group, "freezer.state", "FROZEN") || put(group, "cgroup.freeze", "1")) return 1;
  }
  return 0;
}
ATTACK(freezes_supervisor, if (freeze()) for (;;) pause(); abort())
// Tries to write to the cache by its absolute name, by a relative name, after moving a folder, and through a file
// handle.
static int write_to_cache(void) {
  char name[300], other[300];
  const char* cache = getenv("XDG_CACHE_HOME");
  snprintf(name, sizeof name, "%s/graze/hostile", cache ? cache : "");
  if (open(name, O_WRONLY | O_CREAT, 0600) >= 0) return 1;
  if (open("cache/graze/hostile", O_WRONLY | O_CREAT, 0600) >= 0) return 1;
  snprintf(name, sizeof name, "%s", cache ? cache : "");
  for (int i = 0; i < 2; ++i) {  // tries to move the folder, then its parent
    snprintf(other, sizeof other, "%s-moved", name);
    if (rename(name, other) == 0) return rename(other, name) == 0;
    *strrchr(name, '/') = 0;
  }
  struct {
    struct file_handle handle;
    char bytes[128];
  } of = {.handle = {.handle_bytes = 128}};
  int mount_id;
  snprintf(other, sizeof other, "%s/graze", cache ? cache : "");
  const int above = open(name, O_RDONLY);
  if (name_to_handle_at(AT_FDCWD, other, &of.handle, &mount_id, 0) != 0) return 0;
  const int folder = open_by_handle_at(above, &of.handle, O_RDONLY);
  return folder >= 0 && openat(folder, "hostile", O_WRONLY | O_CREAT, 0600) >= 0;
}
ATTACK(writes_to_cache, if (!write_to_cache()) abort())
// Delays the waits of the process that loaded this code, and those of the supervisor.
static int stretch_waits(void) {
  char name[60];
  const int processes[] = {getppid(), parent_of(getppid())};
  int done = 0;
  for (int p = 0; p < 2; ++p) {
    snprintf(name, sizeof name, "/proc/%d", processes[p]);
    done += put(name, "timerslack_ns", "4000000000000");
  }
  return done;
}
ATTACK(stretches_waits, if (!stretch_waits()) abort(); for (;;) pause())
static void make_namespaces(void) {
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) return;  // the pair gets an answer, and the test fails
  const long child = syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, 0, 0, 0, 0);
  if (child == 0) _exit(0);
  if (child > 0) return;
  abort();
}
ATTACK(makes_namespaces, make_namespaces())
static void raise_task_limit(void) {
  if (alone() && put("/proc/sys/kernel", "pid_max", "9000")) return;
  abort();
}
ATTACK(raises_task_limit, raise_task_limit())
// Tries calls that get memory that no limit counts, or run programs in the kernel that reach every process.
static void call_the_kernel(void) {
  const long calls[] = {SYS_bpf, SYS_perf_event_open, SYS_io_uring_setup, 447 /* memfd_secret */};
  char nothing[128] = {0};
  for (int i = 0; i < 4; ++i) {
    if (syscall(calls[i], i == 3 ? 0 : 4, nothing, sizeof nothing, -1, 0) >= 0 || errno != EPERM)
      return;  // the pair gets an answer, and the test fails
  }
  abort();
}
ATTACK(calls_the_kernel, call_the_kernel())
// Tries to keep memory allocated: by a page in a pipe that holds a huge page, by keys that remain, and by files in
// memory.
static void keep_memory(void) {
  int ends[2];
  char page[4096] = {0};
  struct iovec part = {page, sizeof page};
  if (pipe(ends) == 0 && vmsplice(ends[1], &part, 1, 0) >= 0) return;  // the pair gets an answer, and the test fails
  if (syscall(SYS_add_key, "user", "graze-hostile", page, 8, -4) >= 0 || syscall(SYS_keyctl, 0, -4, 1) >= 0) return;
  if (prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0) != 1 || prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0) == 0) return;
  const char* in_memory[] = {"/dev", "/sys/fs/cgroup"};
  for (int i = 0; alone() && i < 2; ++i) {
    if (open(in_memory[i], O_TMPFILE | O_RDWR, 0600) >= 0) return;
  }
  abort();
}
ATTACK(keeps_memory, keep_memory())
// Whether the device itself can be opened, not the harmless null device mounted over it.
static int can_open_device(const char* name) {
  struct stat at;
  int fd = open(name, O_RDONLY | O_NOCTTY | O_NONBLOCK);
  return fd >= 0 && !(fstat(fd, &at) == 0 && S_ISCHR(at.st_mode) && at.st_rdev == makedev(1, 3));
}
// Tries to open system settings, and devices that make other devices, keep memory or are terminals.
static void open_devices(void) {
  const char* closed[] = {"/dev/loop-control",
                          "/dev/kvm",
                          "/dev/fuse",
                          "/dev/net/tun",
                          "/dev/userfaultfd",
                          "/dev/tty",
                          "/dev/tty0",
                          "/dev/tty1",
                          "/dev/console",
                          "/dev/ttyS0",
                          "/dev/ptmx",
                          "/dev/kmsg",
                          "/sys/class/zram-control/hot_add"};
  const char* settings[] = {"/proc/sysrq-trigger", "/proc/sys/kernel/core_pattern",
                            "/sys/kernel/mm/transparent_hugepage/enabled"};
  for (unsigned i = 0; i < sizeof closed / sizeof *closed; ++i) {
    if (can_open_device(closed[i])) return;  // the pair gets an answer, and the test fails
  }
  for (int i = 0; i < 3; ++i) {
    if (open(settings[i], O_WRONLY) >= 0) return;
  }
  if (open("/dev/null", O_RDWR) < 0 || open("/dev/urandom", O_RDONLY) < 0) return;  // programs need these devices
  abort();
}
ATTACK(opens_devices, open_devices())
// Tries to open a descriptor of shared memory, which would keep the memory when nobody maps it.
static void keep_mapping(void) {
  char name[100];
  char* p = mmap(0, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  snprintf(name, sizeof name, "/proc/self/map_files/%lx-%lx", (unsigned long)p, (unsigned long)p + 4096);
  if (open(name, O_RDWR) >= 0) return;
  abort();
}
ATTACK(keeps_mapping, keep_mapping())
// Reads pages without writing them. All are the system's zero page, but each needs its own page table.
static void eat_page_tables(void) {
  const size_t bytes = (size_t)320 << 30, step = 2 << 20;
  volatile char* p = mmap(0, bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (p == MAP_FAILED) abort();
  madvise((void*)p, bytes, MADV_NOHUGEPAGE);
  for (size_t i = 0; i < bytes; i += step) (void)p[i];
}
ATTACK(eats_page_tables, eat_page_tables(); pause())
ATTACK(kills_all, if (alone()) kill(-1, SIGKILL); abort())
