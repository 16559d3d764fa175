// SceneQueries: rays and moving shapes. Partitions find the bodies whose boxes the moving box
// overlaps (see BoxPath for why none is missed) and call a predicate (BodyCandidateFilter), which
// tests the exact shapes through BodyContact or, for rays on meshes, SubShapeQuery. Sets of at most
// four bodies, all composite, are tested directly, without their partitions; "crowds" below are all
// other sets.

#include <winnow/core/aabb.h>
#include <winnow/core/cast.h>
#include <winnow/core/rounding.h>
#include "core/threads/float_environment.h"
#include "pipeline/mesh/mesh_rays.kernel.h"
#include "pipeline/rays/shape_entries.h"
#include "pipeline/scene/queries/composite_cast.h"
#include "pipeline/scene/queries/linear_casts.h"
#include "pipeline/scene/queries/queries.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;
using mid::kInfinity;

/// Converts a moving box in double to queries in float for partitions, so that nothing is missed.
/// The path is divided into pieces, which are consecutive intervals of t.
///
/// Each piece starts at the position of the box in double, and moves by the direction rounded to
/// float. At its end the deviation from the true path is at most 2^-24 of the length of the piece;
/// the start position has an error of a few roundings of the coordinates. The box of the BoxCast is
/// enlarged by more than both, so it contains the true box at every t. A body's box in the
/// partition contains the body. The length of a piece is at most 2^10 times the distance from the
/// start at which the piece begins, or for the first piece 2^10 times the largest coordinate. Its
/// box is thus too large by at most about 2^-13 of this distance or coordinate. After kMaxPieces
/// pieces, or at the end of the range of float, the rest of the path is tested as one box that
/// contains it.
class BoxPath {
 public:
  /// The direction must be finite and not zero, max_t >= 0 may be infinite, the box must be finite.
  /// Partition coordinates are relative to `origin`.
  BoxPath(const PreciseBox& box, const Eigen::Vector3d& origin, const double direction[3],
          double max_t) noexcept;

  /// Advances to the next piece; call it for the first piece too. Returns false at the end.
  [[nodiscard]] bool next() noexcept;
  /// True for a last piece that is too long for `cast`: test the box `rest` instead.
  [[nodiscard]] bool is_rest() const noexcept { return is_rest_; }

  /// Start of the piece, in the caller's t.
  [[nodiscard]] double begin() const noexcept;
  /// Returns the cast of the piece up to slightly more than t = limit; min_t = 0 is the start of
  /// the piece.
  [[nodiscard]] BoxCast cast(double limit) const noexcept;
  [[nodiscard]] Aabb rest(double limit) const noexcept;

 private:
  [[nodiscard]] PreciseBox at(double path) const noexcept;
  [[nodiscard]] double slack(double end) const noexcept;

  // Path parameters are t times 2^exponent_, which makes them approximately lengths.
  PreciseBox box_;
  Eigen::Vector3d step_;
  int exponent_ = 0;
  double reach_ = 0.0;
  /// Largest coordinate that was rounded, including world coordinates.
  double rounded_reach_ = 0.0;
  double from_ = 0.0;
  double to_ = 0.0;
  double last_ = 0.0;
  int pieces_ = 0;
  bool is_rest_ = false;
};

/// A piece is at most this many times as long as the distance from the start to its beginning.
constexpr double kPieceGrowth = 0x1p10;
constexpr int kMaxPieces = 5;
/// Slightly below the range of float.
constexpr double kFarthest = 0x1p120;

double most_of(const PreciseBox& box) noexcept {
  return std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
}

BoxPath::BoxPath(const PreciseBox& box, const Vector3d& origin, const double direction[3],
                 double max_t) noexcept
    : box_{box.min - origin, box.max - origin} {
  const Vector3d given = Vector3d::Map(direction);
  std::frexp(given.cwiseAbs().maxCoeff(), &exponent_);
  for (int i = 0; i < 3; ++i) step_[i] = std::ldexp(given[i], -exponent_);
  last_ = std::ldexp(max_t, exponent_);
  reach_ = most_of(box_);
  rounded_reach_ = std::max(reach_, most_of(box));
}

