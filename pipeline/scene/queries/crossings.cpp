// SceneQueries::crossings: all points at which a ray crosses surfaces. Each body is tested in
// coordinates relative to it, part by part; convex solids are tested by their triangles, as other
// rays are.

#include <winnow/core/eigen.h>
#include "core/numbers/rotation.h"
#include "core/threads/float_environment.h"
#include "pipeline/rays/shape_entries.h"
#include "pipeline/scene/queries/cast_query.h"
#include "pipeline/scene/queries/observed_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// Returns the weights of the corners of a triangle at the point of its plane nearest to `point`,
/// moved into the triangle. A triangle without an area counts as its longest side.
[[nodiscard]] Vec3d weights_at(const Vector3d& point, const Vector3d (&corner)[3]) noexcept {
  // Corners relative to the point, scaled so that squares of lengths are normal numbers.
  Vector3d to[3];
  double size = 0.0;
  for (int k = 0; k < 3; ++k) {
    to[k] = corner[k] - point;
    size = std::max(size, to[k].cwiseAbs().maxCoeff());
  }
  if (!(size > 0.0)) return {1.0, 0.0, 0.0};
  for (Vector3d& corner_to : to) corner_to /= size;
  const Vector3d normal = (to[1] - to[0]).cross(to[2] - to[0]);
  Vec3d weights{};
  if (normal.squaredNorm() > 0.0) {
    for (int k = 0; k < 3; ++k) {
      weights[k] = std::max(0.0, normal.dot(to[(k + 1) % 3].cross(to[(k + 2) % 3])));
    }
  } else {
    const auto length = [&](int k) { return (to[(k + 1) % 3] - to[k]).squaredNorm(); };
    int longest = length(1) > length(0) ? 1 : 0;
    if (length(2) > length(longest)) longest = 2;
    const int end = (longest + 1) % 3;
    const Vector3d along = to[end] - to[longest];
    const double share = -along.dot(to[longest]) / std::max(along.squaredNorm(), 1e-300);
    weights[end] = std::clamp(share, 0.0, 1.0);
    weights[longest] = 1.0 - weights[end];
  }
  const double sum = weights[0] + weights[1] + weights[2];
  return sum > 0.0 ? weights / sum : Vec3d{1.0, 0.0, 0.0};
}

[[nodiscard]] auto order_of(const SceneCrossing& crossing) noexcept {
  return std::tuple(crossing.t, crossing.key.id, crossing.part, crossing.exits);
}

/// The crossings of one ray with bodies, which it appends to the state's `crossings`.
class CrossingQuery {
 public:
  CrossingQuery(QueryState& state, const ShapeRay& ray, const SceneFilter& filter) noexcept
      : state_(state), ray_(ray), cast_(state.scene.shapes, ray), filter_(filter) {}
  CrossingQuery(const CrossingQuery&) = delete;
  CrossingQuery& operator=(const CrossingQuery&) = delete;

  Status run();

 private:
  void cross_body(std::uint32_t body);
  /// `near` is the ray relative to the body, as the part is.
  void cross_triangle(const ShapeRay& near, const SubShape& part);
  void cross_convex(const ShapeRay& near, const SubShape& part);
  void add(const ShapeRay& near, const SubShape& part, const SceneCrossing& crossing);

  QueryState& state_;
  const ShapeRay& ray_;
  const RayCast cast_;
  const SceneFilter& filter_;
  std::uint32_t body_ = kNoObject;
  bool has_room_ = true;
};

Status CrossingQuery::run() {
  state_.crossings.clear();
  auto cross = [&](std::uint32_t body) { cross_body(body); };
  const Status status = CastQuery(state_, cast_, filter_).visit_all(BodyVisitor::of(cross));
  if (status != Status::ok) return status;
  if (!has_room_) return Status::out_of_memory;
  // A body that is found in two pieces of a path is tested twice.
  Column<SceneCrossing>& found = state_.crossings;
  std::ranges::sort(found.begin(), found.end(), {}, order_of);
  const auto rest = std::ranges::unique(found.begin(), found.end(), {}, order_of);
  found.set_size(static_cast<std::size_t>(rest.begin() - found.begin()));
  return Status::ok;
}

