// SPDX-License-Identifier: Apache-2.0
#include "subjects/questions.h"

#include <algorithm>
#include <cstring>

#include "subjects/include/graze/subject.h"

namespace graze::subjects {

Question Questions::next(std::uint64_t nonce) {
  if (answered() && asked_ > 0) most_ = std::min(2 * most_, 2 * kMostAsked);
  nonce_ = nonce;
  asked_ = taken_ = 0;
  second_before_ = second_;
  at_before_ = at_;
  answers_before_ = answers_;
  Question question{nonce, 0, static_cast<std::uint32_t>(count_), singly_, {}, {}};
  const auto choose = [&](Chosen& chosen, std::size_t i) {
    if (asked_ == most_) return;
    chosen[i / 64] |= std::uint64_t{1} << i % 64;
    ++asked_;
  };
  for (std::size_t i = second_ ? count_ : at_; i < count_; ++i) choose(question.first, i);
  for (std::size_t i = second_ ? at_ : count_; i-- > 0;) {
    if (i >= at_ || answers_[i] <= kIntersects) choose(question.second, i);
  }
  return question;
}

// Skips pairs that failed, because they need no second answer.
void Questions::skip_failed() {
  while (second_ && at_ > 0 && answers_[at_ - 1] > kIntersects) --at_;
}

void Questions::advance() {
  if (second_) {
    --at_;
  } else if (++at_ == count_) {
    second_ = true;
  }
  skip_failed();
  if (!done()) return;
  for (std::size_t i = 0; i < count_; ++i) {
    if (failed_here_[i] != 0 && answers_[i] <= kIntersects) answers_[i] = failed_here_[i];
  }
}

std::size_t Questions::take(const std::uint64_t* words) {
  const std::size_t before = taken_;
  while (!answered()) {
    const std::size_t pair = next_pair();
    const std::uint64_t word = __atomic_load_n(words + (second_ ? kMostAsked : 0) + pair, __ATOMIC_ACQUIRE);
    const auto answer = static_cast<signed char>(static_cast<int>(word & 3) - 2);
    if (answer < kDeclined || word != word_of(nonce_, second_, pair, answer)) break;
    if (!second_) {
      answers_[pair] = answer;
    } else if (answers_[pair] != answer) {
      answers_[pair] = kUnstable;
    }
    advance();
    ++taken_;
  }
  return taken_ - before;
}

void Questions::failed(signed char how) {
  const std::size_t here = answered() ? std::min(second_ ? at_ : at_ - 1, count_ - 1) : next_pair();
  if (program_) {
    second_ = second_before_;
    at_ = at_before_;
    answers_ = answers_before_;
  }
  if (!singly_) {
    singly_ = true;
  } else if (program_ && asked_ > 1) {
    most_ = std::max<std::size_t>(1, std::min(taken_, asked_ / 2));
    if (taken_ > 0) failed_here_[here] = how;
  } else if (taken_ == 0 && asked_ > 1) {
    most_ = 1;
  } else {
    answers_[next_pair()] = how;
    failed_here_.fill(0);  // this pair caused the earlier failures
    advance();
    most_ = program_ ? 1 : 2 * kMostAsked;
  }
  asked_ = taken_ = 0;
}

void Questions::give_up(signed char how) {
  while (!done()) {
    answers_[next_pair()] = how;
    advance();
  }
}

namespace {

template <std::size_t size>
void end_text(char (&text)[size]) {
  text[size - 1] = '\0';
  for (char* c = text; *c; ++c) {
    if (static_cast<unsigned char>(*c) < ' ' || *c == '\x7f') *c = ' ';
  }
}

}  // namespace

bool read_loaded(std::span<const char> bytes, Loaded& loaded) {
  if (bytes.size() != sizeof loaded) return false;
  std::memcpy(&loaded, bytes.data(), sizeof loaded);
  if (loaded.says != Says::loaded && loaded.says != Says::refused) return false;
  for (std::uint32_t* flag : {&loaded.has_f32, &loaded.has_f64, &loaded.of_blocks, &loaded.describes_itself})
    *flag = *flag != 0;
  loaded.outside &= GRAZE_OUTSIDE_TOUCHING | GRAZE_OUTSIDE_COPLANAR | GRAZE_OUTSIDE_DEGENERATE | GRAZE_OUTSIDE_SHARED;
  end_text(loaded.version);
  end_text(loaded.source);
  end_text(loaded.convention);
  end_text(loaded.symbol);
  end_text(loaded.text);
  return true;
}

}  // namespace graze::subjects
