// Pairs of bodies of every kind: contacts, times of impact and casts, with inputs that are
// numerically hard.

#include "tests/digests/digest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

namespace winnow::test {
namespace {

enum class Style { ordinary, lattice, degenerate, parallel, unequal, scaled };
constexpr const char* kStyles[] = {"ordinary", "lattice", "degenerate",
                                   "parallel", "unequal", "scaled"};

constexpr ShapeKind kKinds[] = {
    ShapeKind::sphere,          ShapeKind::capsule,    ShapeKind::box,
    ShapeKind::cylinder,        ShapeKind::cone,       ShapeKind::hull,
    ShapeKind::triangle,        ShapeKind::half_space, ShapeKind::ellipsoid,
    ShapeKind::tapered_capsule, ShapeKind::support};

/// Support function of a box with this half diagonal.
void corner_of(const void* context, const double direction[3], double point[3]) {
  const auto& half = *static_cast<const double(*)[3]>(context);
  for (int k = 0; k < 3; ++k) point[k] = direction[k] < 0.0 ? -half[k] : half[k];
}
constexpr double kCorner[3] = {0.5, 0.25, 0.75};

/// Draws bodies of one style.
class Bodies {
 public:
  Bodies(Style style, std::uint64_t seed) : style_(style), numbers_(seed) {}

  void add_pair(ShapeKind a, ShapeKind b, Digest& digest) {
    unit_ = style_ == Style::scaled ? std::ldexp(1.0, static_cast<int>(numbers_.below(200)) - 100)
                                    : 1.0;
    const double unit_of_pair = unit_;
    for (const ShapeKind kind : {a, b}) {
      if (style_ == Style::unequal) {
        unit_ = std::ldexp(unit_of_pair, -static_cast<int>(numbers_.below(14)));
      }
      ShapeId id;
      digest.add(static_cast<std::uint64_t>(add(kind, id)));
      shapes.push_back(id);
    }
    unit_ = unit_of_pair;
    const Pose first = pose();
    poses.push_back(first);
    poses.push_back(pose());
    if (style_ == Style::parallel) turn_alike(first, poses.back());
    const auto count = static_cast<std::uint32_t>(shapes.size());
    pairs.push_back({count - 2, count - 1});
  }

  Pose pose() {
    Pose pose = numbers_.pose(numbers_.below(2) == 0 ? 2 : 4);
    if (style_ == Style::lattice) {
      for (double& x : pose.position) x = half_steps(-3, 3);
      turn_by_quarters(pose);
    }
    for (double& x : pose.position) x *= unit_;
    return pose;
  }

  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;

 private:
  double half_steps(int least, int most) {
    const auto count = static_cast<std::size_t>(most - least + 1);
    return 0.5 * (static_cast<double>(numbers_.below(count)) + least);
  }

  double length() {
    if (style_ == Style::lattice) return half_steps(0, 3);
    const double length = 1.25 + numbers_.coordinate(1);
    if (style_ != Style::degenerate) return unit_ * length;
    const std::size_t chance = numbers_.below(4);
    return chance == 0 ? 0.0 : chance == 1 ? 0x1p-24 * length : length;
  }

  double rounding() { return numbers_.below(3) == 0 ? 0.25 * length() : 0.0; }

  double coordinate() {
    return style_ == Style::lattice ? half_steps(-3, 3) : unit_ * numbers_.coordinate(2);
  }

  /// Sets an orientation with one, two or four components of equal magnitude: quarter turns.
  void turn_by_quarters(Pose& pose) {
    constexpr int kMasks[] = {1, 2, 4, 8, 3, 5, 9, 6, 10, 12, 15};
    const int mask = kMasks[numbers_.below(std::size(kMasks))];
    for (int k = 0; k < 4; ++k) {
      const double sign = numbers_.below(2) == 0 ? 1.0 : -1.0;
      pose.orientation[k] = (mask >> k & 1) != 0 ? sign : 0.0;
    }
  }

  /// Sets nearly the orientation of another pose, or its opposite.
  void turn_alike(const Pose& other, Pose& pose) {
    constexpr double kLittle[] = {0.0, 0x1p-50, 0x1p-40, 0x1p-30, 0x1p-20};
    const double sign = numbers_.below(2) == 0 ? 1.0 : -1.0;
    for (int k = 0; k < 4; ++k) pose.orientation[k] = sign * other.orientation[k];
    pose.orientation[numbers_.below(4)] += kLittle[numbers_.below(std::size(kLittle))];
  }

