/* SPDX-License-Identifier: Apache-2.0
 * The main function of a program that answers for a subject on another processor, under an emulator, or on another
 * machine. For a toolchain, Graze compiles it together with a subject's source. C11 or C++, little-endian.
 *
 * Include this after the definition of `const struct graze_subject graze_subject`.
 *
 * First, the program writes a struct graze_hello to standard output. Then it reads questions from standard input
 * until the input ends. A question is a struct graze_question, `count` places (uint32_t each), and `count` pairs (18
 * float or double each). The answer to a question is `count` words of uint64_t: the graze_word of each place, in order.
 *
 * If GRAZE_PROGRAM_TYPES_ONLY is defined, this header has no main function and needs no subject.
 */
#ifndef GRAZE_PROGRAM_H
#define GRAZE_PROGRAM_H

#include <graze/subject.h>
#include <stdio.h>
#ifdef __cplusplus
#include <cstring>
#else
#include <string.h>
#endif
#ifndef __wasi__
#include <unistd.h>
#endif

struct graze_hello {
  char greeting[8]; /* "graze 1\n" */
  uint32_t order;   /* 1, in the program's byte order */
  uint32_t has;     /* 1: answers for float, 2: for double; or their sum */
};

struct graze_question {
  uint64_t nonce;
  uint32_t count;     /* at most GRAZE_MOST_ASKED */
  uint32_t is_double; /* 0 or 1 */
};

/* Two places for each pair of a block of 1,024: forward and backward. */
#define GRAZE_MOST_ASKED 2048

#ifndef GRAZE_PROGRAM_TYPES_ONLY

/* An answer's word, in the same form as in shared memory (subjects/channel.h). place: twice the pair's number, plus 1
 * in the backward pass. */
static uint64_t graze_word(uint64_t nonce, uint32_t place, int answer) {
  const uint64_t content = (uint64_t)place << 2 | (uint64_t)((answer < 0 ? -1 : answer > 0) + 2);
  uint64_t check = (nonce ^ content) * UINT64_C(0x9e3779b97f4a7c15);
  check = (check ^ check >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  check = (check ^ check >> 27) * UINT64_C(0x94d049bb133111eb);
  return (check ^ check >> 31) << 16 | content;
}

/* The answer for pair i. If a block's function writes no answer, the two passes give different answers. */
static int graze_answer(const void* pairs, uint32_t i, uint32_t place, int is_double) {
  signed char answer = place & 1 ? GRAZE_DISJOINT : GRAZE_DECLINED;
  if (is_double) {
    const double* p = (const double*)pairs + 18 * (size_t)i;
    if (graze_subject.f64) return graze_subject.f64(p, p + 9);
    graze_subject.block_f64(p, 1, &answer);
  } else {
    const float* p = (const float*)pairs + 18 * (size_t)i;
    if (graze_subject.f32) return graze_subject.f32(p, p + 9);
    graze_subject.block_f32(p, 1, &answer);
  }
  return answer;
}

int main(void) {
  static uint32_t places[GRAZE_MOST_ASKED];
  static double pairs[GRAZE_MOST_ASKED * 18];
  static uint64_t words[GRAZE_MOST_ASKED];
  struct graze_hello hello;
  struct graze_question question;
  FILE* out = stdout;
#ifndef __wasi__
  /* Sends the subject's own output to standard error, so that it is not read as an answer. */
  out = fdopen(dup(1), "wb");
  if (!out || dup2(2, 1) < 0) return 1;
#endif
  memcpy(hello.greeting, "graze 1\n", 8);
  hello.order = 1;
  hello.has = (uint32_t)((graze_subject.f32 || graze_subject.block_f32 ? 1 : 0) +
                         (graze_subject.f64 || graze_subject.block_f64 ? 2 : 0));
  if (fwrite(&hello, sizeof hello, 1, out) != 1 || fflush(out) != 0) return 1;
  while (fread(&question, sizeof question, 1, stdin) == 1 && question.count <= GRAZE_MOST_ASKED) {
    if (fread(places, sizeof places[0], question.count, stdin) != question.count ||
        fread(pairs, 18 * (question.is_double ? sizeof(double) : sizeof(float)), question.count, stdin) !=
            question.count)
      return 1;
    for (uint32_t i = 0; i < question.count; ++i)
      words[i] = graze_word(question.nonce, places[i], graze_answer(pairs, i, places[i], (int)question.is_double));
    if (fwrite(words, sizeof words[0], question.count, out) != question.count || fflush(out) != 0) return 1;
  }
  return 0;
}

#endif
#endif