bool BoxPath::next() noexcept {
  if (is_rest_ || (pieces_ != 0 && to_ >= last_)) return false;
  from_ = to_;
  to_ = std::min(last_, kPieceGrowth * std::max({reach_, from_, 1.0}));
  is_rest_ = pieces_ == kMaxPieces || !(reach_ + to_ < kFarthest);
  ++pieces_;
  if (is_rest_) to_ = last_;
  return true;
}

double BoxPath::begin() const noexcept {
  return std::ldexp(from_, -exponent_);
}

/// Covers the rounding of the direction to float, the rounding of coordinates, and rays that miss a
/// shape by no more than rounding, which cast_ray reports as hits.
double BoxPath::slack(double end) const noexcept {
  return 0x1p-23 * (end - from_) + 0x1p-47 * (rounded_reach_ + end);
}

PreciseBox BoxPath::at(double path) const noexcept {
  return {box_.min + path * step_, box_.max + path * step_};
}

BoxCast BoxPath::cast(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  const PreciseBox start = at(from_).grown(slack(to_));
  BoxCast cast;
  cast.box = Aabb::outward(start.min, start.max);
  cast.direction = step_.cast<float>();
  cast.max_t = round_up((end - from_) * (1.0 + 0x1p-50));
  return cast;
}

Aabb BoxPath::rest(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  PreciseBox sum = at(from_);
  for (int i = 0; i < 3; ++i) {
    if (step_[i] == 0.0) continue;
    const double path = end * step_[i];
    sum.min[i] = std::min(sum.min[i], box_.min[i] + path);
    sum.max[i] = std::max(sum.max[i], box_.max[i] + path);
  }
  // The rounding error of a finite path is relative to its end points.
  for (int i = 0; i < 3; ++i) {
    const double slack = 0x1p-47 * (rounded_reach_ + from_);
    sum.min[i] -= slack + 0x1p-47 * std::abs(sum.min[i]);
    sum.max[i] += slack + 0x1p-47 * std::abs(sum.max[i]);
  }
  Aabb box;
  constexpr float kMaxFloat = std::numeric_limits<float>::max();
  box.min = round_down(sum.min).min(Vec3f::constant(kMaxFloat));
  box.max = round_up(sum.max).max(Vec3f::constant(-kMaxFloat));
  return box;
}

bool is_before(const SceneHit& a, const SceneHit& b) noexcept {
  return a.t != b.t ? a.t < b.t : a.key.id < b.key.id;
}

/// Results for bodies that were tested and may be found again, because a partition calls the
/// predicate once per piece of the path. The cache is direct-mapped: if two bodies have the same
/// entry, the later one stays.
class ResultCache {
 public:
  /// Returns the result for the body, or null.
  [[nodiscard]] const bool* find(std::uint32_t body) const noexcept {
    const std::size_t at = body % kEntries;
    return (used_ >> at & 1U) != 0 && entries_[at].body == body ? &entries_[at].is_hit : nullptr;
  }
  bool note(std::uint32_t body, bool is_hit) noexcept {
    const std::size_t at = body % kEntries;
    used_ |= std::uint64_t{1} << at;
    entries_[at] = {body, is_hit};
    return is_hit;
  }

 private:
  static constexpr std::size_t kEntries = 64;
  struct Entry {
    std::uint32_t body;
    bool is_hit;
  };
  std::uint64_t used_ = 0;
  Entry entries_[kEntries];
};

/// True for a set with at most kFew bodies, all composite: a traversal of its partition is not
/// worth its cost, because the bodies have their own trees.
bool is_few(const SceneState& scene, const SceneSet& set) noexcept {
  constexpr std::size_t kFew = 4;
  return set.partition.has_value() && set.body_of.size() <= kFew &&
         std::all_of(set.body_of.begin(), set.body_of.end(),
                     [&](std::uint32_t body) { return scene.shape[body].is_composite(); });
}

