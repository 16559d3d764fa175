// RecordedQueries: forwards each query to SceneQueries, and writes successful queries with a digest
// of their results to the recording.

#include "pipeline/recording/predicate_log.h"
#include "pipeline/recording/query_digest.h"

namespace winnow {
namespace {

void put_ray(CallWriter& call, const ShapeRay& ray) {
  call.put_bytes(&ray.origin, sizeof ray.origin)
      .put_bytes(&ray.direction, sizeof ray.direction)
      .put(ray.max_t);
}

void put_rays(CallWriter& call, const ShapeRayBatch& rays) {
  call.put(std::uint64_t{rays.count});
  for (std::size_t i = 0; i < rays.count; ++i) put_ray(call, rays[i]);
}

void put_cast(CallWriter& call, const ShapeCast& cast) {
  call.put_bytes(&cast.pose, sizeof cast.pose)
      .put_bytes(&cast.direction, sizeof cast.direction)
      .put(cast.max_t);
}

void put_motion(CallWriter& call, const MotionCast& cast) {
  call.put_bytes(&cast.motion, sizeof cast.motion);
}

/// Form of a cast: with or without bodies that the shape touches at the start.
template <typename Cast>
[[nodiscard]] HitForm form_of(const Cast& cast, HitForm form) noexcept {
  if (cast.touching) return form;
  return form == HitForm::all ? HitForm::all_from_touch : HitForm::closest_from_touch;
}

/// These structs are written as arrays of double.
static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(RigidMotion) == 13 * sizeof(double));

}  // namespace

RecordedQueries::RecordedQueries(RecordedScene& scene, std::pmr::memory_resource* memory) noexcept
    : scene_(scene), queries_(scene.scene_, memory), passed_(memory) {}

/// Runs a query, and records it if it succeeds: write(call) writes the arguments and returns the
/// digest of the results. The filter follows the arguments.
template <typename Query, typename Write>
Status RecordedQueries::record(RecordedCall kind, const Filter& filter, Query&& query,
                               Write&& write) {
  AcceptedObjects passed(filter, passed_);
  const Status status = query(passed.filter());
  if (status != Status::ok) return status;
  if (!passed.is_complete()) scene_.stop_recording(Status::out_of_memory);
  CallWriter call(scene_.recorder_, kind, scene_.world_);
  const Digest digest = write(call);
  call.put_filter(filter);
  passed.put(call);
  call.put(digest.value());
  return status;
}

/// As `record`, for a query with a shape, which is recorded first if it is new. Calls
/// write(call, number of the shape).
template <typename Query, typename Write>
Status RecordedQueries::record_with(ShapeId shape, RecordedCall kind, const Filter& filter,
                                    Query&& query, Write&& write) {
  std::uint32_t number = 0;
  return record(
      kind, filter,
      [&](const Filter& wrapped) {
        const Status status = query(wrapped);
        if (status == Status::ok) number = number_of(shape);
        return status;
      },
      [&](CallWriter& call) { return write(call, number); });
}

std::uint32_t RecordedQueries::number_of(ShapeId shape) noexcept {
  if (scene_.recorder_ == nullptr) return 0;
  const Lock lock(scene_.recorder_->numbering);
  return scene_.number_of(shape);
}

// --- rays --------------------------------------------------------------------------------------

Status RecordedQueries::closest(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.closest(ray, hit, wrapped); },
      [&](CallWriter& call) {
        put_ray(call.put(HitForm::closest), ray);
        return digest_of_answers(hit);
      });
}

Status RecordedQueries::any(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.any(ray, hit, wrapped); },
      [&](CallWriter& call) {
        put_ray(call.put(HitForm::any), ray);
        return digest_of_answers(hit);
      });
}

Status RecordedQueries::all(const ShapeRay& ray, std::span<const SceneHit>& hits,
                            const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.all(ray, hits, wrapped); },
      [&](CallWriter& call) {
        put_ray(call.put(HitForm::all), ray);
        return digest_of_answers(hits);
      });
}

Status RecordedQueries::closest(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                                const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.closest(rays, hits, wrapped); },
      [&](CallWriter& call) {
        put_rays(call.put(HitForm::closest).put(columns_in(hits)), rays);
        return digest_of_columns(hits, rays.count);
      });
}

Status RecordedQueries::any(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                            const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.any(rays, hits, wrapped); },
      [&](CallWriter& call) {
        put_rays(call.put(HitForm::any).put(columns_in(hits)), rays);
        return digest_of_columns(hits, rays.count);
      });
}

Status RecordedQueries::all(const ShapeRayBatch& rays, SceneHitLists& hits, const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.all(rays, hits, wrapped); },
      [&](CallWriter& call) {
        put_rays(call.put(HitForm::all).put(columns_in({})), rays);
        return digest_of_answers(hits);
      });
}

// --- shapes ------------------------------------------------------------------------------------

Status RecordedQueries::overlap(ShapeId shape, const Pose& pose,
                                std::span<const SceneOverlap>& bodies, const Filter& filter) {
  return record_with(
      shape, RecordedCall::query_overlap, filter,
      [&](const Filter& wrapped) { return queries_.overlap(shape, pose, bodies, wrapped); },
      [&](CallWriter& call, std::uint32_t number) {
        call.put(number).put_bytes(&pose, sizeof pose);
        return digest_of_answers(bodies);
      });
}

