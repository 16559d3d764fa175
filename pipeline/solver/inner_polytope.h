#pragma once

#include "pipeline/solver/core.h"

#include <array>
#include <cstdint>

namespace winnow::solver {

/// A polytope of triangles that grows by points outside of it, its faces in the order of their
/// distance from the origin, which is inside. Of fixed size: some 130 KB, for the stack.
class InnerPolytope {
 public:
  struct Face {
    std::array<std::uint16_t, 3> point;
    /// The face across the side from point i to the next.
    std::array<std::uint16_t, 3> across;
    bool alive;
    /// Looked at, and can grow no more.
    bool settled;
    /// Outward, and a lower bound of the distance of the face's plane.
    Vec normal;
    double low;
  };

  /// `noise`: lengths that cannot be told from zero.
  explicit InnerPolytope(double noise) noexcept : noise_(noise) {}

  [[nodiscard]] std::uint32_t point_count() const noexcept { return point_count_; }
  [[nodiscard]] const Vec& point(std::uint32_t i) const noexcept { return points_[i]; }
  /// For the first four points.
  void add(const Vec& w) noexcept { points_[point_count_++] = w; }
  /// Of the first four points; false if they are in a plane.
  bool make_tetrahedron() noexcept;

  /// Takes the nearest face that was not taken yet; false if there is none.
  bool take_nearest(std::uint16_t& face) noexcept;
  [[nodiscard]] const Face& face(std::uint16_t f) const noexcept { return faces_[f]; }
  /// How far a point is above the face.
  [[nodiscard]] double height(const Face& face, const Vec& w) const noexcept {
    return face.normal.dot(w - points_[face.point[0]]);
  }
  /// The face is on the surface of whatever the points are taken from.
  void settle(std::uint16_t f) noexcept { faces_[f].settled = true; }

  /// Replaces the faces that see w, of which `seen` is one, by a fan from w. False if there is no
  /// room or rounding has made the horizon something else than one loop: the end of it then.
  bool attach(const Vec& w, std::uint16_t seen) noexcept;

 private:
  static constexpr std::uint32_t kPoints = 384;
  static constexpr std::uint32_t kFaces = 6 * kPoints;

  /// A side that stays when the faces that see a new point are taken away.
  struct Side {
    std::uint16_t from;
    std::uint16_t to;
    std::uint16_t face;
  };

  bool add_face(std::uint16_t p, std::uint16_t q, std::uint16_t r, std::uint16_t& at) noexcept;
  bool find_horizon(const Vec& w, std::uint16_t seen) noexcept;
  [[nodiscard]] double triangle_distance(std::uint16_t p, std::uint16_t q,
                                         std::uint16_t r) const noexcept;
  [[nodiscard]] bool is_seen(const Vec& w, const Face& face, std::uint16_t from,
                             std::uint16_t to) const noexcept;
  void push(std::uint16_t face) noexcept;
  std::uint16_t pop() noexcept;
  void compact() noexcept;
  [[nodiscard]] bool is_farther(std::uint16_t f, std::uint16_t g) const noexcept {
    return faces_[f].low > faces_[g].low || (faces_[f].low == faces_[g].low && f > g);
  }

  double noise_;
  std::array<Vec, kPoints> points_;
  std::array<Face, kFaces> faces_;
  std::array<std::uint16_t, kFaces> heap_;
  std::array<Side, kFaces> horizon_;
  std::array<std::uint16_t, kFaces> moved_;
  std::uint32_t point_count_ = 0;
  std::uint32_t face_count_ = 0;
  std::uint32_t heap_count_ = 0;
  std::uint32_t horizon_count_ = 0;
};

}  // namespace winnow::solver
