#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/vec3.h>

#include <array>
#include <cstddef>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

/// A rigid body of a simulation, with its orientation in float. A body with zero inverse mass is
/// static.
struct FlowBody {
  Vec3d position;
  Vec3d velocity;
  Vec3d momentum;  ///< angular momentum about the centre of mass
  Vec3d spin;      ///< angular velocity, computed from momentum and orientation
  Vec3d force;
  Vec3d torque;
  Vec3d inverse_inertia;  ///< in the body's axes
  double inverse_mass = 0.0;
  std::array<float, 4> orientation{1.0F, 0.0F, 0.0F, 0.0F};
};
using FlowBodies = std::pmr::vector<FlowBody>;

/// Views the poses of the first bodies.
[[nodiscard]] PoseView poses_of(const FlowBodies& bodies, std::size_t count) noexcept;

struct FlowEnergy {
  double kinetic = 0.0;
  double potential = 0.0;
  double elastic = 0.0;

  [[nodiscard]] double total() const noexcept { return kinetic + potential + elastic; }
};

/// Makes one semi-implicit Euler step: updates velocities by forces and gravity (along -z), then
/// poses by the new velocities. Returns kinetic and potential energy at the step's start. In this
/// leapfrog scheme (Hairer, Lubich and Wanner, "Geometric Numerical Integration", I.1.4) velocities
/// belong to the middle of a step, so the kinetic energy is computed from the mean of the
/// velocities before and after the update. The bits are the same on any number of threads.
FlowEnergy integrate(FlowBodies& bodies, double gravity, double step, const Execution& execution,
                     std::pmr::vector<FlowEnergy>& scratch);

}  // namespace winnow::bench
