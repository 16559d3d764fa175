// The built-in scenes: each is a function that draws bodies and one that moves them by a frame. The
// table at the end lists them.

#include "bench/scenes/scene.h"

#include <winnow/core/vectors.h>
#include "bench/common/errors.h"
#include "bench/common/exact_math.h"
#include "bench/common/random.h"
#include "bench/common/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

namespace winnow::bench {
namespace {

/// A moving cube.
struct Body {
  Vec3d centre;
  Vec3d velocity;     ///< per frame
  double half = 0.5;  ///< half an edge
};

/// Bounds of the bodies' centres; a body that reaches a wall is reflected.
struct Walls {
  Vec3d low;
  Vec3d high;

  [[nodiscard]] static Walls cube(double side) noexcept { return {{}, Vec3d::constant(side)}; }
};

/// Bodies between walls.
struct Bodies {
  Walls walls;
  std::vector<Body> all;
  Random random;                 ///< for values drawn in each frame
  std::optional<Aabb> ground{};  ///< replaces the box of the first body
  std::size_t present;           ///< number of bodies that are in the scene already

  Bodies(const Walls& between, std::vector<Body> bodies, std::uint64_t seed)
      : walls(between), all(std::move(bodies)), random(mix(seed)), present(all.size()) {}
};

/// Bodies, and the function that moves them by one frame.
struct MovingBodies {
  Bodies bodies;
  std::function<void(Bodies&)> move;
};

/// The boxes of moving bodies; they move forever.
class BodyScene final : public FrameSource {
 public:
  BodyScene(std::string name, MovingBodies moving)
      : name_(std::move(name)), moving_(std::move(moving)), boxes_(moving_.bodies.all.size()) {
    const Bodies& bodies = moving_.bodies;
    double half = 0.0;
    for (const Body& body : bodies.all) half = std::max(half, body.half);
    // A little larger than the boxes, so that it contains all of them after rounding to float.
    const Vec3d around = Vec3d::constant(half * 1.000001);
    world_ = Aabb::outward(bodies.walls.low - around, bodies.walls.high + around);
    if (bodies.ground) world_.merge(*bodies.ground);
    place();
  }

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Aabb world() const override { return world_; }
  [[nodiscard]] std::span<const Aabb> boxes() const override {
    return std::span(boxes_).first(moving_.bodies.present);
  }
  [[nodiscard]] std::size_t objects() const override { return boxes_.size(); }
  bool advance() override {
    moving_.move(moving_.bodies);
    place();
    return true;
  }

 private:
  void place() noexcept {
    const Bodies& bodies = moving_.bodies;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const Vec3d half = Vec3d::constant(bodies.all[i].half);
      boxes_[i] = {(bodies.all[i].centre - half).cast<float>(),
                   (bodies.all[i].centre + half).cast<float>()};
    }
    if (bodies.ground) boxes_[0] = *bodies.ground;
  }

  std::string name_;
  MovingBodies moving_;
  std::vector<Aabb> boxes_;
  Aabb world_;
};

/// Draws a uniform velocity of at most 5 % of the edge along each axis.
Vec3d draw_velocity(Random& random, double edge) noexcept {
  return edge * random.in_cube(-0.05, 0.05);
}

/// Draws a uniform point between the walls.
Vec3d draw_point(Random& random, const Walls& walls) noexcept {
  return random.in(walls.low, walls.high);
}

/// Moves a body in a straight line for one frame, with reflections at the walls.
void drift(Body& body, const Walls& walls) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = walls.low[axis];
    const double high = walls.high[axis];
    double c = body.centre[axis] + body.velocity[axis];
    if (c < low || c > high) {
      c = c < low ? low + (low - c) : high - (c - high);
      body.velocity[axis] = -body.velocity[axis];
    }
    // If the walls are closer together than one step, a reflection can leave the centre outside.
    body.centre[axis] = std::clamp(c, low, high);
  }
}

// Bodies at the start.

Bodies unit_cubes(std::size_t objects, std::uint64_t seed, const Walls& walls) {
  Random random(seed);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    body.centre = draw_point(random, walls);
    body.velocity = draw_velocity(random, 1.0);
  }
  return {walls, std::move(bodies), seed};
}

