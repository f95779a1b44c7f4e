// SPDX-License-Identifier: Apache-2.0
// Messages between graze, a subject's supervisor, and the worker in which foreign code runs. The worker may forge
// anything it sends, so the supervisor copies each message or word once, and checks the copy.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace graze::subjects {

inline constexpr std::size_t kMostAsked = 1024;  // pairs in a block

// The answer for a pair. A worker may send only kDeclined, kDisjoint and kIntersects. Only the supervisor gives the
// other answers.
enum Answer : signed char {
  kDeclined = -1,
  kDisjoint = 0,
  kIntersects = 1,
  kCrashed = 2,
  kTimedOut = 3,
  kUnstable = 4
};

using Chosen = std::array<std::uint64_t, kMostAsked / 64>;  // one bit for each pair of a block

inline bool is_chosen(const Chosen& chosen, std::size_t pair) { return chosen[pair / 64] >> pair % 64 & 1; }

// A message from graze to the supervisor. The pairs are in shared memory that only graze can write.
struct Block {
  std::uint32_t count;
};

// The reply from the supervisor to graze.
struct Answers {
  std::uint64_t nanoseconds;  // processor time of the worker's first pass over all pairs; 0: unknown
  std::uint32_t count;
  signed char answers[kMostAsked];
};

// A message from the supervisor to the worker: the pairs to ask about in a forward pass, and those in a backward pass.
struct Question {
  std::uint64_t nonce;
  std::int32_t worker;   // process id of the worker that is asked, which may end before it reads the question
  std::uint32_t count;   // pairs in the block
  std::uint32_t singly;  // ask one pair at a time, even if the subject takes blocks
  Chosen first, second;
};

// A message from the worker to the supervisor. The system adds the sender's process id to each message.
enum class Says : std::uint32_t { loaded, refused, ready, answered };

struct Answered {
  Says says;
  std::uint32_t unused;
  std::uint64_t nonce;
  std::uint64_t nanoseconds;
};

struct Loaded {
  Says says;  // `loaded`; or `refused`, with the reason in `text`
  std::uint32_t outside;
  std::uint32_t has_f32, has_f64, of_blocks;
  std::uint32_t describes_itself;  // has a struct graze_subject
  char version[256], source[512], convention[512];
  char symbol[512];  // the library's symbol that was loaded
  char text[8192];   // the first line of a program's answer to `describe`
};

// An answer's word in shared memory: the pair, the pass, the answer, and a check value that depends on the question's
// nonce.
inline std::uint64_t word_of(std::uint64_t nonce, bool second, std::size_t pair, signed char answer) {
  const std::uint64_t content = pair << 3 | std::uint64_t{second} << 2 | static_cast<std::uint64_t>(answer + 2);
  std::uint64_t check = (nonce ^ content) * 0x9e3779b97f4a7c15;  // finaliser of SplitMix64
  check = (check ^ check >> 30) * 0xbf58476d1ce4e5b9;
  check = (check ^ check >> 27) * 0x94d049bb133111eb;
  return (check ^ check >> 31) << 16 | content;
}
static_assert(kMostAsked << 3 <= 1 << 16);

inline constexpr std::size_t kWords = 2 * kMostAsked;  // for both passes

// Called in the worker: writes an answer where the supervisor reads it.
inline void put_answer(std::uint64_t* words, const Question& question, bool second, std::size_t pair,
                       signed char answer) {
  __atomic_store_n(&words[(second ? kMostAsked : 0) + pair], word_of(question.nonce, second, pair, answer),
                   __ATOMIC_RELEASE);
}

inline constexpr std::size_t kPairsBytes = kMostAsked * 18 * sizeof(double);

// The supervisor's descriptors, then the worker's.
inline constexpr int kControlFd = 3, kSupervisorPairsFd = 4, kSupervisorCodeFd = 5;
inline constexpr int kPairsFd = 3, kWordsFd = 4, kTalkFd = 5, kCodeFd = 6;  // a command has no kCodeFd

}  // namespace graze::subjects
