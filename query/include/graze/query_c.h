/* SPDX-License-Identifier: Apache-2.0
   Reference triangles against an array of triangles: does any meet it, and which ones do. Decided exactly, or by a
   lane of choice, on one core, on all cores, on one GPU or on all. For C and, through C, for every language; C++ has
   <graze/query.h>. docs/query.md has examples.

   A triangle is nine floats, x y z of each vertex: the closed hull of its vertices, so that touching counts, and a
   degenerate one is a segment or a point. One that is not finite is declined, and counted as such. */
#ifndef GRAZE_QUERY_C_H
#define GRAZE_QUERY_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call came to; of all but the first the answer has a message of one line. */
enum graze_status {
  GRAZE_OK = 0,
  GRAZE_BAD_ARGUMENT = 1,
  GRAZE_NO_DEVICE = 2,
  GRAZE_NO_MEMORY = 3, /* of the host or of a device */
  GRAZE_DEVICE_FAILED = 4,
  GRAZE_CANCELLED = 5,
  GRAZE_FAILED = 6
};

enum graze_layout {
  GRAZE_ROWS = 0,    /* rows: nine floats a triangle */
  GRAZE_COLUMNS = 1, /* columns: an array for each of the nine */
  GRAZE_MESH = 2     /* faces: three uint32_t each, places of vertices; a face of one that is not there is declined */
};

/* The most triangles that the parts of a query have together. */
#define GRAZE_MOST_TRIANGLES ((uint64_t)1 << 48)

/* An array of triangles. Strides are in bytes, 0 where nothing lies between; everything is aligned as floats are. A
   stride is a multiple of 4 and not less than an element's size; an array takes at most PTRDIFF_MAX bytes from its
   first element to its last, and does not wrap around the end of the addresses; GRAZE_BAD_ARGUMENT otherwise. Whether
   there is memory behind the pointer is not checked: the caller promises it. A negative stride is none. */
typedef struct graze_triangles {
  uint64_t count;
  int layout;
  int device; /* -1: in the memory of the host; else of this CUDA device */
  const float* rows;
  const float* columns[9];
  const float* vertices;
  const uint32_t* faces;
  uint64_t vertex_count;
  size_t stride;        /* from a row to the next, in each column, or from a face to the next */
  size_t vertex_stride; /* from a vertex to the next */
} graze_triangles;

enum graze_mode { GRAZE_ANY = 0 /* stops at a hit */, GRAZE_ALL = 1 };

enum graze_executor {
  GRAZE_AUTO = 0, /* where the triangles are; those of the host on the cores, or on a GPU where that is faster */
  GRAZE_ONE_CORE = 1,
  GRAZE_ALL_CORES = 2,
  GRAZE_ONE_GPU = 3,
  GRAZE_ALL_GPUS = 4
};

/* How far a query is, at most twenty times a second, one call at a time but from any thread. Anything but 0 ends it. */
typedef int (*graze_progress)(void* user, uint64_t done, uint64_t triangles);

typedef struct graze_query {
  size_t size;                  /* sizeof(graze_query) */
  const float* references;      /* nine floats each, in the memory of the host */
  uint64_t reference_count;     /* 1 to 65536 */
  const graze_triangles* parts; /* the array: one part, or up to 65536 that follow each other, as on several GPUs */
  uint64_t part_count;
  int mode;
  int executor;
  const char* lane; /* NULL: exact. Else as `graze lanes` names it: moller_1997/f32/cpu, a CUDA lane for a GPU */
  /* Of GRAZE_ALL, each may be NULL. A row for each reference, of as many bytes as there are triangles: 1 meets it, 0
     does not, 2 declined; or of a bit each, bit i % 8 of byte i / 8, and (triangles + 7) / 8 bytes. */
  unsigned char* bytes;
  unsigned char* bits;
  /* Of GRAZE_ALL, on the host: the hits, ascending, as triangle * reference_count + reference; so many as there is
     room for. */
  uint64_t* list;
  uint64_t list_room;
  int outputs_on_device; /* bytes and bits lie where the triangles do: in one part, on one device */
  void* stream; /* a cudaStream_t that orders the work on triangles in a device's memory; NULL: ours, after what
                   the default stream was given */
  double launch_seconds; /* that kernels may run without a pause; 0: 0.5 */
  graze_progress progress;
  void* user;
} graze_query;

typedef struct graze_answer {
  int status;
  char message[200];
  uint64_t position;        /* triangles from the beginning that are answered for certain */
  uint64_t triangles;       /* of all parts */
  uint64_t hits;            /* pairs of a triangle and a reference; of GRAZE_ANY 0 or 1 */
  uint64_t declined;        /* likewise; of GRAZE_ANY with the first reference and before the hit */
  uint64_t first;           /* the first triangle that meets a reference; UINT64_MAX: none. Of several parts in the
                               memory of several devices GRAZE_ANY may find another one. */
  uint64_t first_reference; /* the first one that it meets */
  int executor;             /* that it was, never GRAZE_AUTO */
  double seconds;
  double longest_launch; /* seconds of device time */
} graze_answer;

/* Holds what devices need, from the first query on one until it is closed. Threads may share it: they then take turns
   on a device. Returns: NULL without memory. */
typedef struct graze_context graze_context;
graze_context* graze_open(void);
void graze_close(graze_context* context);

/* The number of CUDA devices. */
int graze_devices(void);

/* Returns: answer->status. */
int graze_run(graze_context* context, const graze_query* query, graze_answer* answer);

#ifdef __cplusplus
}
#endif
#endif
