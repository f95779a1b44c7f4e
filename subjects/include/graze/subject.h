/* SPDX-License-Identifier: Apache-2.0
 * What Graze asks of foreign code: a function that says whether two triangles have a point in common.
 *
 * C11 (C++ too), no dependency. Build a shared library and name it: graze fuzz --subject mine=./libmine.so:function
 *
 * The smallest subject is one function, without this header:
 *
 *     int function(const float a[9], const float b[9]);      // or double, then :function/f64
 *
 * a and b are triangles: three vertices, each x, y, z. Returns: GRAZE_DISJOINT, GRAZE_INTERSECTS or GRAZE_DECLINED.
 *
 * A library that says more of itself, or decides whole blocks, exports a variable of type struct graze_subject, with C
 * linkage. Graze takes the one named graze_subject, or the one that is named after the colon:
 *
 *     GRAZE_SUBJECT(graze_subject) = {.abi = GRAZE_SUBJECT_ABI, .version = "1.2", .f32 = function};
 *
 * Each pair is asked twice; the answers must agree. Triangles lie in memory that cannot be written. The function runs
 * in a process of its own, in one thread of it, on any of several processes at once. A function that crashes, throws,
 * exits or does not return has no verdict on that pair, and goes on with the next in a new process.
 */
#ifndef GRAZE_SUBJECT_H
#define GRAZE_SUBJECT_H

#include <stddef.h>
#include <stdint.h>

#define GRAZE_SUBJECT_ABI 1

/* Answers. Two triangles intersect when their closed convex hulls have a point in common: touching counts, and so do
 * triangles that are segments or points. Any other value is taken for GRAZE_DECLINED when it is negative, else for
 * GRAZE_INTERSECTS. */
enum { GRAZE_DECLINED = -1, GRAZE_DISJOINT = 0, GRAZE_INTERSECTS = 1 };

/* Pairs that a subject does not promise to decide so: its convention. Its answers there are counted apart, neither as
 * errors nor as right. */
enum {
  GRAZE_OUTSIDE_TOUCHING = 1,   /* the hulls meet in points or segments, and the least movement parts them */
  GRAZE_OUTSIDE_COPLANAR = 2,   /* all six vertices in one plane */
  GRAZE_OUTSIDE_DEGENERATE = 4, /* a triangle that is a segment or a point */
  GRAZE_OUTSIDE_SHARED = 8      /* a vertex of one is a vertex of the other */
};

struct graze_subject {
  uint32_t abi;           /* GRAZE_SUBJECT_ABI */
  uint32_t outside;       /* GRAZE_OUTSIDE_…, added up */
  const char* version;    /* of the code; may be null */
  const char* source;     /* where it is from: library, license, address; may be null */
  const char* convention; /* where its documentation says what `outside` says; may be null */
  /* One pair at a time. Null where there is none. */
  int (*f32)(const float a[9], const float b[9]);
  int (*f64)(const double a[9], const double b[9]);
  /* Many at once, instead: pairs[18 * i] and the following 17 numbers are a pair, answers[i] is its answer. Of a crash
   * the block is asked again pair by pair. */
  void (*block_f32)(const float* pairs, size_t count, signed char* answers);
  void (*block_f64)(const double* pairs, size_t count, signed char* answers);
};

/* Begins the definition of such a variable, with C linkage in C and C++. */
#ifdef __cplusplus
#define GRAZE_SUBJECT(name)                   \
  extern "C" const struct graze_subject name; \
  const struct graze_subject name
#else
#define GRAZE_SUBJECT(name) const struct graze_subject name
#endif

#endif
