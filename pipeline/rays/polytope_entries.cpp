#include "pipeline/rays/shape_entries.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace winnow {
namespace {

using Eigen::Vector3d;

[[nodiscard]] Span box_span(const LocalRay& ray, const Vector3d& half) noexcept {
  PlaneClip clip(ray);
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = Vector3d::Unit(k);
    clip.below(axis, half[k]);
    clip.below(-axis, half[k]);
  }
  return clip.span();
}

/// The twelve edges of a box, each with a radius.
void meet_box_edges(const LocalRay& ray, const Vector3d& half, double radius,
                    FirstEntry& entry) noexcept {
  for (int k = 0; k < 3; ++k) {
    for (unsigned signs = 0; signs < 4; ++signs) {
      Vector3d a = half;
      if ((signs & 1U) != 0) a[(k + 1) % 3] = -a[(k + 1) % 3];
      if ((signs & 2U) != 0) a[(k + 2) % 3] = -a[(k + 2) % 3];
      Vector3d b = a;
      b[k] = -b[k];
      entry.meet(ray, capsule_span(ray, a, b, radius));
    }
  }
}

/// x * y - z * w to an ulp or two of the result (Kahan; Jeannerod, Louvet and Muller, 2013).
[[nodiscard]] double difference_of_products(double x, double y, double z, double w) noexcept {
  const double product = z * w;
  const double error = std::fma(-z, w, product);
  return std::fma(x, y, -product) + error;
}

/// The product of two edges: of a sliver, too, a direction at right angles to both.
[[nodiscard]] Vector3d accurate_cross(const Vector3d& a, const Vector3d& b) noexcept {
  return {difference_of_products(a.y(), b.z(), a.z(), b.y()),
          difference_of_products(a.z(), b.x(), a.x(), b.z()),
          difference_of_products(a.x(), b.y(), a.y(), b.x())};
}

class ScaledHull {
 public:
  ScaledHull(const HullShape& hull, double scale) noexcept : hull_(hull), scale_(scale) {}
  [[nodiscard]] Vector3d vertex(std::uint32_t i) const noexcept {
    return scale_ * Vector3d(hull_.vertex[0][i], hull_.vertex[1][i], hull_.vertex[2][i]);
  }
  [[nodiscard]] Vector3d normal(const HullFace& face) const noexcept {
    return Vector3d::Map(face.normal);
  }
  [[nodiscard]] std::span<const HullFace> faces() const noexcept {
    return {hull_.faces, hull_.face_count};
  }
  [[nodiscard]] std::span<const HullEdge> edges() const noexcept {
    return {hull_.edges, hull_.edge_count};
  }

  [[nodiscard]] Span solid(const LocalRay& ray, double grown) const noexcept {
    PlaneClip clip(ray);
    for (const HullFace& face : faces()) {
      clip.below(normal(face), scale_ * face.offset + grown);
      if (clip.span().is_empty()) break;
    }
    return clip.span();
  }
  /// Points over a face, no higher than `top`.
  [[nodiscard]] Span over(const LocalRay& ray, const HullFace& face, double top) const noexcept {
    PlaneClip clip(ray);
    const Vector3d up = normal(face);
    clip.below(up, scale_ * face.offset + top);
    clip.below(-up, -scale_ * face.offset);
    for (std::uint32_t i = 0; i < face.count && !clip.span().is_empty(); ++i) {
      const Vector3d a = vertex(hull_.loop[face.first + i]);
      const Vector3d b = vertex(hull_.loop[face.first + (i + 1 < face.count ? i + 1 : 0)]);
      const Vector3d side = (b - a).cross(up).stableNormalized();
      clip.below(side, side.dot(a));
    }
    return clip.span();
  }

 private:
  const HullShape& hull_;
  double scale_;
};

}  // namespace

FirstEntry enter(const LocalRay& ray, const BoxShape& box, double scale) noexcept {
  const Vector3d half = scale * Vector3d::Map(box.half);
  const double rounding = scale * box.rounding;
  FirstEntry entry;
  if (rounding == 0.0) {
    entry.meet(ray, box_span(ray, half));
    return entry;
  }
  if (box_span(ray, half + Vector3d::Constant(rounding)).is_empty()) return entry;
  for (int k = 0; k < 3; ++k) entry.meet(ray, box_span(ray, half + rounding * Vector3d::Unit(k)));
  meet_box_edges(ray, half, rounding, entry);
  return entry;
}

FirstEntry enter(const LocalRay& ray, const TriangleShape& triangle, double scale) noexcept {
  const double rounding = scale * triangle.rounding;
  std::array<Vector3d, 3> vertex;
  for (std::size_t i = 0; i < 3; ++i) vertex[i] = scale * Vector3d::Map(triangle.vertex[i]);
  const Vector3d area = accurate_cross(vertex[1] - vertex[0], vertex[2] - vertex[0]);
  FirstEntry entry;
  if (area.stableNorm() > 0.0) {
    entry.meet(ray, prism_span(ray, vertex, area.stableNormalized(), -rounding, rounding));
    // Edges have no normal of their own, and add nothing to a face that was met.
    if (entry.found && rounding == 0.0) return entry;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    entry.meet(ray, capsule_span(ray, vertex[i], vertex[(i + 1) % 3], rounding));
  }
  return entry;
}

FirstEntry enter(const LocalRay& ray, const HullShape& hull, double scale) noexcept {
  const ScaledHull scaled(hull, scale);
  const double rounding = scale * hull.rounding;
  FirstEntry entry;
  if (hull.dimension == 0) {
    entry.meet(ray, ball_span(ray, scaled.vertex(0), rounding));
    return entry;
  }
  if (hull.dimension == 3) {
    if (rounding > 0.0 && scaled.solid(ray, rounding).is_empty()) return entry;
    entry.meet(ray, scaled.solid(ray, 0.0));
    if (rounding == 0.0) return entry;
  }
  for (const HullFace& face : scaled.faces()) {
    entry.meet(ray, scaled.over(ray, face, rounding));
  }
  if (entry.found && rounding == 0.0) return entry;
  for (const HullEdge& edge : scaled.edges()) {
    entry.meet(ray, capsule_span(ray, scaled.vertex(edge.vertex[0]), scaled.vertex(edge.vertex[1]),
                                 rounding));
  }
  return entry;
}

FirstEntry enter(const LocalRay& ray, const HalfSpaceShape& half_space, double scale) noexcept {
  const Vector3d normal = Vector3d::Map(half_space.normal);
  const double height = normal.dot(ray.at(ray.low)) - scale * half_space.offset;
  const double rate = normal.dot(ray.direction);
  FirstEntry entry;
  if (height > 0.0 && !(rate < 0.0)) return entry;
  entry.found = true;
  entry.inside = height < 0.0 || !(rate < 0.0);
  entry.t = height > 0.0 ? ray.low - height / rate : ray.low;
  entry.normal = normal;
  return entry;
}

}  // namespace winnow
