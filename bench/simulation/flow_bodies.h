#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/pose.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/vec3.h>

#include <cstddef>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

/// Rigid bodies of a simulation as columns of doubles, with orientations in float. A body with zero
/// inverse mass is static.
struct FlowBodies {
  using Column = std::pmr::vector<double>;

  explicit FlowBodies(std::size_t count, std::pmr::memory_resource* memory);

  [[nodiscard]] std::size_t size() const noexcept { return inverse_mass.size(); }
  [[nodiscard]] PoseView poses(std::size_t count) const noexcept;
  [[nodiscard]] Pose pose(std::size_t i) const noexcept { return poses(size())[i]; }

  Column position[3];
  Column velocity[3];
  std::pmr::vector<float> orientation[4];
  Column momentum[3];  ///< angular momentum about the centre of mass
  Column spin[3];      ///< angular velocity, computed from momentum and orientation
  Column force[3];
  Column torque[3];
  Column inverse_mass;
  Column inverse_inertia[3];  ///< in the body's axes
};

[[nodiscard]] inline Vec3d at(const FlowBodies::Column (&columns)[3], std::size_t i) noexcept {
  return {columns[0][i], columns[1][i], columns[2][i]};
}
inline void put(FlowBodies::Column (&columns)[3], std::size_t i, const Vec3d& value) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) columns[axis][i] = value[axis];
}

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
