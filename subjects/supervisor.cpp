// SPDX-License-Identifier: Apache-2.0
#include "subjects/supervisor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>

#include "core/programs/process_state.h"
#include "core/programs/supervisor_process.h"
#include "subjects/containment.h"
#include "subjects/questions.h"
#include "subjects/usage.h"

namespace graze::subjects {
namespace {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;

constexpr auto kLookEvery = std::chrono::milliseconds(100);  // how often the processes' usage is checked
constexpr int kMostWaits = 20;       // a program may wait this many times its limit for a processor
constexpr int kMostLoads = 3;        // the most failed loads for one block
constexpr double kLoadSeconds = 60;  // the time to load the code and start a worker
constexpr std::uint64_t kMostProcesses = 64, kMostDescriptors = 2048;

Time after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Tells graze, at most a hundred times a second, that this supervisor is alive. Graze gives up on silent supervisors.
void tell_alive() {
  static Time next{};
  const Time now = Clock::now();
  if (now < next) return;
  next = now + std::chrono::milliseconds(10);
  send(kControlFd, &kAlive, sizeof kAlive, MSG_NOSIGNAL | MSG_DONTWAIT);
}

class Supervisor {
 public:
  Supervisor(const Limits& limits, char* const* arguments) : limits_(limits), arguments_(arguments) {
    prctl(PR_SET_DUMPABLE, 0);  // other processes of the same user cannot inspect this one
    const int fd = memfd_create("graze-answers", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (fd < 0 || ftruncate(fd, kWords * sizeof(std::uint64_t)) != 0 ||
        fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
      leave();
    words_fd_ = fd;
    void* at = mmap(nullptr, kWords * sizeof(std::uint64_t), PROT_READ, MAP_SHARED, fd, 0);
    if (at == MAP_FAILED) leave();
    words_ = static_cast<const std::uint64_t*>(at);
  }

  int run() {
    Loaded loaded{};
    if (!load(loaded)) {
      loaded.says = Says::refused;
      std::snprintf(loaded.text, sizeof loaded.text, "%s", why_.c_str());
    }
    send(kControlFd, &loaded, sizeof loaded, MSG_NOSIGNAL);
    if (loaded.says == Says::refused) leave();
    of_blocks_ = loaded.of_blocks;
    for (Block block; next_block(block);) answer(block.count);
    leave();
  }

 private:
  [[noreturn]] void leave() {
    end_children(-1, tell_alive);
    _exit(0);
  }

  // Calls poll. If poll fails, this supervisor cannot do its work: it exits, and graze starts another.
  int wait_for(pollfd* of, nfds_t count, int milliseconds) {
    const int found = poll(of, count, milliseconds);
    if (found < 0 && errno != EINTR) leave();
    return found;
  }

  // Waits until this time, or until the next check of the processes' usage.
  void wait_for(pollfd* of, nfds_t count, Time until) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(std::min(until, next_look_) - Clock::now()).count();
    wait_for(of, count, static_cast<int>(std::max<long>(0, left)));
  }

  // Waits for graze's next block, and meanwhile checks the processes' usage.   Returns: false if no block comes.
  bool next_block(Block& block) {
    for (;;) {
      pollfd control{kControlFd, POLLIN, 0};
      if (wait_for(&control, 1, 1000) > 0)
        return recv(kControlFd, &block, sizeof block, 0) == sizeof block && block.count > 0 &&
               block.count <= kMostAsked;
      reap();
      if (!within_limits()) end_all();
    }
  }

  void answer(std::size_t count) {
    Questions questions(count, of_blocks_, limits_.program);
    Answers answers{0, static_cast<std::uint32_t>(count), {}};
    int loads = 0;  // loads since a worker was last ready
    for (bool first = true; !questions.done(); first = false) {
      if (worker_ < 0 && !(loader_ >= 0 && await_worker())) {
        end_all();
        Loaded again{};
        if (++loads > kMostLoads || !load(again)) questions.give_up(kCrashed);
        continue;
      }
      loads = 0;
      Question question = questions.next(++nonce_);
      question.worker = worker_;
      nanoseconds_ = 0;
      const Time start = Clock::now();
      const bool sent = send(talk_, &question, sizeof question, MSG_NOSIGNAL | MSG_DONTWAIT) == sizeof question;
      const signed char how = sent ? watch(questions) : static_cast<signed char>(kCrashed);
      if (how == kDeclined) {
        const auto wall = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count();
        if (first && questions.done() && nanoseconds_ <= static_cast<std::uint64_t>(wall))
          answers.nanoseconds = nanoseconds_;
        continue;
      }
      end_worker();
      questions.take(words_);  // the last answers may have arrived meanwhile
      if (!questions.answered() || limits_.program) questions.failed(how);
    }
    std::copy(questions.answers().begin(), questions.answers().end(), answers.answers);
    if (send(kControlFd, &answers, sizeof answers, MSG_NOSIGNAL) != sizeof answers) leave();
  }

  // Waits for the worker's answers.   Returns: kDeclined if all answers are there; else kCrashed or kTimedOut.
  signed char watch(Questions& questions) {
    double before = processor_seconds(worker_);
    int times = 0;
    std::optional<Activity> programs;  // activity at the previous time limit
    Time until = after(limits_.seconds);
    for (;;) {
      const bool told = wait(until);
      if (questions.take(words_) > 0) {
        before = processor_seconds(worker_);
        times = 0;
        programs.reset();
        until = after(limits_.seconds);
      }
      if (told) return questions.answered() ? kDeclined : kCrashed;  // the worker claims that it has answered
      if (over_limits_) return kCrashed;
      if (has_ended(worker_fd_)) {
        questions.take(words_);
        return kCrashed;
      }
      if (Clock::now() < until) continue;
      // A timeout counts only if the code got the processor time, because load on the machine must not cause verdicts.
      if (limits_.program && times < kMostWaits) {  // the worker itself only waits for the program
        const Activity now = activity_of_descendants(kMostProcesses);
        const bool had_time = programs && now.seconds - programs->seconds >= 0.9 * limits_.seconds;
        programs = now;
        if (now.wants_processor && !had_time) {
          ++times;
          until = after(limits_.seconds);
          continue;
        }
      }
      if (++times >= most_times() || processor_seconds(worker_) - before >= 0.9 * limits_.seconds) return kTimedOut;
      until = after(limits_.seconds);
    }
  }

  // Waits for an event, but at most until `until`.   Returns: whether the worker claims that it has answered.
  bool wait(Time until) {
    pollfd news[] = {{talk_, POLLIN, 0}, {worker_fd_, POLLIN, 0}, {kControlFd, POLLIN, 0}};
    wait_for(news, 3, until);
    if (news[2].revents) leave();  // nobody is waiting for the answers
    if (Clock::now() >= next_look_) {
      tell_alive();
      reap();
      over_limits_ = !within_limits();
    }
    // Once a worker has ended, the next message may announce a new worker, and must not be read here.
    if (news[1].revents || !(news[0].revents & POLLIN)) return false;
    Answered said{};
    pid_t sender = 0;
    const ssize_t received = receive(&said, sizeof said, sender);
    if (received == 0) return true;  // nobody holds the socket any more
    if (received != sizeof said || said.says != Says::answered || said.nonce != nonce_) return false;
    nanoseconds_ = said.nanoseconds;
    return true;
  }

  // Receives a message, and the sender's process id as the system reports it.   Returns: the size of the message in
  // bytes; -1 if there is none.
  ssize_t receive(void* to, std::size_t size, pid_t& sender) {
    iovec part{to, size};
    alignas(cmsghdr) char more[CMSG_SPACE(sizeof(ucred))];
    msghdr message{nullptr, 0, &part, 1, more, sizeof more, 0};
    const ssize_t received = recvmsg(talk_, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC | MSG_TRUNC);
    for (cmsghdr* c = received > 0 ? CMSG_FIRSTHDR(&message) : nullptr; c; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_CREDENTIALS) continue;
      ucred who;
      std::memcpy(&who, CMSG_DATA(c), sizeof who);
      sender = who.pid;
    }
    return received;
  }