/// Calls test_body(body) for all bodies that pass the filter and are in sets for which is_few is
/// true. Returns true if there are other sets, whose partitions must be queried.
template <typename TestBody>
[[nodiscard]] bool test_small_sets(const SceneState& scene, const Filter& filter,
                                   TestBody& test_body) {
  const BodyCandidateFilter body_filter(scene, filter, test_body);
  bool has_crowd = false;
  for (const SceneSet& set : scene.sets) {
    if (!is_few(scene, set)) {
      has_crowd = has_crowd || set.partition.has_value();
      continue;
    }
    for (std::size_t id = 0; id < set.body_of.size(); ++id) {
      // Ids of removed objects keep their entry; skip them.
      const std::uint32_t body = set.body_of[id];
      if (scene.place[body].id == id) body_filter.show(*set.partition, body);
    }
  }
  return has_crowd;
}

/// Sorts the hits from `before` on and removes duplicates: a body whose box extends over two pieces
/// of the path is found in both.
void order_hits(Column<SceneHit>& hits, std::size_t before) noexcept {
  if (hits.size() - before < 2) return;
  SceneHit* const own = hits.begin() + before;
  std::sort(own, hits.end(), is_before);
  const SceneHit* const end = std::unique(
      own, hits.end(), [](const SceneHit& a, const SceneHit& b) { return a.key == b.key; });
  hits.set_size(static_cast<std::size_t>(end - hits.begin()));
}

/// One query: a linear cast in the scene.
class CastQuery {
 public:
  CastQuery(QueryState& state, const LinearCast& linear_cast, const Filter& filter) noexcept
      : state_(state), linear_cast_(linear_cast), filter_(filter), limit_(linear_cast.max_t()) {}

  Status closest(SceneHit& hit);
  /// Appends the hits to the hits of earlier rays.
  Status all();
  /// As `all`, for crowds only: `test_small_sets` found the hits from `before` on.
  Status all_in_crowds(std::size_t before);
  /// As `closest`, for crowds only: `test_small_sets` found `body`, or kNoObject, at time t. Leaves
  /// `hit` unchanged unless there is a better one.
  Status closest_in_crowds(std::uint32_t body, double t, SceneHit& hit);
  Status any_in_crowds(SceneHit& hit);

 private:
  [[nodiscard]] BoxPath box_path() const noexcept;
  [[nodiscard]] bool found() const noexcept { return body_ != kNoObject; }
  [[nodiscard]] bool find_contact(std::uint32_t body, double limit, bool any,
                                  BodyContact& contact) const noexcept {
    return contact.find(state_.parts, linear_cast_, state_.placed(body), limit, any);
  }
  [[nodiscard]] SceneHit shown(std::uint32_t body, const BodyContact& contact) const noexcept;
  /// Tests bodies in crowds only.
  Status closest_in_crowds();
  /// Returns true if this body becomes the closest hit.
  bool improves(std::uint32_t body) noexcept;
  /// Appends the body's hit if there is one and the body was not tested before; returns false if
  /// memory is refused.
  [[nodiscard]] bool adds(std::uint32_t body);
  /// Calls query(partition) for each crowd until a call does not return ok.
  template <typename Query>
  [[nodiscard]] Status each_crowd(Query&& query) const;
  template <typename TestBody>
  [[nodiscard]] Status test_rest(const Partition& partition, const BoxPath& path,
                                 TestBody& test_body);

  QueryState& state_;
  const LinearCast& linear_cast_;
  const Filter& filter_;
  /// The body of the earliest hit so far, or kNoObject; and the largest t that still counts, which
  /// is the time of that hit or, at first, the end of the path.
  std::uint32_t body_ = kNoObject;
  double limit_;
  BodyContact best_;
  ResultCache memo_;
};

BoxPath CastQuery::box_path() const noexcept {
  // The slack of the path covers the rounding.
  const Vector3d start = Vector3d::Map(linear_cast_.start());
  return {{start + linear_cast_.extent().min, start + linear_cast_.extent().max},
          state_.scene.origin,
          linear_cast_.direction(),
          linear_cast_.max_t()};
}

