#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

struct ClothOptions {
  /// Vertices along an edge of the square.
  std::size_t side = 40;
  double step = 1.0 / 60.0;
  double gravity = 10.0;
  /// False: it falls as if there were neither a ball nor itself, to see what gets through then.
  bool swept = true;
  Execution execution = Execution::serial();
};

/// A square of cloth that falls on a ball and hangs down on all sides. Position-based dynamics
/// (Mueller et al., "Position based dynamics", 2007), whose steps are cut at the first touch that
/// winnow finds, of the cloth with itself and with the ball: never late, so that nothing gets
/// through. A client of winnow.
class ClothDrop {
 public:
  /// Throws std::runtime_error if winnow refuses the mesh.
  explicit ClothDrop(const ClothOptions& options);

  void step();

  [[nodiscard]] std::size_t triangles() const noexcept { return corners_.size() / 3; }
  [[nodiscard]] std::size_t steps() const noexcept { return steps_; }
  /// Touches at which steps were cut, of features with each other and of faces with the ball.
  [[nodiscard]] std::size_t impacts() const noexcept { return impacts_; }
  /// Steps that were cut for the whole cloth, because cutting single ways came to no end.
  [[nodiscard]] std::size_t cut_short() const noexcept { return cut_short_; }
  /// Edges that cross a face, and faces that cut the ball, where the cloth is: found by looking at
  /// all of them.
  [[nodiscard]] std::size_t passed() const;
  /// The lowest vertex.
  [[nodiscard]] double lowest() const noexcept;
  /// How much longer the longest edge is than at rest.
  [[nodiscard]] double stretch() const noexcept;
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;

 private:
  struct Link {
    std::uint32_t a;
    std::uint32_t b;
    double length;
  };
  /// Features that are near each other: sum of weight[i] times vertex[i] is to be so long along the
  /// normal.
  struct Stay {
    std::array<std::uint32_t, 4> vertex;
    std::array<double, 4> weight;
    Vec3d normal;
  };

  void make_cloth();
  void link(std::size_t a, std::size_t b);
  void find_near();
  void solve();
  void relax(const Link& link);
  void keep_apart(const Stay& stay);
  [[nodiscard]] double least_radius() const noexcept;
  [[nodiscard]] bool is_on_ball(const Vec3d& vertex) const noexcept;
  void keep_outside(Vec3d& vertex) const;
  /// The share of its way that each vertex may go. False if there is no touch.
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
  std::vector<Stay> stays_;
  std::size_t steps_ = 0;
  std::size_t impacts_ = 0;
  std::size_t cut_short_ = 0;
};

}  // namespace winnow::bench
