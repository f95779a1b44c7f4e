// SPDX-License-Identifier: Apache-2.0
// Bullet's two triangle tests, without margins. A build of Bullet uses either float or double, so scripts/league builds
// this adapter once for each.
#include <BulletCollision/Gimpact/btTriangleShapeEx.h>
#include <BulletCollision/Gimpact/gim_tri_collision.h>
#include <graze/subject.h>

#define TEXT(x) #x
#define VERSION(x) TEXT(x)

namespace {

template <class Triangle>
Triangle make(const btScalar v[9]) {
  Triangle triangle;
  triangle.m_margin = 0;
  for (int i = 0; i < 3; ++i) triangle.m_vertices[i].setValue(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  return triangle;
}

int hard_test(const btScalar a[9], const btScalar b[9]) {
  GIM_TRIANGLE_CONTACT_DATA contact;
  return make<GIM_TRIANGLE>(a).collide_triangle_hard_test(make<GIM_TRIANGLE>(b), contact);
}

// The steps of btGImpactCollisionAlgorithm: computing the planes, the quick test, and clipping.
int clip_method(const btScalar a[9], const btScalar b[9]) {
  auto first = make<btPrimitiveTriangle>(a), second = make<btPrimitiveTriangle>(b);
  first.buildTriPlane();
  second.buildTriPlane();
  if (!first.overlap_test_conservative(second)) return GRAZE_DISJOINT;
  GIM_TRIANGLE_CONTACT contact;
  return first.find_triangle_collision_clip_method(second, contact);
}

#ifdef BT_USE_DOUBLE_PRECISION
#define FUNCTIONS(f) nullptr, f
#else
#define FUNCTIONS(f) f, nullptr
#endif

}  // namespace

GRAZE_SUBJECT(gim_triangle) = {
    GRAZE_SUBJECT_ABI,
    0,
    VERSION(BT_BULLET_VERSION),
    "Bullet GIM_TRIANGLE::collide_triangle_hard_test, zlib, https://github.com/bulletphysics/bullet3",
    "nothing stated",
    FUNCTIONS(hard_test)};
GRAZE_SUBJECT(primitive_triangle) = {
    GRAZE_SUBJECT_ABI,
    0,
    VERSION(BT_BULLET_VERSION),
    "Bullet btPrimitiveTriangle::find_triangle_collision_clip_method, zlib, https://github.com/bulletphysics/bullet3",
    "nothing stated",
    FUNCTIONS(clip_method)};