SceneHit CastQuery::shown(std::uint32_t body, const BodyContact& contact) const noexcept {
  SceneHit hit = contact.hit(linear_cast_);
  hit.key = state_.scene.keys.key_of(body);
  hit.data = state_.scene.keys.client_data(body);
  return hit;
}

bool CastQuery::improves(std::uint32_t body) noexcept {
  if (const bool* const known = memo_.find(body)) return *known;
  BodyContact contact;
  bool better = find_contact(body, limit_, false, contact);
  // Equal t are ordered by the bodies' ids.
  if (better && found() && contact.t() == limit_) better = body < body_;
  if (better) {
    body_ = body;
    best_ = contact;
    limit_ = contact.t();
  }
  return memo_.note(body, better);
}

template <typename Query>
Status CastQuery::each_crowd(Query&& query) const {
  for (const SceneSet& set : state_.scene.sets) {
    if (!set.partition.has_value() || is_few(state_.scene, set)) continue;
    if (const Status status = query(*set.partition); status != Status::ok) return status;
  }
  return Status::ok;
}

/// Tests bodies on the rest of a path that is too long for casts.
template <typename TestBody>
Status CastQuery::test_rest(const Partition& partition, const BoxPath& path, TestBody& test_body) {
  auto test_and_reject = [&](std::uint32_t body) {
    test_body(body);
    return false;
  };
  BodyCandidateFilter body_filter(state_.scene, filter_, test_and_reject);
  return partition.overlap(path.rest(limit_), state_.objects, body_filter.filter());
}

/// Makes two traversals per partition and piece of the path. In the first traversal only bodies
/// that improve the result count as hits, so the partition skips boxes beyond the nearest box of
/// such a body. The traversal returns this box, and every box before it has been tested. The second
/// traversal tests the remaining boxes, from this box to the hit on the exact shape. Both
/// traversals are short if boxes are tight.
Status CastQuery::closest_in_crowds() {
  BoxPath path = box_path();
  auto test_body = [&](std::uint32_t body) { return improves(body); };
  auto test_and_reject = [&](std::uint32_t body) {
    improves(body);
    return false;
  };
  BodyCandidateFilter first(state_.scene, filter_, test_body);
  BodyCandidateFilter second(state_.scene, filter_, test_and_reject);
  while (path.next() && !(found() && limit_ < path.begin())) {
    const Status status = each_crowd([&](const Partition& partition) {
      if (path.is_rest()) return test_rest(partition, path, test_body);
      Hit box;
      BoxCast cast = path.cast(limit_);
      Status result = partition.closest(cast, box, first.filter());
      if (result != Status::ok || !box) return result;
      cast = path.cast(limit_);
      cast.min_t = box.t;
      if (cast.max_t >= cast.min_t) result = partition.closest(cast, box, second.filter());
      return result;
    });
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status CastQuery::closest(SceneHit& hit) {
  auto test_body = [&](std::uint32_t body) { return improves(body); };
  const bool has_crowd = test_small_sets(state_.scene, filter_, test_body);
  const Status status = has_crowd ? closest_in_crowds() : Status::ok;
  if (status == Status::ok) hit = found() ? shown(body_, best_) : SceneHit{};
  return status;
}

Status CastQuery::closest_in_crowds(std::uint32_t body, double t, SceneHit& hit) {
  body_ = body;
  if (found()) limit_ = t;
  const Status status = closest_in_crowds();
  if (status == Status::ok && body_ != body) hit = shown(body_, best_);
  return status;
}

Status CastQuery::any_in_crowds(SceneHit& hit) {
  auto test_body = [&](std::uint32_t body) {
    if (found()) return true;
    if (const bool* const known = memo_.find(body)) return *known;
    if (!find_contact(body, limit_, true, best_)) return memo_.note(body, false);
    body_ = body;
    return true;
  };
  BoxPath path = box_path();
  BodyCandidateFilter body_filter(state_.scene, filter_, test_body);
  while (!found() && path.next()) {
    const Status status = each_crowd([&](const Partition& partition) {
      if (found()) return Status::ok;
      if (path.is_rest()) return test_rest(partition, path, test_body);
      Hit box;
      return partition.any(path.cast(limit_), box, body_filter.filter());
    });
    if (status != Status::ok) return status;
  }
  if (found()) hit = shown(body_, best_);
  return Status::ok;
}

Status CastQuery::all() {
  const std::size_t before = state_.hits.size();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    has_room = adds(body) && has_room;
    return false;
  };
  const bool has_crowd = test_small_sets(state_.scene, filter_, test_body);
  if (!has_room) return Status::out_of_memory;
  if (has_crowd) return all_in_crowds(before);
  order_hits(state_.hits, before);
  return Status::ok;
}

bool CastQuery::adds(std::uint32_t body) {
  if (memo_.find(body) != nullptr) return true;
  memo_.note(body, false);
  BodyContact contact;
  return !find_contact(body, linear_cast_.max_t(), false, contact) ||
         state_.hits.push_back(shown(body, contact));
}

Status CastQuery::all_in_crowds(std::size_t before) {
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    has_room = adds(body) && has_room;
    return false;
  };
  BoxPath path = box_path();
  BodyCandidateFilter body_filter(state_.scene, filter_, test_body);
  while (path.next()) {
    const Status status = each_crowd([&](const Partition& partition) {
      if (path.is_rest()) return test_rest(partition, path, test_body);
      return partition.all(path.cast(linear_cast_.max_t()), state_.boxes, body_filter.filter());
    });
    if (status != Status::ok) return status;
  }
  if (!has_room) return Status::out_of_memory;
  order_hits(state_.hits, before);
  return Status::ok;
}

