#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/pose.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/contacts.h>

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

/// Parameters of a spring, a damper and Coulomb friction at every contact. Contacts never pull.
struct SoftContacts {
  /// Angular frequency of the spring between two bodies of the reduced mass. Stable for steps of up
  /// to about 0.3 / frequency, for bodies that touch a dozen others.
  double frequency = 250.0;
  /// Damping ratio in [0, 1]; 0: elastic, 1: critically damped.
  double damping = 0.3;
  double friction = 0.4;
};

/// Force of a pair on b (a gets its opposite), and torques about both centres.
struct PairForce {
  Vec3d force;
  Vec3d torque_a;
  Vec3d torque_b;
  double elastic = 0.0;
  double deepest = 0.0;
};

struct ContactSums {
  double elastic = 0.0;  ///< energy in the springs
  double deepest = 0.0;  ///< largest depth of a point
};

/// Sets the forces and torques of all bodies from the contacts, whose client data are rows of
/// `bodies`. The bits are the same on any number of threads.
ContactSums apply_contacts(const Contacts& contacts, const SoftContacts& law, FlowBodies& bodies,
                           const Execution& execution, std::pmr::vector<PairForce>& scratch);

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
