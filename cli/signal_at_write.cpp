// SPDX-License-Identifier: Apache-2.0
// For tests, loaded by LD_PRELOAD: sends GRAZE_SIGNAL to its own process before the GRAZE_AT_WRITE-th call that writes,
// syncs or renames a file. A test can thus stop a program at an exact point, on machines of any speed.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

namespace {

std::atomic<int> calls = 0;

void count() {
  const char *signal = std::getenv("GRAZE_SIGNAL"), *at = std::getenv("GRAZE_AT_WRITE");
  if (signal && at && ++calls == std::atoi(at)) kill(getpid(), std::atoi(signal));
}

// Counts only writes to regular files, because the number of writes to sockets and pipes may depend on time.
void count_on(int file) {
  struct stat status {};
  if (file > STDERR_FILENO && fstat(file, &status) == 0 && S_ISREG(status.st_mode)) count();
}

}  // namespace

extern "C" {
ssize_t write(int file, const void* data, size_t bytes) {
  count_on(file);
  return syscall(SYS_write, file, data, bytes);
}
ssize_t writev(int file, const iovec* parts, int number) {
  count_on(file);
  return syscall(SYS_writev, file, parts, number);
}
ssize_t pwrite64(int file, const void* data, size_t bytes, off64_t at) {
  count_on(file);
  return syscall(SYS_pwrite64, file, data, bytes, at);
}
ssize_t pwrite(int file, const void* data, size_t bytes, off_t at) { return pwrite64(file, data, bytes, at); }
int fsync(int file) {
  count_on(file);
  return static_cast<int>(syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  count_on(file);
  return static_cast<int>(syscall(SYS_fdatasync, file));
}
int rename(const char* from, const char* to) noexcept {
  count();
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
}
