// Writes the queries of a scene with digests of their results to a recording.

#include "pipeline/recording/query_recording.h"

#include "pipeline/recording/query_digest.h"
#include "pipeline/scene/queries/observed_filter.h"

namespace winnow {
namespace {

/// These structs are written as arrays of double.
static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(RigidMotion) == 13 * sizeof(double));

void put_ray(CallWriter& call, const ShapeRay& ray) {
  call.put_bytes(&ray.origin, sizeof ray.origin)
      .put_bytes(&ray.direction, sizeof ray.direction)
      .put(ray.min_t)
      .put(ray.max_t);
}

[[nodiscard]] HitForm with_min_t(HitForm form) noexcept {
  if (form == HitForm::all) return HitForm::all_with_min_t;
  return form == HitForm::any ? HitForm::any_with_min_t : HitForm::closest_with_min_t;
}

void put_rays(CallWriter& call, const ShapeRayBatch& rays) {
  call.put(std::uint64_t{rays.count});
  for (std::size_t i = 0; i < rays.count; ++i) put_ray(call, rays[i]);
}

/// Form of a cast: with or without bodies that the shape touches at the start.
template <typename Cast>
[[nodiscard]] HitForm form_of(const Cast& cast, HitForm form) noexcept {
  if (cast.touching) return form;
  return form == HitForm::all ? HitForm::all_from_touch : HitForm::closest_from_touch;
}

[[nodiscard]] Digest digest_of(HitForm form, std::span<const SceneHit> hits) noexcept {
  return form == HitForm::all ? digest_of_answers(hits) : digest_of_answers(hits[0]);
}

}  // namespace

/// Writes the filter, the bodies that its predicate accepted, and the digest of the results.
void QueryRecording::put_end(CallWriter& call, ObservedFilter& filter,
                             const Digest& digest) noexcept {
  call.put_filter(filter.given().object());
  Column<ObjectId>* const accepted = filter.accepted();
  call.put(accepted != nullptr);
  if (accepted != nullptr) call.put_array(sorted_unique(*accepted));
  call.put(digest.value());
  if (!filter.is_complete()) call.give_up(Status::out_of_memory);
}

// --- rays --------------------------------------------------------------------------------------

void QueryRecording::ray(HitForm form, const ShapeRay& ray, ObservedFilter& filter,
                         std::span<const SceneHit> hits) noexcept {
  CallWriter call(recorder_, RecordedCall::query_ray, world_);
  put_ray(call.put(with_min_t(form)), ray);
  put_end(call, filter, digest_of(form, hits));
}

void QueryRecording::rays(HitForm form, const ShapeRayBatch& rays, ObservedFilter& filter,
                          const SceneHitColumns& hits) noexcept {
  CallWriter call(recorder_, RecordedCall::query_rays, world_);
  put_rays(call.put(with_min_t(form)).put(columns_in(hits)), rays);
  put_end(call, filter, digest_of_columns(hits, rays.count));
}

void QueryRecording::rays(const ShapeRayBatch& rays, ObservedFilter& filter,
                          const SceneHitLists& lists) noexcept {
  CallWriter call(recorder_, RecordedCall::query_rays, world_);
  put_rays(call.put(with_min_t(HitForm::all)).put(columns_in({})), rays);
  put_end(call, filter, digest_of_answers(lists));
}

void QueryRecording::crossings(const ShapeRay& ray, ObservedFilter& filter,
                               std::span<const SceneCrossing> points) noexcept {
  CallWriter call(recorder_, RecordedCall::query_crossings, world_);
  put_ray(call, ray);
  put_end(call, filter, digest_of_answers(points));
}

// --- shapes ------------------------------------------------------------------------------------

void QueryRecording::cast(HitForm form, const ShapeCast& cast, ObservedFilter& filter,
                          double tolerance, std::span<const SceneHit> hits) noexcept {
  const std::uint32_t shape = shapes_.number_in_query(cast.shape);
  CallWriter call(recorder_, RecordedCall::query_shape_cast, world_);
  call.put(form_of(cast, form))
      .put(shape)
      .put(tolerance)
      .put_bytes(&cast.pose, sizeof cast.pose)
      .put_bytes(&cast.direction, sizeof cast.direction)
      .put(cast.max_t);
  put_end(call, filter, digest_of(form, hits));
}

