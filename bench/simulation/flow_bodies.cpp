#include "bench/simulation/flow_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow::bench {
namespace {

/// Number of bodies that a task moves.
constexpr std::size_t kChunk = 2048;

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

}  // namespace

PoseView poses_of(const FlowBodies& bodies, std::size_t count) noexcept {
  const double* const p = bodies.front().position.data();
  const float* const q = bodies.front().orientation.data();
  return {{p, p + 1, p + 2}, {q, q + 1, q + 2, q + 3}, count, sizeof(FlowBody), sizeof(FlowBody)};
}

FlowEnergy integrate(FlowBodies& bodies, double gravity, double step, const Execution& execution,
                     std::pmr::vector<FlowEnergy>& scratch) {
  const std::size_t chunks = (bodies.size() + kChunk - 1) / kChunk;
  scratch.assign(chunks, {});
  execution.for_each(chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(bodies.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
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
