// SceneQueries: bodies that overlap a shape or are near it, and bodies nearest to a point.
// shape_distance.h tests the candidates that the partitions find.

#include <winnow/core/volumes.h>
#include "core/memory/new_in.h"
#include "core/numbers/rounding.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/queries/body_distance.h"
#include "pipeline/scene/queries/observed_filter.h"
#include "pipeline/scene/queries/queries.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

using mid::kInfinity;

bool is_nearer(const SceneDistance& a, const SceneDistance& b) noexcept {
  return a.distance != b.distance ? a.distance < b.distance : a.key.id < b.key.id;
}
bool has_lesser_id(const SceneDistance& a, const SceneDistance& b) noexcept {
  return a.key.id < b.key.id;
}

/// Finds the bodies nearest to a point. First tests the bodies with the nearest boxes; the last one
/// of the `count` nearest among them limits the distance, and then all other bodies whose boxes are
/// within this distance are tested.
class NearestBodiesQuery {
 public:
  NearestBodiesQuery(QueryState& state, const Vec3d& point, const SceneFilter& filter) noexcept
      : state_(state), filter_(filter) {
    from_.pose.position = point;
    // Clamping to the range of float makes no box farther away.
    constexpr auto kMaxFloat = static_cast<double>(std::numeric_limits<float>::max());
    const Vector3d& origin = state.scene.origin;
    Vector3d low;
    Vector3d high;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::clamp(add_down(point[i], -origin[i]), -kMaxFloat, kMaxFloat);
      high[i] = std::clamp(add_up(point[i], -origin[i]), -kMaxFloat, kMaxFloat);
    }
    box_ = Aabb::outward(low, high);
  }

  Status run(std::size_t count, double radius);

 private:
  void test_body(std::uint32_t body);
  /// Tests the bodies with the nearest boxes within the radius, and lowers the radius to the last
  /// distance that is still of interest.
  [[nodiscard]] Status test_nearest(const Partition& partition);
  /// Tests all other bodies within the radius. The first `known` results, sorted by id, are of
  /// bodies that were tested.
  [[nodiscard]] Status test_within(const Partition& partition, std::size_t known);
  [[nodiscard]] float reach() const noexcept;

  QueryState& state_;
  const SceneFilter& filter_;
  const SphereShape point_;
  SubShape from_{ShapeId::of(ShapeKind::sphere, 0), {}, kWholeShape, nullptr, &point_};
  Aabb box_;
  std::size_t count_ = 0;
  double radius_ = 0.0;
  bool has_room_ = true;
  /// A partition has more boxes than it returned.
  bool is_cut_ = false;
};

void NearestBodiesQuery::test_body(std::uint32_t body) {
  ShapeDistance to;
  if (!ClosestParts(state_.parts).find(from_, state_.placed(body), radius_, to)) return;
  has_room_ = state_.distances.push_back(distance_to(state_.scene, body, to)) && has_room_;
}

/// Returns the radius, enlarged by the error bound of the solver's distance to a box boundary.
float NearestBodiesQuery::reach() const noexcept {
  return round_up(std::max(radius_, 0.0) * (1.0 + 1e-9));
}

Status NearestBodiesQuery::test_nearest(const Partition& partition) {
  auto take = [](std::uint32_t) { return true; };
  BodyCandidateFilter taking(state_.scene, filter_, take);
  const Status status = partition.nearest(box_, count_, reach(), state_.boxes, taking.filter());
  if (status != Status::ok) return status;
  for (const Hit& hit : state_.boxes) test_body(static_cast<std::uint32_t>(hit.data));
  is_cut_ = is_cut_ || state_.boxes.size() >= count_;
  Column<SceneDistance>& found = state_.distances;
  if (found.size() >= count_) {
    SceneDistance* const last = found.begin() + (count_ - 1);
    std::nth_element(found.begin(), last, found.end(), is_nearer);
    radius_ = last->distance;
  }
  return Status::ok;
}

Status NearestBodiesQuery::test_within(const Partition& partition, std::size_t known) {
  auto test_once = [&](std::uint32_t body) {
    const SceneDistance* const first = state_.distances.begin();
    SceneDistance same;
    same.key.id = body;
    if (!std::binary_search(first, first + known, same, has_lesser_id)) test_body(body);
    return false;
  };
  BodyCandidateFilter body_filter(state_.scene, filter_, test_once);
  return partition.nearest(box_, ~std::size_t{0}, reach(), state_.boxes, body_filter.filter());
}

Status NearestBodiesQuery::run(std::size_t count, double radius) {
  Column<SceneDistance>& found = state_.distances;
  found.clear();
  if (count == 0) return Status::ok;
  count_ = count;
  radius_ = radius;
  Status status =
      state_.each_partition([&](const Partition& partition) { return test_nearest(partition); });
  if (status == Status::ok && is_cut_) {
    const std::size_t known = found.size();
    std::sort(found.begin(), found.end(), has_lesser_id);
    status = state_.each_partition(
        [&](const Partition& partition) { return test_within(partition, known); });
  }
  if (!has_room_) status = Status::out_of_memory;
  if (status != Status::ok) return status;
  std::sort(found.begin(), found.end(), is_nearer);
  found.set_size(std::min(found.size(), count));
  return Status::ok;
}

