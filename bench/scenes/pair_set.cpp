// Draws the seeded random pairs that narrow-phase races and accuracy measurements use. Poses are
// drawn until, by winnow's overlap test, every second pair overlaps; random_shapes.cpp draws the
// shapes.

#include "bench/scenes/pair_set.h"

#include "bench/common/exact_math.h"
#include "bench/common/need.h"
#include "bench/scenes/random_shapes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace winnow::bench {
namespace {

/// Number of different hulls of a set: these stay in the cache; with scattered bodies, more.
constexpr std::uint32_t kHulls = 32;
constexpr std::uint32_t kScatteredHulls = 256;
/// If the centre of one sphere is uniform in the ball around the centre of another whose radius is
/// this multiple of the sum of their radii, the two spheres overlap in half of all cases.
constexpr double kReach = 1.25;
/// Limit on the placements of one pair; few pairs need more than 200.
constexpr int kAttempts = 10'000;
/// In radii of the smaller body: the least gap or depth in half of the pairs if `nearest` is set.
constexpr double kNearAtAll = 0.05;
/// Edge of the cube that contains the positions of bodies a.
constexpr double kWorld = 10.0;
/// Accuracy of the bisection for the touching position, relative to the smaller body.
constexpr double kTouching = 1e-12;
/// Positions are rounded to multiples of this if an offset is added.
constexpr double kGrid = 0x1p-12;

/// Draws the pairs of a set.
class PairDrawing {
 public:
  PairDrawing(PairSet& set, const PairSetOptions& options)
      : set_(set), options_(options), random_(options.seed) {}

  void draw() {
    draw_bodies();
    for (const BodyPair& pair : set_.pairs) place(pair);
    if (options_.nearest > 0.0) {
      place_near_contact();
    } else {
      draw_until_half_overlap();
    }
    const Vec3d offset = Vec3d::constant(options_.offset.value_or(0.0));
    for (Pose& pose : set_.poses) pose.position += offset;
  }

 private:
  /// Places pairs again until every second one overlaps.
  void draw_until_half_overlap() {
    std::vector<std::uint32_t> open(set_.pairs.size());
    std::iota(open.begin(), open.end(), 0U);
    for (int attempt = 0;; ++attempt) {
      const std::vector<std::uint8_t> overlap = overlaps(open);
      std::size_t left = 0;
      for (std::size_t k = 0; k < open.size(); ++k) {
        if (overlap[k] != (open[k] & 1U)) open[left++] = open[k];
      }
      open.resize(left);
      if (open.empty()) return;
      if (attempt == kAttempts) throw std::runtime_error("no pairs are as they should be");
      for (const std::uint32_t i : open) place(set_.pairs[i]);
    }
  }

  void draw_bodies() {
    const std::size_t bodies = 2 * options_.pairs;
    std::vector<std::uint32_t> row(bodies);
    std::iota(row.begin(), row.end(), 0U);
    if (options_.scattered) random_.shuffle(row);
    for (std::size_t i = 0; i < options_.pairs; ++i)
      set_.pairs.push_back({row[2 * i], row[2 * i + 1]});
    std::vector<std::uint8_t> is_b(bodies);
    for (const BodyPair& pair : set_.pairs) is_b[pair.b] = 1;
    const std::uint32_t hulls = options_.scattered ? kScatteredHulls : kHulls;
    ShapeStyle style{.kind = set_.kind.a,
                     .hull_vertices = set_.kind.hull_vertices,
                     .hulls = hulls,
                     .thinness = options_.thinness,
                     .upright = options_.upright,
                     .lenses = &set_.lenses};
    ShapeSource a(set_.pool, style, random_);
    style.kind = set_.kind.b;
    style.scale = options_.ratio;
    ShapeSource b(set_.pool, style, random_);
    set_.poses.resize(bodies);
    for (std::size_t i = 0; i < bodies; ++i) {
      const DrawnShape drawn = is_b[i] != 0 ? b.draw() : a.draw();
      set_.shapes.push_back(drawn.id);
      set_.radius.push_back(drawn.radius);
    }
  }

