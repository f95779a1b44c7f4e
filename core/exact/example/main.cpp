// SPDX-License-Identifier: Apache-2.0
#include <graze/exact.h>

#include <cstdio>

int main() {
  const float a[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
  const float touching[9] = {1, 1, 0, 1, 2, 4, 2, 1, 4}, apart[9] = {1, 1, 0x1p-149f, 1, 2, 4, 2, 1, 4};
  std::printf("touching: %d, an ulp above: %d\n", graze::exact::intersects(a, touching),
              graze::exact::intersects(a, apart));
  const double in_doubles[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0}, above[9] = {1, 1, 0x1p-1074, 1, 2, 4, 2, 1, 4};
  std::printf("in doubles, an ulp above: %d\n", graze::exact::intersects(in_doubles, above));
  const bool right = graze::exact::intersects(a, touching) && !graze::exact::intersects(a, apart) &&
                     !graze::exact::intersects(in_doubles, above);
  return right ? 0 : 1;
}
