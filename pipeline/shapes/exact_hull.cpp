// Quickhull with exact orientation tests. hull_points.cpp calls exact_hull for solid point sets;
// the result goes to merge_coplanar and assemble_hull (hull_builder.cpp).

#include "pipeline/shapes/exact_hull.h"

#include "pipeline/exact/exact_vector.h"
#include "pipeline/shapes/accurate_cross.h"

#include <cmath>
#include <utility>

namespace winnow {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kNone = ~0U;
// Above the absolute error that underflow may cause in products of coordinates of at most 2.
constexpr double kUnderflow = 1e-300;

[[nodiscard]] ExactVector exact_difference(const Vector3d& a, const Vector3d& b) noexcept {
  return exact_vector(a) - exact_vector(b);
}

/// Six times the signed volume of the tetrahedron (a, b, c, d). `volume` is rounded, `sign` is
/// exact: positive if a, b, c are counter-clockwise seen from d.
struct PlaneSide {
  double volume;
  int sign;
};

[[nodiscard]] PlaneSide side_of(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                                const Vector3d& d) noexcept {
  constexpr double kShare = 7.8e-16;
  const Vector3d u = a - d;
  const Vector3d v = b - d;
  const Vector3d w = c - d;
  const double xy[3] = {v.x() * w.y(), w.x() * u.y(), u.x() * v.y()};
  const double yx[3] = {w.x() * v.y(), u.x() * w.y(), v.x() * u.y()};
  const double volume =
      -(u.z() * (xy[0] - yx[0]) + v.z() * (xy[1] - yx[1]) + w.z() * (xy[2] - yx[2]));
  const double most = std::fabs(u.z()) * (std::fabs(xy[0]) + std::fabs(yx[0])) +
                      std::fabs(v.z()) * (std::fabs(xy[1]) + std::fabs(yx[1])) +
                      std::fabs(w.z()) * (std::fabs(xy[2]) + std::fabs(yx[2]));
  if (std::fabs(volume) > kShare * most + kUnderflow) return {volume, volume > 0.0 ? 1 : -1};
  const ExactVector normal = cross(exact_difference(b, a), exact_difference(c, a));
  return {volume, dot(normal, exact_difference(d, a)).sign()};
}

[[nodiscard]] bool on_one_line(const Vector3d& a, const Vector3d& b, const Vector3d& c) noexcept {
  return is_zero(cross(exact_difference(b, a), exact_difference(c, a)));
}

class Quickhull {
 public:
  explicit Quickhull(std::span<const Vector3d> points, std::pmr::memory_resource* memory)
      : points_(points),
        faces_(memory),
        free_(memory),
        open_(memory),
        next_(points.size(), kNone, memory),
        begins_(points.size(), kNone, memory),
        seen_(memory),
        horizon_(memory),
        made_(memory) {}

  bool run() {
    std::uint32_t corner[4];
    if (!find_corners(corner)) return false;
    add_tetrahedron(corner);
    while (!open_.empty()) {
      const std::uint32_t face = open_.back();
      open_.pop_back();
      if (faces_[face].alive && faces_[face].outside != kNone) add_point(face);
    }
    return true;
  }

  void write(HullSurface& surface) const {
    for (const Face& face : faces_) {
      if (!face.alive) continue;
      surface.loops.insert(surface.loops.end(), std::begin(face.vertex), std::end(face.vertex));
      surface.end_face();
    }
  }

 private:
  struct Face {
    std::uint32_t vertex[3];
    std::uint32_t across[3];        // the face across the edge from vertex[i] to the next vertex
    std::uint32_t outside = kNone;  // head of the list of points beyond this face; the farthest one
    double height = 0.0;  // distance of `outside` from the plane, times twice the face's area
    std::uint32_t tested_in_round = 0;  // the find_horizon call that computed is_seen
    bool is_seen = false;
    bool alive = true;
  };
  /// An edge between a face that is visible from the new point and one that is not.
  struct HorizonEdge {
    std::uint32_t from;
    std::uint32_t to;
    std::uint32_t beyond;
  };