/// Tests of one ray. Results depend only on the ray as given, not on the batch.
struct RayInScene {
  const QueryState& state;
  const ShapeRay& ray;

  /// Fills in a hit, which must be a null hit.
  void show(const BodyRayHit& best, SceneHit& hit) const noexcept {
    if (best.body == kNoObject) return;
    hit.key = state.scene.keys.key_of(best.body);
    hit.data = state.scene.keys.client_data(best.body);
    hit.part = best.part;
    hit.t = best.t;
    // Summed in an order that keeps precision for distant bodies.
    const double* const base = state.scene.pose[best.body].position;
    const TwoDiff from = difference(ray.origin, base);
    for (int k = 0; k < 3; ++k) {
      hit.normal[k] = best.normal[k];
      hit.point[k] = base[k] + (from.difference[k] + best.t * ray.direction[k]);
    }
  }
};

/// Tests a ray on crowds. `hit` is the result so far and changes only if there is a better one.
[[nodiscard]] Status query_crowds(QueryState& state, const ShapeRay& ray, const Filter& filter,
                                  const BodyRayHit& best, bool any, SceneHit& hit) {
  if (any && best.body != kNoObject) return Status::ok;
  const RayCast linear_cast(state.scene.shapes, ray);
  CastQuery query(state, linear_cast, filter);
  return any ? query.any_in_crowds(hit) : query.closest_in_crowds(best.body, best.t, hit);
}

/// Tests a single ray on a body that `test_small_sets` found, up to the limit.
void test_ray(QueryState& state, const RayInScene& scene_ray, std::uint32_t body, bool any,
              BodyRayHit& best, double& limit) {
  PartHit hit;
  state.parts.cast_rays(state.placed(body), {&scene_ray.ray, 1}, &limit, any,
                        &state.surfaces.of(body), &hit);
  if (hit.found) best.improve(BodyRayHit::of(body, hit), any, limit);
}

/// Finds the first hit of a single ray, or with `any` any hit. The ray must be valid.
Status query_ray(QueryState& state, const ShapeRay& ray, const Filter& filter, bool any,
                 SceneHit& hit) {
  const RayInScene scene_ray{state, ray};
  BodyRayHit best;
  best.body = kNoObject;
  double limit = ray.max_t;
  auto test_body = [&](std::uint32_t body) {
    test_ray(state, scene_ray, body, any, best, limit);
    return false;
  };
  const bool has_crowd = test_small_sets(state.scene, filter, test_body);
  if (!has_crowd) {
    hit = SceneHit{};
    scene_ray.show(best, hit);
    return Status::ok;
  }
  SceneHit found;
  scene_ray.show(best, found);
  const Status status = query_crowds(state, ray, filter, best, any, found);
  if (status == Status::ok) hit = found;
  return status;
}