void QueryRecording::cast(HitForm form, const MotionCast& cast, ObservedFilter& filter,
                          double tolerance, std::span<const SceneHit> hits) noexcept {
  const std::uint32_t shape = shapes_.number_in_query(cast.shape);
  CallWriter call(recorder_, RecordedCall::query_motion_cast, world_);
  call.put(form_of(cast, form))
      .put(shape)
      .put(tolerance)
      .put_bytes(&cast.motion, sizeof cast.motion);
  put_end(call, filter, digest_of(form, hits));
}

void QueryRecording::overlap(ShapeId shape, const Pose& pose, ObservedFilter& filter,
                             std::span<const SceneOverlap> bodies) noexcept {
  const std::uint32_t number = shapes_.number_in_query(shape);
  CallWriter call(recorder_, RecordedCall::query_overlap, world_);
  call.put(number).put_bytes(&pose, sizeof pose);
  put_end(call, filter, digest_of_answers(bodies));
}

void QueryRecording::distances(ShapeId shape, const Pose& pose, double limit,
                               ObservedFilter& filter,
                               std::span<const SceneDistance> bodies) noexcept {
  const std::uint32_t number = shapes_.number_in_query(shape);
  CallWriter call(recorder_, RecordedCall::query_distances, world_);
  call.put(number).put_bytes(&pose, sizeof pose).put(limit);
  put_end(call, filter, digest_of_answers(bodies));
}

void QueryRecording::nearest(const Vec3d& point, std::size_t count, double radius,
                             ObservedFilter& filter,
                             std::span<const SceneDistance> bodies) noexcept {
  CallWriter call(recorder_, RecordedCall::query_nearest, world_);
  call.put_bytes(&point, 3 * sizeof(double)).put(std::uint64_t{count}).put(radius);
  put_end(call, filter, digest_of_answers(bodies));
}

// --- distances ---------------------------------------------------------------------------------

/// Returns the call to record. If the query used the rules of the scene, first records the pairs
/// that the scene's predicate accepted.
RecordedCall QueryRecording::call_by_rules(PairRules rules, RecordedCall any_two,
                                           RecordedCall by_rules) noexcept {
  if (rules == PairRules::none) return any_two;
  accepted_.write_so_far();
  return by_rules;
}

void QueryRecording::distance(Key a, Key b, double limit, PairRules rules,
                              const SceneDistance& answer) noexcept {
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_distance, RecordedCall::query_distance_by_rules);
  CallWriter(recorder_, call, world_)
      .put(a.id)
      .put(b.id)
      .put(limit)
      .put(digest_of_answers(answer).value());
}

void QueryRecording::least_distance(std::span<const Key> a, std::span<const Key> b, double limit,
                                    PairRules rules, const SetDistance& answer) noexcept {
  const RecordedCall call = call_by_rules(rules, RecordedCall::query_least_distance,
                                          RecordedCall::query_least_distance_by_rules);
  CallWriter(recorder_, call, world_)
      .put_ids(a)
      .put_ids(b)
      .put(limit)
      .put(digest_of_answers(answer).value());
}

void QueryRecording::overlaps(std::span<const Key> a, std::span<const Key> b, std::size_t most,
                              PairRules rules, std::span<const KeyPair> pairs) noexcept {
  const RecordedCall call =
      call_by_rules(rules, RecordedCall::query_overlaps, RecordedCall::query_overlaps_by_rules);
  CallWriter(recorder_, call, world_)
      .put_ids(a)
      .put_ids(b)
      .put(std::uint64_t{most})
      .put(digest_of_answers(pairs).value());
}

void QueryRecording::any_contact(std::span<const Key> a, std::span<const Key> b,
                                 double contact_margin, PairRules rules,
                                 const KeyPair& pair) noexcept {
  const auto call = RecordedCall::query_any_contact_of_sets;
  CallWriter(recorder_, call_by_rules(rules, call, call), world_)
      .put(rules)
      .put(contact_margin)
      .put_ids(a)
      .put_ids(b)
      .put(digest_of_answers(pair).value());
}

void QueryRecording::any_contact(double contact_margin, PairRules rules,
                                 const KeyPair& pair) noexcept {
  const auto call = RecordedCall::query_any_contact;
  CallWriter(recorder_, call_by_rules(rules, call, call), world_)
      .put(rules)
      .put(contact_margin)
      .put(digest_of_answers(pair).value());
}

}  // namespace winnow
