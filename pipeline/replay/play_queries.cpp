// Plays scene queries.

#include "pipeline/recording/query_digest.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {
namespace {

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

void read(ByteReader& in, ShapeRay& ray) noexcept {
  (void)in.get_bytes(ray.origin, sizeof ray.origin);
  (void)in.get_bytes(ray.direction, sizeof ray.direction);
  ray.max_t = in.get<double>();
}

void read(ByteReader& in, ShapeCast& cast) noexcept {
  (void)in.get_bytes(&cast.pose, sizeof cast.pose);
  (void)in.get_bytes(cast.direction, sizeof cast.direction);
  cast.max_t = in.get<double>();
}

void read(ByteReader& in, MotionCast& cast) noexcept {
  (void)in.get_bytes(&cast.motion, sizeof cast.motion);
}

}  // namespace

/// Reads the filter at the end of a query; false if it is incomplete.
bool ReplayState::read_query_filter() noexcept {
  filter.read_filter(in);
  filter.read_passed_objects(in);
  return in.ok();
}

bool ReplayState::read_shape(const ReplayedWorld& of, ShapeId& id) noexcept {
  const auto number = in.get<std::uint32_t>();
  if (!in.ok() || number >= of.shape_ids.size()) return in.fail();
  id = of.shape_ids[number];
  return true;
}

Status ReplayState::query_scene(RecordedCall call, ReplayedWorld& of) {
  if (!of.queries) of.queries.emplace(*of.scene, options.memory);
  switch (call) {
    case RecordedCall::query_ray:
      return query_ray(of);
    case RecordedCall::query_rays:
      return query_rays(of);
    case RecordedCall::query_overlap:
      return query_overlap(of);
    case RecordedCall::query_shape_cast:
      return query_cast<ShapeCast>(of);
    case RecordedCall::query_motion_cast:
      return query_cast<MotionCast>(of);
    case RecordedCall::query_nearest:
      return query_nearest(of);
    case RecordedCall::query_any_contact:
    case RecordedCall::query_any_contact_of_sets:
      return query_any_contact(call, of);
    default:
      return query_sets(call, of);
  }
}

Status ReplayState::query_ray(ReplayedWorld& of) {
  const auto form = in.get_enum(HitForm::all);
  ShapeRay ray;
  read(in, ray);
  if (!read_query_filter()) return reading();
  if (form == HitForm::all) {
    std::span<const SceneHit> hits;
    const Status answered = of.queries->all(ray, hits, filter.filter());
    return answered == Status::ok ? compare(hits) : answered;
  }
  SceneHit hit;
  const Status answered = form == HitForm::any ? of.queries->any(ray, hit, filter.filter())
                                               : of.queries->closest(ray, hit, filter.filter());
  return answered == Status::ok ? compare(hit) : answered;
}

Status ReplayState::query_rays(ReplayedWorld& of) {
  const auto form = in.get_enum(HitForm::all);
  const auto which = in.get<std::uint16_t>();
  const auto count = in.get<std::uint64_t>();
  if (!in.ok() || count > in.rest().size() / sizeof(ShapeRay)) return Status::invalid_argument;
  if (!shape_rays.resize(static_cast<std::size_t>(count))) return Status::out_of_memory;
  for (ShapeRay& ray : shape_rays) read(in, ray);
  if (!read_query_filter()) return reading();
  const ShapeRayBatch batch(std::span<const ShapeRay>(shape_rays.data(), shape_rays.size()));
  if (form == HitForm::all) {
    SceneHitLists hits;
    const Status answered = of.queries->all(batch, hits, filter.filter());
    return answered == Status::ok ? compare(hits) : answered;
  }
  RequestedColumns requested(options.memory);
  if (!requested.resize(batch.count)) return Status::out_of_memory;
  const SceneHitColumns hits = requested.columns(which);
  const Status answered = form == HitForm::any ? of.queries->any(batch, hits, filter.filter())
                                               : of.queries->closest(batch, hits, filter.filter());
  return answered == Status::ok ? compare(digest_of_columns(hits, batch.count)) : answered;
}