/// Writes the hits of a single ray on all bodies into the state's `hits`.
Status query_all_one_by_one(QueryState& state, const ShapeRay& ray, const Filter& filter) {
  const RayInScene scene_ray{state, ray};
  state.hits.clear();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    BodyRayHit best;
    best.body = kNoObject;
    double limit = ray.max_t;
    test_ray(state, scene_ray, body, false, best, limit);
    if (best.body == kNoObject) return false;
    SceneHit hit;
    scene_ray.show(best, hit);
    has_room = state.hits.push_back(hit) && has_room;
    return false;
  };
  const bool has_crowd = test_small_sets(state.scene, filter, test_body);
  if (!has_room) return Status::out_of_memory;
  if (has_crowd) {
    const RayCast linear_cast(state.scene.shapes, ray);
    return CastQuery(state, linear_cast, filter).all_in_crowds(0);
  }
  order_hits(state.hits, 0);
  return Status::ok;
}

/// Up to kRaysAtOnce rays that are tested together, which is cheaper than one by one if they reach
/// the same surfaces; and the first hit of each.
class RaysTogether {
 public:
  RaysTogether(QueryState& state, const Filter& filter) noexcept : state_(state), filter_(filter) {}

  /// Finds the first hits, or with `any` any hits, of rays [first, first + count) of a batch. They
  /// must be valid.
  Status query(const ShapeRayBatch& rays, std::size_t first, std::size_t count, bool any);
  /// Lists each ray's first hits on all bodies that `test_small_sets` finds, sorted by ray, in the
  /// state's `few`, and sets whether there are crowds.
  Status list_few(const ShapeRayBatch& rays, std::size_t first, std::size_t count, bool& has_crowd);
  [[nodiscard]] const SceneHit& hit(std::size_t i) const noexcept { return hit_[i]; }
  /// Returns hit `at` of ray i of the group.
  [[nodiscard]] SceneHit shown(std::size_t i, const BodyRayHit& at) const noexcept {
    SceneHit hit;
    RayInScene{state_, ray_[i]}.show(at, hit);
    return hit;
  }

 private:
  void start(const ShapeRayBatch& rays, std::size_t first, std::size_t count, bool any) noexcept;
  void test_rays(std::uint32_t body);

  QueryState& state_;
  const Filter& filter_;
  std::size_t count_ = 0;
  bool any_ = false;
  /// The rays as given: where they hit a surface depends on nothing else.
  ShapeRay ray_[kRaysAtOnce];
  /// Time of the first hit so far, or the end of the ray; with `any`, negative after a hit.
  double limit_[kRaysAtOnce];
  BodyRayHit best_[kRaysAtOnce];
  SceneHit hit_[kRaysAtOnce];
};

void RaysTogether::test_rays(std::uint32_t body) {
  PartHit hits[kRaysAtOnce];
  state_.parts.cast_rays(state_.placed(body), {ray_, count_}, limit_, any_, nullptr, hits);
  for (std::size_t i = 0; i < count_; ++i) {
    if (hits[i].found) best_[i].improve(BodyRayHit::of(body, hits[i]), any_, limit_[i]);
  }
}

void RaysTogether::start(const ShapeRayBatch& rays, std::size_t first, std::size_t count,
                         bool any) noexcept {
  count_ = count;
  any_ = any;
  for (std::size_t i = 0; i < count; ++i) {
    ray_[i] = rays[first + i];
    limit_[i] = ray_[i].max_t;
    best_[i].body = kNoObject;
  }
}

