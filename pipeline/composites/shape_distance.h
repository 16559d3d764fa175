#pragma once

// Overlap and closest points of two placed shapes, including composite ones. Scene queries and
// contacts of solids call this; parts are solved by the narrow phase.

#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/composites/part_tables.h"
#include "pipeline/shapes/triangle_direction.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace winnow {

/// Closest points of two shapes, or of a point and a shape, and their distance; see SceneDistance.
struct ShapeDistance {
  std::uint32_t part_a = kWholeShape;
  std::uint32_t part = kWholeShape;
  double distance = 0.0;
  double error_bound = 0.0;
  Vec3d normal{};
  Vec3d point_a{};
  Vec3d point_b{};
};

[[nodiscard]] inline PairAnswer solve_parts(const SubShapeQuery& parts, const SubShape& a,
                                            const SubShape& b, ContactLevel level) noexcept {
  PartTables tables(parts.shapes());
  const ShapeId first = tables.put(0, a);
  const ShapeId second = tables.put(1, b);
  PairAnswer answer;
  static_cast<void>(
      collide(tables.tables(), first, a.pose, second, b.pose, {.level = level}, answer));
  return answer;
}

/// True if one part is a one-sided triangle and the other is behind it, so that they do not
/// collide.
[[nodiscard]] inline bool is_either_behind(const SubShapeQuery& parts, const SubShape& a,
                                           const SubShape& b) noexcept {
  return (a.front != 0 && is_behind_triangle(parts.box(b), a)) ||
         (b.front != 0 && is_behind_triangle(parts.box(a), b));
}

/// Two shapes, moved so that the first one's position is the origin if one of them is composite:
/// their parts then keep full precision far from the world's origin. Convex pairs are not moved.
struct Pairing {
  PlacedShape a;
  PlacedShape b;
  double base[3] = {0.0, 0.0, 0.0};

  Pairing(const PlacedShape& first, const PlacedShape& second) noexcept : a(first), b(second) {
    if (!a.shape.is_composite() && !b.shape.is_composite()) return;
    std::copy_n(a.pose.position.data(), 3, base);
    b.pose = relative(b.pose, base);
    a.pose = relative(a.pose, base);
  }
};

/// True if a separating axis proves that a ball is farther than a limit from a triangle of a
/// surface. False proves nothing.
[[nodiscard]] inline bool is_farther(const SubShape& ball, const SubShape& triangle,
                                     double limit) noexcept {
  using mid::Vec;
  if (!is_unrotated(triangle)) return false;
  const TriangleShape& shape = *triangle.triangle;
  const Vec first = as_eigen(shape.vertex[0]);
  const Vec ab = as_eigen(shape.vertex[1]) - first;
  const Vec ac = as_eigen(shape.vertex[2]) - first;
  const Vec at = as_eigen(ball.pose.position);
  const Vec corner = as_eigen(triangle.pose.position);
  const Vec from = (at - corner) - first;
  const Vec axis = mid::direction_to(from, ab, ac);
  const double gap = axis.dot(from) - std::max({0.0, axis.dot(ab), axis.dot(ac)});
  const double scale =
      at.lpNorm<1>() + corner.lpNorm<1>() + first.lpNorm<1>() + ab.lpNorm<1>() + ac.lpNorm<1>();
  const double radii = ball.ball->radius + triangle.thickness;
  return gap > (std::max(limit, 0.0) + radii + 4.0 * mid::kSlack * scale) * axis.norm();
}

/// True if one shape is a solid that contains the other; tests a single point of the other.
[[nodiscard]] inline bool is_either_inside(const SubShapeQuery& parts, const PlacedShape& a,
                                           const PlacedShape& b) noexcept {
  return parts.solid_contains(a, b) || parts.solid_contains(b, a);
}

/// True if two parts overlap.
[[nodiscard]] inline bool do_overlap(const SubShapeQuery& parts, const SubShape& a,
                                     const SubShape& b) noexcept {
  return !is_either_behind(parts, a, b) && solve_parts(parts, a, b, ContactLevel::boolean).overlap;
}