Status ReplayState::query_overlap(ReplayedWorld& of) {
  ShapeId shape;
  Pose pose;
  if (!read_shape(of, shape)) return reading();
  (void)in.get_bytes(&pose, sizeof pose);
  if (!read_query_filter()) return reading();
  std::span<const SceneOverlap> found;
  const Status answered = of.queries->overlap(shape, pose, found, filter.filter());
  return answered == Status::ok ? compare(found) : answered;
}

template <typename Moving>
Status ReplayState::query_cast(ReplayedWorld& of) {
  const auto form = in.get_enum(HitForm::all_from_touch);
  Moving cast;
  cast.touching = form < HitForm::closest_from_touch;
  if (!read_shape(of, cast.shape)) return reading();
  const auto tolerance = in.get<double>();
  read(in, cast);
  if (!read_query_filter()) return reading();
  if (form == HitForm::any) return Status::invalid_argument;
  if (form == HitForm::all || form == HitForm::all_from_touch) {
    std::span<const SceneHit> hits;
    const Status answered = of.queries->all(cast, hits, filter.filter(), tolerance);
    return answered == Status::ok ? compare(hits) : answered;
  }
  SceneHit hit;
  const Status answered = of.queries->closest(cast, hit, filter.filter(), tolerance);
  return answered == Status::ok ? compare(hit) : answered;
}

/// Plays a call of `any_contact`, for the whole scene or for two sets of bodies.
Status ReplayState::query_any_contact(RecordedCall call, ReplayedWorld& of) {
  const auto rules = in.get_enum(PairRules::none);
  const auto contact_margin = in.get<double>();
  KeyPair pair;
  if (call == RecordedCall::query_any_contact) {
    if (!in.ok()) return reading();
    const Status answered = of.queries->any_contact(pair, contact_margin, rules);
    return answered == Status::ok ? compare(pair) : answered;
  }
  if (!read_sets(of)) return reading();
  const Status answered =
      of.queries->any_contact(first_set(), second_set(), pair, contact_margin, rules);
  return answered == Status::ok ? compare(pair) : answered;
}

bool ReplayState::read_sets(ReplayedWorld& of) {
  if (!read_keys(*of.scene)) return false;
  keys.swap(others);
  return read_keys(*of.scene);
}

/// Plays calls of `distance`, `least_distance` and `overlaps`.
Status ReplayState::query_sets(RecordedCall call, ReplayedWorld& of) {
  const bool any_two = call == RecordedCall::query_distance ||
                       call == RecordedCall::query_least_distance ||
                       call == RecordedCall::query_overlaps;
  const PairRules rules = any_two ? PairRules::none : PairRules::scene;
  if (call == RecordedCall::query_distance || call == RecordedCall::query_distance_by_rules) {
    const Key a = of.scene->key_of(in.get<ObjectId>());
    const Key b = of.scene->key_of(in.get<ObjectId>());
    const auto limit = in.get<double>();
    SceneDistance answer;
    if (!in.ok()) return reading();
    const Status answered = of.queries->distance(a, b, answer, limit, rules);
    return answered == Status::ok ? compare(answer) : answered;
  }
  if (!read_sets(of)) return reading();
  const std::span<const Key> first = first_set();
  const std::span<const Key> second = second_set();
  if (call == RecordedCall::query_least_distance ||
      call == RecordedCall::query_least_distance_by_rules) {
    const auto limit = in.get<double>();
    SetDistance answer;
    if (!in.ok()) return reading();
    const Status answered = of.queries->least_distance(first, second, answer, limit, rules);
    return answered == Status::ok ? compare(answer) : answered;
  }
  const auto most = static_cast<std::size_t>(in.get<std::uint64_t>());
  if (!in.ok()) return reading();
  std::span<const KeyPair> pairs;
  const Status answered = of.queries->overlaps(first, second, pairs, most, rules);
  return answered == Status::ok ? compare(pairs) : answered;
}

Status ReplayState::query_nearest(ReplayedWorld& of) {
  double point[3] = {};
  (void)in.get_bytes(point, sizeof point);
  const auto count = static_cast<std::size_t>(in.get<std::uint64_t>());
  const auto radius = in.get<double>();
  if (!read_query_filter()) return reading();
  std::span<const SceneDistance> found;
  const Status answered = of.queries->nearest(point, count, radius, found, filter.filter());
  return answered == Status::ok ? compare(found) : answered;
}

}  // namespace winnow