Status RecordedQueries::closest(const ShapeCast& cast, SceneHit& hit, const Filter& filter,
                                double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_shape_cast, filter,
      [&](const Filter& wrapped) { return queries_.closest(cast, hit, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number) {
        put_cast(call.put(form_of(cast, HitForm::closest)).put(number).put(tolerance), cast);
        return digest_of_answers(hit);
      });
}

Status RecordedQueries::all(const ShapeCast& cast, std::span<const SceneHit>& hits,
                            const Filter& filter, double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_shape_cast, filter,
      [&](const Filter& wrapped) { return queries_.all(cast, hits, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number) {
        put_cast(call.put(form_of(cast, HitForm::all)).put(number).put(tolerance), cast);
        return digest_of_answers(hits);
      });
}

Status RecordedQueries::closest(const MotionCast& cast, SceneHit& hit, const Filter& filter,
                                double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_motion_cast, filter,
      [&](const Filter& wrapped) { return queries_.closest(cast, hit, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number) {
        put_motion(call.put(form_of(cast, HitForm::closest)).put(number).put(tolerance), cast);
        return digest_of_answers(hit);
      });
}

Status RecordedQueries::all(const MotionCast& cast, std::span<const SceneHit>& hits,
                            const Filter& filter, double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_motion_cast, filter,
      [&](const Filter& wrapped) { return queries_.all(cast, hits, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number) {
        put_motion(call.put(form_of(cast, HitForm::all)).put(number).put(tolerance), cast);
        return digest_of_answers(hits);
      });
}

// --- distances ---------------------------------------------------------------------------------

/// Returns the call to record. If the query used the rules of the scene, first records the pairs
/// that the scene's predicate accepted.
RecordedCall RecordedQueries::call_by_rules(PairRules rules, RecordedCall any_two,
                                            RecordedCall by_rules) noexcept {
  if (rules == PairRules::none) return any_two;
  scene_.record_passed_so_far();
  return by_rules;
}

Status RecordedQueries::distance(Key a, Key b, SceneDistance& answer, double limit,
                                 PairRules rules) {
  const Status status = queries_.distance(a, b, answer, limit, rules);
  if (status != Status::ok) return status;
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_distance, RecordedCall::query_distance_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put(a.id)
      .put(b.id)
      .put(limit)
      .put(digest_of_answers(answer).value());
  return status;
}

Status RecordedQueries::least_distance(std::span<const Key> a, std::span<const Key> b,
                                       SetDistance& answer, double limit, PairRules rules) {
  const Status status = queries_.least_distance(a, b, answer, limit, rules);
  if (status != Status::ok) return status;
  const RecordedCall call = call_by_rules(rules, RecordedCall::query_least_distance,
                                          RecordedCall::query_least_distance_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put_ids(a)
      .put_ids(b)
      .put(limit)
      .put(digest_of_answers(answer).value());
  return status;
}

Status RecordedQueries::overlaps(std::span<const Key> a, std::span<const Key> b,
                                 std::span<const KeyPair>& pairs, std::size_t most,
                                 PairRules rules) {
  const Status status = queries_.overlaps(a, b, pairs, most, rules);
  if (status != Status::ok) return status;
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_overlaps, RecordedCall::query_overlaps_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put_ids(a)
      .put_ids(b)
      .put(std::uint64_t{most})
      .put(digest_of_answers(pairs).value());
  return status;
}

Status RecordedQueries::any_contact(std::span<const Key> a, std::span<const Key> b, KeyPair& pair,
                                    double contact_margin, PairRules rules) {
  const Status status = queries_.any_contact(a, b, pair, contact_margin, rules);
  if (status != Status::ok) return status;
  const auto call = RecordedCall::query_any_contact_of_sets;
  CallWriter(scene_.recorder_, call_by_rules(rules, call, call), scene_.world_)
      .put(rules)
      .put(contact_margin)
      .put_ids(a)
      .put_ids(b)
      .put(digest_of_answers(pair).value());
  return status;
}

Status RecordedQueries::any_contact(KeyPair& pair, double contact_margin, PairRules rules) {
  const Status status = queries_.any_contact(pair, contact_margin, rules);
  if (status != Status::ok) return status;
  const auto call = RecordedCall::query_any_contact;
  CallWriter(scene_.recorder_, call_by_rules(rules, call, call), scene_.world_)
      .put(rules)
      .put(contact_margin)
      .put(digest_of_answers(pair).value());
  return status;
}

Status RecordedQueries::nearest(const Vec3d& point, std::size_t count, double radius,
                                std::span<const SceneDistance>& bodies, const Filter& filter) {
  return record(
      RecordedCall::query_nearest, filter,
      [&](const Filter& wrapped) {
        return queries_.nearest(point, count, radius, bodies, wrapped);
      },
      [&](CallWriter& call) {
        call.put_bytes(&point, 3 * sizeof(double)).put(std::uint64_t{count}).put(radius);
        return digest_of_answers(bodies);
      });
}

}  // namespace winnow
