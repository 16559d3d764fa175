// The solver of contact_solver.h. standing.cpp calls step() once a frame: contact points are loaded
// once, then each substep warm-starts, solves, moves and relaxes.

#include "bench/simulation/contact_solver.h"

#include <winnow/core/eigen.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

namespace winnow::bench {
namespace {

using Vec3 = Eigen::Vector3d;

constexpr double kGravity = 10.0;
constexpr double kFriction = 0.7;
constexpr int kSubsteps = 8;
/// Frequency in Hz of the springs that push bodies apart, limited to a quarter of the substep rate,
/// and their damping ratio.
constexpr double kStiffness = 60.0;
constexpr double kSpringDamping = 10.0;
/// Largest speed at which the springs push bodies apart.
constexpr double kPush = 3.0;
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

class SoftSolver final : public ContactSolver {
 public:
  void step(const Contacts& contacts, const ContactGroups& colours, const Execution& execution,
            double seconds, std::vector<RigidBody>& bodies) override {
    const double h = seconds / kSubsteps;
    const Softness soft = softness(h);
    bodies_ = bodies;
    take(contacts);
    for (int substep = 0; substep < kSubsteps; ++substep) {
      fall(h);
      for_colours(colours, execution, [&](std::uint32_t pair) { warm_start(pairs_[pair]); });
      for_colours(colours, execution, [&](std::uint32_t pair) { solve(pairs_[pair], h, &soft); });
      move(h);
      for_colours(colours, execution, [&](std::uint32_t pair) { solve(pairs_[pair], h, nullptr); });
    }
    keep();
  }

 private:
  /// Accumulated impulses of a point, in world axes.
  struct Impulse {
    double normal = 0.0;
    Vec3 tangent = Vec3::Zero();
  };
  struct Point {
    /// Position of the point relative to each body, when contacts were found.
    Vec3 arm[2];
    /// The normal, and two tangents.
    Vec3 axis[3];
    double mass[3];
    double impulse[3];
    double separation;
  };
  struct PairPoints {
    std::uint32_t body[2];
    std::uint32_t first;
    std::uint32_t end;
  };
  /// State of a body during a frame.
  struct Motion {
    Eigen::Matrix3d inverse_inertia;
    /// Translation and rotation since contacts were found.
    Vec3 moved;
    Eigen::Matrix3d turned;
    Eigen::Quaterniond start;
  };
  /// Coefficients of a spring in a substep.
  struct Softness {
    double rate;
    double mass;
    double impulse;
  };

  void take(const Contacts& contacts) {
    motions_.resize(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Eigen::Matrix3d r = bodies_[i].turn.toRotationMatrix();
      motions_[i] = {r * bodies_[i].inverse_inertia.asDiagonal() * r.transpose(), Vec3::Zero(),
                     Eigen::Matrix3d::Identity(), bodies_[i].turn};
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
          points_[p] = point_of(contacts, m, p, pair);
        }
      }
    }
  }

  [[nodiscard]] Point point_of(const Contacts& contacts, std::uint32_t manifold,
                               std::uint32_t point, const PairPoints& pair) const {
    Point made;
    const ContactPoint contact = contacts.contact(point);
    made.arm[0] = as_eigen(contact.position).cast<double>();
    made.arm[1] = made.arm[0] + bodies_[pair.body[0]].position - bodies_[pair.body[1]].position;
    made.separation = -static_cast<double>(contact.depth);
    for (int k = 0; k < 3; ++k) made.axis[0][k] = contacts.normal(k)[manifold];
    made.axis[1] = across(made.axis[0]);
    made.axis[2] = made.axis[0].cross(made.axis[1]);
    for (int i = 0; i < 3; ++i) {
      double give = 0.0;
      for (int side = 0; side < 2; ++side) {
        const Vec3 lever = made.arm[side].cross(made.axis[i]);
        give += bodies_[pair.body[side]].inverse_mass +
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
  [[nodiscard]] static Softness softness(double h) {
    const double omega = 2.0 * std::numbers::pi * std::min(kStiffness, 0.25 / h);
    const double a = 2.0 * kSpringDamping + h * omega;
    const double b = h * omega * a;
    return {omega / a, b / (1.0 + b), 1.0 / (1.0 + b)};
  }

  void fall(double h) {
    for (RigidBody& body : bodies_) {
      if (body.inverse_mass != 0.0) body.velocity.z() -= h * kGravity;
    }
  }

  void move(double h) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      RigidBody& body = bodies_[i];
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

  void apply(const PairPoints& pair, const Point& point, const Vec3& impulse) const {
    for (int side = 0; side < 2; ++side) {
      RigidBody& body = bodies_[pair.body[side]];
      // Pairs of one colour are solved in parallel and may share static bodies, which must
      // therefore not be written.
      if (body.inverse_mass == 0.0) continue;
      const Vec3 push = side == 0 ? Vec3(-impulse) : impulse;
      body.velocity += body.inverse_mass * push;
      body.spin += motions_[pair.body[side]].inverse_inertia * point.arm[side].cross(push);
    }
  }

  [[nodiscard]] Vec3 speed(const PairPoints& pair, const Point& point) const {
    const RigidBody& a = bodies_[pair.body[0]];
    const RigidBody& b = bodies_[pair.body[1]];
    return b.velocity + b.spin.cross(point.arm[1]) - a.velocity - a.spin.cross(point.arm[0]);
  }

  void warm_start(const PairPoints& pair) const {
    for (std::uint32_t p = pair.first; p < pair.end; ++p) {
      const Point& point = points_[p];
      const Vec3 impulse = point.impulse[0] * point.axis[0] + point.impulse[1] * point.axis[1] +
                           point.impulse[2] * point.axis[2];
      apply(pair, point, impulse);
    }
  }

  // Solves friction first, then non-penetration: the constraint that is solved last is met best,
  // and non-penetration matters more. A null `soft` solves the normal constraint without softness
  // (relaxation).
  void solve(const PairPoints& pair, double h, const Softness* soft) {
    for (std::uint32_t p = pair.first; p < pair.end; ++p) {
      Point& point = points_[p];
      const Vec3 slip = speed(pair, point);
      const double most = kFriction * point.impulse[0];
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
      apply(pair, point, change);
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
        bias = std::max(soft->rate * separation, -kPush);
        mass = soft->mass;
        slack = soft->impulse;
      }
      const double approach = speed(pair, point).dot(point.axis[0]);
      const double before = point.impulse[0];
      point.impulse[0] =
          std::max(0.0, before - point.mass[0] * mass * (approach + bias) - slack * before);
      apply(pair, point, (point.impulse[0] - before) * point.axis[0]);
    }
  }

  void keep() {
    impulses_.resize(points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const Point& point = points_[p];
      impulses_[p] = {point.impulse[0],
                      point.impulse[1] * point.axis[1] + point.impulse[2] * point.axis[2]};
    }
  }

  std::span<RigidBody> bodies_;  ///< of the frame
  std::vector<Motion> motions_;
  std::vector<PairPoints> pairs_;
  std::vector<Point> points_;
  std::vector<Impulse> impulses_;
};

}  // namespace

std::unique_ptr<ContactSolver> make_contact_solver() {
  return std::make_unique<SoftSolver>();
}

}  // namespace winnow::bench
