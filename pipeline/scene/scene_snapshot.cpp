// Scene::save and load: the bodies, and the boxes that each set's partition has. Loading reads into
// a second SceneState and swaps its columns in at the end, so that a failure changes nothing and
// pointers to the scene's state stay valid.

#include <winnow/pipeline/scene.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/memory/saved_keys.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/narrow/tier_number.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kSceneMagic = "WINNOWSC";
constexpr std::uint32_t kSceneVersion = 1;

/// Calls visit(column) for each per-body column.
template <typename State, typename Visit>
void visit_body_columns(State& scene, Visit&& visit) {
  visit(scene.shape);
  visit(scene.pose);
  visit(scene.body_state);
  visit(scene.moved_at);
  visit(scene.shaped_at);
  if (scene.options.cache_tolerance > 0.0) visit(scene.anchor);
  if (scene.offsets.any) visit(scene.offsets.column);
  if (scene.rules.with_layers) visit(scene.rules.layer);
}

void put_options(ByteWriter& out, const SceneOptions& options) noexcept {
  out.put(options.contact_margin);
  out.put(tier_number(options.tier));
  out.put(options.cache_tolerance);
  out.put(!options.part_manifolds);
  out.put(options.warm_start);
  out.put(options.suppress_ghost_contacts);
}

void read_options(ByteReader& in, SceneOptions& options) noexcept {
  options.contact_margin = in.get<double>();
  options.tier = read_tier(in);
  options.cache_tolerance = in.get<double>();
  options.part_manifolds = !in.get_bool();
  options.warm_start = in.get_bool();
  options.suppress_ghost_contacts = in.get_bool();
}

[[nodiscard]] bool sees_composites(const SceneState& scene) noexcept {
  return scene.options.composites == nullptr ||
         scene.options.composites->revision() == scene.composites_seen;
}

void put_clocks(ByteWriter& out, const SceneState& scene) noexcept {
  out.put_bytes(scene.origin.data(), 3 * sizeof(double));
  out.put(std::uint64_t{scene.boxes_since_sampling});
  out.put(scene.boxes_updated);
  out.put(scene.clock);
  out.put(scene.regroupings);
  out.put(sees_composites(scene));
}

void read_clocks(ByteReader& in, SceneState& scene) noexcept {
  (void)in.get_bytes(scene.origin.data(), 3 * sizeof(double));
  scene.boxes_since_sampling = static_cast<std::size_t>(in.get<std::uint64_t>());
  scene.boxes_updated = in.get<std::uint64_t>();
  scene.clock = in.get<std::uint32_t>();
  scene.regroupings = in.get<std::uint64_t>();
  // A loaded pool starts to count its revisions anew.
  const std::uint64_t revision =
      scene.options.composites != nullptr ? scene.options.composites->revision() : 0;
  scene.composites_seen = in.get_bool() ? revision : ~revision;
  if (!scene.origin.allFinite()) in.fail();
}

/// Writes the boxes of a set's partition, and its filters if any is not the default.
void put_set(ByteWriter& out, const SceneState& scene, BodyState which) noexcept {
  const SceneSet& set = scene.set(which);
  out.put_bytes(set.origin.data(), 3 * sizeof(double));
  bool filtered = false;
  const auto for_bodies = [&](auto&& visit) {
    for_live(scene.keys.stamps(), [&](ObjectId body) {
      if (scene.body_state[body] == which) visit(scene.place[body]);
    });
  };
  for_bodies([&](Key place) {
    const Aabb box = set.partition->bounds(place);
    const ObjectFilter filter = set.partition->filter(place);
    filtered = filtered || filter != ObjectFilter{};
    out.put_bytes(box.min.data(), 3 * sizeof(float));
    out.put_bytes(box.max.data(), 3 * sizeof(float));
  });
  out.put(filtered);
  if (!filtered) return;
  for_bodies([&](Key place) {
    const ObjectFilter filter = set.partition->filter(place);
    out.put_bytes(&filter, sizeof filter);
  });
}

