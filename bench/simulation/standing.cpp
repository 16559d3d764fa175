// Builds structures that stand only if contacts are good (stack, card house, wheel, arch) and
// simulates them with ContactSolver. bench/rows/simulation_rows.cpp runs it.

#include "bench/simulation/standing.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/scenes/meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace winnow::bench {
namespace {

using Vec3 = Eigen::Vector3d;

constexpr int kStacked = 20;

SceneOptions scene_options(const StandingOptions& options, const CompositePool& composites) {
  return {.execution = options.execution,
          .contact_margin = 0.02,
          .part_manifolds = options.part_manifolds,
          .warm_start = true,
          .composites = &composites};
}

Pose pose_of(const RigidBody& body) {
  return {body.position, body.turn};
}

/// Returns the vertices of a prism whose cross-section is in the xz plane.
std::vector<Vec3> prism(const std::vector<Eigen::Vector2d>& section, double width) {
  std::vector<Vec3> corners;
  for (const Eigen::Vector2d& p : section) {
    corners.emplace_back(p.x(), -0.5 * width, p.y());
    corners.emplace_back(p.x(), 0.5 * width, p.y());
  }
  return corners;
}

/// Returns the centroid of a convex polygon.
Eigen::Vector2d centre_of(const std::vector<Eigen::Vector2d>& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Eigen::Vector2d u = polygon[i] - polygon[0];
    const Eigen::Vector2d v = polygon[i + 1] - polygon[0];
    const double part = u.x() * v.y() - u.y() * v.x();
    sum += part * (polygon[0] + (u + v) / 3.0);
    area += part;
  }
  return sum / area;
}

}  // namespace

const Standing::Structure Standing::kStructures[] = {{"stack", &Standing::build_box_stack},
                                                     {"hull_stack", &Standing::build_hull_stack},
                                                     {"card_house", &Standing::build_card_house},
                                                     {"wheel", &Standing::build_wheel},
                                                     {"arch", &Standing::build_arch}};

std::vector<std::string> standing_names() {
  std::vector<std::string> names;
  for (const auto& structure : Standing::kStructures) names.emplace_back(structure.name);
  return names;
}

Standing::Standing(const std::string& structure, const StandingOptions& options)
    : composites_(shapes_),
      scene_(shapes_, scene_options(options, composites_)),
      options_(options) {
  for (const auto& [name, build] : kStructures) {
    if (structure == name) (this->*build)();
  }
  mark();
}

void Standing::step() {
  need(scene_.collide(ContactLevel::manifold, contacts_), "collide");
  need(scene_.islands(contacts_, islands_), "islands");
  need(scene_.colours(contacts_, colours_), "colours");
  solver_->step(contacts_, colours_, options_.execution, options_.seconds, bodies_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].inverse_mass != 0.0) need(scene_.move(keys_[i], pose_of(bodies_[i])), "move");
  }
  time_ += options_.seconds;
}

void Standing::add(ShapeId shape, const RigidBody& body) {
  keys_.push_back(
      need(scene_.add({.shape = shape,
                       .pose = pose_of(body),
                       .state = body.inverse_mass == 0.0 ? BodyState::fixed : BodyState::dynamic,
                       .data = bodies_.size()}),
           "body"));
  bodies_.push_back(body);
}

