// Cloth that falls on a ball, simulated with DeformableMesh: self_proximity keeps features apart,
// self_impacts and impacts_with cut the steps. bench/rows/simulation_rows.cpp runs it.

#include "bench/simulation/cloth_drop.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/simulation/crossing.h"

#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

/// Edge length of the cloth, and radius of the ball, whose centre is the origin.
constexpr double kSide = 2.0;
constexpr double kBall = 0.4;
/// Minimum distance of features, relative to the rest length of an edge.
constexpr double kThickness = 0.05;
constexpr double kHeight = 1.0;
constexpr int kRelaxations = 20;
constexpr double kDamping = 0.99;
/// Friction: factor of the displacement of vertices on the ball.
constexpr double kSliding = 0.2;
/// A step ends at this share of the time until an impact.
constexpr double kBeforeTouch = 0.9;
/// Number of times that displacements are cut vertex by vertex before all are cut together.
constexpr int kMaxCuts = 8;

/// Returns an upper bound of the distance of a triangle from the origin: the least distance of many
/// of its points.
double distance_from_origin(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  constexpr int kParts = 16;
  double least = a.norm();
  for (int i = 0; i <= kParts; ++i) {
    for (int k = 0; i + k <= kParts; ++k) {
      const Vec3d point = a + (b - a) * (static_cast<double>(i) / kParts) +
                          (c - a) * (static_cast<double>(k) / kParts);
      least = std::min(least, point.norm());
    }
  }
  return least;
}

}  // namespace

ClothDrop::ClothDrop(const ClothOptions& options)
    : options_(options), mesh_({.execution = options.execution}) {
  need(shapes_.add(SphereShape{kBall}, ball_), "the ball");
  make_cloth();
  need(mesh_.build(place_, std::span<const std::uint32_t>(corners_)), "the cloth");
}

void ClothDrop::link(std::size_t a, std::size_t b) {
  const double length = (place_[b] - place_[a]).norm();
  links_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), length});
}

/// Creates the vertices, and links along edges, along diagonals, and over two squares against
/// bending.
void ClothDrop::make_cloth() {
  const std::size_t side = options_.side;
  const double edge = kSide / static_cast<double>(side - 1);
  for (std::size_t i = 0; i < side * side; ++i) {
    // A small offset breaks the symmetry of the folds.
    const double x = (static_cast<double>(i % side) + 0.01) * edge - 0.5 * kSide;
    const double y = (static_cast<double>(i / side) - 0.02) * edge - 0.5 * kSide;
    place_.emplace_back(x, y, kBall + kHeight);
  }
  for (std::size_t y = 0; y < side; ++y) {
    for (std::size_t x = 0; x < side; ++x) {
      const std::size_t i = y * side + x;
      if (x + 1 < side) link(i, i + 1);
      if (y + 1 < side) link(i, i + side);
      if (x + 2 < side) link(i, i + 2);
      if (y + 2 < side) link(i, i + 2 * side);
      if (x + 1 == side || y + 1 == side) continue;
      link(i, i + side + 1);
      link(i + 1, i + side);
      for (const std::size_t corner : {i, i + 1, i + side, i + 1, i + side + 1, i + side}) {
        corners_.push_back(static_cast<std::uint32_t>(corner));
      }
    }
  }
  next_ = place_;
  velocity_.resize(place_.size());
  share_.resize(place_.size());
}

/// Finds the pairs of features that are closer than the thickness before the step.
void ClothDrop::find_near() {
  const double thickness = kThickness * kSide / static_cast<double>(options_.side - 1);
  need(mesh_.move(place_, place_, thickness), "the cloth");
  separations_.clear();
  for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
    const auto take = [&](std::span<const MeshProximity> chunk) {
      for (const MeshProximity& near : chunk) {
        const Vec3d apart = near.point[1] - near.point[0];
        const double length = apart.norm();
        if (!(length > 0.0)) continue;
        SeparationConstraint separation{{}, near.weight, apart / length};
        if (kind == FeaturePair::vertex_face) {
          separation.vertex[0] = near.features.first;
          for (std::size_t k = 0; k < 3; ++k) {
            separation.vertex[k + 1] = corners_[3 * near.features.second + k];
          }
        } else {
          const auto first = mesh_.edge(near.features.first);
          const auto second = mesh_.edge(near.features.second);
          separation.vertex = {first[0], first[1], second[0], second[1]};
        }
        const std::size_t own = kind == FeaturePair::vertex_face ? 1 : 2;
        for (std::size_t k = 0; k < own; ++k) separation.weight[k] = -separation.weight[k];
        separations_.push_back(separation);
      }
    };
    need(mesh_.self_proximity(kind, thickness, take), "what is near");
  }
}

void ClothDrop::relax(const Link& link) {
  const Vec3d apart = next_[link.b] - next_[link.a];
  const double length = apart.norm();
  if (!(length > 0.0)) return;
  const Vec3d by = apart * (0.5 * (length - link.length) / length);
  next_[link.a] += by;
  next_[link.b] -= by;
}

void ClothDrop::solve_separation(const SeparationConstraint& separation) {
  const double thickness = kThickness * kSide / static_cast<double>(options_.side - 1);
  double along = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    along += separation.weight[k] * separation.normal.dot(next_[separation.vertex[k]]);
    squares += separation.weight[k] * separation.weight[k];
  }
  if (!(along < thickness) || !(squares > 0.0)) return;
  const double by = (thickness - along) / squares;
  for (std::size_t k = 0; k < 4; ++k) {
    next_[separation.vertex[k]] += separation.normal * (by * separation.weight[k]);
  }
}