  // Starts the process that loads the code, and waits for it to do so.   Returns: whether the code is loaded; if not,
  // why_ has the reason.
  bool load(Loaded& loaded) {
    int talk[2];
    const int yes = 1;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, talk) != 0 ||
        setsockopt(talk[0], SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes) != 0) {
      why_ = fmt::format("cannot make a socket: {}", std::strerror(errno));
      return false;
    }
    why_ = "crashed while it was loaded";
    loader_ = fork();
    if (loader_ == 0) become_loader(talk[1]);
    if (loader_ < 0) why_ = fmt::format("cannot start a process: {}", std::strerror(errno));
    close(talk[1]);
    talk_ = talk[0];
    loader_fd_ = loader_ > 0 ? open_process(loader_) : -1;
    const Time until = after(kLoadSeconds);
    while (loader_fd_ >= 0) {
      if (!wait_for_message(until)) break;
      pid_t sender = 0;
      char bytes[sizeof(Loaded)];
      const ssize_t received = receive(bytes, sizeof bytes, sender);
      if (received == 0) break;  // nobody holds the socket any more
      if (received != sizeof bytes || !read_loaded(bytes, loaded)) continue;
      if (loaded.says == Says::refused) why_ = loaded.text;
      return loaded.says == Says::loaded;
    }
    return false;
  }

