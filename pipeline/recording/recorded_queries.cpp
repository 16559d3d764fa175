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

[[nodiscard]] Status status_of(Status status) noexcept {
  return status;
}
template <typename T>
[[nodiscard]] Status status_of(const Answer<T>& answer) noexcept {
  return answer.status;
}

/// These structs are written as arrays of double.
static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(RigidMotion) == 13 * sizeof(double));

}  // namespace

RecordedQueries::RecordedQueries(RecordedScene& scene, std::pmr::memory_resource* memory) noexcept
    : scene_(scene), queries_(scene.scene_, memory), passed_(memory) {}

/// Runs a query, and records it if it succeeds: write(call, answer) writes the arguments and
/// returns the digest of the answer. The filter follows the arguments.
template <typename Query, typename Write>
auto RecordedQueries::record(RecordedCall kind, const Filter& filter, Query&& query,
                             Write&& write) {
  AcceptedObjects passed(filter, passed_);
  const auto answer = query(passed.filter());
  if (status_of(answer) != Status::ok) return answer;
  if (!passed.is_complete()) scene_.stop_recording(Status::out_of_memory);
  CallWriter call(scene_.recorder_, kind, scene_.world_);
  const Digest digest = write(call, answer);
  call.put_filter(filter);
  passed.put(call);
  call.put(digest.value());
  return answer;
}

/// As `record`, for a query with a shape, which is recorded first if it is new. Calls
/// write(call, number of the shape, answer).
template <typename Query, typename Write>
auto RecordedQueries::record_with(ShapeId shape, RecordedCall kind, const Filter& filter,
                                  Query&& query, Write&& write) {
  std::uint32_t number = 0;
  return record(
      kind, filter,
      [&](const Filter& wrapped) {
        const auto answer = query(wrapped);
        if (answer.status == Status::ok) number = number_of(shape);
        return answer;
      },
      [&](CallWriter& call, const auto& answer) { return write(call, number, answer); });
}

std::uint32_t RecordedQueries::number_of(ShapeId shape) noexcept {
  if (scene_.recorder_ == nullptr) return 0;
  const Lock lock(scene_.recorder_->numbering);
  return scene_.number_of(shape);
}

// --- rays --------------------------------------------------------------------------------------

Answer<SceneHit> RecordedQueries::closest(const ShapeRay& ray, const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.closest(ray, wrapped); },
      [&](CallWriter& call, const auto& answer) {
        put_ray(call.put(HitForm::closest), ray);
        return digest_of_answers(answer);
      });
}

Answer<SceneHit> RecordedQueries::any(const ShapeRay& ray, const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.any(ray, wrapped); },
      [&](CallWriter& call, const auto& answer) {
        put_ray(call.put(HitForm::any), ray);
        return digest_of_answers(answer);
      });
}

Answer<std::span<const SceneHit>> RecordedQueries::all(const ShapeRay& ray, const Filter& filter) {
  return record(
      RecordedCall::query_ray, filter,
      [&](const Filter& wrapped) { return queries_.all(ray, wrapped); },
      [&](CallWriter& call, const auto& answer) {
        put_ray(call.put(HitForm::all), ray);
        return digest_of_answers(answer);
      });
}

Status RecordedQueries::closest(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                                const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.closest(rays, hits, wrapped); },
      [&](CallWriter& call, Status) {
        put_rays(call.put(HitForm::closest).put(columns_in(hits)), rays);
        return digest_of_columns(hits, rays.count);
      });
}

Status RecordedQueries::any(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                            const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.any(rays, hits, wrapped); },
      [&](CallWriter& call, Status) {
        put_rays(call.put(HitForm::any).put(columns_in(hits)), rays);
        return digest_of_columns(hits, rays.count);
      });
}

Answer<SceneHitLists> RecordedQueries::all(const ShapeRayBatch& rays, const Filter& filter) {
  return record(
      RecordedCall::query_rays, filter,
      [&](const Filter& wrapped) { return queries_.all(rays, wrapped); },
      [&](CallWriter& call, const auto& answer) {
        put_rays(call.put(HitForm::all).put(columns_in({})), rays);
        return digest_of_answers(answer);
      });
}

// --- shapes ------------------------------------------------------------------------------------

Answer<std::span<const SceneOverlap>> RecordedQueries::overlap(ShapeId shape, const Pose& pose,
                                                               const Filter& filter) {
  return record_with(
      shape, RecordedCall::query_overlap, filter,
      [&](const Filter& wrapped) { return queries_.overlap(shape, pose, wrapped); },
      [&](CallWriter& call, std::uint32_t number, const auto& answer) {
        call.put(number).put_bytes(&pose, sizeof pose);
        return digest_of_answers(answer);
      });
}

