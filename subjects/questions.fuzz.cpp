// SPDX-License-Identifier: Apache-2.0
// Plays hostile subjects: forged, early, late and destroyed answers in shared memory, arbitrary messages, and arbitrary
// program output. The questions must always end, and an accepted failure must stay a failure.
#include "subjects/questions.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/fuzz_target.h"
#include "subjects/line_protocol.h"

namespace graze::subjects {
namespace {

// Checks that a step may change the answers `before` into the answers `now`.
void must_follow(std::span<const signed char> before, std::span<const signed char> now) {
  for (std::size_t i = 0; i < now.size(); ++i) {
    must_hold(now[i] >= kDeclined && now[i] <= kUnstable, "an answer is one of enum Answer");
    must_hold(before[i] <= kIntersects || now[i] == before[i] || now[i] == kCrashed, "a failure stays one");
  }
}

void ask_hostile(std::string_view bytes) {
  const std::size_t count = 1 + static_cast<unsigned char>(bytes[0]) % 9;
  const bool program = bytes[0] & 128;
  Questions questions(count, bytes[0] & 64, program);
  static std::uint64_t words[kWords];
  const auto set_words = [&](int byte) {
    for (std::uint64_t* pass : {words, words + kMostAsked}) std::memset(pass, byte, 16 * sizeof *pass);
  };
  set_words(0);
  std::uint64_t nonce = 1;
  std::size_t failures = 0;
  bool asked = false;
  std::array<signed char, kMostAsked> before_question{};
  for (std::size_t at = 1; at + 1 < bytes.size() && !questions.done(); at += 2) {
    const auto what = static_cast<unsigned char>(bytes[at]), how = static_cast<unsigned char>(bytes[at + 1]);
    if (!asked || questions.answered()) {
      std::copy(questions.answers().begin(), questions.answers().end(), before_question.begin());
      const Question question = questions.next(++nonce);
      std::uint64_t beyond = 0;
      for (std::size_t w = 0; w < question.first.size(); ++w)
        beyond |= (question.first[w] | question.second[w]) >> (w == 0 ? count : 0);
      must_hold(beyond == 0, "only pairs of the block are asked about");
      must_hold((question.first[0] | question.second[0]) != 0 && question.count == count, "a question asks something");
      asked = true;
    }
    std::array<signed char, kMostAsked> before;
    std::copy(questions.answers().begin(), questions.answers().end(), before.begin());
    const bool second = how & 32;
    std::uint64_t& word = words[(second ? kMostAsked : 0) + how % 16];
    const auto answer = static_cast<signed char>(static_cast<int>(what >> 4) % 3 - 1);
    switch (what % 8) {
      case 0:
      case 1: {  // writes all answers of a pass, as an honest worker does
        for (std::size_t i = 0; i < count; ++i)
          words[(second ? kMostAsked : 0) + i] = word_of(nonce, second, i, answer);
        break;
      }
      case 2:
        word = word_of(nonce, second, how % 16, answer);
        break;
      case 3:
        word = word_of(nonce - 1, second, how % 16, answer);
        break;
      case 4:
        word ^= std::uint64_t{1} << how % 64;
        break;
      case 5:
        set_words(how);
        break;
      case 6: {
        const std::size_t taken = questions.take(words);
        must_hold(taken <= 2 * count, "an answer counts once");
        must_hold(questions.take(words) == 0, "and not again");
        break;
      }
      default:
        if (questions.answered() && !program) break;
        questions.failed(how & 1 ? kCrashed : kTimedOut);
        asked = false;
        if (program) before = before_question;  // no answer to a failed question counts
        must_hold(++failures <= (program ? 1 + 12 * count : 1 + 4 * count), "the number of failures is limited");
    }
    must_follow({before.data(), count}, questions.answers());
  }
  questions.give_up(kCrashed);
  must_hold(questions.done(), "after give_up no question is left");
  must_follow({questions.answers().data(), count}, questions.answers());
  reached(failures + 100 * count);
}

void read_message(std::string_view bytes) {
  Loaded loaded;
  std::vector<char> padded(bytes.begin(), bytes.end());
  if (!bytes.empty() && bytes.back() & 1) padded.resize(sizeof loaded, bytes.back());
  if (!read_loaded(padded, loaded)) return;
  for (const char* text : {loaded.version, loaded.source, loaded.convention, loaded.symbol, loaded.text}) {
    for (const char* c = text; *c; ++c) must_hold(static_cast<unsigned char>(*c) >= ' ', "a text is one line");
  }
  must_hold(std::strlen(loaded.version) < sizeof loaded.version && std::strlen(loaded.text) < sizeof loaded.text,
            "a text ends");
  must_hold(loaded.has_f32 <= 1 && loaded.has_f64 <= 1 && loaded.outside < 16, "flags have allowed values");
}

void read_lines(std::string_view bytes) {
  Lines lines;
  std::string line;
  std::size_t taken = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 7) {
    lines.add(bytes.data() + at, std::min<std::size_t>(7, bytes.size() - at));
    while (lines.take(line)) {
      ++taken;
      try {
        const signed char answer = answer_of_line(line);
        must_hold(answer >= kDeclined && answer <= kIntersects && line.size() == 1, "an answer is a single letter");
      } catch (const std::runtime_error& error) {
        must_be_one_line(error.what());
      }
    }
  }
  must_hold(taken == static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n')),
            "every line is taken once");
}

const RegisterFuzzTarget kQuestions("questions", [](std::string_view bytes) {
  if (bytes.size() < 2) return;
  const char which = bytes[0];
  bytes.remove_prefix(1);
  which == 'm' ? read_message(bytes) : which == 'l' ? read_lines(bytes) : ask_hostile(bytes);
});

}  // namespace
}  // namespace graze::subjects
