// The solver of contact_solver.h. standing.cpp calls step() once a frame: contact points are loaded
// once, then each substep warm-starts, solves, moves and relaxes.

#include "bench/simulation/contact_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace winnow::bench {
namespace {

using Vec3 = Eigen::Vector3d;

/// Number of pairs that a task solves.
constexpr std::size_t kSolvedPairs = 64;

/// Returns a unit vector perpendicular to a unit normal; the result is a continuous function of the
/// normal almost everywhere.
Vec3 across(const Vec3& normal) {
  return normal.cross(std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
}

/// Calls body(pair) for all pairs, one colour after the other. The pairs of a colour run in
/// parallel, except in kRestColour.
template <typename Body>
void for_colours(const ContactGroups& colours, const Execution& execution, Body&& body) {
  for (std::size_t colour = 0; colour < colours.size(); ++colour) {
    const auto pairs = colours.pairs(colour);
    const std::size_t share = colour == kRestColour ? pairs.size() : kSolvedPairs;
    execution.for_each((pairs.size() + share - 1) / share, [&](std::size_t task) {
      const std::size_t end = std::min(pairs.size(), (task + 1) * share);
      for (std::size_t i = task * share; i < end; ++i) body(pairs[i]);
    });
  }
}

}  // namespace

void ContactSolver::step(const Contacts& contacts, const ContactGroups& colours,
                         const Execution& execution, double seconds,
                         std::vector<RigidBody>& bodies) {
  const double h = seconds / options_.substeps;
  const Softness soft = softness(h);
  take(contacts, bodies);
  for (int substep = 0; substep < options_.substeps; ++substep) {
    fall(h, bodies);
    for_colours(colours, execution, [&](std::uint32_t pair) { warm_start(pairs_[pair], bodies); });
    for_colours(colours, execution,
                [&](std::uint32_t pair) { solve(pairs_[pair], h, &soft, bodies); });
    move(h, bodies);
    for_colours(colours, execution,
                [&](std::uint32_t pair) { solve(pairs_[pair], h, nullptr, bodies); });
  }
  keep();
}

void ContactSolver::take(const Contacts& contacts, const std::vector<RigidBody>& bodies) {
  motions_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Eigen::Matrix3d r = bodies[i].turn.toRotationMatrix();
    motions_[i] = {r * bodies[i].inverse_inertia.asDiagonal() * r.transpose(), Vec3::Zero(),
                   Eigen::Matrix3d::Identity(), bodies[i].turn};
  }
  pairs_.resize(contacts.size());
  points_.resize(contacts.points());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    PairPoints& pair = pairs_[i];
    pair.body[0] = static_cast<std::uint32_t>(contacts.data_a()[i]);
    pair.body[1] = static_cast<std::uint32_t>(contacts.data_b()[i]);
    const std::uint32_t end = contacts.manifold_first()[i + 1];
    pair.first = contacts.point_first()[contacts.manifold_first()[i]];
    pair.end = contacts.point_first()[end];
    for (std::uint32_t m = contacts.manifold_first()[i]; m < end; ++m) {
      for (std::uint32_t p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        points_[p] = point_of(contacts, m, p, pair, bodies);
      }
    }
  }
}

ContactSolver::Point ContactSolver::point_of(const Contacts& contacts, std::uint32_t manifold,
                                             std::uint32_t point, const PairPoints& pair,
                                             const std::vector<RigidBody>& bodies) const {
  Point made;
  const ContactPoint contact = contacts.contact(point);
  made.arm[0] = as_eigen(contact.position).cast<double>();
  made.arm[1] = made.arm[0] + bodies[pair.body[0]].position - bodies[pair.body[1]].position;
  made.separation = -static_cast<double>(contact.depth);
  for (int k = 0; k < 3; ++k) made.axis[0][k] = contacts.normal(k)[manifold];
  made.axis[1] = across(made.axis[0]);
  made.axis[2] = made.axis[0].cross(made.axis[1]);
  for (int i = 0; i < 3; ++i) {
    double give = 0.0;
    for (int side = 0; side < 2; ++side) {
      const Vec3 lever = made.arm[side].cross(made.axis[i]);
      give += bodies[pair.body[side]].inverse_mass +
              lever.dot(motions_[pair.body[side]].inverse_inertia * lever);
    }
    made.mass[i] = 1.0 / give;
  }
  const std::uint32_t before = contacts.previous_point()[point];
  const Impulse known = before == kNoContact ? Impulse{} : impulses_[before];
  made.impulse[0] = known.normal;
  for (int i = 1; i < 3; ++i) made.impulse[i] = known.tangent.dot(made.axis[i]);
  return made;
}

// An implicit spring (Catto, "Soft constraints", 2011).
ContactSolver::Softness ContactSolver::softness(double h) const {
  const double omega = 2.0 * std::numbers::pi * std::min(options_.stiffness, 0.25 / h);
  const double a = 2.0 * options_.damping + h * omega;
  const double b = h * omega * a;
  return {omega / a, b / (1.0 + b), 1.0 / (1.0 + b)};
}

