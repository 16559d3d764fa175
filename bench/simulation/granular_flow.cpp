// Granular flow of granular_flow.h. A step calls Scene::collide, then apply_contacts and integrate
// (flow_bodies.cpp) and Scene::move, and puts bodies that left the funnel back on top. FlowRun and
// the "simulate" command run it.

#include "bench/simulation/granular_flow.h"

#include "bench/common/exact_math.h"
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/stage_clock.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace winnow::bench {
namespace {

/// Number of shapes of each kind, which bodies share.
constexpr std::size_t kSizes = 16;
constexpr double kLargestRadius = 0.6;
constexpr double kLargestHalf = 0.42;
constexpr double kDensity = 1.0;
/// Relative distance of bodies when they are placed.
constexpr double kRoom = 1.03;
/// Depth below the mesh at which bodies are put back.
constexpr double kFall = 4.0;

/// The mass of a shape and its moments of inertia in its own axes.
struct Inertia {
  double mass;
  Vec3d moment;
};

Inertia inertia_of(const ShapeTables& tables, ShapeId id) {
  if (id.kind() == ShapeKind::sphere) {
    const double r = tables.spheres[id.index()].radius;
    const double mass = kDensity * 4.18879020478639 * r * r * r;
    const double moment = 0.4 * mass * r * r;
    return {mass, {moment, moment, moment}};
  }
  const double* h = tables.boxes[id.index()].half.data();
  const double mass = kDensity * 8.0 * h[0] * h[1] * h[2];
  const auto about = [&](double u, double v) { return mass / 3.0 * (u * u + v * v); };
  return {mass, {about(h[1], h[2]), about(h[0], h[2]), about(h[0], h[1])}};
}

FunnelSize funnel_for(std::size_t objects) {
  const double across = cube_root(static_cast<double>(objects));
  FunnelSize size;
  size.radius = 3.0 + 0.7 * across;
  size.outlet = 1.6 + 0.08 * across;
  size.depth = size.radius;
  size.wall = 4.0 + 0.7 * across;
  return size;
}

}  // namespace

GranularFlow::GranularFlow(const FlowOptions& options)
    : options_(options),
      objects_(options.objects),
      shapes_(options.memory),
      composites_(shapes_, options.memory),
      scene_(
          shapes_,
          {.memory = options.memory, .execution = options.execution, .composites = &composites_}),
      contacts_(options.memory),
      found_pairs_(options.memory),
      funnel_(funnel_for(options.objects)),
      bodies_(options.objects + 1, options.memory),
      shape_of_(options.memory),
      keys_(options.memory),
      spots_(options.memory),
      spot_of_(options.objects, options.memory),
      pair_forces_(options.memory),
      energy_parts_(options.memory),
      then_(options.memory) {
  make_obstacle();
  make_shapes();
  make_spots();
  fill();
  add_to_scene();
}

void GranularFlow::make_obstacle() {
  mesh_ = make_funnel(funnel_);
  mesh_shape_ = need(composites_.add_mesh(mesh_.points(), mesh_.indices(), {}, options_.execution),
                     "the mesh");
  floor_ = mesh_.vertices.front().z() - kFall;  // the first ring is the outlet
}

void GranularFlow::make_shapes() {
  Random random(options_.seed);
  ShapeId spheres[kSizes];
  ShapeId boxes[kSizes];
  for (std::size_t i = 0; i < kSizes; ++i) {
    spheres[i] = need(shapes_.add(SphereShape{random.in(0.4, kLargestRadius)}), "a sphere");
    const BoxShape box{
        {random.in(0.3, kLargestHalf), random.in(0.3, kLargestHalf), random.in(0.3, kLargestHalf)}};
    boxes[i] = need(shapes_.add(box), "a box");
  }
  shape_of_.reserve(objects_);
  for (std::size_t i = 0; i < objects_; ++i) {
    const bool is_box = options_.shape == FlowShape::boxes ||
                        (options_.shape == FlowShape::mixed && random.below(2) == 1);
    shape_of_.push_back((is_box ? boxes : spheres)[random.below(kSizes)]);
    const Inertia inertia = inertia_of(shapes_.tables(), shape_of_.back());
    bodies_[i].inverse_mass = 1.0 / inertia.mass;
    for (int axis = 0; axis < 3; ++axis) {
      bodies_[i].inverse_inertia[axis] = 1.0 / inertia.moment[axis];
      bodies_[i].velocity[axis] = random.in(-options_.stir, options_.stir);
    }
  }
  const bool round = options_.shape == FlowShape::spheres;
  spacing_ = 2.0 * kRoom * (round ? kLargestRadius : std::sqrt(3.0) * kLargestHalf);
}

void GranularFlow::make_spots() {
  const double most = funnel_.radius - spacing_;
  const int reach = static_cast<int>(most / spacing_);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const Spot spot{spacing_ * x, spacing_ * y, objects_};
      if (std::hypot(spot.x, spot.y) <= most) spots_.push_back(spot);
    }
  }
}

