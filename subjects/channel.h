// SPDX-License-Identifier: Apache-2.0
// What passes between graze, the supervisor of a subject, and the worker in which foreign code runs. Whatever the
// worker sends or writes may be forged: the supervisor reads it once, copies it and checks it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace graze::subjects {

inline constexpr std::size_t kMostAsked = 1024;  // pairs in a block

// A pair's answer; those after kIntersects are not for the worker to give.
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

// graze to the supervisor: the pairs lie in memory that only graze can write.
struct Block {
  std::uint32_t count;
};

// The supervisor to graze.
struct Answers {
  std::uint64_t nanoseconds;  // processor time of the worker's first pass over all pairs; 0: not known
  std::uint32_t count;
  signed char answers[kMostAsked];
};

// The supervisor to the worker: the pairs to ask about, forward, and those to ask about again after that, backward.
struct Question {
  std::uint64_t nonce;
  std::int32_t worker;   // process id of the worker that is meant: the question may outlive it
  std::uint32_t count;   // pairs in the block
  std::uint32_t singly;  // one pair at a time, also of a subject that takes blocks
  Chosen first, second;
};

// The worker to the supervisor; the sender's process id comes with a message, from the system.
enum class Says : std::uint32_t { loaded, refused, ready, answered };

struct Answered {
  Says says;
  std::uint32_t unused;
  std::uint64_t nonce;
  std::uint64_t nanoseconds;
};

struct Loaded {
  Says says;  // loaded, or refused: `text` says why
  std::uint32_t outside;
  std::uint32_t has_f32, has_f64, of_blocks;
  std::uint32_t describes_itself;  // by a struct graze_subject
  char version[256], source[512], convention[512];
  char symbol[512];  // of the library, that was taken
  char text[8192];   // of a program: its first line in answer to `describe`
};

// An answer as it stands in shared memory: the pair, the pass, the answer and a check, which only the question's nonce
// explains.
inline std::uint64_t word_of(std::uint64_t nonce, bool second, std::size_t pair, signed char answer) {
  const std::uint64_t content = pair << 3 | std::uint64_t{second} << 2 | static_cast<std::uint64_t>(answer + 2);
  std::uint64_t check = (nonce ^ content) * 0x9e3779b97f4a7c15;  // the finaliser of SplitMix64
  check = (check ^ check >> 30) * 0xbf58476d1ce4e5b9;
  check = (check ^ check >> 27) * 0x94d049bb133111eb;
  return (check ^ check >> 31) << 16 | content;
}
static_assert(kMostAsked << 3 <= 1 << 16);

inline constexpr std::size_t kWords = 2 * kMostAsked;  // of both passes

// In the worker: writes an answer to the question where the supervisor looks for it.
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
