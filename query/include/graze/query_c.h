/* SPDX-License-Identifier: Apache-2.0
   Tests reference triangles against an array of triangles: whether any triangle meets a reference, and which triangles
   do. The decision is exact, or made by a lane of your choice, on one core, all cores, one GPU or all GPUs. This header
   is for C, and for every language that can call C; C++ has <graze/query.h>. docs/query.md has examples.

   A triangle is nine floats or nine doubles: x, y and z of each vertex. They are never rounded. The triangle is the
   closed hull of its vertices, so touching counts as meeting, and a degenerate triangle is a segment or a point. A
   triangle that is not finite is declined and counted in `declined`. */
#ifndef GRAZE_QUERY_C_H
#define GRAZE_QUERY_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The result of a call. For every status but GRAZE_OK, the answer has a one-line message. */
enum graze_status {
  GRAZE_OK = 0,
  GRAZE_BAD_ARGUMENT = 1,
  GRAZE_NO_DEVICE = 2,
  GRAZE_NO_MEMORY = 3, /* on the host or on a device */
  GRAZE_DEVICE_FAILED = 4,
  GRAZE_CANCELLED = 5,
  GRAZE_FAILED = 6
};

/* The type of coordinates. */
enum graze_coordinates {
  GRAZE_F32 = 0, /* float */
  GRAZE_F64 = 1  /* double: only for the exact decision */
};

enum graze_layout {
  GRAZE_ROWS = 0,    /* rows: nine coordinates for each triangle */
  GRAZE_COLUMNS = 1, /* columns: an array for each of the nine coordinates */
  GRAZE_MESH = 2     /* faces: three uint32_t indices of vertices; a face with an index out of range is declined */
};

/* The maximum number of triangles in all parts of a query together. */
#define GRAZE_MOST_TRIANGLES ((uint64_t)1 << 48)

/* An array of triangles. rows, columns and vertices point to coordinates of the query's type, and are aligned for that
   type. Strides are in bytes; 0 means that elements are contiguous. The following rules are checked; breaking one gives
   GRAZE_BAD_ARGUMENT. A stride is a multiple of the alignment, at least an element's size, and not negative. An array
   takes at most PTRDIFF_MAX bytes from its first element to its last, and does not wrap around the end of the address
   space. The caller guarantees that the pointers refer to such memory. */
typedef struct graze_triangles {
  uint64_t count;
  int layout;
  int device; /* -1: in host memory; else in the memory of this CUDA device */
  const void* rows;
  const void* columns[9];
  const void* vertices;
  const uint32_t* faces;
  uint64_t vertex_count;
  size_t stride;        /* from one row, element of a column, or face to the next */
  size_t vertex_stride; /* from one vertex to the next */
} graze_triangles;

enum graze_mode { GRAZE_ANY = 0 /* stops at a hit */, GRAZE_ALL = 1 };

enum graze_executor {
  GRAZE_AUTO = 0, /* where the triangles are; for host memory, the cores, or the GPUs if they are faster */
  GRAZE_ONE_CORE = 1,
  GRAZE_ALL_CORES = 2,
  GRAZE_ONE_GPU = 3,
  GRAZE_ALL_GPUS = 4
};

/* Reports progress, at most 20 times a second, one call at a time but from any thread. Return nonzero to cancel. */
typedef int (*graze_progress)(void* user, uint64_t done, uint64_t triangles);

typedef struct graze_query {
  size_t size;                  /* sizeof(graze_query) */
  const void* references;       /* nine coordinates each, in host memory */
  uint64_t reference_count;     /* 1 to 65536 */
  const graze_triangles* parts; /* one part, or up to 65536 consecutive ones, such as on several GPUs */
  uint64_t part_count;
  int mode;
  int executor;
  const char* lane; /* NULL: exact. Else a name from `graze lanes`: moller_1997/f32/cpu, or a CUDA lane for a GPU */
  /* For GRAZE_ALL; each may be NULL, and has one row per reference. bytes: one byte per triangle, 1 if it meets the
     reference, 0 if not, 2 if declined. bits: (triangles + 7) / 8 bytes; triangle i is bit i % 8 of byte i / 8. If
     bits is used, every part except the last must have a multiple of 64 triangles. */
  unsigned char* bytes;
  unsigned char* bits;
  /* For GRAZE_ALL, on the host: the hits in ascending order, as triangle * reference_count + reference; at most
     list_room of them. */
  uint64_t* list;
  uint64_t list_room;
  int outputs_on_device; /* bytes and bits are in the memory of the triangles' device; the triangles are one part */
  int coordinates;       /* the type of the coordinates of all triangles and references */
  void* stream; /* a cudaStream_t that orders the work on triangles in device memory; NULL: our own stream, after
                   the work already given to the default stream */
  double launch_seconds; /* how long kernels may run without a pause; 0 means 0.5 */
  graze_progress progress;
  void* user;
} graze_query;

typedef struct graze_answer {
  int status;
  char message[200];
  uint64_t position;        /* all triangles before this position are answered */
  uint64_t triangles;       /* in all parts */
  uint64_t hits;            /* pairs of a triangle and a reference that meet; 0 or 1 for GRAZE_ANY */
  uint64_t declined;        /* declined pairs; for GRAZE_ANY, only those of the first reference, before the hit */
  uint64_t first;           /* the first triangle that meets a reference; UINT64_MAX: none. With parts in the memory
                               of several devices, GRAZE_ANY may find a later one. */
  uint64_t first_reference; /* the first reference that this triangle meets */
  int executor;             /* the executor that was used; GRAZE_AUTO: none, because the query was refused */
  double seconds;
  double longest_launch; /* the longest kernel launch, in seconds of device time */
} graze_answer;

/* Holds a device's resources from the first query on that device until graze_close. Threads may share a context; they
   then take turns on a device. graze_open returns NULL if there is not enough memory. */
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
