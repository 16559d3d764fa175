// Fast bodies in a funnel or beside a rotating blade: spheres and boxes that move from impact to
// impact and collide with each other and with static or rotating obstacles. All bodies move to the
// time of the first impact that ContinuousCollision finds, the two bodies of this impact get an
// impulse, and the rest of the step is tested again. Only these impacts are used, never an overlap
// test. A brute-force check finds centres that passed through. bench/rows/simulation_rows.cpp runs
// it.

#include "bench/simulation/barriers.h"

#include <winnow/core/eigen.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/scenes/meshes.h"
#include "bench/scenes/random_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace winnow::bench {
namespace {

using Vec3 = Eigen::Vector3d;

/// Distance of bodies at an impact; their size is about 1.
constexpr double kTolerance = 1e-4;
constexpr double kRestitution = 0.9;
/// Factor of the velocities in each step; it removes the energy that the blade adds.
constexpr double kBladeDrag = 0.5;
constexpr double kBladeTurns = 0.5;
constexpr FunnelSize kFunnel{.radius = 8.0, .outlet = 2.0, .depth = 8.0, .wall = 8.0, .edge = 2.0};
constexpr double kFunnelSpeed = 600.0;
/// Half extents of the blade; its tips move along the thin axis.
constexpr double kBlade[3] = {5.0, 0.01, 1.0};
constexpr double kRoom = 6.0;
constexpr std::size_t kBodies = 16;
/// A step is cut short after this many impacts per body.
constexpr std::size_t kMaxImpacts = 50;
/// The check samples the blade's frame this many times per radian of its rotation.
constexpr double kSamplesPerRadian = 40.0;

Vec3 position_of(const Pose& pose) {
  return as_eigen(pose.position);
}

class FastBodies final : public Barrier {
 public:
  explicit FastBodies(const BarrierOptions& options)
      : options_(options),
        scene_(shapes_, {.execution = options.execution, .composites = &composites_}) {
    if (has_funnel()) {
      make_funnel_scene();
    } else {
      make_blade_scene();
    }
    for (const Body& body : bodies_) keys_.push_back(body.key);
    motions_.resize(bodies_.size());
    poses_.resize(bodies_.size());
  }

  void step() override {
    push(options_.step);
    double left = options_.step;
    std::size_t found = 0;
    while (left > 0.0) {
      for (std::size_t i = 0; i < bodies_.size(); ++i) {
        motions_[i] =
            RigidMotion::by_velocities(bodies_[i].pose, bodies_[i].velocity, bodies_[i].spin, left);
      }
      if (!options_.continuous) {
        advance(1.0);
        break;
      }
      need(ccd_.find_impacts(keys_, motions_, {.tolerance = kTolerance, .first_only = true}),
           "impacts");
      const auto impacts = ccd_.impacts();
      const double share = impacts.empty() ? 1.0 : impacts.front().time;
      advance(share);
      if (impacts.empty()) break;
      for (const SceneImpact& impact : impacts) {
        if (impact.time == share) collide(impact);
      }
      left *= 1.0 - share;
      if (++found < kMaxImpacts * bodies_.size()) continue;
      ++figures_.cut_short;
      break;
    }
    put_back();
    ++figures_.steps;
  }

  [[nodiscard]] BarrierFigures figures() const override {
    BarrierFigures figures = figures_;
    figures.objects = bodies_.size();
    figures.fingerprint = fingerprint();
    return figures;
  }

 private:
  struct Body {
    Key key;
    Pose pose;
    Vec3 velocity = Vec3::Zero();
    Vec3 spin = Vec3::Zero();
    double radius = 0.0;
    /// Mass and inertia of a ball of this radius; 0 if the body is static or kinematic.
    double inverse_mass = 0.0;
    double inverse_inertia = 0.0;
  };

  [[nodiscard]] bool has_funnel() const { return options_.scene == "funnel"; }

  [[nodiscard]] Key add(ShapeId shape, const Pose& pose, BodyState state) {
    const Key key = need(scene_.add({.shape = shape, .pose = pose, .state = state}), "a body");
    return key;
  }