  [[noreturn]] void become_loader(int talk) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // Even without a namespace, signals to the code's process group must not reach the supervisor or its guardian.
    setsid();
    const int given[] = {kSupervisorPairsFd, words_fd_, talk, kSupervisorCodeFd};
    const int to[] = {kPairsFd, kWordsFd, kTalkFd, kCodeFd};
    const int count = limits_.has_code ? 4 : 3;
    int from[4];
    for (int i = 0; i < count; ++i) from[i] = fcntl(given[i], F_DUPFD, 16);
    for (int i = 0; i < count; ++i) dup2(from[i], to[i]);
    close_range(static_cast<unsigned>(to[count - 1]) + 1, ~0u, 0);
    if (limits_.bytes > 0) {  // the code needs no device driver
      drop_rights();
      forbid_calls(limits_.system_v);
    }
    execv("/proc/self/exe", arguments_);
    _exit(127);
  }

  // Waits for a message from the loader or its workers.   Returns: false if the loader ended or stopped, the time is
  // up, or a limit is exceeded. If it returns false, why_ has the reason, unless the loader ended.
  bool wait_for_message(Time until) {
    while (Clock::now() < until) {
      pollfd news[] = {{talk_, POLLIN, 0}, {loader_fd_, POLLIN, 0}, {kControlFd, POLLRDHUP, 0}};
      wait_for(news, 3, until);
      if (news[2].revents & (POLLHUP | POLLERR | POLLRDHUP)) leave();
      if (news[0].revents & POLLIN) return true;
      if (news[0].revents || news[1].revents) return false;
      if (Clock::now() < next_look_) continue;
      tell_alive();
      reap();
      if (is_stopped(loader_)) break;
      if (within_limits()) continue;
      why_ = fmt::format("used more than {} MiB, {} processes or {} descriptors while it was loaded",
                         limits_.bytes >> 20, kMostProcesses, kMostDescriptors);
      return false;
    }
    why_ =
        is_stopped(loader_) ? "stopped while it was loaded" : fmt::format("was not loaded within {} s", kLoadSeconds);
    return false;
  }

  // Waits for the loader's next worker.   Returns: whether that worker is ready.
  bool await_worker() {
    const Time until = after(kLoadSeconds);
    while (wait_for_message(until)) {
      Says said{};
      pid_t sender = 0;
      const ssize_t received = receive(&said, sizeof said, sender);
      if (received == 0) return false;  // nobody holds the socket any more
      if (received != sizeof said || said != Says::ready || sender <= 1) continue;
      const int fd = open_process(sender);  // opened first, so that no other process gets the id during the checks
      if (fd >= 0 && is_descendant(sender) && !has_ended(fd)) {
        worker_ = sender;
        worker_fd_ = fd;
        return true;
      }
      close(fd);
    }
    return false;
  }

  // Ends the worker and the processes that it started. The process that loaded the code forks the next worker.
  void end_worker() {
    if (over_limits_) return end_all();
    syscall(SYS_pidfd_send_signal, worker_fd_, SIGKILL, nullptr, 0);
    const Time until = after(5);
    while (!has_ended(worker_fd_) && Clock::now() < until) poll(nullptr, 0, 1);
    close(worker_fd_);
    worker_ = worker_fd_ = -1;
    if (!end_children(loader_, tell_alive) || has_ended(loader_fd_)) end_all();
  }

  void end_all() {
    if (!end_children(-1, tell_alive))
      _exit(1);  // the code starts processes faster than they can be killed, but the namespace ends with this process
    for (int* fd : {&talk_, &loader_fd_, &worker_fd_}) {
      if (*fd >= 0) close(*fd);
      *fd = -1;
    }
    loader_ = worker_ = -1;
    over_limits_ = false;
  }

  // Reaps orphans that have ended.
  void reap() {
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
  }

  bool within_limits() {
    next_look_ = Clock::now() + kLookEvery;
    if (limits_.bytes == 0) return true;
    const Usage most{kMostProcesses, limits_.bytes, kMostDescriptors};
    return usage_of_descendants(most).within(most);
  }

  static bool has_ended(int process_fd) {
    pollfd ended{process_fd, POLLIN, 0};
    return process_fd < 0 || poll(&ended, 1, 0) > 0;
  }

  // How many time limits the worker may wait: 100 if it waits for a processor, 3 for a disk, otherwise 1. By vfork,
  // code can pretend to wait for a disk.
  int most_times() const {
    const char state = process_state(worker_);
    return state == 'R' ? 100 : state == 'D' ? 3 : 1;
  }

  const Limits& limits_;
  char* const* arguments_;
  const std::uint64_t* words_ = nullptr;
  int words_fd_ = -1, talk_ = -1;
  pid_t loader_ = -1, worker_ = -1;
  int loader_fd_ = -1, worker_fd_ = -1;  // process descriptors
  bool of_blocks_ = false, over_limits_ = false;
  std::uint64_t nonce_ = 0, nanoseconds_ = 0;
  Time next_look_ = Clock::now() + kLookEvery;
  std::string why_;
};

}  // namespace

