// SPDX-License-Identifier: Apache-2.0
// The C ABI. No exception passes through it.
#include "query/include/graze/query_c.h"

#include <cstdio>
#include <new>
#include <string>

#include "query/context.h"

extern "C" {

graze_context* graze_open(void) { return new (std::nothrow) graze_context; }

void graze_close(graze_context* context) { delete context; }

int graze_devices(void) {
  try {
    std::string why_not;
    return graze::cuda::count_query_devices(why_not);
  } catch (...) {
    return 0;
  }
}

int graze_run(graze_context* context, const graze_query* query, graze_answer* answer) {
  if (!answer) return GRAZE_BAD_ARGUMENT;
  if (context && query) {
    context->run(*query, *answer);
    return answer->status;
  }
  *answer = {};
  answer->status = GRAZE_BAD_ARGUMENT;
  answer->first = UINT64_MAX;
  std::snprintf(answer->message, sizeof answer->message, "%s: expected a pointer, found NULL",
                context ? "query" : "context");
  return answer->status;
}
}
