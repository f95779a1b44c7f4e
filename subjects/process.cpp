// SPDX-License-Identifier: Apache-2.0
#include "subjects/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "core/programs/supervisor_process.h"
#include "core/stop.h"
#include "core/text.h"
#include "subjects/questions.h"
#include "subjects/source_build.h"

namespace graze::subjects {
namespace {

constexpr std::size_t kMostFailuresKept = std::size_t{1} << 20;

Verdict verdict_of(signed char answer) {
  static constexpr Verdict kVerdicts[] = {Verdict::disjoint, Verdict::intersects, Verdict::crashed, Verdict::timed_out,
                                          Verdict::unstable};  // from kDisjoint to kUnstable
  return answer < kDisjoint || answer > kUnstable ? Verdict::declined : kVerdicts[answer];
}

// The subject's text, made valid UTF-8 as results require.
std::string fit(const char* text) {
  using Json = nlohmann::json;
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

// Shared memory for the pairs, which the supervisor can read and only this process can write.
class SharedPairs {
 public:
  SharedPairs() : fd_(memfd_create("graze-pairs", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    if (fd_ >= 0 && ftruncate(fd_, kPairsBytes) == 0)
      at_ = mmap(nullptr, kPairsBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, 0);
    constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;
    if (at_ == MAP_FAILED || fcntl(fd_, F_ADD_SEALS, kSeals) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot share memory with a subject");
  }
  ~SharedPairs() {
    close(fd_);
    munmap(at_, kPairsBytes);
  }
  SharedPairs(const SharedPairs&) = delete;
  SharedPairs& operator=(const SharedPairs&) = delete;
  int fd() const { return fd_; }
  void* at() const { return at_; }

 private:
  int fd_;
  void* at_ = MAP_FAILED;
};

std::vector<std::string> arguments_of(const Code& code, bool describe) {
  std::error_code none;  // only an existing folder can be protected
  std::filesystem::create_directories(cache_folder(), none);
  return {code.kind,
          code.what,
          code.name,
          code.scalar,
          std::to_string(code.memory),
          fmt::format("{}", code.timeout),
          describe ? "1" : "0",
          code.namespaces ? "1" : "0",
          cache_folder()};
}

// The code, with the content of its file.   Throws: std::runtime_error if the file cannot be read.
Code loadable(Code code) {
  if (code.kind != "command" && !code.content)
    code.content =
        std::make_shared<SealedCopy>(std::filesystem::path(code.what).filename().string(), code_in(code.what));
  return code;
}

std::vector<int> shared_with(const Code& code, int pairs) {
  return code.content ? std::vector{pairs, code.content->fd()} : std::vector{pairs};
}

}  // namespace

class HostProcess {
 public:
  HostProcess(const Code& code, bool describe)
      : supervisor_(code.kind == "device" ? "graze-subject-device" : "graze-subject-host", arguments_of(code, describe),
                    shared_with(code, pairs_.fd()), -1) {
    char bytes[sizeof(Loaded)] = {};
    std::string why;
    if (supervisor_.receive(bytes, sizeof bytes) != sizeof bytes || !read_loaded(bytes, loaded_)) {
      why = supervisor_.stopped() ? "stopped its supervisor while it was loaded"
                                  : "ended its supervisor while it was loaded";
    } else if (loaded_.says == Says::refused) {
      why = loaded_.text;
    } else {
      return;
    }
    // The message must name the file or the command.
    if (code.kind != "device" && why.find(code.what) == why.npos)
      why = (code.kind == "command" ? shown(code.what) : code.what) + ": " + why;
    throw CannotLoad(why);
  }

  struct CannotLoad : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  const Loaded& loaded() const { return loaded_; }

  // Returns: the answers; nullopt if the supervisor cannot continue; then this object must not be used again.
  std::optional<Answers> ask(const Pair* pairs, std::size_t count, bool in_double) {
    if (in_double) {
      std::copy_n(&pairs[0].a[0].x, count * 18, static_cast<double*>(pairs_.at()));
    } else {
      std::memcpy(pairs_.at(), pairs, count * sizeof(Pair));
    }
    return ask(count);
  }
  std::optional<Answers> ask(const DoublePair* pairs, std::size_t count, bool) {
    std::memcpy(pairs_.at(), pairs, count * sizeof(DoublePair));
    return ask(count);
  }

  bool silent() const { return supervisor_.silent(); }

 private:
  // Asks about the pairs in the shared memory.
  std::optional<Answers> ask(std::size_t count) {
    const Block block{static_cast<std::uint32_t>(count)};
    Answers answers;
    if (!supervisor_.send(&block, sizeof block) || supervisor_.receive(&answers, sizeof answers) != sizeof answers ||
        answers.count != count)
      return std::nullopt;
    return answers;
  }

  SharedPairs pairs_;
  SupervisorProcess supervisor_;
  Loaded loaded_{};
};

namespace {

// Returns: the code's description of itself. If a program fails when asked for a description, it is loaded again and
// not asked.
Loaded loaded_of(const Code& code) {
  if (code.kind == "command") {
    try {
      return HostProcess(code, true).loaded();
    } catch (const HostProcess::CannotLoad&) {
      return HostProcess(code, false).loaded();
    }
  }
  return HostProcess(loadable(code), true).loaded();
}

}  // namespace

Description describe(const Code& code) {
  const StopSignals stops;
  const Loaded c = loaded_of(code);
  return {c.has_f32 != 0,    c.has_f64 != 0,          c.outside,     fit(c.version), fit(c.source),
          fit(c.convention), c.describes_itself != 0, fit(c.symbol), c.text,         c.of_blocks != 0};
}

ForeignProcesses::ForeignProcesses(Code code, Scalar scalar) : code_(loadable(std::move(code))), scalar_(scalar) {
  code_.scalar = name(scalar);
}

ForeignProcesses::~ForeignProcesses() = default;

std::unique_ptr<HostProcess> ForeignProcesses::idle_or_new() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<HostProcess> process = std::move(idle_.back());
      idle_.pop_back();
      return process;
    }
  }
  try {
    return std::make_unique<HostProcess>(code_, false);
  } catch (const HostProcess::CannotLoad&) {
    return nullptr;  // the code could be loaded before, so it caused this failure itself
  }
}

template <class AnyPair>
void ForeignProcesses::decide_all(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects,
                                  std::uint64_t* declined) {
  std::unique_lock alone(alone_, std::defer_lock);
  if (code_.alone) alone.lock();
  const bool in_double = decides_doubles();
  std::unique_ptr<HostProcess> process = idle_or_new();
  bool loads = process != nullptr;
  signed char how = kCrashed;  // the verdict for pairs without an answer
  // Returns: nullopt if the supervisor ended, or if the code can no longer be loaded.
  const auto ask = [&](const AnyPair* of, std::size_t size) {
    std::optional<Answers> answers;
    if (!process && loads) loads = (process = idle_or_new()) != nullptr;
    if (process) answers = process->ask(of, size, in_double);
    how = process && process->silent() ? kTimedOut : kCrashed;
    if (!answers) process.reset();
    return answers;
  };
  std::fill_n(intersects, (count + 63) / 64, std::uint64_t{0});
  std::fill_n(declined, (count + 63) / 64, std::uint64_t{0});
  std::optional<std::uint64_t> nanoseconds = 0;
  for (std::size_t begin = 0; begin < count; begin += kMostAsked) {
    const std::size_t size = std::min(count - begin, kMostAsked);
    std::optional<Answers> answers = ask(pairs + begin, size);
    if (!answers) {  // asks about one pair at a time, to find the pair at fault
      answers.emplace();
      for (std::size_t i = 0; i < size; ++i) {
        const std::optional<Answers> of_pair = ask(pairs + begin + i, 1);
        answers->answers[i] = of_pair ? of_pair->answers[0] : how;
      }
    }
    nanoseconds =
        nanoseconds && answers->nanoseconds > 0 ? std::optional(*nanoseconds + answers->nanoseconds) : std::nullopt;
    for (std::size_t i = 0; i < size; ++i) {
      const Verdict verdict = verdict_of(answers->answers[i]);
      const std::size_t at = begin + i;
      const std::uint64_t bit = std::uint64_t{1} << at % 64;
      if (verdict == Verdict::intersects || is_failure(verdict)) intersects[at / 64] |= bit;
      if (verdict == Verdict::declined || is_failure(verdict)) declined[at / 64] |= bit;
      if (!is_failure(verdict)) continue;
      const std::lock_guard lock(mutex_);
      if (failures_.size() == kMostFailuresKept) failures_.clear();
      failures_[std::string(reinterpret_cast<const char*>(&pairs[at]), sizeof(AnyPair))] = verdict;
    }
  }
  // The processes started after the files were read, and have answered. So if the files are unchanged now, the
  // processes ran the code that was hashed.
  expect_unchanged(code_.files);
  const std::lock_guard lock(mutex_);
  nanoseconds_ = nanoseconds;
  if (process) idle_.push_back(std::move(process));
}

void ForeignProcesses::decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects,
                              std::uint64_t* declined) {
  decide_all(pairs, count, intersects, declined);
}