void put_scene(ByteWriter& out, const SceneState& scene) noexcept {
  put_options(out, scene.options);
  put_keys(out, scene.keys);
  out.put(scene.offsets.any);
  out.put(scene.rules.with_layers);
  visit_body_columns(scene, [&](const auto& column) {
    for_live(scene.keys.stamps(),
             [&](ObjectId body) { out.put_bytes(&column[body], sizeof column[body]); });
  });
  put_clocks(out, scene);
  out.put_array(
      std::span<const std::uint32_t>(scene.stale.bodies.data(), scene.stale.bodies.size()));
  out.put_array(
      std::span<const std::uint64_t>(scene.rules.ignored.data(), scene.rules.ignored.size()));
  out.put_array(scene.rules.layers.words());
  for (const BodyState which : kAllBodyStates) put_set(out, scene, which);
}

/// Reads a scene into a state without bodies. Keys are read into a separate table, which is
/// restored last.
class SceneReader {
 public:
  SceneReader(ByteReader& in, SceneState& scene, ReadKeys& keys, const SavedNames* names) noexcept
      : in_(in), scene_(scene), keys_(keys), names_(names) {}

  [[nodiscard]] Status run() {
    if (!scene_.options_are_good) return Status::invalid_argument;
    keys_.read(in_);
    if (keys_.stamps.size() >= kMaxBodies) in_.fail();
    if (!in_.ok() || !read_columns()) return status_of(in_);
    read_clocks(in_, scene_);
    if (!read_stale() || !read_ignored() || !read_layers()) return status_of(in_);
    for (const BodyState which : kAllBodyStates) {
      if (const Status status = read_set(which); status != Status::ok) return status;
    }
    if (!in_.rest().empty()) in_.fail();
    return status_of(in_);
  }

 private:
  [[nodiscard]] bool is_live(std::uint64_t body) const noexcept {
    return body < keys_.stamps.size() && (keys_.stamps[static_cast<std::size_t>(body)] & 1U) != 0;
  }

  /// Elements of removed bodies get default values.
  [[nodiscard]] bool read_columns() {
    const std::size_t slots = keys_.stamps.size();
    Column<std::uint8_t> seen(scene_.options.memory);
    if (in_.get_bool() && !scene_.offsets.begin(scene_.shape.size(), scene_.shape.capacity()))
      return in_.refuse_memory();
    if (in_.get_bool() && !scene_.rules.begin_layers(scene_.shape.size(), scene_.shape.capacity()))
      return in_.refuse_memory();
    if (!scene_.reserve(slots) || !seen.resize(slots)) return in_.refuse_memory();
    if (!KeyTable::are_consistent(keys_.saved(), seen)) return in_.fail();
    visit_body_columns(scene_, [&](auto& column) {
      column.set_size(slots);
      std::fill(column.begin(), column.end(), std::remove_reference_t<decltype(column[0])>{});
      for_live(keys_.all_stamps(),
               [&](ObjectId body) { (void)in_.get_bytes(&column[body], sizeof column[body]); });
    });
    scene_.ball.set_size(slots);
    scene_.place.set_size(slots);
    std::fill(scene_.place.begin(), scene_.place.end(), Key{});
    scene_.stale.flag.set_size(slots);
    std::fill(scene_.stale.flag.begin(), scene_.stale.flag.end(), std::uint8_t{0});
    bool good = in_.ok();
    if (names_ != nullptr) {
      for_live(keys_.all_stamps(),
               [&](ObjectId body) { scene_.shape[body] = names_->now(scene_.shape[body]); });
    }
    for_live(keys_.all_stamps(), [&](ObjectId body) {
      good = good && scene_.body_state[body] <= BodyState::sleeping &&
             scene_.check(scene_.shape[body], scene_.pose[body]) == Status::ok &&
             (scene_.anchor.empty() || scene_.anchor[body].is_valid()) &&
             are_good(scene_.offsets.of(body)) && scene_.rules.layer_of(body) < kSceneLayers;
    });
    return good || in_.fail();
  }

