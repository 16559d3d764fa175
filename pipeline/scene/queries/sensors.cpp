// Sensors: finds the bodies that overlap each sensor, on several threads, and compares them with
// the last call to report events.

#include <winnow/pipeline/sensors.h>

#include "core/hooks/log.h"
#include "core/memory/key_table.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/scene_observer.h"

#include <algorithm>
#include <tuple>

namespace winnow {
namespace {

constexpr std::size_t kMaxSensors = std::size_t{1} << 28U;
/// Minimum number of sensors for each thread.
constexpr std::size_t kSensorsPerWatch = 64;

template <typename Entry>
[[nodiscard]] auto order_in(const Entry& entry) noexcept {
  return std::tuple(entry.sensor.id, entry.body.id);
}

[[nodiscard]] bool is_same(const SensedBody& a, const SensedBody& b) noexcept {
  return a.sensor == b.sensor && a.body == b.body;
}

/// Returns a filter for the bodies that the sensor detects.
[[nodiscard]] SceneFilter filter_of(const SensorDefinition& sensor) noexcept {
  return {.layers = sensor.filter.layers,
          .mask = sensor.filter.mask,
          .environment = sensor.filter.environment,
          .layer = sensor.layer,
          .ignored = sensor.carrier};
}

}  // namespace

struct SensorsState {
  SensorsState(SceneState* scene, std::pmr::memory_resource* memory) noexcept
      : bodies(scene),
        observer(scene == nullptr ? nullptr : scene->observer),
        number(observer == nullptr ? 0 : observer->make_sensors()),
        keys(memory),
        sensors(memory),
        sensed(memory),
        before(memory),
        left(memory),
        watches(memory) {}
  ~SensorsState() {
    drop_watches();
    if (observer != nullptr) observer->end_sensors(number);
  }
  SensorsState(const SensorsState&) = delete;
  SensorsState& operator=(const SensorsState&) = delete;

  /// A thread's state of queries and the bodies that it found.
  struct Watch {
    Watch(const SceneState& scene, std::pmr::memory_resource* memory) noexcept
        : query(scene, memory), sensed(memory) {}

    QueryState query;
    Column<SensedBody> sensed;
    Status status = Status::ok;
  };

  /// Null if the scene has no memory.
  SceneState* bodies;
  /// Null if the scene is not recorded.
  SceneObserver* observer;
  /// Number of this object in the recording.
  std::uint32_t number;
  KeyTable keys;
  /// By id; with holes for removed sensors.
  Column<SensorDefinition> sensors;
  Column<SensedBody> sensed;
  Column<SensedBody> before;
  Column<ExitedBody> left;
  /// One for each thread in use so far.
  Column<Watch*> watches;

  [[nodiscard]] Status check(const SensorDefinition& sensor) const noexcept {
    if (bodies == nullptr) return Status::out_of_memory;
    const Status status = bodies->check(sensor.shape, sensor.pose);
    const bool has_layer = sensor.layer < kSceneLayers || sensor.layer == kEveryLayer;
    return status != Status::ok || has_layer ? status : Status::invalid_argument;
  }
  [[nodiscard]] Status find_sensed();
  [[nodiscard]] bool have_watches(std::size_t count) noexcept;
  [[nodiscard]] Status find_sensed(ObjectId first, ObjectId end, Watch& watch) const;
  [[nodiscard]] Status take_all(std::size_t count) noexcept;
  [[nodiscard]] bool compare() noexcept;
  /// Clears all results and frees the query objects, after a failed allocation.
  void forget() noexcept {
    sensed.clear();
    before.clear();
    left.clear();
    drop_watches();
  }
  void drop_watches() noexcept {
    for (Watch* const watch : watches) delete_in(watches.memory(), watch);
    watches.clear();
  }
};

bool SensorsState::have_watches(std::size_t count) noexcept {
  while (watches.size() < count) {
    if (!watches.grow(watches.size() + 1)) return false;
    auto* const watch = new_in<Watch>(watches.memory(), *bodies, watches.memory());
    if (watch == nullptr) return false;
    (void)watches.push_back(watch);
  }
  return true;
}

/// Fills `sensed`. Each thread tests consecutive sensors, so that the results are in order.
Status SensorsState::find_sensed() {
  if (bodies == nullptr) return Status::out_of_memory;
  if (const Status status = bodies->refresh(); status != Status::ok) return status;
  const Execution& execution = bodies->options.execution;
  const std::size_t slots = keys.slot_count();
  const std::size_t count =
      std::clamp(slots / kSensorsPerWatch, std::size_t{1}, execution.concurrency());
  if (!have_watches(count)) return Status::out_of_memory;
  const auto part = [&](std::size_t i) { return static_cast<ObjectId>(slots * i / count); };
  execution.for_each(count, [&](std::size_t i) {
    watches[i]->status = find_sensed(part(i), part(i + 1), *watches[i]);
  });
  return take_all(count);
}

Status SensorsState::find_sensed(ObjectId first, ObjectId end, Watch& watch) const {
  watch.sensed.clear();
  for (ObjectId id = first; id < end; ++id) {
    if (!keys.is_live(id)) continue;
    const SensorDefinition& sensor = sensors[id];
    const auto found = find_overlaps(watch.query, sensor.shape, sensor.pose, filter_of(sensor));
    if (found.status != Status::ok) return found.status;
    for (const SceneOverlap& body : found) {
      if (!watch.sensed.push_back({keys.key_of(id), body.key, sensor.data, body.data})) {
        return Status::out_of_memory;
      }
    }
  }
  return Status::ok;
}

Status SensorsState::take_all(std::size_t count) noexcept {
  std::size_t all = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (watches[i]->status != Status::ok) return watches[i]->status;
    all += watches[i]->sensed.size();
  }
  if (!sensed.grow(all)) return Status::out_of_memory;
  for (std::size_t i = 0; i < count; ++i) {
    const Column<SensedBody>& of_one = watches[i]->sensed;
    std::copy(of_one.begin(), of_one.end(), sensed.end());
    sensed.set_size(sensed.size() + of_one.size());
  }
  return Status::ok;
}

