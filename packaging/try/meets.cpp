// SPDX-License-Identifier: Apache-2.0
#include <graze/exact.h>
#include <graze/query.h>

#include <cstdio>
#include <vector>

int main() {
  const std::vector<graze::query::Triangle> triangles = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 1, 1, 0, 1, 0, 1, 1}};
  const graze::query::Context context;
  const auto answer =
      context.count(triangles[0], graze::query::rows_of(std::span<const graze::query::Triangle>(triangles)));
  const bool same = graze::exact::intersects(triangles[0].data(), triangles[1].data());
  std::printf("libgraze-dev: %llu of 2 meet the first; the second %s\n", static_cast<unsigned long long>(answer.hits),
              same ? "does" : "does not");
  return answer.hits == 1 && !same ? 0 : 1;
}
