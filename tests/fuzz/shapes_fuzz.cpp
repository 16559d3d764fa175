// Convex shapes, including hulls of hostile points and faces: bad ones are refused and change
// nothing, and both tiers agree on good ones within their error bounds, in either order.

#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Workshop {
 public:
  explicit Workshop(Bytes& bytes) {
    constexpr double kSizes[] = {1.0, 1.0, 1.0, 1e-3, 1e3, 1e-8, 1e8};
    size_ = kSizes[bytes.below(std::size(kSizes))];
  }
  void add(Bytes& bytes);
  void check_pairs(Bytes& bytes);
  void check_rays(Bytes& bytes) const;

 private:
  /// Returns mostly a valid length.
  double length(Bytes& bytes) const {
    return bytes.chance(32) ? bytes.any<double>() : size_ * bytes.extent();
  }
  double coordinate(Bytes& bytes) const {
    return bytes.chance(64) ? bytes.any<double>() : size_ * 0.25 * bytes.grid_value();
  }
  std::vector<Eigen::Vector3d> points(Bytes& bytes) const;
  Status add_kind(Bytes& bytes, ShapeId& id, bool& good);
  Status add_faces(Bytes& bytes, ShapeId& id);

  ShapePool pool_;
  std::vector<ShapeId> ids_;
  double size_ = 1.0;
};

bool is_length(double x) {
  return x >= 0.0 && x < kInfinity;
}

std::vector<Eigen::Vector3d> Workshop::points(Bytes& bytes) const {
  std::vector<Eigen::Vector3d> points(bytes.below(24));
  for (Eigen::Vector3d& point : points) {
    for (int k = 0; k < 3; ++k) point[k] = coordinate(bytes);
  }
  return points;
}

Status Workshop::add_faces(Bytes& bytes, ShapeId& id) {
  // Starts from an octahedron and changes some of it.
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    points.push_back(size_ * Eigen::Vector3d::Unit(axis));
    points.push_back(-size_ * Eigen::Vector3d::Unit(axis));
  }
  std::vector<std::uint32_t> loops{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                   2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  std::vector<std::uint32_t> sizes(8, 3);
  for (std::size_t changes = bytes.below(4); changes-- != 0;) {
    switch (bytes.below(5)) {
      case 0:
        points[bytes.below(points.size())][static_cast<int>(bytes.below(3))] = coordinate(bytes);
        break;
      case 1:
        loops[bytes.below(loops.size())] = bytes.byte();
        break;
      case 2:
        sizes[bytes.below(sizes.size())] = bytes.byte();
        break;
      case 3:
        if (loops.size() > 1) loops.pop_back();
        break;
      default:
        if (sizes.size() > 1) sizes.pop_back();
    }
  }
  return pool_.add_hull(points, {loops, sizes}, size_ * bytes.extent()).get(id);
}

/// Sets `good` to whether the shape must be accepted, if that is clear.
Status Workshop::add_kind(Bytes& bytes, ShapeId& id, bool& good) {
  const double a = length(bytes);
  const double b = length(bytes);
  const double c = length(bytes);
  const double r = bytes.chance(4) ? length(bytes) : 0.0;
  const bool finite = std::isfinite(a) && std::isfinite(b) && std::isfinite(c);
  switch (bytes.below(11)) {
    case 0:
      good = is_length(a);
      return pool_.add(SphereShape{a}).get(id);
    case 1:
      good = is_length(a) && is_length(b);
      return pool_.add(CapsuleShape{a, b}).get(id);
    case 2:
      good = is_length(a) && is_length(b) && is_length(c) && is_length(r);
      return pool_.add(BoxShape{{a, b, c}, r}).get(id);
    case 3:
      good = is_length(a) && is_length(b) && is_length(r);
      return pool_.add(CylinderShape{a, b, r}).get(id);
    case 4:
      good = is_length(a) && is_length(b) && is_length(r);
      return pool_.add(ConeShape{a, b, r}).get(id);
    case 5:
      good = finite && is_length(r);
      return pool_.add(TriangleShape{{{a, b, c}, {b, -c, a}, {-c, a, 0.0}}, r}).get(id);
    case 6:
      good = finite && (a != 0.0 || b != 0.0 || c != 0.0);
      return pool_.add(HalfSpaceShape{{a, b, c}, 0.0}).get(id);
    case 9:
      good = is_length(a) && is_length(b) && is_length(c) && is_length(r);
      return pool_.add(EllipsoidShape{{a, b, c}, r}).get(id);
    case 10:
      good = is_length(a) && is_length(b) && is_length(c);
      return pool_.add(TaperedCapsuleShape{{a, b}, c}).get(id);
    case 7: {
      const auto given = points(bytes);
      good = !given.empty() && is_length(r) &&
             std::all_of(given.begin(), given.end(), [](auto& p) { return p.allFinite(); });
      return pool_.add_hull(given, r).get(id);
    }
    default:
      const Status status = add_faces(bytes, id);
      good = status == Status::ok;
      return status;
  }
}

