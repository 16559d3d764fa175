#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/contacts.h>
#include "bench/simulation/flow_bodies.h"

#include <cstddef>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

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

}  // namespace winnow::bench
