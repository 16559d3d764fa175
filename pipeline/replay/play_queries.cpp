// Plays scene queries.

#include "pipeline/recording/query_digest.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {
namespace {

/// Bytes of a ray without min_t.
constexpr std::size_t kRayBytes = 7 * sizeof(double);

/// The columns that the program requested for the results of a batch of rays.
class RequestedColumns {
 public:
  explicit RequestedColumns(std::pmr::memory_resource* memory) noexcept
      : keys_(memory), data_(memory), part_(memory), numbers_(memory) {}

  /// False if memory is refused.
  [[nodiscard]] bool resize(std::size_t rays) noexcept {
    rays_ = rays;
    return keys_.resize(rays) && data_.resize(rays) && part_.resize(rays) &&
           numbers_.resize(kNumbers * rays);
  }
  [[nodiscard]] SceneHitColumns columns(std::uint16_t which) noexcept {
    const auto has = [&](unsigned bit) { return (which >> bit & 1U) != 0; };
    const auto number = [&](unsigned i) {
      return has(3 + i) ? numbers_.data() + i * rays_ : nullptr;
    };
    return {has(0) ? keys_.data() : nullptr,   has(1) ? data_.data() : nullptr,
            has(2) ? part_.data() : nullptr,   number(0),
            {number(1), number(2), number(3)}, {number(4), number(5), number(6)}};
  }

 private:
  static constexpr std::size_t kNumbers = 7;