  TriangleShape triangle() {
    TriangleShape shape;
    for (auto& corner : shape.vertex) {
      for (double& x : corner) x = coordinate();
    }
    if (style_ == Style::degenerate) {
      const std::size_t from = numbers_.below(3);
      for (int k = 0; k < 3; ++k) {
        const double off = numbers_.below(2) == 0 ? 0.0 : 0x1p-30;
        shape.vertex[2][k] = shape.vertex[from][k] + off;
      }
    }
    shape.rounding = rounding();
    return shape;
  }

  /// Adds an octahedron or a block with other proportions.
  Status add_hull(ShapeId& id) {
    const auto some = [&] { return std::max(length(), 0.5 * unit_); };
    const Vec3d size{some(), some(), some()};
    std::vector<Vec3d> corners;
    std::vector<std::uint32_t> loops;
    std::vector<std::uint32_t> sizes;
    if (numbers_.below(2) == 0) {
      const double low = some();
      corners = {{size[0], 0, 0},  {-low, 0, 0},    {0, size[1], 0},
                 {0, -size[1], 0}, {0, 0, size[2]}, {0, 0, -low}};
      loops = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
      sizes.assign(8, 3);
    } else {
      for (unsigned i = 0; i < 8; ++i) {
        Vec3d& corner = corners.emplace_back();
        for (int k = 0; k < 3; ++k) corner[k] = (i >> k & 1U) != 0 ? size[k] : -size[k];
      }
      loops = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
      sizes.assign(6, 4);
    }
    return pool.add_hull(corners, {loops, sizes}, rounding()).get(id);
  }

  Status add(ShapeKind kind, ShapeId& id) {
    const double size[3] = {length(), length(), length()};
    switch (kind) {
      case ShapeKind::sphere:
        return pool.add(SphereShape{size[0]}).get(id);
      case ShapeKind::capsule:
        return pool.add(CapsuleShape{size[0], size[1]}).get(id);
      case ShapeKind::box:
        return pool.add(BoxShape{{size[0], size[1], size[2]}, rounding()}).get(id);
      case ShapeKind::cylinder:
        return pool.add(CylinderShape{size[0], size[1], rounding()}).get(id);
      case ShapeKind::cone:
        return pool.add(ConeShape{size[0], size[1], rounding()}).get(id);
      case ShapeKind::hull:
        return add_hull(id);
      case ShapeKind::triangle:
        return pool.add(triangle()).get(id);
      case ShapeKind::half_space: {
        HalfSpaceShape shape{{0.0, 0.0, 1.0}, coordinate()};
        if (style_ != Style::lattice) shape.normal[0] = numbers_.coordinate(1);
        return pool.add(shape).get(id);
      }
      case ShapeKind::ellipsoid:
        return pool.add(EllipsoidShape{{size[0], size[1], size[2]}, rounding()}).get(id);
      case ShapeKind::tapered_capsule:
        return pool.add(TaperedCapsuleShape{{size[0], size[1]}, size[2]}).get(id);
      case ShapeKind::support:
        return pool.add(SupportShape{&corner_of, &kCorner, 1.0, rounding()}).get(id);
    }
    return Status::invalid_argument;
  }