/// Returns walls around a cube whose volume is twice the volume of that many unit cubes.
Walls uniform_walls(std::size_t objects) {
  return Walls::cube(cube_root(2.0 * static_cast<double>(objects)));
}

Bodies uniform(std::size_t objects, std::uint64_t seed) {
  return unit_cubes(objects, seed, uniform_walls(objects));
}

/// Distribution of cubes with log-uniform edges.
struct Sizes {
  double smallest;
  double ratio;   ///< largest edge / smallest edge
  double volume;  ///< volume of the world per object
};

Bodies log_uniform(const Sizes& sizes, std::size_t objects, std::uint64_t seed) {
  const Walls walls = Walls::cube(cube_root(sizes.volume * static_cast<double>(objects)));
  Random random(seed);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    const double edge = sizes.smallest * power(sizes.ratio, random.unit());
    body.half = 0.5 * edge;
    body.centre = draw_point(random, walls);
    body.velocity = draw_velocity(random, edge);
  }
  return {walls, std::move(bodies), seed};
}

// Two cubes with edges a and b overlap with probability (a + b)^3 / (volume of the world). There
// are thus ten pairs per object if the volume per object is a twentieth of the mean of (a + b)^3.
Bodies mixed(std::size_t objects, std::uint64_t seed) {
  return log_uniform({0.1, 100.0, 14.2}, objects, seed);
}

Bodies mixed_1000(std::size_t objects, std::uint64_t seed) {
  return log_uniform({0.01, 1000.0, 8.0}, objects, seed);
}

Bodies clustered(std::size_t objects, std::uint64_t seed) {
  constexpr std::size_t kClusterSize = 500;
  constexpr double kDeviation = 3.5;
  const Walls walls = Walls::cube(2.0 * cube_root(2.0 * static_cast<double>(objects)));
  Random random(seed);
  std::vector<Vec3d> centres(std::max<std::size_t>(1, objects / kClusterSize));
  for (Vec3d& centre : centres) centre = draw_point(random, walls);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    const Vec3d& centre = centres[random.below(static_cast<std::uint32_t>(centres.size()))];
    const Vec3d offset{random.normal(), random.normal(), random.normal()};
    body.centre = (centre + kDeviation * offset).max(walls.low).min(walls.high);
    body.velocity = draw_velocity(random, 1.0);
  }
  return {walls, std::move(bodies), seed};
}

Bodies wall(std::size_t objects, std::uint64_t seed) {
  const double side = std::sqrt(2.0 * static_cast<double>(objects));
  return unit_cubes(objects, seed, {{-0.25, 0.0, 0.0}, {0.25, side, side}});
}

// Functions that move all bodies in straight lines, or by other steps.

void fly(Bodies& bodies) {
  for (std::size_t i = 0; i < bodies.present; ++i) drift(bodies.all[i], bodies.walls);
}

void step_at_random(Bodies& bodies) {
  for (Body& body : bodies.all) body.velocity = draw_velocity(bodies.random, 2.0 * body.half);
  fly(bodies);
}

/// Draws a step in a uniform direction by rejection sampling in the unit ball.
Vec3d draw_step(Random& random, double length) {
  for (;;) {
    const Vec3d step = random.in_cube(-1.0, 1.0);
    const double square = step.squared_norm();
    if (square > 1.0 || square < 1e-6) continue;
    return step * (length / std::sqrt(square));
  }
}

void jump(Bodies& bodies) {
  for (Body& body : bodies.all) body.velocity = draw_step(bodies.random, 4.0 * body.half);
  fly(bodies);
}

void teleport(Bodies& bodies) {
  for (Body& body : bodies.all) body.centre = draw_point(bodies.random, bodies.walls);
}

/// Bodies flow along x at a speed that grows with y, and re-enter on the opposite side.
void shear(Bodies& bodies) {
  // Relative speed, in edges per frame, of bodies one edge apart in y: twice the fastest of
  // `uniform`.
  constexpr double kRate = 0.2;
  const Walls& walls = bodies.walls;
  for (Body& body : bodies.all) {
    body.centre.x() += kRate * (body.centre.y() - walls.low.y());
    while (body.centre.x() > walls.high.x()) body.centre.x() -= walls.high.x() - walls.low.x();
  }
}

