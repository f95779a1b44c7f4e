// SPDX-License-Identifier: Apache-2.0
// A predicate on vectors with operators, passed by reference, with methods and a class with a constructor.
struct Vec {
  float x, y, z;
  __device__ explicit Vec(const float* p) : x(p[0]), y(p[1]), z(p[2]) {}
  __device__ Vec(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  __device__ Vec operator-(const Vec& o) const { return Vec(x - o.x, y - o.y, z - o.z); }
  __device__ Vec operator^(const Vec& o) const { return Vec(y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x); }
  __device__ float operator*(const Vec& o) const { return x * o.x + y * o.y + z * o.z; }
  __device__ Vec& operator+=(const Vec& o) {
    x += o.x, y += o.y, z += o.z;
    return *this;
  }
};

class Plane {
 public:
  __device__ explicit Plane(const float* t) : at_(t), normal_((Vec(t + 3) - Vec(t)) ^ (Vec(t + 6) - Vec(t))) {}
  __device__ float distance(const float* p) const { return normal_ * (Vec(p) - at_); }

 private:
  Vec at_, normal_;
};

__device__ bool intersects(const float a[9], const float b[9]) {
  const Plane p(a), q(b);
  const float d0 = p.distance(b), d1 = p.distance(b + 3), d2 = p.distance(b + 6);
  const float e0 = q.distance(a), e1 = q.distance(a + 3), e2 = q.distance(a + 6);
  if ((d0 > 0 && d1 > 0 && d2 > 0) || (d0 < 0 && d1 < 0 && d2 < 0)) return false;
  if ((e0 > 0 && e1 > 0 && e2 > 0) || (e0 < 0 && e1 < 0 && e2 < 0)) return false;
  Vec middle(0, 0, 0);
  for (int v = 0; v < 9; v += 3) (middle += Vec(a + v)) += Vec(b + v);
  return p.distance(b) * (middle * middle) >= q.distance(a) || d1 * e1 <= d2 * e2;
}