Status RaysTogether::query(const ShapeRayBatch& rays, std::size_t first, std::size_t count,
                           bool any) {
  start(rays, first, count, any);
  auto test_body = [&](std::uint32_t body) {
    test_rays(body);
    return false;
  };
  const bool has_crowd = test_small_sets(state_.scene, filter_, test_body);
  for (std::size_t i = 0; i < count; ++i) hit_[i] = shown(i, best_[i]);
  if (!has_crowd) return Status::ok;
  for (std::size_t i = 0; i < count; ++i) {
    const Status status = query_crowds(state_, ray_[i], filter_, best_[i], any_, hit_[i]);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status RaysTogether::list_few(const ShapeRayBatch& rays, std::size_t first, std::size_t count,
                              bool& has_crowd) {
  Column<RayHit>& few = state_.few;
  few.clear();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    start(rays, first, count, false);
    test_rays(body);
    for (std::size_t i = 0; i < count; ++i) {
      if (best_[i].body != kNoObject) has_room = few.push_back({first + i, best_[i]}) && has_room;
    }
    return false;
  };
  has_crowd = test_small_sets(state_.scene, filter_, test_body);
  const auto is_earlier = [](const RayHit& a, const RayHit& b) { return a.ray < b.ray; };
  // The hits of one body are in order already.
  const bool is_ordered = std::is_sorted(few.begin(), few.end(), is_earlier);
  if (!is_ordered) std::sort(few.begin(), few.end(), is_earlier);
  return has_room ? Status::ok : Status::out_of_memory;
}

bool is_valid(const double (&direction)[3], double max_t) noexcept {
  const bool moves = direction[0] != 0.0 || direction[1] != 0.0 || direction[2] != 0.0;
  return is_finite(direction) && moves && max_t >= 0.0;
}

Status check(const QueryState* state, const ShapeRay& ray) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) {
    return status;
  }
  return is_valid(ray) ? Status::ok : Status::invalid_argument;
}

Status check(const QueryState* state, const ShapeRayBatch& rays) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) {
    return status;
  }
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (!is_valid(rays[i])) return Status::invalid_argument;
  }
  return Status::ok;
}

template <typename T>
void put(T* column, std::size_t row, const T& value) noexcept {
  if (column != nullptr) column[row] = value;
}

void put(const SceneHitColumns& columns, std::size_t row, const SceneHit& hit) noexcept {
  put(columns.key, row, hit.key);
  put(columns.data, row, hit.data);
  put(columns.part, row, hit.part);
  put(columns.t, row, hit ? hit.t : kInfinity);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(columns.normal[axis], row, hit.normal[axis]);
    put(columns.point[axis], row, hit.point[axis]);
  }
}

/// Finds one hit for each ray.
Status query_each(QueryState* state, const ShapeRayBatch& rays, const Filter& filter,
                  const SceneHitColumns& hits, bool any) {
  Status status = check(state, rays);
  if (status != Status::ok) return status;
  RaysTogether group(*state, filter);
  for (std::size_t first = 0; first < rays.count; first += kRaysAtOnce) {
    const std::size_t count = std::min<std::size_t>(kRaysAtOnce, rays.count - first);
    status = group.query(rays, first, count, any);
    if (status != Status::ok) return status;
    for (std::size_t i = 0; i < count; ++i) put(hits, first + i, group.hit(i));
  }
  return Status::ok;
}

Status query_one(QueryState* state, const ShapeRay& ray, const Filter& filter, SceneHit& hit,
                 bool any) {
  const Status status = check(state, ray);
  return status == Status::ok ? query_ray(*state, ray, filter, any, hit) : status;
}