  void place(const BodyPair& pair) {
    Pose& a = set_.poses[pair.a];
    Pose& b = set_.poses[pair.b];
    turn(a);
    if (options_.angle) {
      turn_from(random_, a, *options_.angle, b);
    } else {
      turn(b);
    }
    const double reach = kReach * (set_.radius[pair.a] + set_.radius[pair.b]);
    const Vec3d offset = random_in_ball(random_, reach);
    a.position = on_grid(random_.in_cube(-0.5 * kWorld, 0.5 * kWorld));
    b.position = on_grid(a.position + offset);
  }

  void turn(Pose& pose) {
    options_.upright ? turn_upright(random_, pose) : turn_at_random(random_, pose);
  }

  [[nodiscard]] Vec3d on_grid(Vec3d point) const {
    if (!options_.offset) return point;
    for (double& x : point) x = kGrid * std::nearbyint(x / kGrid);
    return point;
  }

  /// Returns whether each of these pairs overlaps, by winnow's test.
  std::vector<std::uint8_t> overlaps(const std::vector<std::uint32_t>& which) {
    std::vector<BodyPair> pairs;
    for (const std::uint32_t i : which) pairs.push_back(set_.pairs[i]);
    const NarrowOptions boolean{.level = ContactLevel::boolean};
    need(narrow_.collide(set_.pool, set_.bodies(), pairs, boolean, result_), "pairs");
    std::vector<std::uint8_t> overlap(which.size());
    for (std::size_t i = 0; i < result_.size(); ++i) {
      overlap[result_.pair_of(i)] = result_.overlaps(i) ? 1 : 0;
    }
    return overlap;
  }

  /// A line through the position of a along which b is placed; the shapes touch between the
  /// distances `inside` and `outside`.
  struct Line {
    Vec3d along;
    double inside;
    double outside;
    [[nodiscard]] double middle() const { return 0.5 * (inside + outside); }
  };

  /// Finds the touching position on each line by bisection, all pairs at once, and places the
  /// bodies near it.
  void place_near_contact() {
    std::vector<std::uint32_t> which(set_.pairs.size());
    std::iota(which.begin(), which.end(), 0U);
    std::vector<Line> lines;
    double ratio = 1.0;
    for (const std::uint32_t i : which) {
      const BodyPair& pair = set_.pairs[i];
      const double reach = kReach * (set_.radius[pair.a] + set_.radius[pair.b]);
      lines.push_back({random_unit(random_), 0.0, reach});
      ratio = std::max(ratio, reach / small_radius(pair));
    }
    for (double width = ratio; width > kTouching; width *= 0.5) {
      for (std::size_t k = 0; k < which.size(); ++k)
        place_on_line(which[k], lines[k], lines[k].middle());
      const std::vector<std::uint8_t> overlap = overlaps(which);
      for (std::size_t k = 0; k < which.size(); ++k) {
        Line& line = lines[k];
        (overlap[k] != 0 ? line.inside : line.outside) = line.middle();
      }
    }
    for (std::size_t k = 0; k < which.size(); ++k) {
      const BodyPair& pair = set_.pairs[which[k]];
      const double small = small_radius(pair);
      const double least = 2 * k < which.size() ? kNearAtAll : options_.nearest;
      const double by = small * least * power(1.0 / least, random_.unit());
      place_on_line(which[k], lines[k], lines[k].outside + ((k & 1U) != 0 ? -by : by));
    }
  }

  [[nodiscard]] double small_radius(const BodyPair& pair) const {
    return std::min(set_.radius[pair.a], set_.radius[pair.b]);
  }

  void place_on_line(std::uint32_t i, const Line& line, double distance) {
    const BodyPair& pair = set_.pairs[i];
    set_.poses[pair.b].position = on_grid(set_.poses[pair.a].position + distance * line.along);
  }

  PairSet& set_;
  const PairSetOptions& options_;
  Random random_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

}  // namespace

std::unique_ptr<PairSet> make_pair_set(const PairKind& kind, const PairSetOptions& options) {
  auto set = std::make_unique<PairSet>();
  set->kind = kind;
  PairDrawing(*set, options).draw();
  return set;
}

}  // namespace winnow::bench