  [[nodiscard]] bool read_stale() {
    Column<std::uint32_t> stale(scene_.options.memory);
    if (!in_.get_array(stale)) return false;
    for (const std::uint32_t body : stale) {
      if (!is_live(body) || scene_.stale.flag[body] != 0) return in_.fail();
      scene_.stale.mark(body);
    }
    return true;
  }

  [[nodiscard]] bool read_ignored() {
    const std::size_t slots = keys_.stamps.size();
    if (!in_.get_array(scene_.rules.ignored)) return false;
    if (scene_.rules.ignored.empty()) return true;
    if (!scene_.rules.ignores.resize(slots)) return in_.refuse_memory();
    std::fill(scene_.rules.ignores.begin(), scene_.rules.ignores.end(), std::uint8_t{0});
    std::uint64_t before = 0;
    for (const std::uint64_t pair : scene_.rules.ignored) {
      const auto first = static_cast<std::uint32_t>(pair >> 32U);
      const auto second = static_cast<std::uint32_t>(pair);
      const bool good = first < second && pair > before && is_live(first) && is_live(second);
      if (!good) return in_.fail();
      scene_.rules.ignores[first] = scene_.rules.ignores[second] = 1;
      before = pair;
    }
    return true;
  }

  [[nodiscard]] bool read_layers() {
    Column<std::uint64_t> words(scene_.options.memory);
    if (!in_.get_array(words)) return false;
    switch (scene_.rules.layers.restore({words.data(), words.size()})) {
      case LayerMatrix::Restored::good:
        return true;
      case LayerMatrix::Restored::out_of_memory:
        return in_.refuse_memory();
      case LayerMatrix::Restored::refused:
        break;
    }
    return in_.fail();
  }

  [[nodiscard]] Status read_set(BodyState which) {
    SceneSet& set = scene_.set(which);
    (void)in_.get_bytes(set.origin.data(), 3 * sizeof(double));
    if (!set.origin.allFinite()) in_.fail();
    const BoxRoom room(scene_.staged);
    scene_.staged.chosen.clear();
    bool has_room = true;
    for_live(keys_.all_stamps(), [&](ObjectId body) {
      if (scene_.body_state[body] == which)
        has_room = has_room && scene_.staged.chosen.push_back(body);
    });
    if (!has_room) return Status::out_of_memory;
    const std::size_t count = scene_.staged.chosen.size();
    if (count > in_.rest().size() / sizeof(PlainBox)) in_.fail();
    if (!in_.ok()) return status_of(in_);
    if (count == 0) return in_.get_bool() ? Status::invalid_argument : status_of(in_);
    if (!scene_.staged.boxes.resize(count)) return Status::out_of_memory;
    (void)in_.get_bytes(scene_.staged.boxes.data(), count * sizeof(PlainBox));
    scene_.set_balls({scene_.staged.chosen.data(), count}, set.origin);
    const Status placed = scene_.place_boxes(which, {scene_.staged.chosen.data(), count});
    return placed == Status::ok ? read_filters(set) : placed;
  }