int supervise(const Limits& limits, char* const* arguments) { return Supervisor(limits, arguments).run(); }

int supervise_program(double seconds, std::uint64_t bytes, const std::string& scratch, char* const* words) {
  const Time until = after(seconds);
  const pid_t self = getpid(), program = fork();
  if (program == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != self) _exit(0);
    setsid();  // as in become_loader
    drop_rights();
    execvp(words[0], words);
    fmt::print(stderr, "{}\n", std::strerror(errno));
    _exit(127);
  }
  const int process = program > 0 ? open_process(program) : -1;
  int status = -1;
  bool ended = false, wanted = true;
  while (process >= 0 && wanted && !ended && Clock::now() < until) {
    pollfd news[] = {{process, POLLIN, 0}, {kControlFd, POLLRDHUP, 0}};
    if (poll(news, 2, 100) < 0 && errno != EINTR) break;
    ended = news[0].revents;
    wanted = !news[1].revents;
    tell_alive();
    if (!ended && usage_of_descendants({~0ull, bytes, ~0ull}).bytes > bytes) {
      status = kTookTooMuchMemory;
      break;
    }
  }
  if (ended && waitpid(program, &status, 0) == program)
    status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  end_children(-1, tell_alive);
  std::error_code ignored;
  if (wanted) wanted = send(kControlFd, &status, sizeof status, MSG_NOSIGNAL) == sizeof status;
  if (!wanted) std::filesystem::remove_all(scratch, ignored);
  return 0;
}

}  // namespace graze::subjects