void ForeignProcesses::decide_doubles(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                                      std::uint64_t* declined) {
  decide_all(pairs, count, intersects, declined);
}

std::optional<std::uint64_t> ForeignProcesses::nanoseconds() const {
  const std::lock_guard lock(mutex_);
  return nanoseconds_;
}

std::unique_ptr<ForeignProcesses> ForeignProcesses::anew() const {
  return std::make_unique<ForeignProcesses>(code_, scalar_);
}

int ForeignProcesses::content() const { return code_.content ? code_.content->fd() : -1; }

template <class AnyPair>
Verdict ForeignProcesses::failure_of(const AnyPair& pair) {
  const std::string key(reinterpret_cast<const char*>(&pair), sizeof pair);
  const auto kept = [&]() -> std::optional<Verdict> {
    const std::lock_guard lock(mutex_);
    const auto found = failures_.find(key);
    if (found == failures_.end()) return std::nullopt;
    return found->second;
  };
  if (const std::optional<Verdict> verdict = kept()) return *verdict;
  std::uint64_t intersects, declined;
  decide_all(&pair, 1, &intersects, &declined);
  return kept().value_or(Verdict::unstable);  // the code failed on this pair before, and does not fail now
}

Verdict ForeignProcesses::failure(const Pair& pair) { return failure_of(pair); }
Verdict ForeignProcesses::failure_on_doubles(const DoublePair& pair) { return failure_of(pair); }

}  // namespace graze::subjects
