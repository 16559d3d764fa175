#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include "bench/common/interface.h"

#include <Eigen/Geometry>
#include <memory>
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

/// Moves bodies whose contacts are known.
class ContactSolver : public Interface {
 public:
  /// Moves bodies by one frame of `seconds`. All substeps use the contacts found at the start of
  /// the frame, whose client data are indices of `bodies`.
  virtual void step(const Contacts& contacts, const ContactGroups& colours,
                    const Execution& execution, double seconds, std::vector<RigidBody>& bodies) = 0;
};

/// Sequential impulses (Catto, "Iterative dynamics with temporal coherence", 2005) with contacts as
/// soft constraints that are solved once each substep and relaxed after it ("Solver2D", 2024).
/// Warm-starts with the impulses of the last frame, found by Contacts::previous_point, and solves
/// pairs of one colour in parallel. Uses only winnow's public interface.
[[nodiscard]] std::unique_ptr<ContactSolver> make_contact_solver();

}  // namespace winnow::bench
