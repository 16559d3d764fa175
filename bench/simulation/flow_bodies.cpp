// Bodies of a granular flow: forces of their contacts (apply_contacts), and their motion
// (integrate).

#include "bench/simulation/flow_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow::bench {
namespace {

/// Number of bodies that a task moves.
constexpr std::size_t kBodiesOfTask = 2048;

using Turn = std::array<double, 4>;

Vec3d turned(const Turn& q, const Vec3d& v) {
  const Vec3d u(&q[1]);
  const Vec3d t = 2.0 * u.cross(v);
  return v + q[0] * t + u.cross(t);
}

Vec3d turned_back(const Turn& q, const Vec3d& v) {
  return turned({q[0], -q[1], -q[2], -q[3]}, v);
}

/// Returns the orientation after rotating for `time`, to first order, normalized.
Turn integrate_orientation(const Turn& q, const Vec3d& spin, double time) {
  const double h = 0.5 * time;
  const Vec3d u(&q[1]);
  const Vec3d v = u + (h * q[0]) * spin + h * spin.cross(u);
  const double w = q[0] - h * spin.dot(u);
  const double scale = 1.0 / std::sqrt(w * w + v.squared_norm());
  return {scale * w, scale * v.x(), scale * v.y(), scale * v.z()};
}

bool is_round(const Vec3d& inertia) {
  return inertia[0] == inertia[1] && inertia[0] == inertia[2];
}

Vec3d spin_of(const Turn& q, const Vec3d& momentum, const Vec3d& inverse_inertia) {
  if (is_round(inverse_inertia)) return inverse_inertia[0] * momentum;
  Vec3d own = turned_back(q, momentum);
  for (std::size_t axis = 0; axis < 3; ++axis) own[axis] *= inverse_inertia[axis];
  return turned(q, own);
}

/// Moves a body and adds its energy before the move.
void move_body(FlowBody& body, double gravity, double step, FlowEnergy& energy) {
  if (body.inverse_mass == 0.0) return;
  const double mass = 1.0 / body.inverse_mass;
  const Vec3d before = body.velocity;
  const Vec3d pull{0.0, 0.0, -gravity};
  body.velocity = before + step * (body.inverse_mass * body.force + pull);
  const Vec3d mean = 0.5 * (before + body.velocity);
  energy.kinetic += 0.5 * mass * mean.squared_norm();
  energy.potential += mass * gravity * body.position.z();
  body.position += step * body.velocity;

  Turn q;
  for (std::size_t k = 0; k < 4; ++k) q[k] = static_cast<double>(body.orientation[k]);
  const Vec3d twist = step * body.torque;
  const Vec3d middle = body.momentum + 0.5 * twist;
  energy.kinetic += 0.5 * middle.dot(spin_of(q, middle, body.inverse_inertia));
  body.momentum += twist;
  Vec3d spin = spin_of(q, body.momentum, body.inverse_inertia);
  // Uses the spin at half the step; otherwise bodies with unequal moments of inertia would gain
  // energy.
  if (!is_round(body.inverse_inertia)) {
    spin = spin_of(integrate_orientation(q, spin, 0.5 * step), body.momentum, body.inverse_inertia);
  }
  q = integrate_orientation(q, spin, step);
  body.spin = spin_of(q, body.momentum, body.inverse_inertia);
  for (std::size_t k = 0; k < 4; ++k) body.orientation[k] = static_cast<float>(q[k]);
}

/// Number of pairs that a task computes.
constexpr std::size_t kPairsOfTask = 1024;
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

PoseView poses_of(const FlowBodies& bodies, std::size_t count) noexcept {
  const double* const p = bodies.front().position.data();
  const float* const q = bodies.front().orientation.data();
  return {{p, p + 1, p + 2}, {q, q + 1, q + 2, q + 3}, count, sizeof(FlowBody), sizeof(FlowBody)};
}

ContactSums apply_contacts(const Contacts& contacts, const SoftContacts& law, FlowBodies& bodies,
                           const Execution& execution, std::pmr::vector<PairForce>& scratch) {
  scratch.resize(contacts.size());
  execution.for_each((contacts.size() + kPairsOfTask - 1) / kPairsOfTask, [&](std::size_t chunk) {
    const std::size_t end = std::min(contacts.size(), (chunk + 1) * kPairsOfTask);
    for (std::size_t i = chunk * kPairsOfTask; i < end; ++i) {
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

FlowEnergy integrate(FlowBodies& bodies, double gravity, double step, const Execution& execution,
                     std::pmr::vector<FlowEnergy>& scratch) {
  const std::size_t chunks = (bodies.size() + kBodiesOfTask - 1) / kBodiesOfTask;
  scratch.assign(chunks, {});
  execution.for_each(chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(bodies.size(), (chunk + 1) * kBodiesOfTask);
    for (std::size_t i = chunk * kBodiesOfTask; i < end; ++i) {
      move_body(bodies[i], gravity, step, scratch[chunk]);
    }
  });
  FlowEnergy sum;
  for (const FlowEnergy& part : scratch) {
    sum.kinetic += part.kinetic;
    sum.potential += part.potential;
  }
  return sum;
}

}  // namespace winnow::bench
