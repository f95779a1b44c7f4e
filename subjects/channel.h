// SPDX-License-Identifier: Apache-2.0
// What a campaign and a subject's host process share: memory, and a socket on which single letters go to and fro.
#pragma once

#include <cstddef>
#include <cstdint>

namespace graze::subjects {

inline constexpr std::size_t kMostAsked = 1024;  // pairs in a block

// A pair's answer besides those of graze/subject.h.
enum Answer : signed char { kDeclined = -1, kDisjoint = 0, kIntersects = 1, kCrashed = 2, kTimedOut = 3, kUnstable = 4 };

// Of the process that asks: to the host.
enum Letter : char {
  kAsk = 'a',       // there are pairs, from the state on
  kAnswered = 'k',  // all have their answers
  kReady = 'r',     // the code is loaded
  kRefused = 'e',   // it is not; why stands in the message
  kDied = 'd'       // the worker ended in the middle; another stands ready
};

// The host's process loads the code and forks a worker, which asks it. When the worker dies, the host forks another,
// and the asking process says from where it goes on.
struct Channel {
  // Of the pairs at hand. A pass asks them all, forward or backward; `next` is the pair that the worker is at.
  std::uint64_t count;
  volatile std::uint64_t next;
  volatile std::uint32_t second;   // the pass that asks again
  volatile std::uint32_t singly;   // also of a subject that takes blocks
  volatile std::int32_t worker;    // process id; 0 where there is none
  volatile std::int32_t status;    // of the worker that died, as waitpid gives it
  volatile std::uint64_t nanoseconds;  // of processor time, of the first pass over all pairs; 0 where it was interrupted
  signed char answers[kMostAsked];

  // Of the code, once it is loaded.
  std::uint32_t outside;
  std::uint32_t has_f32, has_f64, of_blocks;
  char version[256], source[512], convention[512];
  std::uint32_t describes_itself;  // by a struct graze_subject
  char symbol[512];                // of the library, that was taken
  char message[1024];  // why it was refused; empty, or what the worker said last
};

// The pairs lie in memory of their own, 18 numbers each, which the host's process cannot write.
inline constexpr std::size_t kPairsBytes = kMostAsked * 18 * sizeof(double);

// Descriptors of the host's process.
inline constexpr int kChannelFd = 3, kPairsFd = 4, kSocketFd = 5;

}  // namespace graze::subjects