using Rows = std::vector<std::uint32_t>;

Rows rows_of(const Bodies& bodies) {
  Rows rows(bodies.all.size());
  std::iota(rows.begin(), rows.end(), 0U);
  return rows;
}

// Scenes whose motion needs data of its own.

/// A random twentieth of the bodies moves in each frame.
MovingBodies sleepy(std::size_t objects, std::uint64_t seed) {
  Bodies start = uniform(objects, seed);
  return {start, [order = rows_of(start)](Bodies& bodies) mutable {
            const std::size_t count = std::max<std::size_t>(1, order.size() / 20);
            bodies.random.draw_front(order, count);
            for (const std::uint32_t i : std::span(order).first(count)) {
              drift(bodies.all[i], bodies.walls);
            }
          }};
}

/// All bodies move in straight lines, except a tenth of them, a different one in each frame, which
/// get new positions.
MovingBodies respawn(std::size_t objects, std::uint64_t seed) {
  Bodies start = uniform(objects, seed);
  Rows order = rows_of(start);
  start.random.shuffle(order);
  return {std::move(start),
          [order = std::move(order), next = std::size_t{0}](Bodies& bodies) mutable {
            fly(bodies);
            for (std::size_t k = 0; k < std::max<std::size_t>(1, order.size() / 10); ++k) {
              bodies.all[order[next]].centre = draw_point(bodies.random, bodies.walls);
              next = (next + 1) % order.size();
            }
          }};
}

/// Seven bodies (all, if there are fewer) move in every frame; the others never move.
MovingBodies few_movers(std::size_t objects, std::uint64_t seed) {
  Bodies start = uniform(objects, seed);
  Rows movers;
  while (movers.size() < std::min<std::size_t>(7, objects)) {
    const std::uint32_t one = start.random.below(static_cast<std::uint32_t>(objects));
    if (std::ranges::find(movers, one) == movers.end()) movers.push_back(one);
  }
  return {std::move(start), [movers = std::move(movers)](Bodies& bodies) {
            for (const std::uint32_t i : movers) drift(bodies.all[i], bodies.walls);
          }};
}

// Bodies jitter about positions on a lattice whose step does not divide the edge. Along each axis
// two cubes therefore overlap or are separate by at least half a step, which is fifty times the
// jitter, so that no pair begins or ends.
MovingBodies jitter(std::size_t objects, std::uint64_t seed) {
  constexpr double kStep = 2.0 / 2001.0;
  constexpr double kJitter = 1e-5;
  Bodies start = uniform(objects, seed);
  std::vector<Vec3d> rest_positions;
  for (Body& body : start.all) {
    for (int axis = 0; axis < 3; ++axis) {
      body.centre[axis] = kStep * std::floor(body.centre[axis] / kStep);
    }
    rest_positions.push_back(body.centre);
  }
  start.walls.low -= Vec3d::constant(kStep);  // room for the jitter
  return {std::move(start), [rest_positions = std::move(rest_positions)](Bodies& bodies) {
            for (std::size_t i = 0; i < rest_positions.size(); ++i) {
              if (i % 100 == 99) continue;
              bodies.all[i].centre = rest_positions[i] + bodies.random.in_cube(-kJitter, kJitter);
            }
          }};
}

/// Starts with a thousandth of the objects, whose number grows by the same factor in each frame
/// until all are present.
MovingBodies growth(std::size_t objects, std::uint64_t seed) {
  constexpr std::size_t kFrames = 60;  // until all bodies are added
  Bodies start = uniform(objects, seed);
  const std::size_t first = std::max<std::size_t>(1, objects / 1000);
  start.present = first;
  const double times = static_cast<double>(objects) / static_cast<double>(first);
  return {std::move(start), [=, frame = std::size_t{0}](Bodies& bodies) mutable {
            fly(bodies);
            const double share = static_cast<double>(++frame) / static_cast<double>(kFrames);
            bodies.present =
                frame >= kFrames
                    ? objects
                    : std::min(objects, static_cast<std::size_t>(static_cast<double>(first) *
                                                                 power(times, share)));
          }};
}

