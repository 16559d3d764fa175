#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/contacts.h>
#include "bench/simulation/flow_bodies.h"

#include <cstddef>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

/// A spring with a damper and Coulomb's friction at every contact. Contacts never pull.
struct SoftContacts {
  /// Of the spring between two bodies of the reduced mass, radians in unit time. Stable in steps of
  /// up to about 0.3 / frequency, for bodies that touch a dozen others.
  double frequency = 250.0;
  /// 0: elastic; 1: critically damped. In [0, 1].
  double damping = 0.3;
  double friction = 0.4;
};

/// What one pair of bodies does to both: a force on b (and its opposite on a), torques about the
/// centres of both.
struct PairForce {
  Vec force{};
  Vec torque_a{};
  Vec torque_b{};
  double elastic = 0.0;
  double deepest = 0.0;
};

struct ContactSums {
  double elastic = 0.0;  ///< energy in the springs
  double deepest = 0.0;  ///< the greatest depth of a point
};

/// Sets the forces and torques of all bodies to those of the contacts, whose client data are rows
/// of `bodies`. The same bits on any number of threads.
ContactSums apply_contacts(const Contacts& contacts, const SoftContacts& law, FlowBodies& bodies,
                           const Execution& execution, std::pmr::vector<PairForce>& scratch);

}  // namespace winnow::bench