void Standing::add_solid(ShapeId shape, const Vec3& edges, const Vec3& position,
                         double turn_about_y) {
  RigidBody body;
  body.position = position;
  body.turn = Eigen::AngleAxisd(turn_about_y, Vec3::UnitY());
  const double mass = edges.prod();
  body.inverse_mass = 1.0 / mass;
  const Vec3 squares = edges.cwiseAbs2();
  const Vec3 sums(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
  body.inverse_inertia = (12.0 / mass) * sums.cwiseInverse();
  add(shape, body);
}

void Standing::add_floor() {
  const ShapeId floor = need(shapes_.add(BoxShape{{20.0, 20.0, 1.0}}), "floor");
  RigidBody body;
  body.position.z() = -1.0;
  add(floor, body);
}

void Standing::build_stack(ShapeId box) {
  for (int i = 0; i < kStacked; ++i) add_solid(box, Vec3::Ones(), {0.0, 0.0, 0.5 + i}, 0.0);
}

void Standing::build_box_stack() {
  add_floor();
  const ShapeId box = need(shapes_.add(BoxShape{{0.5, 0.5, 0.5}}), "box");
  build_stack(box);
}

void Standing::build_hull_stack() {
  add_floor();
  const std::vector<Vec3> corners =
      prism({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, 1.0);
  const ShapeId box = need(shapes_.add_hull(std::span(corners), 0.0), "box");
  build_stack(box);
}

// Three storeys: pairs of cards that lean on each other, and cards between the tops.
void Standing::build_card_house() {
  add_floor();
  const Vec3 card(0.05, 0.6, 1.0);
  const double lean = 25.0 * std::numbers::pi / 180.0;
  const double apart = 1.0;
  const double lying = apart - 0.02;
  ShapeId leaning;
  ShapeId flat;
  leaning =
      need(shapes_.add(BoxShape{{0.5 * card.x(), 0.5 * card.y(), 0.5 * card.z()}}), "leaning");
  flat = need(shapes_.add(BoxShape{{0.5 * lying, 0.5 * card.y(), 0.5 * card.x()}}), "flat");
  const double reach = 0.5 * (card.z() * std::sin(lean) + card.x() * std::cos(lean));
  const double height = 0.5 * (card.z() * std::cos(lean) + card.x() * std::sin(lean));
  double z = 0.0;
  for (int tents = 3; tents > 0; --tents) {
    const double left = -0.5 * apart * (tents - 1);
    for (int i = 0; i < tents; ++i) {
      for (const double side : {-1.0, 1.0}) {
        add_solid(leaning, card, {left + apart * i + side * reach, 0.0, z + height}, -side * lean);
      }
    }
    z += 2.0 * height;
    for (int i = 0; i + 1 < tents; ++i) {
      add_solid(flat, {lying, card.y(), card.x()},
                {left + apart * (i + 0.5), 0.0, z + 0.5 * card.x()}, 0.0);
    }
    z += card.x();
  }
}

// A wheel that stands on its rim, away from the vertices and edges of the floor's triangles.
void Standing::build_wheel() {
  Heights flat;
  flat.cells = 16;
  flat.edge = 0.7;
  flat.height.assign((flat.cells + 1) * (flat.cells + 1), 0.0);
  const Triangles triangles = make_terrain(flat);
  const ShapeId floor = need(
      composites_.add_mesh(std::span(triangles.vertices), std::span(triangles.corners)), "floor");
  add(floor, {});
  const double radius = 0.5;
  const double half_width = 0.2;
  const ShapeId wheel = need(shapes_.add(CylinderShape{radius, half_width}), "wheel");
  RigidBody body;
  body.position = {5.13, 5.37, radius};
  body.turn = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX());
  const double mass = std::numbers::pi * radius * radius * 2.0 * half_width;
  const double across = mass * (radius * radius / 4.0 + half_width * half_width / 3.0);
  body.inverse_mass = 1.0 / mass;
  body.inverse_inertia = {1.0 / across, 1.0 / across, 2.0 / (mass * radius * radius)};
  add(wheel, body);
}

// A semicircle of wedges.
void Standing::build_arch() {
  add_floor();
  constexpr int kWedges = 11;
  const double radii[2] = {4.0, 5.2};
  const double width = 1.2;
  for (int i = 0; i < kWedges; ++i) {
    const double turns[2] = {std::numbers::pi * i / kWedges, std::numbers::pi * (i + 1) / kWedges};
    std::vector<Eigen::Vector2d> section;
    for (const auto& [turn, radius] :
         {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, 0)}) {
      section.emplace_back(radii[radius] * std::cos(turns[turn]),
                           radii[radius] * std::sin(turns[turn]));
    }
    const Eigen::Vector2d centre = centre_of(section);
    for (Eigen::Vector2d& corner : section) corner -= centre;
    const std::vector<Vec3> corners = prism(section, width);
    const ShapeId wedge = need(shapes_.add_hull(std::span(corners), 0.0), "wedge");
    const double edge =
        std::sqrt(std::numbers::pi / kWedges * (radii[0] + radii[1]) / 2.0 * (radii[1] - radii[0]));
    add_solid(wedge, {edge, width, edge}, {centre.x(), 0.0, centre.y()}, 0.0);
  }
}

void Standing::mark() {
  marked_ = bodies_;
}

double Standing::drift() const {
  double most = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    most = std::max(most, (bodies_[i].position - marked_[i].position).norm());
  }
  return most;
}

double Standing::tilt() const {
  double most = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    most = std::max(most, bodies_[i].turn.angularDistance(marked_[i].turn));
  }
  return most;
}

double Standing::deepest() const {
  double deepest = 0.0;
  for (const double distance : contacts_.distance()) deepest = std::max(deepest, -distance);
  return deepest;
}

double Standing::kept_points() const {
  const auto before = contacts_.previous_point();
  const auto kept = std::count_if(before.begin(), before.end(),
                                  [](std::uint32_t point) { return point != kNoContact; });
  return before.empty() ? 1.0 : static_cast<double>(kept) / static_cast<double>(before.size());
}

std::uint64_t Standing::fingerprint() const {
  std::uint64_t sum = 0;
  for (const RigidBody& body : bodies_) {
    for (const double x : body.position) sum = mix(sum, x);
    for (const double x : body.turn.coeffs()) sum = mix(sum, x);
  }
  return sum;
}

}  // namespace winnow::bench
