/* SPDX-License-Identifier: Apache-2.0
   Which of three triangles meet a reference: one crosses it, one touches it at a point, one is an ulp away. */
#include <graze/query_c.h>
#include <stdio.h>

int main(void) {
  const float reference[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
  const float triangles[3][9] = {
      {1, 1, -1, 1, 1, 1, 2, 1, 1}, {1, 1, 0, 1, 2, 4, 2, 1, 4}, {1, 1, 1.4012984643e-45f, 1, 2, 4, 2, 1, 4}};
  unsigned char meets[3];

  graze_triangles part = {0};
  part.count = 3;
  part.device = -1; /* in host memory */
  part.rows = triangles[0];

  graze_query query = {0};
  query.size = sizeof query;
  query.references = reference;
  query.reference_count = 1;
  query.parts = &part;
  query.part_count = 1;
  query.mode = GRAZE_ALL;
  query.bytes = meets;

  graze_answer answer;
  graze_context* context = graze_open();
  if (graze_run(context, &query, &answer) != GRAZE_OK) {
    fprintf(stderr, "after %llu triangles: %s\n", (unsigned long long)answer.position, answer.message);
    return 1;
  }
  graze_close(context);
  printf("crossing: %d, touching: %d, an ulp away: %d; %llu of %llu\n", meets[0], meets[1], meets[2],
         (unsigned long long)answer.hits, (unsigned long long)answer.triangles);
  return answer.hits == 2 ? 0 : 1;
}