/// Sets events by comparison with the last call. Keys are compared, because an id may belong to
/// another body now.
bool SensorsState::compare() noexcept {
  left.clear();
  SensedBody* now = sensed.begin();
  for (const SensedBody& old : before) {
    while (now != sensed.end() && order_in(*now) < order_in(old)) ++now;
    if (now != sensed.end() && is_same(*now, old)) {
      now->event = ContactEvent::persisted;
    } else if (!left.push_back({old.sensor, old.body, old.sensor_data, old.body_data})) {
      return false;
    }
  }
  return true;
}

Sensors::Sensors(Scene& scene, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(new_in<SensorsState>(memory, scene.state_, memory)) {}

Sensors::~Sensors() {
  delete_in(memory_, state_);
}

Answer<Key> Sensors::add(const SensorDefinition& sensor) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Sensors::add");
  SensorsState& s = *state_;
  if (const Status good = s.check(sensor); good != Status::ok) return logged(good, "Sensors::add");
  if (s.keys.slots_with(1) > kMaxSensors) return logged(Status::too_many_objects, "Sensors::add");
  const std::size_t slots = s.keys.slots_with(1);
  if (!s.keys.reserve(s.keys.size() + 1) || !s.sensors.grow(slots)) {
    return logged(Status::out_of_memory, "Sensors::add");
  }
  s.sensors.set_size(slots);
  const Key key = s.keys.acquire(0, sensor.data);
  s.sensors[key.id] = sensor;
  if (s.observer != nullptr) s.observer->add_sensor(s.number, key, sensor);
  return key;
}

Status Sensors::remove(Key key) {
  if (!contains(key)) return logged(Status::invalid_key, "Sensors::remove");
  state_->keys.release(key.id);
  if (state_->observer != nullptr) state_->observer->remove_sensor(state_->number, key);
  return Status::ok;
}

Status Sensors::move(Key key, const Pose& pose) {
  const DefaultFloatEnvironment environment;
  if (!contains(key)) return logged(Status::invalid_key, "Sensors::move");
  if (!pose.is_valid()) return logged(Status::invalid_pose, "Sensors::move");
  state_->sensors[key.id].pose = pose;
  if (state_->observer != nullptr) state_->observer->move_sensor(state_->number, key, pose);
  return Status::ok;
}

Status Sensors::set(Key key, const SensorDefinition& sensor) {
  const DefaultFloatEnvironment environment;
  if (!contains(key)) return logged(Status::invalid_key, "Sensors::set");
  if (const Status good = state_->check(sensor); good != Status::ok) {
    return logged(good, "Sensors::set");
  }
  state_->sensors[key.id] = sensor;
  if (state_->observer != nullptr) state_->observer->set_sensor(state_->number, key, sensor);
  return Status::ok;
}

Answer<SensorDefinition> Sensors::sensor(Key key) const noexcept {
  if (!contains(key)) return Status::invalid_key;
  return state_->sensors[key.id];
}

Status Sensors::sense() {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Sensors::sense");
  SensorsState& s = *state_;
  s.sensed.swap(s.before);
  s.sensed.clear();
  Status status = s.find_sensed();
  if (status == Status::ok && !s.compare()) status = Status::out_of_memory;
  if (status == Status::out_of_memory) {
    s.forget();
  } else if (status != Status::ok) {
    s.sensed.swap(s.before);
  }
  if (status == Status::ok && s.observer != nullptr) s.observer->sense(s.number, *this);
  return logged(status, "Sensors::sense");
}

std::span<const SensedBody> Sensors::sensed() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->sensed.data(), state_->sensed.size()};
}

std::span<const ExitedBody> Sensors::left() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->left.data(), state_->left.size()};
}

std::size_t Sensors::size() const noexcept {
  return state_ != nullptr ? state_->keys.size() : 0;
}

bool Sensors::contains(Key key) const noexcept {
  return state_ != nullptr && state_->keys.is_valid(key);
}

Footprint Sensors::footprint() const noexcept {
  if (state_ == nullptr) return {};
  const SensorsState& s = *state_;
  Footprint sum;
  for (const SensorsState::Watch* const watch : s.watches) {
    sum.scratch += watch->query.footprint().total();
    sum.scratch += {sizeof(*watch), sizeof(*watch)};
    sum.scratch += watch->sensed.bytes();
  }
  sum.scratch += s.watches.bytes();
  sum.structure += {sizeof(SensorsState), sizeof(SensorsState)};
  sum.structure += s.sensors.bytes();
  sum.keys += s.keys.key_bytes();
  sum.client_data += s.keys.client_data_bytes();
  sum.scratch += s.before.bytes();
  sum.results += s.sensed.bytes();
  sum.results += s.left.bytes();
  return sum;
}

}  // namespace winnow