  [[nodiscard]] PlaneSide side(const Face& face, std::uint32_t point) const noexcept {
    return side_of(points_[face.vertex[0]], points_[face.vertex[1]], points_[face.vertex[2]],
                   points_[point]);
  }

  /// The index with the largest `measure`, if it is `valid`; else any valid index; kNone if there
  /// is none.
  template <typename Measure, typename Valid>
  [[nodiscard]] std::uint32_t best(Measure&& measure, Valid&& valid) const {
    std::uint32_t found = kNone;
    double most = -1.0;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const double m = measure(i);
      if (m > most) {
        most = m;
        found = i;
      }
    }
    if (found != kNone && valid(found)) return found;
    // Rounding in `measure` can select an invalid point; then any valid one will do.
    for (found = 0; found < points_.size(); ++found) {
      if (valid(found)) return found;
    }
    return kNone;
  }

  /// Finds four points that are not coplanar.
  bool find_corners(std::uint32_t corner[4]) const {
    if (points_.empty()) return false;
    corner[0] = 0;
    const Vector3d& p = points_[0];
    corner[1] = best([&](std::uint32_t i) { return (points_[i] - p).squaredNorm(); },
                     [&](std::uint32_t i) { return points_[i] != p; });
    if (corner[1] == kNone) return false;
    const Vector3d& q = points_[corner[1]];
    corner[2] =
        best([&](std::uint32_t i) { return accurate_cross(q - p, points_[i] - p).squaredNorm(); },
             [&](std::uint32_t i) { return !on_one_line(p, q, points_[i]); });
    if (corner[2] == kNone) return false;
    const Vector3d& r = points_[corner[2]];
    corner[3] =
        best([&](std::uint32_t i) { return std::fabs(side_of(p, q, r, points_[i]).volume); },
             [&](std::uint32_t i) { return side_of(p, q, r, points_[i]).sign != 0; });
    if (corner[3] == kNone) return false;
    // Orders the corners so that (0, 1, 2) is counter-clockwise seen from outside, the side
    // opposite to corner 3.
    if (side_of(p, q, r, points_[corner[3]]).sign > 0) std::swap(corner[0], corner[1]);
    return true;
  }

  void add_tetrahedron(const std::uint32_t (&corner)[4]) {
    // Face k omits corner k. The edge of face k that also omits corner i is shared with face i.
    constexpr std::uint32_t kLoop[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    for (const auto& loop : kLoop) {
      Face face{};
      for (std::uint32_t i = 0; i < 3; ++i) {
        face.vertex[i] = corner[loop[i]];
        face.across[i] = loop[(i + 2) % 3];
      }
      made_.push_back(static_cast<std::uint32_t>(faces_.size()));
      faces_.push_back(face);
    }
    for (std::uint32_t i = 0; i < points_.size(); ++i) assign(i);
    open_.assign(made_.begin(), made_.end());
  }

  /// Adds the point to the list of a new face that it lies beyond, if there is one. It suffices to
  /// test the new faces: a point beyond a removed face that is outside of the new hull lies beyond
  /// a new face, because the plane of a new face lies between the planes of the two old faces at
  /// its horizon edge.
  void assign(std::uint32_t point) {
    for (const std::uint32_t made : made_) {
      Face& face = faces_[made];
      const PlaneSide found = side(face, point);
      if (found.sign <= 0) continue;
      if (face.outside == kNone || found.volume > face.height) {
        next_[point] = face.outside;
        face.outside = point;
        face.height = found.volume;
      } else {
        next_[point] = next_[face.outside];
        next_[face.outside] = point;
      }
      return;
    }
  }

  /// Adds the farthest point beyond face `first`: replaces the faces visible from it by a fan from
  /// the point to the horizon.
  void add_point(std::uint32_t first) {
    const std::uint32_t point = faces_[first].outside;
    find_horizon(first, point);
    made_.clear();
    for (const HorizonEdge& edge : horizon_) made_.push_back(add_face(edge, point));
    for (const std::uint32_t made : made_) join(made);
    for (const std::uint32_t gone : seen_) {
      std::uint32_t next = kNone;
      for (std::uint32_t i = faces_[gone].outside; i != kNone; i = next) {
        next = next_[i];
        if (i != point) assign(i);
      }
    }
    free_.insert(free_.end(), seen_.begin(), seen_.end());
    open_.insert(open_.end(), made_.begin(), made_.end());
  }

  /// Returns whether the face is visible from the point. Computed once per point and face.
  bool is_visible(std::uint32_t at, std::uint32_t point) {
    Face& face = faces_[at];
    if (face.tested_in_round != visibility_round_) {
      face.tested_in_round = visibility_round_;
      face.is_seen = side(face, point).sign > 0;
      if (face.is_seen) {
        seen_.push_back(at);
        face.alive = false;
      }
    }
    return face.is_seen;
  }

  /// Collects the visible faces and the horizon edges. Visible faces are connected and bounded by
  /// one loop, because a point in a face's plane does not see the face, and a point on the line of
  /// an edge sees neither of its faces.
  void find_horizon(std::uint32_t first, std::uint32_t point) {
    ++visibility_round_;
    seen_.clear();
    horizon_.clear();
    is_visible(first, point);
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      for (std::uint32_t i = 0; i < 3; ++i) {
        const Face face = faces_[seen_[k]];
        if (is_visible(face.across[i], point)) continue;
        horizon_.push_back({face.vertex[i], face.vertex[(i + 1) % 3], face.across[i]});
      }
    }
  }

