// SPDX-License-Identifier: Apache-2.0
// Triangles in a type of your own: is there a hit, and which triangles are hit?
#include <graze/query.h>

#include <cstdio>
#include <vector>

struct Face {
  float corners[9];
  int material;
};

int main() {
  const graze::query::Triangle reference = {0, 0, 0, 4, 0, 0, 0, 4, 0};
  const std::vector<Face> faces = {{{9, 9, 9, 9, 8, 9, 9, 9, 8}, 1}, {{1, 1, -1, 1, 1, 1, 2, 1, 1}, 2}};
  const graze_triangles part = graze::query::rows_of(std::span<const Face>(faces));
  const graze::query::Context context;
  const graze::query::Answer any = context.any(reference, part);
  std::vector<std::uint8_t> meets;
  const graze::query::Answer all = context.all(reference, part, meets);
  if (!any || !all) return std::fprintf(stderr, "%s%s\n", any.message, all.message), 1;
  std::printf("the first hit is face %d, of material %d; %d of %d\n", int(any.first), faces[any.first].material,
              int(all.hits), int(all.triangles));
  return meets[0] == 0 && meets[1] == 1 ? 0 : 1;
}
