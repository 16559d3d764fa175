// Locally convex patches of touched surfaces (convex_patch.h). Called by surface_contacts.cpp.

#include "pipeline/composites/convex_patch.h"

#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {

void ConvexPatch::grow(const SurfaceCones& cones, const AnswerGroup& group, std::uint32_t start,
                       bool second, const Vec& outward) noexcept {
  primitive_[0] = start;
  facet_[0] = cones.facet(start);
  // Neighbours are wound alike.
  turn_ = facet_[0].normal.dot(outward) < 0.0 ? -1.0 : 1.0;
  facet_[0].normal *= turn_;
  count_ = 1;
  for (std::size_t before = 0; before != count_;) {
    before = count_;
    for (std::size_t k = group.first; k < group.end && count_ < kMaxFacets; ++k) {
      const std::uint32_t next = cones.primitive(k, second);
      if (!cones.overlaps(k) || !cones.is_triangle(next) || contains(next)) continue;
      static_cast<void>(add(next, cones.facet(next)));
    }
  }
}

bool ConvexPatch::add(std::uint32_t primitive, Facet facet) noexcept {
  facet.normal *= turn_;
  if (count_ == kMaxFacets || !accepts(facet)) return false;
  primitive_[count_] = primitive;
  facet_[count_++] = facet;
  return true;
}

// True if the triangle shares a corner with the patch, and neither is in front of the other.
bool ConvexPatch::accepts(const Facet& facet) const noexcept {
  if (facet.normal.isZero()) return false;
  bool is_neighbour = false;
  for (std::size_t k = 0; k < count_; ++k) {
    const Facet& own = facet_[k];
    const double slack = kFlatSine * (facet.size + own.size);
    if (facet.top(own.normal) > own.top(own.normal) + slack) return false;
    if (own.top(facet.normal) > facet.top(facet.normal) + slack) return false;
    is_neighbour = is_neighbour || own.shares_corner(facet);
  }
  return is_neighbour;
}

bool ConvexPatch::contains(std::uint32_t primitive) const noexcept {
  return std::find(primitive_, primitive_ + count_, primitive) != primitive_ + count_;
}

double ConvexPatch::top(const Vec& direction) const noexcept {
  double top = facet_[0].top(direction);
  for (std::size_t k = 1; k < count_; ++k) top = std::max(top, facet_[k].top(direction));
  return top;
}

bool ConvexPatch::is_under(const Vec& point) const noexcept {
  return std::any_of(facet_, facet_ + count_, [&](Facet facet) {
    const Vec down = facet.normal * facet.normal.dot(facet.corner[0] - point);
    facet.normal *= turn_;
    return facet.contains(point + down, kFlatSine * facet.size);
  });
}

double ConvexPatch::size() const noexcept {
  double size = 0.0;
  for (std::size_t k = 0; k < count_; ++k) size = std::max(size, facet_[k].size);
  return size;
}

SupportShape ConvexPatch::shape() const noexcept {
  const auto farthest = [](const void* context, const double direction[3], double point[3]) {
    const ConvexPatch& patch = *static_cast<const ConvexPatch*>(context);
    const Eigen::Map<const Vec> along(direction);
    const Vec* best = &patch.facet_[0].corner[0];
    double height = along.dot(*best);
    for (std::size_t k = 0; k < patch.count_; ++k) {
      for (const Vec& corner : patch.facet_[k].corner) {
        const double next = along.dot(corner);
        if (next <= height) continue;
        height = next;
        best = &corner;
      }
    }
    Vec::Map(point) = *best - patch.facet_[0].corner[0];
  };
  double square = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    for (const Vec& corner : facet_[k].corner) {
      square = std::max(square, (corner - facet_[0].corner[0]).squaredNorm());
    }
  }
  return {farthest, this, std::sqrt(square), 0.0};
}

Pose ConvexPatch::pose() const noexcept {
  return pose_of(facet_[0].corner[0], {1.0, 0.0, 0.0, 0.0});
}

PairAnswer solve_patches(const ShapeTables& tables, const PatchSide& a,
                         const PatchSide& b) noexcept {
  ShapeTables both = tables;
  SupportShape own[2];
  both.supports = own;
  both.count[static_cast<std::size_t>(ShapeKind::support)] = 2;
  ShapeId shapes[2];
  Pose poses[2];
  for (std::uint32_t k = 0; k < 2; ++k) {
    const PatchSide& side = k == 0 ? a : b;
    shapes[k] = side.shape;
    poses[k] = side.pose;
    if (!side.patch.is_empty()) {
      own[k] = side.patch.shape();
      poses[k] = side.patch.pose();
      shapes[k] = ShapeId::of(ShapeKind::support, k);
    } else if (side.shape.kind() == ShapeKind::support) {
      own[k] = tables.supports[side.shape.index()];
      shapes[k] = ShapeId::of(ShapeKind::support, k);
    }
  }
  SolverCounts counts;
  return solve_pair(both, shapes[0], poses[0], shapes[1], poses[1], ContactLevel::distance, 0.0,
                    counts);
}

}  // namespace winnow::mid