void ContactSolver::fall(double h, std::vector<RigidBody>& bodies) {
  for (RigidBody& body : bodies) {
    if (body.inverse_mass != 0.0) body.velocity.z() -= h * options_.gravity;
  }
}

void ContactSolver::move(double h, std::vector<RigidBody>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    RigidBody& body = bodies[i];
    if (body.inverse_mass == 0.0) continue;
    body.position += h * body.velocity;
    motions_[i].moved += h * body.velocity;
    const Eigen::Quaterniond rate(0.0, body.spin.x(), body.spin.y(), body.spin.z());
    body.turn.coeffs() += 0.5 * h * (rate * body.turn).coeffs();
    body.turn.normalize();
    motions_[i].turned = (body.turn * motions_[i].start.conjugate()).toRotationMatrix();
    const Eigen::Matrix3d r = body.turn.toRotationMatrix();
    motions_[i].inverse_inertia = r * body.inverse_inertia.asDiagonal() * r.transpose();
  }
}

void ContactSolver::apply(const PairPoints& pair, const Point& point, const Vec3& impulse,
                          std::vector<RigidBody>& bodies) const {
  for (int side = 0; side < 2; ++side) {
    RigidBody& body = bodies[pair.body[side]];
    // Pairs of one colour are solved in parallel and may share static bodies, which must therefore
    // not be written.
    if (body.inverse_mass == 0.0) continue;
    const Vec3 push = side == 0 ? Vec3(-impulse) : impulse;
    body.velocity += body.inverse_mass * push;
    body.spin += motions_[pair.body[side]].inverse_inertia * point.arm[side].cross(push);
  }
}

Vec3 ContactSolver::speed(const PairPoints& pair, const Point& point,
                          const std::vector<RigidBody>& bodies) const {
  const RigidBody& a = bodies[pair.body[0]];
  const RigidBody& b = bodies[pair.body[1]];
  return b.velocity + b.spin.cross(point.arm[1]) - a.velocity - a.spin.cross(point.arm[0]);
}

void ContactSolver::warm_start(const PairPoints& pair, std::vector<RigidBody>& bodies) const {
  for (std::uint32_t p = pair.first; p < pair.end; ++p) {
    const Point& point = points_[p];
    const Vec3 impulse = point.impulse[0] * point.axis[0] + point.impulse[1] * point.axis[1] +
                         point.impulse[2] * point.axis[2];
    apply(pair, point, impulse, bodies);
  }
}

// Solves friction first, then non-penetration: the constraint that is solved last is met best, and
// non-penetration matters more. A null `soft` solves the normal constraint without softness
// (relaxation).
void ContactSolver::solve(const PairPoints& pair, double h, const Softness* soft,
                          std::vector<RigidBody>& bodies) {
  for (std::uint32_t p = pair.first; p < pair.end; ++p) {
    Point& point = points_[p];
    const Vec3 slip = speed(pair, point, bodies);
    const double most = options_.friction * point.impulse[0];
    double unclamped[2];
    for (int i = 0; i < 2; ++i) {
      unclamped[i] = point.impulse[i + 1] - point.mass[i + 1] * slip.dot(point.axis[i + 1]);
    }
    const double length = std::hypot(unclamped[0], unclamped[1]);
    const double scale = length > most ? most / length : 1.0;
    Vec3 change = Vec3::Zero();
    for (int i = 0; i < 2; ++i) {
      change += (scale * unclamped[i] - point.impulse[i + 1]) * point.axis[i + 1];
      point.impulse[i + 1] = scale * unclamped[i];
    }
    apply(pair, point, change, bodies);
  }
  const Motion& a = motions_[pair.body[0]];
  const Motion& b = motions_[pair.body[1]];
  for (std::uint32_t p = pair.first; p < pair.end; ++p) {
    Point& point = points_[p];
    const Vec3 parted = b.moved + b.turned * point.arm[1] - point.arm[1] - a.moved -
                        a.turned * point.arm[0] + point.arm[0];
    const double separation = point.separation + parted.dot(point.axis[0]);
    double bias = 0.0;
    double mass = 1.0;
    double slack = 0.0;
    if (separation > 0.0) {
      bias = separation / h;
    } else if (soft != nullptr) {
      bias = std::max(soft->rate * separation, -options_.push);
      mass = soft->mass;
      slack = soft->impulse;
    }
    const double approach = speed(pair, point, bodies).dot(point.axis[0]);
    const double before = point.impulse[0];
    point.impulse[0] =
        std::max(0.0, before - point.mass[0] * mass * (approach + bias) - slack * before);
    apply(pair, point, (point.impulse[0] - before) * point.axis[0], bodies);
  }
}

void ContactSolver::keep() {
  impulses_.resize(points_.size());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    impulses_[p] = {point.impulse[0],
                    point.impulse[1] * point.axis[1] + point.impulse[2] * point.axis[2]};
  }
}

}  // namespace winnow::bench