void CrossingQuery::cross_body(std::uint32_t body) {
  body_ = body;
  PlacedShape placed = state_.placed(body);
  const TwoDiff from = difference(ray_.origin.data(), placed.pose.position.data());
  ShapeRay near = ray_;
  near.origin = from.difference;
  for (int i = 0; i < 3; ++i) placed.pose.position[i] = -from.rest[i];
  auto cross = [&](const SubShape& part, double limit) {
    part.triangle != nullptr ? cross_triangle(near, part) : cross_convex(near, part);
    return limit;
  };
  state_.parts.visit_parts(placed, moving_box_from(cast_, from.difference, ray_.max_t), cross,
                           mid::Solids::triangles);
}

void CrossingQuery::cross_triangle(const ShapeRay& near, const SubShape& part) {
  SubShape both_sides = part;
  both_sides.front = 0;
  ShapeHit hit;
  if (!enters(state_.scene.shapes, near, both_sides, hit) || hit.t > near.max_t) return;
  const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(part.pose.orientation));
  Vector3d corner[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = as_eigen(part.pose.position) + turn * as_eigen(part.triangle->vertex[k]);
  }
  const Vector3d way = as_eigen(near.direction);
  Vector3d front = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  if (part.is_mirrored) front = -front;
  SceneCrossing crossing{.t = hit.t, .exits = front.dot(way) > 0.0, .normal = hit.normal};
  // The normal of a hit points against the ray.
  if (crossing.exits) crossing.normal = -hit.normal;
  crossing.barycentric = weights_at(as_eigen(near.origin) + hit.t * way, corner);
  add(near, part, crossing);
}

void CrossingQuery::cross_convex(const ShapeRay& near, const SubShape& part) {
  PartTables own(state_.scene.shapes);
  const ShapeId shape = own.put(0, part);
  bool starts_inside = false;
  const ShapeHit entry = find_entry(own.tables(), shape, part.pose, near, starts_inside);
  if (!entry.hit) return;
  if (!starts_inside) add(near, part, {.t = entry.t, .normal = entry.normal});
  // Rounding may put the exit from a flat or grazed shape before the entry.
  ShapeRay endless = near;
  endless.max_t = mid::kInfinity;
  const ShapeHit exit = find_exit(own.tables(), shape, part.pose, endless);
  const bool is_grazed = !exit.hit && !starts_inside && part.shape.kind() != ShapeKind::half_space;
  if (!exit.hit && !is_grazed) return;
  const double t = is_grazed ? entry.t : std::max(exit.t, entry.t);
  const Vec3d normal = is_grazed ? entry.normal : exit.normal;
  if (t <= near.max_t) add(near, part, {.t = t, .exits = true, .normal = normal});
}

void CrossingQuery::add(const ShapeRay& near, const SubShape& part, const SceneCrossing& crossing) {
  SceneCrossing full = crossing;
  full.key = state_.scene.keys.key_of(body_);
  full.data = state_.scene.keys.client_data(body_);
  full.part = part.part;
  const Vec3d& base = state_.scene.pose[body_].position;
  // Summed in an order that keeps precision for distant bodies.
  for (int i = 0; i < 3; ++i) {
    full.point[i] = base[i] + (near.origin[i] + crossing.t * near.direction[i]);
  }
  has_room_ = state_.crossings.push_back(full) && has_room_;
}

}  // namespace

Answer<std::span<const SceneCrossing>> SceneQueries::crossings(const ShapeRay& ray,
                                                               const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = QueryState::check_state(state_); status != Status::ok) return status;
  if (!is_valid(ray)) return Status::invalid_argument;
  ObservedFilter observed(state_, filter);
  const Status status = CrossingQuery(*state_, ray, observed.used()).run();
  if (status != Status::ok) return status;
  const std::span<const SceneCrossing> points(state_->crossings.data(), state_->crossings.size());
  if (state_->observer != nullptr) state_->observer->crossings(ray, observed, points);
  return points;
}

}  // namespace winnow