/// Unit cubes that jitter about the points of a lattice, on a ground box (row 0) that does not
/// move.
MovingBodies pile(std::size_t objects, std::uint64_t seed) {
  constexpr double kJitter = 0.25;
  constexpr std::size_t kLayers = 4;
  const double area = static_cast<double>(objects) / kLayers;
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(std::max(1.0, area))));
  const auto side = static_cast<double>(across);
  Random random(seed);
  std::vector<Body> bodies(objects);
  std::vector<Walls> around(objects);
  for (std::size_t i = 1; i < objects; ++i) {
    const std::size_t cell = (i - 1) / kLayers;
    const Vec3d resting(static_cast<double>(cell % across), static_cast<double>(cell / across),
                        0.5 + static_cast<double>((i - 1) % kLayers));
    around[i] = {resting - Vec3d::constant(kJitter), resting + Vec3d::constant(kJitter)};
    bodies[i].centre = resting + random.in_cube(-kJitter, kJitter);
    bodies[i].velocity = draw_velocity(random, 1.0);
  }
  Bodies start({{-kJitter, -kJitter, 0.0}, {side, side, kLayers}}, std::move(bodies), seed);
  // The undersides of the lowest cubes are within the jitter of z = 0; the ground's top at kJitter
  // touches each of them.
  const auto edge = static_cast<float>(side + 1.0);
  start.ground = Aabb{{-1.0F, -1.0F, -1.0F}, {edge, edge, static_cast<float>(kJitter)}};
  return {std::move(start), [around = std::move(around)](Bodies& moving) {
            for (std::size_t i = 1; i < around.size(); ++i) drift(moving.all[i], around[i]);
          }};
}

/// A path from `end` + `length` * `direction` to `end`.
struct Path {
  Vec3d end;
  Vec3d direction;
  double length = 0.0;
  double speed = 0.0;

  [[nodiscard]] Vec3d place() const { return end + length * direction; }
  /// Falls for a frame, bounces at the end and comes to rest there.
  void fall() {
    constexpr double kGravity = 0.01;  // per frame squared
    constexpr double kRestitution = 0.5;
    if (length == 0.0 && speed == 0.0) return;
    speed += kGravity;
    length -= speed;
    if (length > 0.0) return;
    length = 0.0;
    speed *= -kRestitution;
    if (speed > -2.0 * kGravity) speed = 0.0;
  }
};

/// Returns unit cubes that fall along paths; `path_from` returns the path from a point.
template <typename PathFrom>
MovingBodies falling(std::size_t objects, std::uint64_t seed, PathFrom&& path_from) {
  const Walls walls = uniform_walls(objects);
  Random random(seed);
  std::vector<Body> bodies(objects);
  std::vector<Path> paths;
  for (Body& body : bodies) {
    body.centre = paths.emplace_back(path_from(draw_point(random, walls), walls.high.x())).place();
  }
  return {{walls, std::move(bodies), seed}, [paths = std::move(paths)](Bodies& moving) mutable {
            for (std::size_t i = 0; i < paths.size(); ++i) {
              paths[i].fall();
              moving.all[i].centre = paths[i].place();
            }
          }};
}

MovingBodies free_fall(std::size_t objects, std::uint64_t seed) {
  // At rest the heap is a quarter as high as at the start, and four times as dense.
  return falling(objects, seed, [](const Vec3d& start, double) {
    return Path{{start.x(), start.y(), 0.25 * start.z()}, {0.0, 0.0, 1.0}, 0.75 * start.z()};
  });
}

MovingBodies gravity(std::size_t objects, std::uint64_t seed) {
  constexpr double kShrink = 0.63;  // its cube is a quarter
  return falling(objects, seed, [](const Vec3d& start, double side) {
    const Vec3d middle = Vec3d::constant(0.5 * side);
    const Vec3d out = start - middle;
    const double distance = out.norm();
    return Path{middle + kShrink * out, distance > 0.0 ? out / distance : Vec3d(),
                (1.0 - kShrink) * distance};
  });
}