/// Calls test_body(body), whose result is ignored, for each body that passes the filter and whose
/// box is within `reach` of the shape.
template <typename TestBody>
[[nodiscard]] Status test_near(QueryState& state, const PlacedShape& shape, double reach,
                               const SceneFilter& filter, TestBody& test_body) {
  BodyCandidateFilter body_filter(state.scene, filter, test_body);
  const PlainBox around =
      state.scene.bounds_from(state.scene.origin, shape.shape, shape.pose, reach);
  const Aabb box{Eigen::Vector3f::Map(around.min), Eigen::Vector3f::Map(around.max)};
  return state.each_partition([&](const Partition& partition) {
    return partition.overlap(box, state.objects, body_filter.filter());
  });
}

bool has_lesser_overlap_id(const SceneOverlap& a, const SceneOverlap& b) noexcept {
  return a.key.id < b.key.id;
}

}  // namespace

SceneQueries::SceneQueries(const Scene& scene, std::pmr::memory_resource* memory) noexcept
    : memory_(memory) {
  if (scene.state_ != nullptr) state_ = new_in<QueryState>(memory, *scene.state_, memory);
}

SceneQueries::~SceneQueries() {
  delete_in(memory_, state_);
}

Footprint SceneQueries::footprint() const noexcept {
  if (state_ == nullptr) return {};
  Footprint sum = state_->footprint();
  sum.structure = {sizeof(QueryState), sizeof(QueryState)};
  return sum;
}

Footprint QueryState::footprint() const noexcept {
  Footprint sum;
  for (const Bytes& bytes : {boxes.footprint().total(), objects.footprint().total(), bounds.bytes(),
                             gaps.bytes(), small_set_hits.bytes(), accepted.bytes()}) {
    sum.scratch += bytes;
  }
  for (const Bytes& bytes : {hits.bytes(), hits_first.bytes(), crossings.bytes(), overlaps.bytes(),
                             distances.bytes(), overlapping.bytes()}) {
    sum.results += bytes;
  }
  return sum;
}

Answer<std::span<const SceneOverlap>> SceneQueries::overlap(ShapeId shape, const Pose& pose,
                                                            const SceneFilter& filter) {
  if (state_ == nullptr) return Status::out_of_memory;
  ObservedFilter observed(state_, filter);
  const auto found = find_overlaps(*state_, shape, pose, observed.used());
  if (is_observed(found.status, state_)) state_->observer->overlap(shape, pose, observed, found);
  return found;
}

Answer<std::span<const SceneOverlap>> find_overlaps(QueryState& state, ShapeId shape,
                                                    const Pose& pose, const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = QueryState::check_state(&state); status != Status::ok) return status;
  if (!state.parts.contains(shape)) return Status::invalid_key;
  if (!pose.is_valid()) return Status::invalid_pose;
  const PlacedShape query_shape{shape, pose};
  Column<SceneOverlap>& found = state.overlaps;
  found.clear();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    SceneOverlap answer;
    if (do_overlap(state.parts, query_shape, state.placed(body), answer.part)) {
      answer.key = state.scene.keys.key_of(body);
      answer.data = state.scene.keys.client_data(body);
      has_room = found.push_back(answer) && has_room;
    }
    return false;
  };
  Status status = test_near(state, query_shape, 0.0, filter, test_body);
  if (!has_room) status = Status::out_of_memory;
  if (status != Status::ok) return status;
  std::sort(found.begin(), found.end(), has_lesser_overlap_id);
  return std::span<const SceneOverlap>(found.data(), found.size());
}

Answer<std::span<const SceneDistance>> SceneQueries::distances(ShapeId shape, const Pose& pose,
                                                               double limit,
                                                               const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = QueryState::check_state(state_); status != Status::ok) return status;
  if (!state_->parts.contains(shape)) return Status::invalid_key;
  if (!pose.is_valid()) return Status::invalid_pose;
  if (!std::isfinite(limit)) return Status::invalid_argument;
  ObservedFilter observed(state_, filter);
  const PlacedShape query_shape{shape, pose};
  Column<SceneDistance>& found = state_->distances;
  found.clear();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    ShapeDistance to;
    if (ClosestParts(state_->parts).find(query_shape, state_->placed(body), limit, to)) {
      has_room = found.push_back(distance_to(state_->scene, body, to)) && has_room;
    }
    return false;
  };
  // Covers the error of the solver's distance to a box boundary.
  const double reach = std::max(limit, 0.0) * (1.0 + 1e-9);
  Status status = test_near(*state_, query_shape, reach, observed.used(), test_body);
  if (!has_room) status = Status::out_of_memory;
  if (status != Status::ok) return status;
  std::sort(found.begin(), found.end(), is_nearer);
  const std::span<const SceneDistance> bodies(found.data(), found.size());
  if (state_->observer != nullptr) {
    state_->observer->distances(shape, pose, limit, observed, bodies);
  }
  return bodies;
}

Answer<std::span<const SceneDistance>> SceneQueries::nearest(const Vec3d& point, std::size_t count,
                                                             double radius,
                                                             const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = QueryState::check_state(state_); status != Status::ok) return status;
  if (!is_finite(point) || !(radius >= 0.0)) return Status::invalid_argument;
  ObservedFilter observed(state_, filter);
  const Status status = NearestBodiesQuery(*state_, point, observed.used()).run(count, radius);
  if (status != Status::ok) return status;
  const std::span<const SceneDistance> found(state_->distances.data(), state_->distances.size());
  if (state_->observer != nullptr) state_->observer->nearest(point, count, radius, observed, found);
  return found;
}

}  // namespace winnow
