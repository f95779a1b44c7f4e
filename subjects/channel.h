// SPDX-License-Identifier: Apache-2.0
// Messages between graze, a subject's supervisor, and the worker in which foreign code runs. Anything that the worker
// sends or writes may be forged. So the supervisor reads it once, copies it and checks the copy.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace graze::subjects {

inline constexpr std::size_t kMostAsked = 1024;  // pairs in a block

// The answer for a pair. A worker may only send kDeclined to kIntersects; the supervisor gives the others.
enum Answer : signed char {
  kDeclined = -1,
  kDisjoint = 0,
  kIntersects = 1,
  kCrashed = 2,
  kTimedOut = 3,
  kUnstable = 4
};

using Chosen = std::array<std::uint64_t, kMostAsked / 64>;  // a bit for each pair of a block

inline bool is_chosen(const Chosen& chosen, std::size_t pair) { return chosen[pair / 64] >> pair % 64 & 1; }

// From graze to the supervisor. The pairs lie in memory that only graze can write.
struct Block {
  std::uint32_t count;
};

// From the supervisor to graze.
struct Answers {
  std::uint64_t nanoseconds;  // processor time of the worker's first pass over all pairs; 0: unknown
  std::uint32_t count;
  signed char answers[kMostAsked];
};

// From the supervisor to the worker: pairs to ask in a forward pass, and pairs to ask again in a later backward pass.
struct Question {
  std::uint64_t nonce;
  std::int32_t worker;   // process id of the worker that it is for; the question may outlive that worker
  std::uint32_t count;   // pairs in the block
  std::uint32_t singly;  // ask one pair at a time even if the subject takes blocks
  Chosen first, second;
};

// From the worker to the supervisor. The system adds the sender's process id to each message.
enum class Says : std::uint32_t { loaded, refused, ready, answered };

struct Answered {
  Says says;
  std::uint32_t unused;
  std::uint64_t nonce;
  std::uint64_t nanoseconds;
};

struct Loaded {
  Says says;  // loaded; or refused, and `text` has the reason
  std::uint32_t outside;
  std::uint32_t has_f32, has_f64, of_blocks;
  std::uint32_t describes_itself;  // has a struct graze_subject
  char version[256], source[512], convention[512];
  char symbol[512];  // the library's symbol that was loaded
  char text[8192];   // for a program: the first line of its answer to `describe`
};

// An answer in shared memory: pair, pass, answer, and a check value that depends on the question's nonce.
inline std::uint64_t word_of(std::uint64_t nonce, bool second, std::size_t pair, signed char answer) {
  const std::uint64_t content = pair << 3 | std::uint64_t{second} << 2 | static_cast<std::uint64_t>(answer + 2);
  std::uint64_t check = (nonce ^ content) * 0x9e3779b97f4a7c15;  // finaliser of SplitMix64
  check = (check ^ check >> 30) * 0xbf58476d1ce4e5b9;
  check = (check ^ check >> 27) * 0x94d049bb133111eb;
  return (check ^ check >> 31) << 16 | content;
}
static_assert(kMostAsked << 3 <= 1 << 16);

inline constexpr std::size_t kWords = 2 * kMostAsked;  // for both passes

// In the worker: writes an answer to the place where the supervisor reads it.
inline void put_answer(std::uint64_t* words, const Question& question, bool second, std::size_t pair,
                       signed char answer) {
  __atomic_store_n(&words[(second ? kMostAsked : 0) + pair], word_of(question.nonce, second, pair, answer),
                   __ATOMIC_RELEASE);
}

inline constexpr std::size_t kPairsBytes = kMostAsked * 18 * sizeof(double);

// Descriptors: of the supervisor, and of the worker.
inline constexpr int kControlFd = 3, kSupervisorPairsFd = 4, kSupervisorCodeFd = 5;
inline constexpr int kPairsFd = 3, kWordsFd = 4, kTalkFd = 5, kCodeFd = 6;  // the code is not there for a command

}  // namespace graze::subjects
