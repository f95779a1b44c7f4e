// SPDX-License-Identifier: Apache-2.0
#include "strata/mesh_slabs.h"

#include <CGAL/box_intersection_d.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/stop.h"
#include "strata/mesh_box.h"

namespace graze::strata {
namespace {

// With fewer boxes than this, CGAL sweeps instead of dividing further. On a terrain of a million triangles, this limit
// takes less than half the time that CGAL's default limit of 10 takes.
constexpr std::ptrdiff_t kSwept = 1000;

// How many boxes a CGAL call pairs with a slab's. With long boxes, it takes quadratic time and cannot be interrupted.
constexpr std::size_t kTogether = std::size_t{1} << 15;

bool is_finite(const std::array<Vec3<float>, 3>& t) {
  return std::all_of(t.begin(), t.end(), [](const Vec3<float>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  });
}

// The boxes of finite triangles.
std::vector<Box> finite_boxes(BoxSlabs::Triangles triangles) {
  std::vector<Box> boxes = boxes_of(triangles, 0, triangles.size());
  std::erase_if(boxes, [&](const Box& box) { return !is_finite(triangles[box.info()]); });
  return boxes;
}

// The axis along which the union of the boxes is longest.
int longest_axis(const std::vector<Box>& boxes) {
  int longest = 0;
  double most = -1;
  for (int axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Box& box : boxes) {
      low = std::min<double>(low, box.min_coord(axis));
      high = std::max<double>(high, box.max_coord(axis));
    }
    if (high - low <= most) continue;
    most = high - low;
    longest = axis;
  }
  return longest;
}

}  // namespace

struct BoxSlabs::Boxes {
  std::vector<Box> a, b;  // sorted by their low ends along the axis
  bool self;
  std::size_t of_slab;
  int axis;
  std::uint64_t not_finite;
};

BoxSlabs::BoxSlabs(Triangles a, std::optional<Triangles> b, std::size_t triangles_of_slab) {
  auto boxes = std::make_unique<Boxes>();
  boxes->a = finite_boxes(a);
  if (b) boxes->b = finite_boxes(*b);
  boxes->self = !b;
  boxes->of_slab = triangles_of_slab;
  boxes->axis = longest_axis(boxes->a);
  boxes->not_finite = a.size() - boxes->a.size() + (b ? b->size() - boxes->b.size() : 0);
  const auto lower = [axis = boxes->axis](const Box& p, const Box& q) { return p.min_coord(axis) < q.min_coord(axis); };
  std::sort(boxes->a.begin(), boxes->a.end(), lower);
  std::sort(boxes->b.begin(), boxes->b.end(), lower);
  boxes_ = std::move(boxes);
}

BoxSlabs::~BoxSlabs() = default;

std::size_t BoxSlabs::size() const { return (boxes_->a.size() + boxes_->of_slab - 1) / boxes_->of_slab; }

std::size_t BoxSlabs::triangles_before(std::size_t slab) const {
  return std::min(slab * boxes_->of_slab, boxes_->a.size());
}

std::uint64_t BoxSlabs::not_finite() const { return boxes_->not_finite; }

void BoxSlabs::pairs(std::size_t slab, const std::function<void(std::uint32_t, std::uint32_t)>& found) const {
  const auto at = [&](std::size_t place) { return boxes_->a.begin() + static_cast<std::ptrdiff_t>(place); };
  const int axis = boxes_->axis;
  const auto end = at(triangles_before(slab + 1));
  std::vector<Box> own(at(triangles_before(slab)), end), others;
  float high = own.front().max_coord(axis);
  for (const Box& box : own) high = std::max(high, box.max_coord(axis));
  if (boxes_->self) {
    // Later slabs' boxes do not begin below this slab, so only the slab's high end limits the search.
    for (auto box = end; box != boxes_->a.end() && box->min_coord(axis) <= high; ++box) others.push_back(*box);
  } else {
    const float low = own.front().min_coord(axis);
    for (auto box = boxes_->b.begin(); box != boxes_->b.end() && box->min_coord(axis) <= high; ++box) {
      if (box->max_coord(axis) >= low) others.push_back(*box);
    }
  }
  const auto ordered = [&](const Box& p, const Box& q) {
    if (boxes_->self && q.info() < p.info()) return found(q.info(), p.info());
    found(p.info(), q.info());
  };
  for (std::size_t first = 0; first < others.size(); first += kTogether) {
    if (stop_requested) throw Stopped();
    const auto begin = others.begin() + static_cast<std::ptrdiff_t>(first);
    const auto last = std::min(first + kTogether, others.size());
    CGAL::box_intersection_d(own.begin(), own.end(), begin, others.begin() + static_cast<std::ptrdiff_t>(last), ordered,
                             kSwept);
  }
  if (boxes_->self) CGAL::box_self_intersection_d(own.begin(), own.end(), ordered, kSwept);
}

}  // namespace graze::strata
