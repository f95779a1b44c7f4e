// SPDX-License-Identifier: Apache-2.0
#include "fuzz/files.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include "core/cannot.h"
#include "core/stop.h"
#include "fuzz/own_files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kLockAttempts = 10;  // one second in total

[[noreturn]] void fail(const char* act, const fs::path& file, int error) {
  throw std::runtime_error(cannot(act, file, error));
}

constexpr std::size_t kMostOfDevice = 64;  // MiB

struct Handle {
  int number;
  ~Handle() {
    if (number >= 0) close(number);
  }
};

// Waits until the pipe is ready. The pipe's other end may never open, so the wait also ends on a request to stop.
void wait_for(int handle, short events) {
  pollfd ready{handle, events, 0};
  while (poll(&ready, 1, 100) <= 0) {
    if (stop_requested) throw Stopped();
  }
}

// Returns whether the whole text was written; if not, errno says why.
bool write_all(int handle, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(handle, text.data() + at, text.size() - at);
    if (written < 0 && errno == EAGAIN) wait_for(handle, POLLOUT);
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (written < 0) return false;
    at += static_cast<std::size_t>(written);
  }
  return true;
}

bool copy_all(int from, int to) {
  std::string bytes;
  while (true) {
    bytes.resize(std::size_t{1} << 20);
    const ssize_t count = read(from, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count == 0;
    bytes.resize(static_cast<std::size_t>(count));
    if (!write_all(to, bytes)) return false;
  }
}

bool same_file(const struct stat& one, const struct stat& other) {
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

bool is_standard_output(const struct stat& file) {
  struct stat output {};
  return fstat(STDOUT_FILENO, &output) == 0 && same_file(output, file);
}

// Opens the file for writing. A named pipe opens once somebody reads it.
int opened(const fs::path& file, bool pipe) {
  if (!pipe) return open(file.c_str(), O_WRONLY | O_CLOEXEC);
  while (true) {
    const int number = open(file.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    if (number >= 0 || errno != ENXIO) return number;
    if (stop_requested) throw Stopped();
    poll(nullptr, 0, 100);
  }
}

// Writes to a device or a pipe, which must not be replaced with a file.
void write_into(const fs::path& file, bool pipe, bool standard_output, const std::string& text) {
  std::cout.flush();
  std::fflush(stdout);
  const Handle own{standard_output ? dup(STDOUT_FILENO) : opened(file, pipe)};
  if (own.number < 0 || !write_all(own.number, text)) fail("write", file, errno);
}

// Creates a new file that only this writer uses. Other writers wait until this one has renamed it. A file left by a
// killed writer is removed and never written to, because it may be a hard link to another user's file.
// Returns: the file's descriptor; negative on failure, with the reason in errno.
int made_alone(const std::string& file) {
  while (true) {
    int number = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    const bool made = number >= 0;
    if (!made && errno != EEXIST) return number;
    if (!made) number = open(file.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (number < 0 && errno == ENOENT) continue;  // its writer has just renamed it
    struct stat opened {
    }, named{};
    if (number < 0 || fstat(number, &opened) != 0 || !S_ISREG(opened.st_mode)) return number;
    while (flock(number, LOCK_EX) != 0 && errno == EINTR) {
    }  // some file systems have no locks
    const bool there = lstat(file.c_str(), &named) == 0 && same_file(opened, named);
    if (made && there) return number;
    const int error = there && unlink(file.c_str()) != 0 ? errno : 0;
    close(number);
    errno = error;
    if (error != 0) return -1;
  }
}

// Lets `fill` write the new file, then renames it.   fill: int -> bool; if it returns false, errno says why.
template <class Fill>
void replace(const fs::path& file, const fs::path& asked, const Fill& fill) {
  const std::string beside = file.string() + kPart;
  Handle part{made_alone(beside)};
  int error = errno;
  struct stat state {};
  if (lstat(beside.c_str(), &state) == 0 && !S_ISREG(state.st_mode))
    throw std::runtime_error(cannot("write", asked, beside + " is in the way, and is not a file; remove it"));
  if (part.number < 0) fail("write", asked, error);
  // A full disk may only be noticed on close. The file stays open, and so locked, until it is renamed.
  const bool done = fill(part.number) && close(dup(part.number)) == 0;
  if (done && std::rename(beside.c_str(), file.c_str()) == 0) return;
  error = errno;
  unlink(beside.c_str());
  fail("write", asked, error);
}

// Throws: std::runtime_error unless the mode is a regular file's.   act: the verb of the message, such as "read".
void expect_mode_of_file(const char* act, const fs::path& file, mode_t mode) {
  if (S_ISDIR(mode)) fail(act, file, EISDIR);
  if (!S_ISREG(mode)) throw std::runtime_error(cannot(act, file, "it is a pipe or a device; remove it"));
}

}  // namespace

void expect_file(const fs::path& file) {
  struct stat there {};
  if (stat(file.c_str(), &there) == 0) expect_mode_of_file("use", file, there.st_mode);
}

fs::path behind_links(fs::path file) {
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(file)); ++links)
    file = file.parent_path() / fs::read_symlink(file);
  return file;
}

std::string read_whole(const fs::path& file, NamedBy named_by) {
  const Handle in{open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  if (in.number < 0 && (errno == ENOENT || errno == ENOTDIR)) return {};
  struct stat state {};
  if (in.number < 0 || fstat(in.number, &state) != 0) fail("read", file, errno);
  if (named_by == NamedBy::graze) expect_mode_of_file("read", file, state.st_mode);
  std::string text;
  char bytes[65536];
  while (true) {
    if (S_ISFIFO(state.st_mode)) wait_for(in.number, POLLIN);
    const ssize_t count = read(in.number, bytes, sizeof bytes);
    if (count == 0) return text;
    if (count > 0) {
      text.append(bytes, static_cast<std::size_t>(count));
      if (!S_ISREG(state.st_mode) && text.size() > kMostOfDevice << 20)
        throw std::runtime_error(cannot(
            "read", file, "it is a pipe or a device that gives more than " + std::to_string(kMostOfDevice) + " MiB"));
    } else if (errno == EAGAIN) {
      wait_for(in.number, POLLIN);
    } else if (errno != EINTR) {
      fail("read", file, errno);
    }
  }
}

void write_whole(const fs::path& file, const std::string& text, NamedBy named_by) {
  struct stat there {};
  const bool exists = stat(file.c_str(), &there) == 0;
  if (!exists && errno != ENOENT) fail("write", file, errno);
  if (exists && (named_by == NamedBy::graze || S_ISDIR(there.st_mode)))
    expect_mode_of_file("write", file, there.st_mode);
  // If standard output is a file, replacing that file would lose everything else that is printed.
  const bool standard_output = exists && is_standard_output(there);
  if (exists && (standard_output || !S_ISREG(there.st_mode)))
    return write_into(file, S_ISFIFO(there.st_mode), standard_output, text);
  expect_own(file, text);
  replace(behind_links(file), file,
          [&](int part) { return write_all(part, text) && (!exists || fchmod(part, there.st_mode & 07777) == 0); });
}

void copy_whole(const fs::path& from, const fs::path& to) {
  expect_file(from);
  const Handle source{open(from.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat state {};
  if (source.number < 0 || fstat(source.number, &state) != 0) fail("read", from, errno);
  replace(to, to, [&](int part) {
    return copy_all(source.number, part) && fchmod(part, state.st_mode & 07777) == 0 && fsync(part) == 0;
  });
}

FolderLock::FolderLock(const fs::path& folder, WhenTaken when_taken)
    : handle_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (handle_ < 0) fail("open the folder", folder, errno);
  const int how = when_taken == WhenTaken::wait     ? LOCK_EX
                  : when_taken == WhenTaken::refuse ? LOCK_EX | LOCK_NB
                                                    : LOCK_SH | LOCK_NB;
  // A process that was just killed may have a child that has not ended yet.
  int error = 0;
  for (int attempt = 0; attempt == 0 || (attempt < kLockAttempts && !stop_requested); ++attempt) {
    if (flock(handle_, how) == 0) return;
    error = errno;
    if (error != EWOULDBLOCK && error != EINTR) break;
    poll(nullptr, 0, 100);
  }
  close(handle_);
  if (stop_requested) throw Stopped();
  if (error != EWOULDBLOCK) fail("lock", folder, error);
  throw std::runtime_error(cannot("use", folder, "another process is using it; wait until it has ended"));
}

FolderLock::~FolderLock() { close(handle_); }

}  // namespace graze::fuzz
