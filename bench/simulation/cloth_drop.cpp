// A square of cloth that falls on a ball and drapes over it, by position-based dynamics (Mueller et
// al., "Position based dynamics", 2007). DeformableMesh finds features that must be kept apart
// (self_proximity), and the impacts of the cloth with itself and with the ball (self_impacts,
// impacts_with), at the first of which a step is cut. Reported times of impact are never late, so
// that nothing passes through. bench/rows/simulation_rows.cpp runs it.

#include "bench/simulation/barriers.h"

#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/need.h"
#include "bench/common/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kVertices = 40;  ///< along an edge
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

class ClothDrop final : public Barrier {
 public:
  explicit ClothDrop(const BarrierOptions& options)
      : options_(options),
        side_(options.size != 0 ? options.size : kVertices),
        mesh_({.execution = options.execution}) {
    ball_ = need(shapes_.add(SphereShape{kBall}), "the ball");
    make_cloth();
    need(mesh_.build(place_, std::span<const std::uint32_t>(corners_)), "the cloth");
  }

  void step() override {
    const double seconds = options_.step;
    if (options_.continuous) find_near();
    for (std::size_t i = 0; i < place_.size(); ++i) {
      velocity_[i].z() -= options_.gravity * seconds;
      next_[i] = place_[i] + velocity_[i] * seconds;
    }
    solve();
    for (std::size_t i = 0; i < place_.size(); ++i) {
      if (is_on_ball(place_[i]) && is_on_ball(next_[i])) cut(i, kSliding);
    }
    double earliest = 1.0;
    bool touches = options_.continuous && find_touches(earliest);
    for (int cuts = 0; touches && cuts < kMaxCuts; ++cuts) {
      for (std::size_t i = 0; i < place_.size(); ++i) {
        cut(i, share_[i]);
      }
      touches = find_touches(earliest);
    }
    if (touches) {
      // Moves all vertices to the same time just before the first impact.
      ++figures_.cut_short;
      for (std::size_t i = 0; i < place_.size(); ++i) {
        cut(i, kBeforeTouch * earliest);
      }
    }
    for (std::size_t i = 0; i < place_.size(); ++i) {
      velocity_[i] = (next_[i] - place_[i]) * (kDamping / seconds);
    }
    place_ = next_;
    ++figures_.steps;
  }

  [[nodiscard]] BarrierFigures figures() const override {
    BarrierFigures figures = figures_;
    figures.objects = corners_.size() / 3;
    figures.passed = passed();
    figures.lowest = place_.front().z();
    for (const Vec3d& vertex : place_) {
      figures.lowest = std::min(figures.lowest, vertex.z());
      for (const double x : vertex) figures.fingerprint = mix(figures.fingerprint, x);
    }
    figures.strain = 0.0;
    for (const Link& one : links_) {
      const double length = (place_[one.b] - place_[one.a]).norm();
      figures.strain = std::max(figures.strain, length / one.length - 1.0);
    }
    return figures;
  }

 private:
  struct Link {
    std::uint32_t a;
    std::uint32_t b;
    double length;
  };
  /// Two features that are close to each other. The sum of weight[i] times vertex[i], projected on
  /// the normal, must be at least the thickness.
  struct SeparationConstraint {
    std::array<std::uint32_t, 4> vertex;
    std::array<double, 4> weight;
    Vec3d normal;
  };

  /// Returns the rest length of an edge along the sides of the cloth.
  [[nodiscard]] double edge() const { return kSide / static_cast<double>(side_ - 1); }
  [[nodiscard]] double thickness() const {
    return kThickness * kSide / static_cast<double>(side_ - 1);
  }

  /// Returns a vertex and the corners of a face, or the ends of two edges.
  [[nodiscard]] std::array<std::uint32_t, 4> vertices_of(FeaturePair kind, std::uint32_t first,
                                                         std::uint32_t second) const {
    if (kind == FeaturePair::vertex_face) {
      const std::uint32_t* const corner = corners_.data() + 3 * std::size_t{second};
      return {first, corner[0], corner[1], corner[2]};
    }
    const auto [a, b] = mesh_.edge(first);
    const auto [c, d] = mesh_.edge(second);
    return {a, b, c, d};
  }