  Style style_;
  Numbers numbers_;
  double unit_ = 1.0;
};

/// Adds `each` pairs of every two kinds.
void add_all(Bodies& bodies, std::size_t each, Digest& digest) {
  for (const ShapeKind a : kKinds) {
    for (const ShapeKind b : kKinds) {
      for (std::size_t i = 0; i < each; ++i) bodies.add_pair(a, b, digest);
    }
  }
}

void add(Digest& digest, const NarrowResult& result) {
  for (std::size_t i = 0; i < result.size(); ++i) {
    digest.add(std::uint64_t{result.pair_of(i)} * 2U + (result.overlaps(i) ? 1U : 0U));
    if (result.distance().empty()) continue;
    digest.add(result.distance()[i]);
    digest.add(result.error_bound()[i]);
    for (int k = 0; k < 3; ++k) {
      digest.add(result.normal(k)[i]);
      digest.add(result.point(k)[i]);
    }
  }
  for (std::size_t i = 0; i < result.contacts(); ++i) {
    const ContactPoint point = result.contact(i);
    for (const float x : point.position) digest.add(static_cast<double>(x));
    digest.add(static_cast<double>(point.depth));
    digest.add(point.feature);
  }
}

void collide(Style style, NarrowTier tier, const Execution& execution, Digest& digest) {
  Bodies bodies(style, 11);
  add_all(bodies, 12, digest);
  NarrowPhase phase;
  NarrowResult result;
  for (const ContactLevel level :
       {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    for (const double margin : {0.0, 0.25}) {
      const Status status = phase.collide(
          bodies.pool, {bodies.shapes, bodies.poses}, bodies.pairs,
          {.level = level, .tier = tier, .contact_margin = margin, .execution = execution}, result);
      digest.add(static_cast<std::uint64_t>(status));
      add(digest, result);
      digest.add(phase.statistics());
      if (level != ContactLevel::manifold) break;
    }
  }
}

void impacts(Style style, const Execution& execution, Digest& digest) {
  Bodies bodies(style, 12);
  add_all(bodies, 6, digest);
  std::vector<RigidMotion> motions;
  for (std::size_t i = 0; i < bodies.poses.size(); ++i) {
    const Pose& start = bodies.poses[i];
    Pose end = bodies.pose();
    // One in four does not rotate, one in four does not move.
    if (i % 4 == 1) end.orientation = start.orientation;
    motions.push_back(i % 4 == 2 ? RigidMotion::stationary(start)
                                 : RigidMotion::between(start, end));
  }
  ImpactResult result;
  digest.add(static_cast<std::uint64_t>(
      time_of_impact(bodies.pool, {bodies.shapes, motions}, bodies.pairs,
                     {.tolerance = 0x1p-16, .execution = execution}, result)));
  for (std::size_t i = 0; i < result.size(); ++i) {
    digest.add(static_cast<std::uint64_t>(result.status(i)) * 2U + (result.hits(i) ? 1U : 0U));
    digest.add(result.time()[i]);
    digest.add(result.gap()[i]);
    digest.add(result.error_bound()[i]);
    for (int k = 0; k < 3; ++k) {
      digest.add(result.normal(k)[i]);
      digest.add(result.point(k)[i]);
    }
  }
}

/// Triangles and edges whose points move on a lattice with steps of this size.
void feature_impacts_of(FeaturePair kind, double steps, Digest& digest) {
  constexpr std::size_t kCount = 300;
  Numbers numbers(13);
  std::array<std::array<std::vector<double>, 3>, 8> columns;
  FeatureColumns pairs;
  pairs.count = kCount;
  for (std::size_t point = 0; point < 8; ++point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double>& column = columns[point][axis];
      for (std::size_t i = 0; i < kCount; ++i) {
        column.push_back(std::floor(numbers.coordinate(2) * steps) / steps);
      }
      (point < 4 ? pairs.start : pairs.end)[point % 4][axis] = column.data();
    }
  }
  std::vector<double> times(kCount);
  for (const double apart : {0.0, 0x1p-6}) {
    digest.add(
        static_cast<std::uint64_t>(feature_impacts(kind, pairs, times, {.min_separation = apart})));
    for (const double time : times) digest.add(time);
  }
}

void feature_impacts_of_all(const Execution&, Digest& digest) {
  for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
    for (const double steps : {1.0, 0x1p16}) feature_impacts_of(kind, steps, digest);
  }
}

}  // namespace

std::vector<Work> shape_works() {
  std::vector<Work> works;
  for (const Style style : {Style::ordinary, Style::lattice, Style::degenerate, Style::parallel,
                            Style::unequal, Style::scaled}) {
    const std::string name = kStyles[static_cast<std::size_t>(style)];
    for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
      const char* const tier_name = tier == NarrowTier::robust ? "/robust" : "/reference";
      works.push_back({"shapes/" + name + tier_name,
                       [=](const Execution& e, Digest& d) { collide(style, tier, e, d); }});
    }
    works.push_back(
        {"impacts/" + name, [=](const Execution& e, Digest& d) { impacts(style, e, d); }});
  }
  works.push_back({"impacts/features", feature_impacts_of_all});
  return works;
}

}  // namespace winnow::test
