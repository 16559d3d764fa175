#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

struct ClothOptions {
  /// Number of vertices along an edge of the square.
  std::size_t side = 40;
  double step = 1.0 / 60.0;
  double gravity = 10.0;
  /// If false, the cloth falls without collision detection, for comparison: `passed` then counts
  /// the features that passed through each other or the ball.
  bool continuous = true;
  Execution execution = Execution::serial();
};

/// A square of cloth that falls on a ball and drapes over it. The method is position-based dynamics
/// (Mueller et al., "Position based dynamics", 2007). Each step is cut at the first impact that
/// winnow finds, of the cloth with itself or with the ball. Reported times of impact are never
/// late, so that nothing passes through. The class uses only winnow's public interface.
class ClothDrop {
 public:
  /// Throws std::runtime_error if winnow rejects the mesh.
  explicit ClothDrop(const ClothOptions& options);

  void step();

  [[nodiscard]] std::size_t triangles() const noexcept { return corners_.size() / 3; }
  [[nodiscard]] std::size_t steps() const noexcept { return steps_; }
  /// Returns the number of impacts that cut steps, of features with each other and of faces with
  /// the ball.
  [[nodiscard]] std::size_t impacts() const noexcept { return impacts_; }
  /// Returns the number of steps that were cut for the whole cloth, because cuts of single vertices
  /// did not end.
  [[nodiscard]] std::size_t cut_short() const noexcept { return cut_short_; }
  /// Returns the number of edges that cross a face, and of faces that intersect the ball, at
  /// present. Tests all of them by brute force.
  [[nodiscard]] std::size_t passed() const;
  /// Returns the height of the lowest vertex.
  [[nodiscard]] double lowest() const noexcept;
  /// Returns the largest relative extension of a link.
  [[nodiscard]] double max_strain() const noexcept;
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;

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

  void make_cloth();
  void link(std::size_t a, std::size_t b);
  void find_near();
  void solve();
  void relax(const Link& link);
  void solve_separation(const SeparationConstraint& separation);
  [[nodiscard]] double least_radius() const noexcept;
  [[nodiscard]] bool is_on_ball(const Vec3d& vertex) const noexcept;
  void keep_outside(Vec3d& vertex) const;
  /// Computes the share of its displacement that each vertex may go. Returns false if there is no
  /// impact.
  [[nodiscard]] bool find_touches(double& earliest);
  void cut(std::uint32_t vertex, double share);

  ClothOptions options_;
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
  std::size_t steps_ = 0;
  std::size_t impacts_ = 0;
  std::size_t cut_short_ = 0;
};

}  // namespace winnow::bench