/// Calls visit(part of a, part of b) for the parts whose boxes overlap, until it returns false.
template <typename Visit>
void each_near_pair(const SubShapeQuery& parts, const Pairing& pair, Visit&& visit) {
  if (parts.pairs(pair.a, pair.b, visit)) return;
  bool goes_on = true;
  auto visit_parts_near = [&](const SubShape& a, double) {
    parts.visit_parts(pair.b, stationary(parts.box(a)), [&](const SubShape& b, double) {
      goes_on = visit(a, b);
      return goes_on ? 0.0 : -1.0;
    });
    return goes_on ? 0.0 : -1.0;
  };
  // If a is a single part, the box of b is not needed; for a compound it would visit all
  // children.
  if (!pair.a.shape.is_composite()) {
    visit_parts_near({pair.a.shape, pair.a.pose}, 0.0);
  } else {
    parts.visit_parts(pair.a, stationary(parts.box(pair.b)), visit_parts_near);
  }
}

/// True if the surfaces overlap; `part` is then a part of b that does.
[[nodiscard]] inline bool do_parts_overlap(const SubShapeQuery& parts, const Pairing& pair,
                                           std::uint32_t& part) noexcept {
  bool found = false;
  each_near_pair(parts, pair, [&](const SubShape& a, const SubShape& b) {
    found = do_overlap(parts, a, b);
    if (found) part = b.part;
    return !found;
  });
  return found;
}

/// True if the shapes overlap; `part` is then a part of b that does, or kWholeShape if one is
/// inside the other, a solid.
[[nodiscard]] inline bool do_overlap(const SubShapeQuery& parts, const PlacedShape& first,
                                     const PlacedShape& second, std::uint32_t& part) noexcept {
  const Pairing pair(first, second);
  if (do_parts_overlap(parts, pair, part)) return true;
  part = kWholeShape;
  return is_either_inside(parts, pair.a, pair.b);
}

/// Returns b, moved.
[[nodiscard]] inline PlacedShape moved_b(const Pairing& pair, const mid::Vec& by) noexcept {
  PlacedShape moved = pair.b;
  as_eigen(moved.pose.position) += by;
  return moved;
}
/// True if the shapes overlap after b is moved.
[[nodiscard]] inline bool do_overlap_at(const SubShapeQuery& parts, const Pairing& pair,
                                        const mid::Vec& by) noexcept {
  std::uint32_t part = kWholeShape;
  return do_overlap(parts, pair.a, moved_b(pair, by), part);
}

/// Returns whether the depth of two overlapping shapes is that of a solid; see find_solid_depth.
[[nodiscard]] inline bool has_solid_depth(const SubShapeQuery& parts,
                                          const Pairing& pair) noexcept {
  const auto is_bounded = [&](const PlacedShape& shape) { return parts.box(shape).is_finite(); };
  return (parts.has_solids(pair.a.shape) || parts.has_solids(pair.b.shape)) && is_bounded(pair.a) &&
         is_bounded(pair.b);
}

// Defined in solid_depth.cpp.
[[nodiscard]] bool find_solid_depth(const SubShapeQuery& parts, const Pairing& pair,
                                    ShapeDistance& answer) noexcept;

/// Finds the closest parts of two shapes, within a limit.
class ClosestParts {
 public:
  explicit ClosestParts(const SubShapeQuery& parts) noexcept : parts_(parts) {}