  void make_funnel_scene() {
    funnel_ = make_funnel(kFunnel);
    const ShapeId mesh =
        need(composites_.add_mesh(funnel_.points(), funnel_.indices()), "the funnel");
    static_cast<void>(add(mesh, Pose{}, BodyState::fixed));
    fill(0.6 * kFunnel.radius, 1.0, kFunnel.wall - 1.0, kFunnelSpeed);
  }

  void make_blade_scene() {
    for (int side = 0; side < 6; ++side) {
      const double sign = side % 2 == 0 ? 1.0 : -1.0;
      Vec3 normal = Vec3::Zero();
      normal[side / 2] = sign;
      const ShapeId wall = need(shapes_.add(HalfSpaceShape{normal, -kRoom}), "a wall");
      static_cast<void>(add(wall, Pose{}, BodyState::fixed));
    }
    fill(kRoom - 1.0, 1.5, kRoom - 1.0, 200.0);
    const ShapeId shape =
        need(shapes_.add(BoxShape{{kBlade[0], kBlade[1], kBlade[2]}}), "the blade");
    Body blade;
    blade.key = add(shape, Pose{}, BodyState::fixed);
    blade.spin = Vec3(0.0, 0.0, 2.0 * std::numbers::pi * kBladeTurns / options_.step);
    bodies_.push_back(blade);
  }

  /// Places bodies in layers of a lattice, so that they do not overlap.
  void fill(double reach, double low, double high, double speed) {
    constexpr double kApart = 1.3;
    const auto steps = [](double length) { return static_cast<int>(length / kApart); };
    const int across = 2 * steps(reach / std::numbers::sqrt2) + 1;
    const auto layers = static_cast<std::size_t>(steps(high - low) + 1);
    const std::size_t places = layers * static_cast<std::size_t>(across * across);
    for (std::size_t i = 0; i < std::min(options_.size != 0 ? options_.size : kBodies, places);
         ++i) {
      const auto row = static_cast<int>(i);
      const double radius = random_.in(0.3, 0.5);
      Body body;
      ShapeId shape;
      if (i % 2 == 0) {
        shape = need(shapes_.add(SphereShape{radius}), "a ball");
      } else {
        const double half = radius / std::sqrt(3.0);
        shape = need(shapes_.add(BoxShape{{half, half, half}}), "a box");
      }
      body.radius = radius;
      body.pose = Pose::at(kApart * (row % across - across / 2),
                           kApart * (row / across % across - across / 2),
                           low + kApart * (row / (across * across)));
      body.inverse_mass = 1.0 / (radius * radius * radius);
      body.inverse_inertia = body.inverse_mass / (0.4 * radius * radius);
      body.velocity = random_.in(0.1, 1.0) * speed * random_unit(random_);
      body.key = add(shape, body.pose, BodyState::dynamic);
      bodies_.push_back(body);
    }
  }

  void push(double seconds) {
    for (Body& body : bodies_) {
      if (body.inverse_mass == 0.0) continue;
      if (!has_funnel()) body.velocity *= kBladeDrag;
      body.velocity.z() -= options_.gravity * seconds;
      figures_.fastest = std::max(figures_.fastest, body.velocity.norm() * seconds / body.radius);
    }
  }