  std::size_t rays_ = 0;
  Column<Key> keys_;
  Column<ClientData> data_;
  Column<std::uint32_t> part_;
  Column<double> numbers_;
};

/// Rays of recordings before version 5 have no min_t.
void read(ByteReader& in, bool with_min_t, ShapeRay& ray) noexcept {
  (void)in.get_bytes(&ray.origin, sizeof ray.origin);
  (void)in.get_bytes(&ray.direction, sizeof ray.direction);
  ray.min_t = with_min_t ? in.get<double>() : 0.0;
  ray.max_t = in.get<double>();
}

/// Reads the form of rays. `with_min_t` is set to whether they have a min_t. Returns an
/// invalid form if it is not one of rays.
[[nodiscard]] HitForm read_ray_form(ByteReader& in, bool& with_min_t) noexcept {
  const auto form = in.get_enum(HitForm::all_with_min_t);
  with_min_t = form >= HitForm::closest_with_min_t;
  switch (form) {
    case HitForm::closest_with_min_t:
      return HitForm::closest;
    case HitForm::any_with_min_t:
      return HitForm::any;
    case HitForm::all_with_min_t:
      return HitForm::all;
    default:
      return form;
  }
}

void read(ByteReader& in, ShapeCast& cast) noexcept {
  (void)in.get_bytes(&cast.pose, sizeof cast.pose);
  (void)in.get_bytes(&cast.direction, sizeof cast.direction);
  cast.max_t = in.get<double>();
}

void read(ByteReader& in, MotionCast& cast) noexcept {
  (void)in.get_bytes(&cast.motion, sizeof cast.motion);
}

Status query_ray(ReplayState& replay, ReplayedWorld& of) {
  bool with_min_t = false;
  const HitForm form = read_ray_form(replay.in, with_min_t);
  if (form > HitForm::all) return Status::invalid_argument;
  ShapeRay ray;
  read(replay.in, with_min_t, ray);
  if (!replay.read_query_filter()) return status_of(replay.in);
  if (form == HitForm::all) {
    return replay.compare_if(of.queries->all(ray, replay.filter.scene_filter()));
  }
  return replay.compare_if(form == HitForm::any
                               ? of.queries->any(ray, replay.filter.scene_filter())
                               : of.queries->closest(ray, replay.filter.scene_filter()));
}

Status query_rays(ReplayState& replay, ReplayedWorld& of) {
  bool with_min_t = false;
  const HitForm form = read_ray_form(replay.in, with_min_t);
  if (form > HitForm::all) return Status::invalid_argument;
  const auto which = replay.in.get<std::uint16_t>();
  const auto count = replay.in.get<std::uint64_t>();
  if (!replay.in.ok() || count > replay.in.rest().size() / kRayBytes)
    return Status::invalid_argument;
  if (!replay.shape_rays.resize(static_cast<std::size_t>(count))) return Status::out_of_memory;
  for (ShapeRay& ray : replay.shape_rays) read(replay.in, with_min_t, ray);
  if (!replay.read_query_filter()) return status_of(replay.in);
  const ShapeRayBatch batch(
      std::span<const ShapeRay>(replay.shape_rays.data(), replay.shape_rays.size()));
  if (form == HitForm::all) {
    return replay.compare_if(of.queries->all(batch, replay.filter.scene_filter()));
  }
  RequestedColumns requested(replay.options.memory);
  if (!requested.resize(batch.count)) return Status::out_of_memory;
  const SceneHitColumns hits = requested.columns(which);
  const Status answered = form == HitForm::any
                              ? of.queries->any(batch, hits, replay.filter.scene_filter())
                              : of.queries->closest(batch, hits, replay.filter.scene_filter());
  return answered == Status::ok ? replay.compare(digest_of_columns(hits, batch.count)) : answered;
}

Status query_crossings(ReplayState& replay, ReplayedWorld& of) {
  ShapeRay ray;
  read(replay.in, true, ray);
  if (!replay.read_query_filter()) return status_of(replay.in);
  return replay.compare_if(of.queries->crossings(ray, replay.filter.scene_filter()));
}

Status query_distances(ReplayState& replay, ReplayedWorld& of) {
  ShapeId shape;
  Pose pose;
  if (!replay.read_shape(of, shape)) return status_of(replay.in);
  (void)replay.in.get_bytes(&pose, sizeof pose);
  const auto limit = replay.in.get<double>();
  if (!replay.read_query_filter()) return status_of(replay.in);
  return replay.compare_if(of.queries->distances(shape, pose, limit, replay.filter.scene_filter()));
}

Status query_overlap(ReplayState& replay, ReplayedWorld& of) {
  ShapeId shape;
  Pose pose;
  if (!replay.read_shape(of, shape)) return status_of(replay.in);
  (void)replay.in.get_bytes(&pose, sizeof pose);
  if (!replay.read_query_filter()) return status_of(replay.in);
  return replay.compare_if(of.queries->overlap(shape, pose, replay.filter.scene_filter()));
}

template <typename Moving>
Status query_cast(ReplayState& replay, ReplayedWorld& of) {
  const auto form = replay.in.get_enum(HitForm::all_from_touch);
  Moving cast;
  cast.touching = form < HitForm::closest_from_touch;
  if (!replay.read_shape(of, cast.shape)) return status_of(replay.in);
  const auto tolerance = replay.in.get<double>();
  read(replay.in, cast);
  if (!replay.read_query_filter()) return status_of(replay.in);
  if (form == HitForm::any) return Status::invalid_argument;
  if (form == HitForm::all || form == HitForm::all_from_touch) {
    return replay.compare_if(of.queries->all(cast, replay.filter.scene_filter(), tolerance));
  }
  return replay.compare_if(of.queries->closest(cast, replay.filter.scene_filter(), tolerance));
}

/// Plays a call of `any_contact`, for the whole scene or for two sets of bodies.
Status query_any_contact(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  const auto rules = replay.in.get_enum(PairRules::none);
  const auto contact_margin = replay.in.get<double>();
  if (call == RecordedCall::query_any_contact) {
    if (!replay.in.ok()) return status_of(replay.in);
    return replay.compare_if(of.queries->any_contact(contact_margin, rules));
  }
  if (!replay.read_sets(of)) return status_of(replay.in);
  return replay.compare_if(
      of.queries->any_contact(replay.first_set(), replay.second_set(), contact_margin, rules));
}

/// Plays calls of `distance`, `least_distance` and `overlaps`.
Status query_sets(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  const bool any_two = call == RecordedCall::query_distance ||
                       call == RecordedCall::query_least_distance ||
                       call == RecordedCall::query_overlaps;
  const PairRules rules = any_two ? PairRules::none : PairRules::scene;
  if (call == RecordedCall::query_distance || call == RecordedCall::query_distance_by_rules) {
    const Key a = of.scene->key_of(replay.in.get<ObjectId>());
    const Key b = of.scene->key_of(replay.in.get<ObjectId>());
    const auto limit = replay.in.get<double>();
    if (!replay.in.ok()) return status_of(replay.in);
    return replay.compare_if(of.queries->distance(a, b, limit, rules));
  }
  if (!replay.read_sets(of)) return status_of(replay.in);
  const std::span<const Key> first = replay.first_set();
  const std::span<const Key> second = replay.second_set();
  if (call == RecordedCall::query_least_distance ||
      call == RecordedCall::query_least_distance_by_rules) {
    const auto limit = replay.in.get<double>();
    if (!replay.in.ok()) return status_of(replay.in);
    return replay.compare_if(of.queries->least_distance(first, second, limit, rules));
  }
  const auto most = static_cast<std::size_t>(replay.in.get<std::uint64_t>());
  if (!replay.in.ok()) return status_of(replay.in);
  return replay.compare_if(of.queries->overlaps(first, second, most, rules));
}

Status query_nearest(ReplayState& replay, ReplayedWorld& of) {
  double point[3] = {};
  (void)replay.in.get_bytes(point, sizeof point);
  const auto count = static_cast<std::size_t>(replay.in.get<std::uint64_t>());
  const auto radius = replay.in.get<double>();
  if (!replay.read_query_filter()) return status_of(replay.in);
  return replay.compare_if(of.queries->nearest(point, count, radius, replay.filter.scene_filter()));
}

}  // namespace

Status query_scene(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  if (!of.queries) of.queries.emplace(*of.scene, replay.options.memory);
  switch (call) {
    case RecordedCall::query_ray:
      return query_ray(replay, of);
    case RecordedCall::query_rays:
      return query_rays(replay, of);
    case RecordedCall::query_crossings:
      return query_crossings(replay, of);
    case RecordedCall::query_distances:
      return query_distances(replay, of);
    case RecordedCall::query_overlap:
      return query_overlap(replay, of);
    case RecordedCall::query_shape_cast:
      return query_cast<ShapeCast>(replay, of);
    case RecordedCall::query_motion_cast:
      return query_cast<MotionCast>(replay, of);
    case RecordedCall::query_nearest:
      return query_nearest(replay, of);
    case RecordedCall::query_any_contact:
    case RecordedCall::query_any_contact_of_sets:
      return query_any_contact(replay, call, of);
    default:
      return query_sets(replay, call, of);
  }
}

}  // namespace winnow