/// Returns the least distance of a vertex from the origin such that the faces between vertices are
/// outside the ball as well.
double ClothDrop::least_radius() const noexcept {
  const double edge = kSide / static_cast<double>(options_.side - 1);
  return std::hypot(kBall, edge) + kThickness * edge;
}

bool ClothDrop::is_on_ball(const Vec3d& vertex) const noexcept {
  return options_.continuous && vertex.norm() < least_radius() * 1.001;
}

void ClothDrop::keep_outside(Vec3d& vertex) const {
  const double away = vertex.norm();
  if (away > 0.0 && away < least_radius()) vertex *= least_radius() / away;
}

void ClothDrop::solve() {
  for (int i = 0; i < kRelaxations; ++i) {
    for (const Link& one : links_) relax(one);
    for (const SeparationConstraint& separation : separations_) solve_separation(separation);
    for (Vec3d& vertex : next_) {
      if (options_.continuous) keep_outside(vertex);
    }
  }
}

void ClothDrop::cut(std::uint32_t vertex, double share) {
  share_[vertex] = std::min(share_[vertex], share);
}

bool ClothDrop::find_touches(double& earliest) {
  std::fill(share_.begin(), share_.end(), 1.0);
  earliest = 1.0;
  bool any = false;
  need(mesh_.move(place_, next_), "the cloth");
  const auto touch = [&](std::span<const std::uint32_t> vertices, double time) {
    any = true;
    ++impacts_;
    earliest = std::min(earliest, time);
    for (const std::uint32_t vertex : vertices) cut(vertex, kBeforeTouch * time);
  };
  for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
    const auto take = [&](std::span<const MeshImpact> chunk) {
      for (const MeshImpact& impact : chunk) {
        const auto [first, second] = impact.features;
        if (kind == FeaturePair::vertex_face) {
          touch(std::span(&first, 1), impact.time);
          touch(std::span(corners_).subspan(3 * std::size_t{second}, 3), impact.time);
        } else {
          touch(mesh_.edge(first), impact.time);
          touch(mesh_.edge(second), impact.time);
        }
      }
    };
    need(mesh_.self_impacts(kind, {}, take), "touches");
  }
  const auto take = [&](std::span<const MeshShapeImpact> chunk) {
    for (const MeshShapeImpact& impact : chunk) {
      touch(std::span(corners_).subspan(3 * std::size_t{impact.face}, 3), impact.time);
    }
  };
  need(mesh_.impacts_with({shapes_, ball_, RigidMotion::stationary(Pose{})}, {}, take), "the ball");
  return any;
}

void ClothDrop::step() {
  const double seconds = options_.step;
  if (options_.continuous) find_near();
  for (std::size_t i = 0; i < place_.size(); ++i) {
    velocity_[i].z() -= options_.gravity * seconds;
    next_[i] = place_[i] + velocity_[i] * seconds;
  }
  solve();
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (!is_on_ball(place_[i]) || !is_on_ball(next_[i])) continue;
    next_[i] = place_[i] + (next_[i] - place_[i]) * kSliding;
  }
  double earliest = 1.0;
  bool touches = options_.continuous && find_touches(earliest);
  for (int cuts = 0; touches && cuts < kMaxCuts; ++cuts) {
    for (std::size_t i = 0; i < place_.size(); ++i) {
      next_[i] = place_[i] + (next_[i] - place_[i]) * share_[i];
    }
    touches = find_touches(earliest);
  }
  if (touches) {
    // Moves all vertices to the same time just before the first impact.
    ++cut_short_;
    for (std::size_t i = 0; i < place_.size(); ++i) {
      next_[i] = place_[i] + (next_[i] - place_[i]) * (kBeforeTouch * earliest);
    }
  }
  for (std::size_t i = 0; i < place_.size(); ++i) {
    velocity_[i] = (next_[i] - place_[i]) * (kDamping / seconds);
  }
  place_ = next_;
  ++steps_;
}

std::size_t ClothDrop::passed() const {
  std::size_t count = 0;
  for (std::size_t face = 0; face < corners_.size(); face += 3) {
    const std::uint32_t* const corner = corners_.data() + face;
    const Vec3d& a = place_[corner[0]];
    const Vec3d& b = place_[corner[1]];
    const Vec3d& c = place_[corner[2]];
    count += distance_from_origin(a, b, c) < kBall ? 1 : 0;
    const Vec3d low = a.min(b).min(c);
    const Vec3d high = a.max(b).max(c);
    for (std::size_t i = 0; i < mesh_.edges(); ++i) {
      const auto [first, second] = mesh_.edge(i);
      const Vec3d& p = place_[first];
      const Vec3d& q = place_[second];
      bool near = true;
      for (int axis = 0; axis < 3 && near; ++axis) {
        near = std::min(p[axis], q[axis]) <= high[axis] && std::max(p[axis], q[axis]) >= low[axis];
      }
      const bool shared = std::find(corner, corner + 3, first) != corner + 3 ||
                          std::find(corner, corner + 3, second) != corner + 3;
      count += near && !shared && crosses(p, q, a, b, c) ? 1 : 0;
    }
  }
  return count;
}

double ClothDrop::lowest() const noexcept {
  double low = place_.front().z();
  for (const Vec3d& vertex : place_) low = std::min(low, vertex.z());
  return low;
}

double ClothDrop::max_strain() const noexcept {
  double most = 0.0;
  for (const Link& one : links_) {
    most = std::max(most, (place_[one.b] - place_[one.a]).norm() / one.length - 1.0);
  }
  return most;
}

std::uint64_t ClothDrop::fingerprint() const noexcept {
  std::uint64_t sum = 0;
  for (const Vec3d& vertex : place_) {
    for (int i = 0; i < 3; ++i) sum = mix(sum, vertex[i]);
  }
  return sum;
}

}  // namespace winnow::bench