  /// Returns false if the distance exceeds the limit.
  bool find(const PlacedShape& first, const PlacedShape& second, double limit,
            ShapeDistance& answer) noexcept {
    const Pairing pair(first, second);
    std::uint32_t part = kWholeShape;
    if (has_solid_depth(parts_, pair) && do_overlap(parts_, first, second, part) &&
        find_solid_depth(parts_, pair, answer)) {
      return answer.distance <= limit;
    }
    return find_parts(pair, limit, answer);
  }
  /// Finds the closest parts of two surfaces, whether or not one is inside the other.
  bool find_surfaces(const Pairing& pair, ShapeDistance& answer) noexcept {
    return find_parts(pair, mid::kInfinity, answer);
  }
  /// As above, for a part that belongs to no shape, such as a point.
  bool find(SubShape first, PlacedShape second, double limit, ShapeDistance& answer) noexcept {
    double base[3] = {0.0, 0.0, 0.0};
    if (second.shape.is_composite()) {
      std::copy_n(first.pose.position.data(), 3, base);
      second.pose = relative(second.pose, base);
      first.pose = relative(first.pose, base);
    }
    const bool contained = parts_.solid_contains(second, first.pose.position);
    begin(base, contained ? mid::kInfinity : limit, answer);
    test_parts_near(first, second);
    return found_ && (!contained || is_within(limit, answer));
  }

 private:
  bool find_parts(const Pairing& pair, double limit, ShapeDistance& answer) noexcept {
    begin(pair.base, limit, answer);
    answer.normal = {};
    auto test_and_limit = [&](const SubShape& a, const SubShape& b, double) {
      test_pair(a, b);
      return reach();
    };
    if (parts_.near_pairs(pair.a, pair.b, reach(), answer.normal.data(), test_and_limit))
      return found_;
    // If a is a single part, the box of b is not needed; for a compound it would visit all
    // children.
    if (!pair.a.shape.is_composite()) {
      test_parts_near({pair.a.shape, pair.a.pose}, pair.b);
    } else {
      parts_.near(pair.a, parts_.box(pair.b), reach(),
                  [&](const SubShape& a, double) { return test_parts_near(a, pair.b); });
    }
    return found_;
  }
  /// For a point inside a solid: turns the distance from the surface into a depth. Returns false if
  /// the resulting distance exceeds the limit.
  [[nodiscard]] static bool is_within(double limit, ShapeDistance& answer) noexcept {
    if (answer.distance > 0.0) {
      answer.distance = -answer.distance;
      for (double& component : answer.normal) component = -component;
    }
    return answer.distance <= limit;
  }
  void begin(const double* base, double limit, ShapeDistance& answer) noexcept {
    found_ = false;
    limit_ = limit;
    answer_ = &answer;
    base_ = base;
  }
  /// Boxes beyond this are skipped. Never negative, because overlapping boxes may have parts of any
  /// depth.
  [[nodiscard]] double reach() const noexcept { return std::max(limit_, 0.0); }
  double test_parts_near(const SubShape& a, const PlacedShape& second) noexcept {
    parts_.near(second, parts_.box(a), reach(), [&](const SubShape& b, double) {
      test_pair(a, b);
      return reach();
    });
    return reach();
  }
  void test_pair(const SubShape& a, const SubShape& b) noexcept {
    if (a.ball != nullptr && b.triangle != nullptr && is_farther(a, b, limit_)) return;
    const PairAnswer pair = solve_parts(parts_, a, b, ContactLevel::distance);
    if (!(pair.distance <= limit_) || is_either_behind(parts_, a, b)) return;
    ShapeDistance& answer = *answer_;
    if (found_ && pair.distance == limit_ &&
        std::pair(answer.part, answer.part_a) <= std::pair(b.part, a.part)) {
      return;
    }
    found_ = true;
    limit_ = pair.distance;
    answer.distance = pair.distance;
    answer.error_bound = pair.error_bound;
    answer.part_a = a.part;
    answer.part = b.part;
    for (int i = 0; i < 3; ++i) {
      answer.normal[i] = pair.normal[i];
      const double on_a = a.pose.position[i] + pair.point[i];
      answer.point_a[i] = base_[i] + on_a;
      answer.point_b[i] = base_[i] + (on_a + pair.distance * pair.normal[i]);
    }
  }

  const SubShapeQuery& parts_;
  double limit_ = 0.0;
  bool found_ = false;
  ShapeDistance* answer_ = nullptr;
  const double* base_ = nullptr;
};

}  // namespace winnow
