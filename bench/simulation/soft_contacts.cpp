#include "bench/simulation/soft_contacts.h"

#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

/// Number of pairs that a task computes.
constexpr std::size_t kChunk = 1024;
/// Friction at low sliding speed is viscous, with this share of the spring's damping. A larger
/// share would overshoot if a light body touches many others.
constexpr double kCreep = 0.25;

/// Two bodies in contact, and the spring of their reduced mass.
struct Touch {
  Touch(const FlowBody& first, const FlowBody& second, const SoftContacts& law)
      : a(first), b(second) {
    const double mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    stiffness = mass * law.frequency * law.frequency;
    damping = 2.0 * law.damping * mass * law.frequency;
  }

  const FlowBody& a;
  const FlowBody& b;
  double stiffness = 0.0;
  double damping = 0.0;
};

/// Adds the force of one contact point; all points of a pair share the spring.
void add_point(const Touch& touch, const SoftContacts& law, const ContactPoint& point,
               const Vec3d& normal, double share, PairForce& sum) {
  const auto& [a, b, stiffness, full_damping] = touch;
  const auto depth = static_cast<double>(point.depth);
  const Vec3d arm_a = Vec3f(point.position).cast<double>();
  const Vec3d arm_b = arm_a - (b.position - a.position);
  const Vec3d velocity = b.velocity + b.spin.cross(arm_b) - a.velocity - a.spin.cross(arm_a);
  const double parting = velocity.dot(normal);
  const double damping = share * full_damping;
  const double push = std::max(0.0, share * stiffness * depth - damping * parting);
  const Vec3d sliding = velocity - parting * normal;
  const double speed = sliding.norm();
  const double drag = std::min(kCreep * damping, speed > 0.0 ? law.friction * push / speed : 0.0);
  const Vec3d force = push * normal - drag * sliding;
  sum.force += force;
  sum.torque_a -= arm_a.cross(force);
  sum.torque_b += arm_b.cross(force);
  sum.elastic += 0.5 * share * stiffness * depth * depth;
  sum.deepest = std::max(sum.deepest, depth);
}

PairForce force_of(const Contacts& contacts, std::size_t pair, const SoftContacts& law,
                   const FlowBodies& bodies) {
  PairForce sum;
  const Touch touch(bodies[contacts.data_a()[pair]], bodies[contacts.data_b()[pair]], law);
  const auto manifold_first = contacts.manifold_first();
  const auto point_first = contacts.point_first();
  const std::uint32_t first = manifold_first[pair];
  const std::uint32_t last = manifold_first[pair + 1];
  double depths = 0.0;
  for (std::uint32_t p = point_first[first]; p < point_first[last]; ++p) {
    depths += std::max(0.0, static_cast<double>(contacts.contact(p).depth));
  }
  for (std::uint32_t m = first; m < last; ++m) {
    const Vec3d normal{contacts.normal(0)[m], contacts.normal(1)[m], contacts.normal(2)[m]};
    for (std::uint32_t p = point_first[m]; p < point_first[m + 1]; ++p) {
      const ContactPoint point = contacts.contact(p);
      if (point.depth <= 0.0F) continue;
      // Points are weighted by depth, so that a point that appears or vanishes at depth zero
      // changes nothing. The weights of a pair of bodies add up to 1, so that a fine mesh is not
      // stiffer than a coarse one.
      const double share = static_cast<double>(point.depth) / depths;
      add_point(touch, law, point, normal, share, sum);
    }
  }
  return sum;
}

}  // namespace

ContactSums apply_contacts(const Contacts& contacts, const SoftContacts& law, FlowBodies& bodies,
                           const Execution& execution, std::pmr::vector<PairForce>& scratch) {
  scratch.resize(contacts.size());
  execution.for_each((contacts.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(contacts.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      scratch[i] = force_of(contacts, i, law, bodies);
    }
  });
  for (FlowBody& body : bodies) body.force = body.torque = {};
  ContactSums sums;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    FlowBody& a = bodies[contacts.data_a()[i]];
    FlowBody& b = bodies[contacts.data_b()[i]];
    a.force -= scratch[i].force;
    b.force += scratch[i].force;
    a.torque += scratch[i].torque_a;
    b.torque += scratch[i].torque_b;
    sums.elastic += scratch[i].elastic;
    sums.deepest = std::max(sums.deepest, scratch[i].deepest);
  }
  return sums;
}

}  // namespace winnow::bench