/// Writes all hits of valid rays into the state's `hits`, and where the hits of each ray begin.
Status query_all(QueryState& state, const ShapeRayBatch& rays, const Filter& filter) {
  Column<std::size_t>& first = state.hits_first;
  state.hits.clear();
  if (!first.resize(rays.count + 1)) return Status::out_of_memory;
  first[0] = 0;
  RaysTogether group(state, filter);
  for (std::size_t i = 0; i < rays.count; i += kRaysAtOnce) {
    const std::size_t end = std::min(rays.count, i + kRaysAtOnce);
    bool has_crowd = false;
    Status status = group.list_few(rays, i, end - i, has_crowd);
    if (status != Status::ok) return status;
    const RayHit* next = state.few.begin();
    for (std::size_t k = i; k < end; ++k) {
      for (; next != state.few.end() && next->ray == k; ++next) {
        if (!state.hits.push_back(group.shown(k - i, next->at))) return Status::out_of_memory;
      }
      if (has_crowd) {
        const ShapeRay ray = rays[k];
        const RayCast linear_cast(state.scene.shapes, ray);
        status = CastQuery(state, linear_cast, filter).all_in_crowds(first[k]);
        if (status != Status::ok) return status;
      } else {
        order_hits(state.hits, first[k]);
      }
      first[k + 1] = state.hits.size();
    }
  }
  return Status::ok;
}

Status check(const QueryState* state, const ShapeCast& cast, double tolerance) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) {
    return status;
  }
  if (!state->parts.contains(cast.shape)) return Status::invalid_key;
  if (!cast.shape.is_composite() && cast.shape.kind() == ShapeKind::half_space) {
    return Status::unsupported;
  }
  if (!cast.pose.is_valid()) return Status::invalid_pose;
  const bool valid = is_valid(cast.direction, cast.max_t) && tolerance >= 0.0 &&
                     tolerance <= std::numeric_limits<double>::max();
  return valid ? Status::ok : Status::invalid_argument;
}

/// Calls query(linear_cast) for the cast.
template <typename Query>
Status query_cast(QueryState* state, const ShapeCast& cast, double tolerance, Query&& query) {
  if (const Status status = check(state, cast, tolerance); status != Status::ok) return status;
  if (cast.shape.is_composite()) return query(CompositeCast(state->parts, cast, tolerance));
  return query(ConvexCast(state->parts, cast, tolerance));
}

}  // namespace

Status SceneQueries::closest(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  const DefaultFloatEnvironment environment;
  return query_one(state_, ray, filter, hit, false);
}

Status SceneQueries::any(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  const DefaultFloatEnvironment environment;
  return query_one(state_, ray, filter, hit, true);
}

Status SceneQueries::all(const ShapeRay& ray, std::span<const SceneHit>& hits,
                         const Filter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check(state_, ray); status != Status::ok) return status;
  const Status status = query_all_one_by_one(*state_, ray, filter);
  if (status == Status::ok) hits = {state_->hits.data(), state_->hits.size()};
  return status;
}

Status SceneQueries::closest(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                             const Filter& filter) {
  const DefaultFloatEnvironment environment;
  return query_each(state_, rays, filter, hits, false);
}

Status SceneQueries::any(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                         const Filter& filter) {
  const DefaultFloatEnvironment environment;
  return query_each(state_, rays, filter, hits, true);
}

Status SceneQueries::all(const ShapeRayBatch& rays, SceneHitLists& hits, const Filter& filter) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check(state_, rays); status != Status::ok) return status;
  const Status status = query_all(*state_, rays, filter);
  if (status != Status::ok) return status;
  const Column<std::size_t>& first = state_->hits_first;
  hits = {{state_->hits.data(), state_->hits.size()}, {first.data(), first.size()}};
  return Status::ok;
}

Status SceneQueries::closest(const ShapeCast& cast, SceneHit& hit, const Filter& filter,
                             double tolerance) {
  const DefaultFloatEnvironment environment;
  return query_cast(state_, cast, tolerance, [&](const LinearCast& linear_cast) {
    return CastQuery(*state_, linear_cast, filter).closest(hit);
  });
}

Status SceneQueries::all(const ShapeCast& cast, std::span<const SceneHit>& hits,
                         const Filter& filter, double tolerance) {
  const DefaultFloatEnvironment environment;
  const Status status = query_cast(state_, cast, tolerance, [&](const LinearCast& linear_cast) {
    state_->hits.clear();
    return CastQuery(*state_, linear_cast, filter).all();
  });
  if (status == Status::ok) hits = {state_->hits.data(), state_->hits.size()};
  return status;
}

}  // namespace winnow