void Workshop::add(Bytes& bytes) {
  const ShapeTables before = pool_.tables();
  const std::size_t reserved = pool_.footprint().total().used;
  ShapeId id;
  bool good = false;
  const Status status = add_kind(bytes, id, good);
  if (status == Status::ok) {
    WINNOW_REQUIRE(good && pool_.contains(id));
    const Aabb box = pool_.bounds(id, Pose{});
    WINNOW_REQUIRE(!as_eigen(box.min).hasNaN() && !as_eigen(box.max).hasNaN());
    // Pairs are tested only if their sizes are comparable.
    const float largest = (as_eigen(box.max) - as_eigen(box.min)).maxCoeff();
    const bool is_small = static_cast<double>(largest) < 1e12 * size_;
    if (is_small || id.kind() == ShapeKind::half_space) ids_.push_back(id);
    return;
  }
  // `good` is not tested here: a hull of numbers near the ends of double may be rejected too.
  WINNOW_REQUIRE(status == Status::invalid_shape || status == Status::unsupported);
  WINNOW_REQUIRE(id == ShapeId{} && pool_.footprint().total().used == reserved);
  WINNOW_REQUIRE(std::equal(before.count, before.count + kShapeKinds, pool_.tables().count));
}

struct Answer {
  bool overlap = false;
  double distance = 0.0;
  double bound = 0.0;
};

bool agree(const Answer& x, const Answer& y) {
  return x.distance == y.distance ||
         std::abs(x.distance - y.distance) <= (x.bound + y.bound) * (1.0 + 1e-12);
}

void Workshop::check_pairs(Bytes& bytes) {
  if (ids_.empty()) return;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;
  std::vector<BodyPair> turned;
  for (std::size_t i = 1 + bytes.below(12); i-- != 0;) {
    for (int k = 0; k < 2; ++k) {
      shapes.push_back(ids_[bytes.below(ids_.size())]);
      poses.push_back(bytes.pose());
      for (double& x : poses.back().position) x *= size_;
    }
    const auto n = static_cast<std::uint32_t>(shapes.size());
    pairs.push_back({n - 2, n - 1});
    turned.push_back({n - 1, n - 2});
  }
  const auto collide = [&](std::span<const BodyPair> requested, ContactLevel level,
                           NarrowTier tier) {
    NarrowPhase narrow;
    NarrowResult result;
    WINNOW_REQUIRE(narrow.collide(pool_, {shapes, poses}, requested,
                                  {.level = level, .tier = tier, .contact_margin = 0.25 * size_},
                                  result) == Status::ok);
    std::vector<Answer> answers(requested.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      Answer& answer = answers[result.pair_of(i)];
      answer.overlap = result.overlaps(i);
      if (level == ContactLevel::boolean) continue;
      answer.distance = result.distance()[i];
      answer.bound = result.error_bound()[i];
      WINNOW_REQUIRE(!std::isnan(answer.distance) && answer.bound >= 0.0);
      double square = 0.0;
      for (int k = 0; k < 3; ++k) square += result.normal(k)[i] * result.normal(k)[i];
      WINNOW_REQUIRE(std::abs(square - 1.0) < 1e-5);
      if (level == ContactLevel::manifold) {
        WINNOW_REQUIRE(result.contact_count()[i] <= kManifoldPoints);
      }
    }
    return answers;
  };
  const auto truth = collide(pairs, ContactLevel::distance, NarrowTier::reference);
  const auto robust = collide(pairs, ContactLevel::distance, NarrowTier::robust);
  const auto mirrored = collide(turned, ContactLevel::distance, NarrowTier::robust);
  const auto verdicts = collide(pairs, ContactLevel::boolean, NarrowTier::robust);
  const auto manifolds = collide(pairs, ContactLevel::manifold, NarrowTier::robust);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    WINNOW_REQUIRE(robust[i].overlap == truth[i].overlap);
    WINNOW_REQUIRE(mirrored[i].overlap == truth[i].overlap);
    WINNOW_REQUIRE(verdicts[i].overlap == truth[i].overlap);
    WINNOW_REQUIRE(manifolds[i].overlap == truth[i].overlap);
    WINNOW_REQUIRE(agree(robust[i], truth[i]));
    WINNOW_REQUIRE(agree(mirrored[i], truth[i]));
    if (truth[i].distance <= 0.0) WINNOW_REQUIRE(agree(manifolds[i], truth[i]));
  }
}

/// Checks that the hit point of a ray is on the shape.
void Workshop::check_rays(Bytes& bytes) const {
  if (ids_.empty()) return;
  const ShapeId id = ids_[bytes.below(ids_.size())];
  const Pose pose = bytes.pose();
  ShapeRay ray;
  for (double& x : ray.origin) x = size_ * 0.25 * bytes.grid_value();
  for (double& x : ray.direction) x = bytes.grid_value();
  ray.max_t = bytes.chance(2) ? kInfinity : size_ * bytes.extent();
  ShapeHit hit;
  const Status status = cast_ray(pool_.tables(), id, pose, ray).get(hit);
  const bool moves = ray.direction[0] != 0.0 || ray.direction[1] != 0.0 || ray.direction[2] != 0.0;
  WINNOW_REQUIRE((status == Status::ok) == moves);
  if (status != Status::ok || !hit.hit) return;
  WINNOW_REQUIRE(hit.t >= 0.0 && hit.t <= ray.max_t);
  double square = 0.0;
  for (const double x : hit.normal) square += x * x;
  WINNOW_REQUIRE(std::abs(square - 1.0) < 1e-9);
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  const auto isas = available_isas();
  const IsaScope isa(isas[bytes.below(isas.size())]);
  Workshop workshop(bytes);
  for (int steps = 0; !bytes.empty() && steps < 60; ++steps) {
    switch (bytes.below(5)) {
      case 0:
      case 1:
        workshop.add(bytes);
        break;
      case 2:
        workshop.check_rays(bytes);
        break;
      default:
        workshop.check_pairs(bytes);
    }
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(150, 900);
}

}  // namespace winnow::test