  void advance(double share) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      poses_[i] = motions_[i].at(share);
      const bool moves = bodies_[i].inverse_mass > 0.0;
      const Vec3 from = position_of(motions_[i].start);
      const bool through = has_funnel() ? passes_funnel(from, position_of(poses_[i]))
                                        : passes_blade(motions_[i], motions_.back(), share);
      figures_.passed += moves && through ? 1 : 0;
      bodies_[i].pose = poses_[i];
    }
    need(scene_.move(keys_, poses_), "poses");
  }

  [[nodiscard]] bool passes_funnel(const Vec3& from, const Vec3& to) const {
    for (std::size_t i = 0; i < funnel_.corners.size(); i += 3) {
      const auto corner = [&](std::size_t k) { return funnel_.vertices[funnel_.corners[i + k]]; };
      if (crosses(from, to, corner(0), corner(1), corner(2))) return true;
    }
    return false;
  }

  [[nodiscard]] bool passes_blade(const RigidMotion& body, const RigidMotion& blade,
                                  double share) const {
    const auto looks =
        static_cast<int>(std::ceil(kSamplesPerRadian * share * as_eigen(blade.turn).norm())) + 1;
    const auto seen = [&](int look) {
      const double time = share * look / looks;
      const Pose at = blade.at(time);
      const Eigen::Quaterniond turn = at.orientation;
      return Vec3(turn.conjugate() * (position_of(body.at(time)) - position_of(at)));
    };
    Vec3 before = seen(0);
    for (int look = 1; look <= looks; ++look) {
      const Vec3 now = seen(look);
      if ((before.y() > 0.0) != (now.y() > 0.0)) {
        const Vec3 through = before + (now - before) * (before.y() / (before.y() - now.y()));
        if (std::abs(through.x()) < kBlade[0] && std::abs(through.z()) < kBlade[2]) return true;
      }
      before = now;
    }
    return false;
  }

  /// Applies an impulse along the normal.
  void collide(const SceneImpact& impact) {
    ++figures_.impacts;
    Body fixed;
    const auto body_of = [&](const Key& key) -> Body& {
      const auto at =
          std::ranges::find_if(bodies_, [&](const Body& body) { return body.key == key; });
      return at == bodies_.end() ? fixed : *at;
    };
    Body& a = body_of(impact.a);
    Body& b = body_of(impact.b);
    const Vec3 normal = as_eigen(impact.normal);
    const Vec3 point = as_eigen(impact.point);
    const Vec3 arm_a = point - position_of(a.pose);
    const Vec3 arm_b = point - position_of(b.pose);
    const double closing =
        (a.velocity + a.spin.cross(arm_a) - b.velocity - b.spin.cross(arm_b)).dot(normal);
    const double give = a.inverse_mass + b.inverse_mass +
                        a.inverse_inertia * arm_a.cross(normal).squaredNorm() +
                        b.inverse_inertia * arm_b.cross(normal).squaredNorm();
    if (!(closing > 0.0) || !(give > 0.0)) return;
    const Vec3 impulse = (1.0 + kRestitution) * closing / give * normal;
    a.velocity -= a.inverse_mass * impulse;
    b.velocity += b.inverse_mass * impulse;
    a.spin -= a.inverse_inertia * arm_a.cross(impulse);
    b.spin += b.inverse_inertia * arm_b.cross(impulse);
  }

  /// Returns bodies that left the funnel through an opening to its top, if there is a free place.
  void put_back() {
    if (!has_funnel()) return;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Body& body = bodies_[i];
      const double z = body.pose.position[2];
      if (z > -kFunnel.depth - 1.0 && z < kFunnel.wall + 1.0) continue;
      const Pose place = Pose::at(random_.in(-3.0, 3.0), random_.in(-3.0, 3.0), 0.5 * kFunnel.wall);
      const bool free = std::ranges::all_of(bodies_, [&](const Body& other) {
        return (position_of(other.pose) - position_of(place)).norm() > other.radius + body.radius;
      });
      if (!free) continue;
      body.pose = poses_[i] = place;
      body.velocity = random_.in(0.1, 1.0) * kFunnelSpeed * random_unit(random_);
      body.spin = Vec3::Zero();
    }
    need(scene_.move(keys_, poses_), "poses");
  }

  [[nodiscard]] std::uint64_t fingerprint() const {
    std::uint64_t sum = 0;
    for (const Body& body : bodies_) {
      for (const double x : body.pose.position) sum = mix(sum, x);
      for (const double x : body.pose.orientation) sum = mix(sum, x);
      for (const double x : body.velocity) sum = mix(sum, x);
    }
    return sum;
  }

  BarrierOptions options_;
  ShapePool shapes_;
  CompositePool composites_{shapes_};
  Scene scene_;
  ContinuousCollision ccd_{scene_};
  Triangles funnel_;
  Random random_{1};
  std::vector<Body> bodies_;  ///< the blade is the last one
  std::vector<Key> keys_;
  std::vector<RigidMotion> motions_;
  std::vector<Pose> poses_;
  BarrierFigures figures_{.fastest = 0.0};
};

}  // namespace

std::unique_ptr<Barrier> make_fast_bodies(const BarrierOptions& options) {
  return std::make_unique<FastBodies>(options);
}

}  // namespace winnow::bench