/// Places bodies layer by layer from the outlet up, inside the cone.
void GranularFlow::fill() {
  double z = -funnel_.depth + spacing_;
  for (std::size_t i = 0; i < objects_; z += spacing_) {
    const double height = std::min(1.0, 1.0 + z / funnel_.depth);
    const double inside = std::lerp(funnel_.outlet, funnel_.radius, height) - 0.75 * spacing_;
    for (std::size_t s = 0; s < spots_.size() && i < objects_; ++s) {
      if (std::hypot(spots_[s].x, spots_[s].y) > inside) continue;
      bodies_[i].position = {spots_[s].x, spots_[s].y, z};
      spots_[s].last = i;
      spot_of_[i++] = s;
    }
  }
  refill_ = z;
}

void GranularFlow::add_to_scene() {
  std::vector<BodyDefinition> definitions(objects_ + 1);
  for (std::size_t i = 0; i < objects_; ++i) {
    definitions[i].shape = shape_of_[i];
    definitions[i].pose = pose(i);
    definitions[i].data = i;
  }
  definitions[objects_].shape = mesh_shape_;
  definitions[objects_].state = BodyState::fixed;
  definitions[objects_].data = objects_;
  keys_.resize(objects_ + 1);
  need(scene_.add(definitions, keys_), "the bodies");
}

void GranularFlow::find_contacts(bool profiled) {
  if (keeps_poses_) {
    then_.resize(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) then_[i] = pose(i);
  }
  if (profiled) {
    const Stopwatch refreshing;
    need(scene_.refresh(), "boxes");
    last_.times.broad = refreshing.ms();
    const Stopwatch searching;
    need(scene_.collide(ContactLevel::pairs, found_pairs_), "pairs");
    last_.times.broad += searching.ms();
    // The scene keeps its pairs, so that finding them a second time costs almost nothing.
    const StageClock mid_phase(WorkStage::mid_phase);
    const Stopwatch colliding;
    need(scene_.collide(ContactLevel::manifold, contacts_), "contacts");
    last_.times.mid = mid_phase.ms();
    last_.times.narrow = colliding.ms() - last_.times.mid;
    return;
  }
  const Stopwatch colliding;
  need(scene_.collide(ContactLevel::manifold, contacts_), "contacts");
  last_.times.narrow = colliding.ms();
}

void GranularFlow::step(bool profiled) {
  last_ = {};
  last_.times.profiled = profiled;
  find_contacts(profiled);

  const Stopwatch solving;
  const ContactSums sums =
      apply_contacts(contacts_, options_.law, bodies_, options_.execution, pair_forces_);
  last_.energy =
      integrate(bodies_, options_.gravity, options_.step, options_.execution, energy_parts_);
  last_.energy.elastic = sums.elastic;
  last_.deepest = sums.deepest;
  last_.fed = fed_;
  for (std::size_t i = 0; i < objects_; ++i) {
    const Vec3d& at = bodies_[i].position;
    const double aside = std::max(std::abs(at.x()), std::abs(at.y()));
    if (at.z() < floor_ || aside > 3.0 * funnel_.radius) put_back(i);
  }
  last_.times.solver = solving.ms();

  const Stopwatch moving;
  need(scene_.move(std::span(keys_).first(objects_), poses_of(bodies_, objects_)), "poses");
  last_.times.move = moving.ms();
  ++steps_;
  last_.time = options_.step * static_cast<double>(steps_);
  last_.contacts = contacts_.size();
  last_.points = contacts_.points();
}

double GranularFlow::energy_of(std::size_t i) const noexcept {
  const FlowBody& body = bodies_[i];
  const double mass = 1.0 / body.inverse_mass;
  // The energy that `integrate` will count, with half of the next step's gravity.
  Vec3d velocity = body.velocity;
  velocity.z() -= 0.5 * options_.gravity * options_.step;
  return 0.5 * mass * velocity.squared_norm() + 0.5 * body.spin.dot(body.momentum) +
         mass * options_.gravity * body.position.z();
}

void GranularFlow::put_back(std::size_t i) {
  const double before = energy_of(i);
  const std::size_t s = next_spot_++ % spots_.size();
  Spot& spot = spots_[s];
  double z = refill_;
  // If the previous body at this spot has not fallen far enough, places this body above it.
  if (spot.last < objects_ && spot.last != i && spot_of_[spot.last] == s) {
    z = std::max(z, bodies_[spot.last].position.z() + spacing_);
  }
  FlowBody& body = bodies_[i];
  body.position = {spot.x, spot.y, z};
  body.velocity = body.momentum = body.spin = {};
  spot.last = i;
  spot_of_[i] = s;
  fed_ += energy_of(i) - before;
  ++returned_;
}

std::uint64_t GranularFlow::fingerprint() const noexcept {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < objects_; ++i) {
    std::uint64_t body = i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      body = mix(body, bodies_[i].position[axis]);
      body = mix(body, bodies_[i].velocity[axis]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      body = mix(body ^ std::bit_cast<std::uint32_t>(bodies_[i].orientation[k]));
    }
    sum += body;
  }
  return sum;
}

}  // namespace winnow::bench
