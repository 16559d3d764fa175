#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// A body of the solver. A body with zero inverse mass is static.
struct RigidBody {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  double inverse_mass = 0.0;
  /// Diagonal of the inverse inertia tensor in the body's axes.
  Eigen::Vector3d inverse_inertia = Eigen::Vector3d::Zero();
};

struct SolverOptions {
  double gravity = 10.0;
  double friction = 0.7;
  int substeps = 8;
  /// Frequency in Hz of the springs that push bodies apart, limited to a quarter of the substep
  /// rate, and their damping ratio.
  double stiffness = 60.0;
  double damping = 10.0;
  /// Largest speed at which the springs push bodies apart.
  double push = 3.0;
};

/// Sequential impulses (Catto, "Iterative dynamics with temporal coherence", 2005) with contacts as
/// soft constraints that are solved once each substep and relaxed after it ("Solver2D", 2024).
/// Warm-starts with the impulses of the last frame, found by Contacts::previous_point, and solves
/// pairs of one colour in parallel. Uses only winnow's public interface; client data are indices of
/// `bodies`.
class ContactSolver {
 public:
  explicit ContactSolver(const SolverOptions& options) : options_(options) {}

  /// Moves bodies by one frame of `seconds`. All substeps use the contacts found at the start of
  /// the frame.
  void step(const Contacts& contacts, const ContactGroups& colours, const Execution& execution,
            double seconds, std::vector<RigidBody>& bodies);

 private:
  /// Accumulated impulses of a point, in world axes.
  struct Impulse {
    double normal = 0.0;
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
  };
  struct Point {
    /// Position of the point relative to each body, when contacts were found.
    Eigen::Vector3d arm[2];
    /// The normal, and two tangents.
    Eigen::Vector3d axis[3];
    double mass[3];
    double impulse[3];
    double separation;
  };
  struct PairPoints {
    std::uint32_t body[2];
    std::uint32_t first;
    std::uint32_t end;
  };
  /// State of a body during a frame.
  struct Motion {
    Eigen::Matrix3d inverse_inertia;
    /// Translation and rotation since contacts were found.
    Eigen::Vector3d moved;
    Eigen::Matrix3d turned;
    Eigen::Quaterniond start;
  };
  /// Coefficients of a spring in a substep.
  struct Softness {
    double rate;
    double mass;
    double impulse;
  };

  void take(const Contacts& contacts, const std::vector<RigidBody>& bodies);
  [[nodiscard]] Point point_of(const Contacts& contacts, std::uint32_t manifold,
                               std::uint32_t point, const PairPoints& pair,
                               const std::vector<RigidBody>& bodies) const;
  [[nodiscard]] Softness softness(double h) const;
  void fall(double h, std::vector<RigidBody>& bodies);
  void move(double h, std::vector<RigidBody>& bodies);
  void warm_start(const PairPoints& pair, std::vector<RigidBody>& bodies) const;
  void solve(const PairPoints& pair, double h, const Softness* soft,
             std::vector<RigidBody>& bodies);
  void apply(const PairPoints& pair, const Point& point, const Eigen::Vector3d& impulse,
             std::vector<RigidBody>& bodies) const;
  [[nodiscard]] Eigen::Vector3d speed(const PairPoints& pair, const Point& point,
                                      const std::vector<RigidBody>& bodies) const;
  void keep();

  SolverOptions options_;
  std::vector<Motion> motions_;
  std::vector<PairPoints> pairs_;
  std::vector<Point> points_;
  std::vector<Impulse> impulses_;
};

}  // namespace winnow::bench
