/* SPDX-License-Identifier: Apache-2.0
 * The interface of foreign code: a function that decides whether two triangles have a point in common.
 *
 * C11 or C++, without dependencies. Build a shared library and name it: graze fuzz --subject mine=./libmine.so:function
 *
 * The smallest subject is a single function, and does not need this header:
 *
 *     int function(const float a[9], const float b[9]);      // for double, name it as :function/f64
 *
 * a and b are triangles of three vertices, each x, y, z. Returns: GRAZE_DISJOINT, GRAZE_INTERSECTS or GRAZE_DECLINED.
 *
 * A library that describes itself or decides blocks of pairs exports a variable of type struct graze_subject with C
 * linkage. Graze uses the variable named graze_subject, or the one named after the colon:
 *
 *     GRAZE_SUBJECT(graze_subject) = {.abi = GRAZE_SUBJECT_ABI, .version = "1.2", .f32 = function};
 *
 * Graze asks about each pair twice. The answers must agree, and the function must not change the rounding mode. The
 * triangles are in read-only memory. The function runs in several processes at once, in one thread of each. If it
 * crashes, throws, exits or does not return, the pair's verdict is crashed or timed out, and a new process continues
 * with the next pair.
 */
#ifndef GRAZE_SUBJECT_H
#define GRAZE_SUBJECT_H

#include <stddef.h>
#include <stdint.h>

#define GRAZE_SUBJECT_ABI 1

/* Answers. Two triangles intersect when their closed convex hulls have a point in common: touching counts, and so do
 * triangles that are segments or points. Any other negative value counts as GRAZE_DECLINED, any other positive value
 * as GRAZE_INTERSECTS. */
enum { GRAZE_DECLINED = -1, GRAZE_DISJOINT = 0, GRAZE_INTERSECTS = 1 };

/* The subject's convention: the kinds of pairs on which its answer may differ from the truth. Graze counts such answers
 * separately, neither as wrong nor as right. */
enum {
  GRAZE_OUTSIDE_TOUCHING = 1, /* the hulls meet in points or segments, and an arbitrarily small motion separates them */
  GRAZE_OUTSIDE_COPLANAR = 2, /* all six vertices are in one plane */
  GRAZE_OUTSIDE_DEGENERATE = 4, /* a triangle is a segment or a point */
  GRAZE_OUTSIDE_SHARED = 8      /* a vertex of one triangle is a vertex of the other */
};

struct graze_subject {
  uint32_t abi;           /* GRAZE_SUBJECT_ABI */
  uint32_t outside;       /* the sum of GRAZE_OUTSIDE_… */
  const char* version;    /* the code's version; may be null */
  const char* source;     /* where it comes from: library, license, address; may be null */
  const char* convention; /* where the documentation states the convention; may be null */
  /* These functions decide one pair at a time. They may be null. */
  int (*f32)(const float a[9], const float b[9]);
  int (*f64)(const double a[9], const double b[9]);
  /* These functions decide a block of pairs instead. Pair i is pairs[18 * i] to pairs[18 * i + 17], and its answer is
   * answers[i]. If an answer is not written, its pair is unstable. After a crash, Graze asks about the block again, one
   * pair at a time. They may be null. */
  void (*block_f32)(const float* pairs, size_t count, signed char* answers);
  void (*block_f64)(const double* pairs, size_t count, signed char* answers);
};

/* Begins the definition of a struct graze_subject with C linkage, in C and C++. */
#ifdef __cplusplus
#define GRAZE_SUBJECT(name)                   \
  extern "C" const struct graze_subject name; \
  const struct graze_subject name
#else
#define GRAZE_SUBJECT(name) const struct graze_subject name
#endif

#endif