  [[nodiscard]] Status read_filters(SceneSet& set) {
    if (!in_.get_bool()) return status_of(in_);
    for (const std::uint32_t body : scene_.staged.chosen) {
      ObjectFilter filter;
      if (!in_.get_bytes(&filter, sizeof filter)) return status_of(in_);
      if (filter == ObjectFilter{}) continue;
      const Status status = set.partition->set_filter(scene_.place[body], filter);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  }

  ByteReader& in_;
  SceneState& scene_;
  ReadKeys& keys_;
  const SavedNames* names_;
};

/// Keeps the present keys of the bodies in `kept` and gives new keys to all others.
void rename(ReadKeys& keys, const KeyTable& present, std::span<const ObjectId> kept) noexcept {
  // No key table has the tag of this stamp.
  constexpr std::uint32_t kRenamed = 1;
  for (std::uint32_t& stamp : keys.stamps) {
    if ((stamp & 1U) != 0) stamp = kRenamed;
  }
  const std::span<const std::uint32_t> now = present.stamps();
  for (const ObjectId id : kept) {
    if (id >= std::min(keys.stamps.size(), now.size())) continue;
    if ((keys.stamps[id] & now[id] & 1U) != 0) keys.stamps[id] = now[id];
  }
}

/// Moves the state that was read into the scene. The key table must have room.
void take_over(SceneState& scene, SceneState& read, const ReadKeys& keys) noexcept {
  scene.options = read.options;
  scene.options_are_good = true;
  scene.growth = read.growth;
  scene.keys.restore(keys.saved(), scene.keys);
  scene.shape.swap(read.shape);
  scene.pose.swap(read.pose);
  scene.body_state.swap(read.body_state);
  scene.place.swap(read.place);
  scene.moved_at.swap(read.moved_at);
  scene.shaped_at.swap(read.shaped_at);
  scene.anchor.swap(read.anchor);
  scene.ball.swap(read.ball);
  scene.offsets.column.swap(read.offsets.column);
  scene.offsets.any = read.offsets.any;
  scene.stale.bodies.swap(read.stale.bodies);
  scene.stale.flag.swap(read.stale.flag);
  scene.rules.swap_bodies(read.rules);
  for (std::size_t i = 0; i < kBodyStates; ++i) {
    SceneSet& set = scene.sets[i];
    std::swap(set.partition, read.sets[i].partition);
    set.body_of.swap(read.sets[i].body_of);
    set.origin = read.sets[i].origin;
    set.with_dynamic.clear();
    ++set.changes;
  }
  scene.pairs.clear();
  scene.origin = read.origin;
  scene.boxes_since_sampling = read.boxes_since_sampling;
  scene.boxes_updated = read.boxes_updated;
  // Contacts that were filled before do not match the new serial.
  scene.serial = read.serial;
  scene.clock = read.clock;
  scene.regroupings = read.regroupings;
  scene.composites_seen = read.composites_seen;
  scene.statistics = {};
}

}  // namespace

Status load_scene(SceneState& scene, std::span<const std::byte> saved, const SavedNames* names) {
  ByteReader in = open_snapshot(saved, kSceneMagic, kSceneVersion);
  if (in.get<std::uint32_t>() != kShapeKinds) in.fail();
  SceneOptions options = scene.options;
  read_options(in, options);
  if (!in.ok()) return status_of(in);
  auto* const read = new_in<SceneState>(options.memory, scene.shapes, options);
  if (read == nullptr) return Status::out_of_memory;
  ReadKeys keys(options.memory);
  Status status = SceneReader(in, *read, keys, names).run();
  if (status == Status::ok && !scene.keys.reserve_slots(keys.stamps.size())) {
    status = Status::out_of_memory;
  }
  if (names != nullptr) rename(keys, scene.keys, names->kept);
  if (status == Status::ok) take_over(scene, *read, keys);
  delete_in(options.memory, read);
  return status == Status::ok || status == Status::out_of_memory ? status
                                                                 : Status::invalid_argument;
}

Status Scene::save(Column<std::byte>& out) const {
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::save");
  const Status status = write_snapshot(out, kSceneMagic, kSceneVersion, [&](ByteWriter& writer) {
    writer.put(kShapeKinds);
    put_scene(writer, *state_);
  });
  return logged(status, "Scene::save");
}

Status Scene::load(std::span<const std::byte> saved) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::load");
  if (state_->observer != nullptr) state_->observer->before_load();
  const Status status = load_scene(*state_, saved, nullptr);
  if (is_observed(status, state_)) state_->observer->load(saved);
  return logged(status, "Scene::load");
}

}  // namespace winnow