Answer<SceneHit> RecordedQueries::closest(const ShapeCast& cast, const Filter& filter,
                                          double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_shape_cast, filter,
      [&](const Filter& wrapped) { return queries_.closest(cast, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number, const auto& answer) {
        put_cast(call.put(form_of(cast, HitForm::closest)).put(number).put(tolerance), cast);
        return digest_of_answers(answer);
      });
}

Answer<std::span<const SceneHit>> RecordedQueries::all(const ShapeCast& cast, const Filter& filter,
                                                       double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_shape_cast, filter,
      [&](const Filter& wrapped) { return queries_.all(cast, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number, const auto& answer) {
        put_cast(call.put(form_of(cast, HitForm::all)).put(number).put(tolerance), cast);
        return digest_of_answers(answer);
      });
}

Answer<SceneHit> RecordedQueries::closest(const MotionCast& cast, const Filter& filter,
                                          double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_motion_cast, filter,
      [&](const Filter& wrapped) { return queries_.closest(cast, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number, const auto& answer) {
        put_motion(call.put(form_of(cast, HitForm::closest)).put(number).put(tolerance), cast);
        return digest_of_answers(answer);
      });
}

Answer<std::span<const SceneHit>> RecordedQueries::all(const MotionCast& cast, const Filter& filter,
                                                       double tolerance) {
  return record_with(
      cast.shape, RecordedCall::query_motion_cast, filter,
      [&](const Filter& wrapped) { return queries_.all(cast, wrapped, tolerance); },
      [&](CallWriter& call, std::uint32_t number, const auto& answer) {
        put_motion(call.put(form_of(cast, HitForm::all)).put(number).put(tolerance), cast);
        return digest_of_answers(answer);
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

Answer<SceneDistance> RecordedQueries::distance(Key a, Key b, double limit, PairRules rules) {
  const auto answer = queries_.distance(a, b, limit, rules);
  if (answer.status != Status::ok) return answer;
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_distance, RecordedCall::query_distance_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put(a.id)
      .put(b.id)
      .put(limit)
      .put(digest_of_answers(answer).value());
  return answer;
}

Answer<SetDistance> RecordedQueries::least_distance(std::span<const Key> a, std::span<const Key> b,
                                                    double limit, PairRules rules) {
  const auto answer = queries_.least_distance(a, b, limit, rules);
  if (answer.status != Status::ok) return answer;
  const RecordedCall call = call_by_rules(rules, RecordedCall::query_least_distance,
                                          RecordedCall::query_least_distance_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put_ids(a)
      .put_ids(b)
      .put(limit)
      .put(digest_of_answers(answer).value());
  return answer;
}

Answer<std::span<const KeyPair>> RecordedQueries::overlaps(std::span<const Key> a,
                                                           std::span<const Key> b, std::size_t most,
                                                           PairRules rules) {
  const auto answer = queries_.overlaps(a, b, most, rules);
  if (answer.status != Status::ok) return answer;
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_overlaps, RecordedCall::query_overlaps_by_rules);
  CallWriter(scene_.recorder_, call, scene_.world_)
      .put_ids(a)
      .put_ids(b)
      .put(std::uint64_t{most})
      .put(digest_of_answers(answer).value());
  return answer;
}

Answer<KeyPair> RecordedQueries::any_contact(std::span<const Key> a, std::span<const Key> b,
                                             double contact_margin, PairRules rules) {
  const auto answer = queries_.any_contact(a, b, contact_margin, rules);
  if (answer.status != Status::ok) return answer;
  const auto call = RecordedCall::query_any_contact_of_sets;
  CallWriter(scene_.recorder_, call_by_rules(rules, call, call), scene_.world_)
      .put(rules)
      .put(contact_margin)
      .put_ids(a)
      .put_ids(b)
      .put(digest_of_answers(answer).value());
  return answer;
}

Answer<KeyPair> RecordedQueries::any_contact(double contact_margin, PairRules rules) {
  const auto answer = queries_.any_contact(contact_margin, rules);
  if (answer.status != Status::ok) return answer;
  const auto call = RecordedCall::query_any_contact;
  CallWriter(scene_.recorder_, call_by_rules(rules, call, call), scene_.world_)
      .put(rules)
      .put(contact_margin)
      .put(digest_of_answers(answer).value());
  return answer;
}

Answer<std::span<const SceneDistance>> RecordedQueries::nearest(const Vec3d& point,
                                                                std::size_t count, double radius,
                                                                const Filter& filter) {
  return record(
      RecordedCall::query_nearest, filter,
      [&](const Filter& wrapped) { return queries_.nearest(point, count, radius, wrapped); },
      [&](CallWriter& call, const auto& answer) {
        call.put_bytes(&point, 3 * sizeof(double)).put(std::uint64_t{count}).put(radius);
        return digest_of_answers(answer);
      });
}

}  // namespace winnow