  /// Makes the face between a horizon edge and the point, and links it to the face across the edge.
  std::uint32_t add_face(const HorizonEdge& edge, std::uint32_t point) {
    std::uint32_t at = static_cast<std::uint32_t>(faces_.size());
    if (free_.empty()) {
      faces_.emplace_back();
    } else {
      at = free_.back();
      free_.pop_back();
    }
    faces_[at] = {.vertex = {edge.from, edge.to, point}, .across = {edge.beyond, kNone, kNone}};
    Face& beyond = faces_[edge.beyond];
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (beyond.vertex[i] == edge.to) beyond.across[i] = at;
    }
    begins_[edge.from] = at;
    return at;
  }

  /// Links a new face to the next one around the horizon.
  void join(std::uint32_t at) {
    const std::uint32_t following = begins_[faces_[at].vertex[1]];
    faces_[at].across[1] = following;
    faces_[following].across[2] = at;
  }

  std::span<const Vector3d> points_;
  std::pmr::vector<Face> faces_;
  std::pmr::vector<std::uint32_t> free_;
  std::pmr::vector<std::uint32_t> open_;  // faces that may have points beyond them
  std::pmr::vector<std::uint32_t> next_;  // for each point, the next one in the list of its face
  std::pmr::vector<std::uint32_t>
      begins_;  // for each vertex, the new face whose first vertex it is
  std::pmr::vector<std::uint32_t> seen_;
  std::pmr::vector<HorizonEdge> horizon_;
  std::pmr::vector<std::uint32_t> made_;  // faces made for the current point
  std::uint32_t visibility_round_ = 0;
};

}  // namespace

bool exact_hull(std::span<const Vector3d> points, HullSurface& surface) {
  Quickhull hull(points, surface.loops.get_allocator().resource());
  if (!hull.run()) return false;
  hull.write(surface);
  return true;
}

int turn_in_plane(const Vector3d& a, const Vector3d& b, const Vector3d& c, int u, int v) {
  constexpr double kShare = 3.4e-16;
  const double left = (a[u] - c[u]) * (b[v] - c[v]);
  const double right = (a[v] - c[v]) * (b[u] - c[u]);
  const double turn = left - right;
  if (std::fabs(turn) > kShare * (std::fabs(left) + std::fabs(right)) + kUnderflow) {
    return turn > 0.0 ? 1 : -1;
  }
  const ExactVector to_a = exact_difference(a, c);
  const ExactVector to_b = exact_difference(b, c);
  return compare(to_a.x[u] * to_b.x[v], to_a.x[v] * to_b.x[u]);
}

}  // namespace winnow