  void link(std::size_t a, std::size_t b) {
    const double length = (place_[b] - place_[a]).norm();
    links_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), length});
  }

  /// Creates the vertices, and links along edges, along diagonals, and over two squares against
  /// bending.
  void make_cloth() {
    const std::size_t side = side_;
    for (std::size_t i = 0; i < side * side; ++i) {
      // A small offset breaks the symmetry of the folds.
      const double x = (static_cast<double>(i % side) + 0.01) * edge() - 0.5 * kSide;
      const double y = (static_cast<double>(i / side) - 0.02) * edge() - 0.5 * kSide;
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
  void find_near() {
    need(mesh_.move(place_, place_, thickness()), "the cloth");
    separations_.clear();
    for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
      const auto take = [&](std::span<const MeshProximity> chunk) {
        for (const MeshProximity& near : chunk) {
          const Vec3d apart = near.point[1] - near.point[0];
          const double length = apart.norm();
          if (!(length > 0.0)) continue;
          const auto [first, second] = near.features;
          SeparationConstraint separation{vertices_of(kind, first, second), near.weight,
                                          apart / length};
          const std::size_t own = kind == FeaturePair::vertex_face ? 1 : 2;
          for (std::size_t k = 0; k < own; ++k) separation.weight[k] = -separation.weight[k];
          separations_.push_back(separation);
        }
      };
      need(mesh_.self_proximity(kind, thickness(), take), "what is near");
    }
  }

  void relax(const Link& link) {
    const Vec3d apart = next_[link.b] - next_[link.a];
    const double length = apart.norm();
    if (!(length > 0.0)) return;
    const Vec3d by = apart * (0.5 * (length - link.length) / length);
    next_[link.a] += by;
    next_[link.b] -= by;
  }

  void solve_separation(const SeparationConstraint& separation) {
    double along = 0.0;
    double squares = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      along += separation.weight[k] * separation.normal.dot(next_[separation.vertex[k]]);
      squares += separation.weight[k] * separation.weight[k];
    }
    if (!(along < thickness()) || !(squares > 0.0)) return;
    const double by = (thickness() - along) / squares;
    for (std::size_t k = 0; k < 4; ++k) {
      next_[separation.vertex[k]] += separation.normal * (by * separation.weight[k]);
    }
  }

  /// Returns the least distance of a vertex from the origin such that the faces between vertices
  /// are outside the ball as well.
  [[nodiscard]] double least_radius() const {
    return std::hypot(kBall, edge()) + kThickness * edge();
  }

  [[nodiscard]] bool is_on_ball(const Vec3d& vertex) const {
    return options_.continuous && vertex.norm() < least_radius() * 1.001;
  }

  void keep_outside(Vec3d& vertex) const {
    const double away = vertex.norm();
    if (away > 0.0 && away < least_radius()) vertex *= least_radius() / away;
  }

  void solve() {
    for (int i = 0; i < kRelaxations; ++i) {
      for (const Link& one : links_) relax(one);
      for (const SeparationConstraint& separation : separations_) solve_separation(separation);
      for (Vec3d& vertex : next_) {
        if (options_.continuous) keep_outside(vertex);
      }
    }
  }

  /// Computes the share of its displacement that each vertex may go. Returns false if there is no
  /// impact.
  [[nodiscard]] bool find_touches(double& earliest) {
    std::fill(share_.begin(), share_.end(), 1.0);
    earliest = 1.0;
    bool any = false;
    need(mesh_.move(place_, next_), "the cloth");
    const auto touch = [&](std::span<const std::uint32_t> vertices, double time) {
      any = true;
      ++figures_.impacts;
      earliest = std::min(earliest, time);
      for (const std::uint32_t vertex : vertices) {
        share_[vertex] = std::min(share_[vertex], kBeforeTouch * time);
      }
    };
    for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
      const auto take = [&](std::span<const MeshImpact> chunk) {
        for (const MeshImpact& impact : chunk) {
          touch(vertices_of(kind, impact.features.first, impact.features.second), impact.time);
        }
      };
      need(mesh_.self_impacts(kind, {}, take), "touches");
    }
    const auto take = [&](std::span<const MeshShapeImpact> chunk) {
      for (const MeshShapeImpact& impact : chunk) {
        touch(std::span(corners_).subspan(3 * std::size_t{impact.face}, 3), impact.time);
      }
    };
    need(mesh_.impacts_with({shapes_, ball_, RigidMotion::stationary(Pose{})}, {}, take),
         "the ball");
    return any;
  }

  /// Reduces the displacement of a vertex to a share of it.
  void cut(std::size_t i, double share) { next_[i] = place_[i] + (next_[i] - place_[i]) * share; }

  [[nodiscard]] std::size_t passed() const {
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
          near =
              std::min(p[axis], q[axis]) <= high[axis] && std::max(p[axis], q[axis]) >= low[axis];
        }
        const bool shared = std::find(corner, corner + 3, first) != corner + 3 ||
                            std::find(corner, corner + 3, second) != corner + 3;
        count += near && !shared && crosses(p, q, a, b, c) ? 1 : 0;
      }
    }
    return count;
  }

  BarrierOptions options_;
  std::size_t side_;
  ShapePool shapes_;
  ShapeId ball_;
  DeformableMesh mesh_;
  std::vector<std::uint32_t> corners_;
  std::vector<Link> links_;
  std::vector<Vec3d> place_;
  std::vector<Vec3d> next_;
  std::vector<Vec3d> velocity_;
  std::vector<double> share_;
  std::vector<SeparationConstraint> separations_;
  BarrierFigures figures_;
};

}  // namespace

std::unique_ptr<Barrier> make_cloth_drop(const BarrierOptions& options) {
  return std::make_unique<ClothDrop>(options);
}

}  // namespace winnow::bench