/// Returns a scene whose motion is one function of its bodies.
template <auto Start, auto Move>
MovingBodies moved(std::size_t objects, std::uint64_t seed) {
  return {Start(objects, seed), Move};
}

struct BuiltInScene {
  SceneInfo info;
  MovingBodies (*make)(std::size_t objects, std::uint64_t seed);
};

constexpr std::array<BuiltInScene, 18> kScenes{{
    {{"uniform", "unit cubes spread evenly over a cube of side cbrt(2N), all in straight flight"},
     moved<uniform, fly>},
    {{"sleepy", "as uniform, but in each frame only another random 5 % of the objects move"},
     sleepy},
    {{"mixed", "cubes with edges log-uniform from 0.1 to 10 in a cube of volume 14.2 N"},
     moved<mixed, fly>},
    {{"clustered", "N/500 Gaussian clusters (deviation 3.5) of unit cubes, side 2 cbrt(2N)"},
     moved<clustered, fly>},
    {{"pile", "four layers of unit cubes that shiver and overlap, on one ground box (row 0)"},
     pile},
    {{"wall", "unit cubes of which all overlap on x; y and z spread over a side of sqrt(2N)"},
     moved<wall, fly>},
    {{"brownian", "as uniform, but every object takes a new random step in every frame"},
     moved<uniform, step_at_random>},
    {{"free_fall", "unit cubes fall, bounce and come to rest in a heap a quarter as high"},
     free_fall},
    {{"gravity", "unit cubes fall to the centre of the world, bounce and come to rest there"},
     gravity},
    {{"mixed_1000", "cubes with edges log-uniform from 0.01 to 10 in a cube of volume 8 N"},
     moved<mixed_1000, fly>},
    {{"teleport", "as uniform, but in each frame every object is somewhere else"},
     moved<uniform, teleport>},
    {{"teleport_mixed", "as mixed, but in each frame every object is somewhere else"},
     moved<mixed, teleport>},
    {{"respawn", "as uniform, but in each frame another tenth of the objects is somewhere else"},
     respawn},
    {{"shear", "as uniform, but objects go along x, by a fifth of their y, and round the world"},
     moved<uniform, shear>},
    {{"jumps", "as uniform, but in each frame every object jumps by two edges, anywhere"},
     moved<uniform, jump>},
    {{"few_movers", "as uniform, but only seven objects move, however many there are"}, few_movers},
    {{"jitter",
      "as uniform, but 99 of 100 jitter by 1e-5 about fixed positions, and no pair changes"},
     jitter},
    {{"growth", "as uniform, but it begins with N/1000 objects, and has all after 60 frames"},
     growth},
}};

const BuiltInScene* find_scene(std::string_view name) {
  const auto* const at =
      std::ranges::find(kScenes, name, [](const BuiltInScene& one) { return one.info.name; });
  return at == kScenes.end() ? nullptr : at;
}

}  // namespace

std::vector<SceneInfo> scene_infos() {
  std::vector<SceneInfo> infos;
  for (const BuiltInScene& scene : kScenes) infos.push_back(scene.info);
  return infos;
}

std::unique_ptr<FrameSource> make_scene(std::string_view name, std::size_t objects,
                                        std::uint64_t seed) {
  const BuiltInScene* const scene = find_scene(name);
  if (scene == nullptr) return nullptr;
  return std::make_unique<BodyScene>(std::string(name), scene->make(objects, seed));
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const BuiltInScene& scene : kScenes) names.emplace_back(scene.info.name);
  return names;
}

std::vector<std::string> main_scenes() {
  std::vector<std::string> names = scene_names();
  names.resize(kMainScenes);
  return names;
}

bool is_built_in(const std::string& name) {
  return find_scene(name) != nullptr;
}

std::unique_ptr<FrameSource> scene_or_error(const std::string& name, std::size_t objects,
                                            std::uint64_t seed) {
  auto scene = make_scene(name, objects, seed);
  if (!scene)
    throw ArgumentError("there is no scene " + name + "; there are " + listed(scene_names()));
  return scene;
}

}  // namespace winnow::bench
