// Scene::save_contacts and load_contacts: the contacts and the records for the next call. Keys of
// live bodies are saved as ids, so that loaded contacts refer to the bodies of the present scene,
// whatever keys these have.

#include <winnow/pipeline/scene.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kContactsMagic = "WINNOWCT";
constexpr std::uint32_t kContactsVersion = 2;

/// The saved form of a record.
struct SavedRecord {
  BodyPair pair;
  std::uint32_t code;
  std::uint32_t frame_index;
};

static_assert(sizeof(SavedRecord) == 16 && sizeof(EndedContact) == 32);

/// Calls visit(column) for all columns of a frame except runs, keys and parts, at any level, and
/// visit_parts(side) for parts.
template <typename Frame, typename Visit, typename VisitParts>
void visit_frame(Frame& frame, Visit&& visit, VisitParts&& visit_parts) {
  visit(frame.event);
  visit(frame.manifold_first);
  for (int side = 0; side < 2; ++side) visit_parts(side);
  visit(frame.distance);
  visit(frame.error_bound);
  for (auto& column : frame.normal) visit(column);
  for (auto& column : frame.point) visit(column);
  visit(frame.point_first);
  for (auto& column : frame.points.position) visit(column);
  visit(frame.points.depth);
  visit(frame.points.feature);
}

/// The counters of a scene that must be equal when its contacts are loaded.
[[nodiscard]] std::array<std::uint64_t, 4> scene_counters(const SceneState& scene) noexcept {
  return {scene.clock, scene.regroupings, scene.keys.slot_count(), scene.keys.size()};
}

/// Writes contacts into a snapshot.
class ContactsWriter {
 public:
  ContactsWriter(ByteWriter& out, const SceneState& scene) noexcept : out_(out), scene_(scene) {}

  void put(const ContactsState& contacts) noexcept {
    for (const std::uint64_t number : scene_counters(scene_)) out_.put(number);
    out_.put(contacts.level);
    out_.put(contacts.clock);
    out_.put(contacts.regroupings);
    out_.put(std::uint64_t{contacts.cached_count});
    put_frame(contacts.frame, contacts.known, contacts.records, contacts.cached);
    put_ended(contacts.ended);
    const bool sleeps = contacts.dormant_records.size() != 0;
    out_.put(sleeps);
    if (sleeps) {
      put_frame(contacts.dormant, contacts.known, contacts.dormant_records,
                contacts.dormant_cached);
    }
    put_column(contacts.history.pair);
    put_column(contacts.history.point);
    put_column(contacts.history.pose);
  }

 private:
  template <typename T>
  void put_column(const Column<T>& column) noexcept {
    out_.put_array(std::span<const T>(column.data(), column.size()));
  }
  /// Writes the stamp of a live key as 0, which no key has.
  void put_key(Key key) noexcept {
    out_.put(key.id);
    out_.put(scene_.keys.is_valid(key) ? 0U : key.stamp);
  }
  void put_frame(const ContactFrame& frame, const KnownBodies& known, const PairRecords& records,
                 const Column<CachedPair>& cached) noexcept {
    out_.put(std::uint64_t{frame.pairs()});
    for (const Column<Key>& keys : frame.key) {
      for (const Key key : keys) put_key(key);
    }
    for (const Column<Key>& keys : frame.key) {
      out_.put(std::uint64_t{keys.size()});
      for (const Key key : keys) out_.put(known.data[key.id]);
    }
    visit_frame(
        frame, [&](const auto& column) { put_column(column); },
        [&](int side) {
          out_.put(std::uint64_t{frame.manifolds});
          for (std::size_t m = 0; m < frame.manifolds; ++m) out_.put(frame.part_of(side, m));
        });
    out_.put(std::uint64_t{frame.runs.size()});
    for (const ContactRun& run : frame.runs) {
      out_.put(run.kind_a);
      out_.put(run.kind_b);
      out_.put(run.first);
      out_.put(run.count);
    }
    put_records(frame, records);
    out_.put(std::uint64_t{cached.size()});
    for (const CachedPair& one : cached) {
      out_.put_bytes(&one.relative, sizeof one.relative);
      out_.put_bytes(&one.turned_for, sizeof one.turned_for);
      out_.put(one.limit);
      out_.put(one.tested_at);
      out_.put(one.radius);
      out_.put(one.radius_a);
      out_.put(one.drift);
      out_.put(one.from_b);
      out_.put(one.widened);
    }
  }
  // Writes the records. Without stored records, each pair of the frame is its own record.
  void put_records(const ContactFrame& frame, const PairRecords& records) noexcept {
    const bool are_kept = records.size() != 0;
    out_.put(std::uint64_t{are_kept ? records.size() : frame.pairs()});
    for (std::size_t r = 0; r < records.size(); ++r) {
      put_record(records.order_of(r).bodies(), records.order_of(r).code(),
                 records.frame_index_of(r));
    }
    for (const ContactRun& run : std::span(frame.runs.data(), are_kept ? 0 : frame.runs.size())) {
      const std::uint32_t code = KindPairs::index(run.kind_a, run.kind_b);
      for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
        put_record({frame.key[0][i].id, frame.key[1][i].id}, code, i);
      }
    }
  }
  void put_record(const BodyPair& pair, std::uint32_t code, std::uint32_t frame_index) noexcept {
    for (const std::uint32_t number : {pair.a, pair.b, code, frame_index}) out_.put(number);
  }
  void put_ended(const Column<EndedContact>& ended) noexcept {
    out_.put(std::uint64_t{ended.size()});
    for (const EndedContact& one : ended) {
      put_key(one.a);
      put_key(one.b);
      out_.put(one.data_a);
      out_.put(one.data_b);
    }
  }

  ByteWriter& out_;
  const SceneState& scene_;
};

/// Reads contacts into an empty state. Checks every index and count, because the bytes are
/// untrusted.
class ContactsReader {
 public:
  ContactsReader(ByteReader& in, const SceneState& scene, ContactsState& contacts) noexcept
      : in_(in), scene_(scene), contacts_(contacts) {}

  [[nodiscard]] Status run() noexcept {
    for (const std::uint64_t number : scene_counters(scene_)) {
      if (in_.get<std::uint64_t>() != number) in_.fail();
    }
    contacts_.level = in_.get_enum(ContactLevel::manifold);
    contacts_.clock = in_.get<std::uint32_t>();
    contacts_.regroupings = in_.get<std::uint64_t>();
    contacts_.cached_count = static_cast<std::size_t>(in_.get<std::uint64_t>());
    uses_cache_ = scene_.options.cache_tolerance > 0.0 && contacts_.level >= ContactLevel::distance;
    const bool read =
        read_frame(contacts_.frame, contacts_.records, contacts_.cached) && read_ended() &&
        (!in_.get_bool() ||
         read_frame(contacts_.dormant, contacts_.dormant_records, contacts_.dormant_cached)) &&
        read_history();
    if (!read || !in_.rest().empty()) in_.fail();
    contacts_.scene = scene_.serial;
    // No serial of BodyPairs equals this, so the next call matches all pairs.
    contacts_.pairs_serial = ~std::uint64_t{0};
    return status_of(in_);
  }

 private:
  [[nodiscard]] Key get_key() noexcept {
    const auto id = in_.get<ObjectId>();
    const auto stamp = in_.get<std::uint32_t>();
    const bool lives = stamp == 0 && scene_.keys.is_live(id);
    if (id >= scene_.keys.slot_count() || (stamp == 0) != lives) in_.fail();
    return lives ? scene_.keys.key_of(id) : Key{id, stamp};
  }

  /// Resizes a column for elements of `bytes` bytes each; fails if the input is shorter.
  template <typename T>
  [[nodiscard]] bool make_room(Column<T>& column, std::uint64_t count, std::size_t bytes) noexcept {
    if (!in_.ok() || count > in_.rest().size() / bytes) return in_.fail();
    return column.resize(static_cast<std::size_t>(count)) || in_.refuse_memory();
  }

  [[nodiscard]] bool read_frame(ContactFrame& frame, PairRecords& records,
                                Column<CachedPair>& cached) noexcept {
    const auto pairs = in_.get<std::uint64_t>();
    for (Column<Key>& keys : frame.key) {
      if (!make_room(keys, pairs, sizeof(Key))) return false;
      for (Key& key : keys) key = get_key();
    }
    Column<ClientData> data[2] = {Column<ClientData>(frame.event.memory()),
                                  Column<ClientData>(frame.event.memory())};
    for (Column<ClientData>& of_side : data) {
      if (in_.get_array(of_side) && of_side.size() != frame.key[0].size()) in_.fail();
    }
    visit_frame(
        frame, [&](auto& column) { (void)in_.get_array(column); },
        [&](int side) { (void)in_.get_array(frame.part[side]); });
    frame.manifolds = frame.part[0].size();
    frame.with_parts = true;
    const auto runs = in_.get<std::uint64_t>();
    if (!make_room(frame.runs, runs, 10)) return false;
    for (ContactRun& run : frame.runs) {
      run.kind_a = in_.get<std::uint8_t>();
      run.kind_b = in_.get<std::uint8_t>();
      run.first = in_.get<std::uint32_t>();
      run.count = in_.get<std::uint32_t>();
    }
    Column<SavedRecord> saved(frame.event.memory());
    (void)in_.get_array(saved);
    if (!read_cached(cached)) return false;
    const bool good = has_good_columns(frame) && are_good(frame, saved) &&
                      cached.size() == (uses_cache_ ? saved.size() : 0);
    return good ? take(saved, frame, data, records) : in_.fail();
  }

  /// Stores the data after all checks.
  [[nodiscard]] bool take(const Column<SavedRecord>& saved, ContactFrame& frame,
                          const Column<ClientData> (&data)[2], PairRecords& records) noexcept {
    KnownBodies& known = contacts_.known;
    const std::size_t bodies = scene_.keys.slot_count();
    const std::size_t noted = known.stamp.size();
    if (!records.reserve(saved.size()) || !known.stamp.resize(bodies) ||
        !known.data.resize(bodies)) {
      return in_.refuse_memory();
    }
    std::fill(known.stamp.begin() + noted, known.stamp.end(), 0U);
    std::fill(known.data.begin() + noted, known.data.end(), ClientData{0});
    for (const SavedRecord& record : saved) {
      records.push_back_within_room(PairOrder::of(record.code, record.pair), record.frame_index);
    }
    for (int side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i < frame.pairs(); ++i) {
        const Key key = frame.key[side][i];
        known.stamp[key.id] = key.stamp;
        known.data[key.id] = data[side][i];
      }
    }
    if (scene_.options.composites == nullptr) {
      frame.with_parts = false;
      for (Column<std::uint32_t>& part : frame.part) part.release();
    }
    return true;
  }

  [[nodiscard]] bool read_cached(Column<CachedPair>& cached) noexcept {
    const auto count = in_.get<std::uint64_t>();
    if (!make_room(cached, count, sizeof(Pose))) return false;
    for (CachedPair& one : cached) {
      (void)in_.get_bytes(&one.relative, sizeof one.relative);
      (void)in_.get_bytes(&one.turned_for, sizeof one.turned_for);
      one.limit = in_.get<float>();
      one.tested_at = in_.get<std::uint32_t>();
      one.radius = in_.get<float>();
      one.radius_a = in_.get<float>();
      one.drift = in_.get<float>();
      one.from_b = in_.get_bool();
      one.widened = in_.get_bool();
    }
    return in_.ok();
  }

  /// True if `first` begins at 0, never decreases, and ends at `end`.
  [[nodiscard]] static bool leads(const Column<std::uint32_t>& first, std::size_t count,
                                  std::size_t end) noexcept {
    return first.size() == count + 1 && first[0] == 0 && first[count] == end &&
           std::is_sorted(first.begin(), first.end());
  }

  [[nodiscard]] bool has_good_columns(const ContactFrame& frame) const noexcept {
    const ContactLevel level = contacts_.level;
    const std::size_t pairs = frame.key[0].size();
    const std::size_t manifolds = frame.part[0].size();
    const std::size_t distances = level >= ContactLevel::distance ? manifolds : 0;
    const std::size_t places = level == ContactLevel::distance ? manifolds : 0;
    const std::size_t points = frame.points.depth.size();
    bool good = frame.event.size() == pairs && frame.part[1].size() == manifolds &&
                frame.distance.size() == distances && frame.error_bound.size() == distances &&
                frame.points.feature.size() == points;
    for (const auto& column : frame.normal) good = good && column.size() == distances;
    for (const auto& column : frame.point) good = good && column.size() == places;
    for (const auto& column : frame.points.position) good = good && column.size() == points;
    const bool events_valid =
        std::all_of(frame.event.begin(), frame.event.end(),
                    [](ContactEvent event) { return event <= ContactEvent::persisted; });
    if (!good || !events_valid) return false;
    if (level == ContactLevel::pairs) {
      return manifolds == 0 && points == 0 && frame.manifold_first.empty() &&
             frame.point_first.empty();
    }
    if (!leads(frame.manifold_first, pairs, manifolds)) return false;
    return level == ContactLevel::manifold ? leads(frame.point_first, manifolds, points)
                                           : points == 0 && frame.point_first.empty();
  }

  /// Checks that the runs of the returned frame cover all of its pairs, that records are sorted,
  /// and that each pair of the frame has exactly one record, with its bodies.
  [[nodiscard]] bool are_good(const ContactFrame& frame,
                              const Column<SavedRecord>& records) noexcept {
    std::size_t end = 0;
    for (const ContactRun& run : frame.runs) {
      if (run.first != end || run.kind_a >= kShapeKinds || run.kind_b >= kShapeKinds) {
        return false;
      }
      end += run.count;
    }
    if (&frame == &contacts_.frame && end != frame.pairs()) return false;
    const std::size_t bodies = scene_.keys.slot_count();
    const auto order = [](const SavedRecord& r) { return PairOrder::of(r.code, r.pair); };
    Column<std::uint8_t> seen(frame.event.memory());
    if (!seen.resize(frame.pairs())) return in_.refuse_memory();
    std::fill(seen.begin(), seen.end(), std::uint8_t{0});
    std::size_t in_contact = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const SavedRecord& record = records[i];
      const bool is_pair = record.code < KindPairs::kCount && record.pair.a < bodies &&
                           record.pair.b < bodies && record.pair.a != record.pair.b;
      if (!is_pair || (i > 0 && !(order(records[i - 1]) < order(record)))) return false;
      if (record.frame_index == kNoEntry) continue;
      if (record.frame_index >= frame.pairs() || seen[record.frame_index]++ != 0) return false;
      if (frame.key[0][record.frame_index].id != record.pair.a) return false;
      if (frame.key[1][record.frame_index].id != record.pair.b) return false;
      ++in_contact;
    }
    return in_contact == frame.pairs() && (uses_cache_ || in_contact == records.size());
  }

  [[nodiscard]] bool read_ended() noexcept {
    const auto count = in_.get<std::uint64_t>();
    if (!make_room(contacts_.ended, count, sizeof(EndedContact))) return false;
    for (EndedContact& one : contacts_.ended) {
      one.a = get_key();
      one.b = get_key();
      one.data_a = in_.get<ClientData>();
      one.data_b = in_.get<ClientData>();
    }
    return in_.ok();
  }

  [[nodiscard]] bool read_history() noexcept {
    ContactHistory& history = contacts_.history;
    (void)in_.get_array(history.pair);
    (void)in_.get_array(history.point);
    (void)in_.get_array(history.pose);
    const bool has_history = scene_.options.warm_start;
    const bool poses_valid = std::all_of(history.pose.begin(), history.pose.end(),
                                         [](const Pose& pose) { return pose.is_valid(); });
    return in_.ok() && poses_valid && history.pose.size() <= scene_.keys.slot_count() &&
           history.pair.size() == (has_history ? contacts_.frame.pairs() : 0) &&
           history.point.size() == (has_history ? contacts_.frame.points.size() : 0);
  }

  ByteReader& in_;
  const SceneState& scene_;
  ContactsState& contacts_;
  bool uses_cache_ = false;
};

}  // namespace

Status Scene::save_contacts(const Contacts& contacts, Column<std::byte>& out) const {
  Status status = Status::out_of_memory;
  if (state_ != nullptr && contacts.state_ != nullptr) {
    status = contacts.state_->scene != state_->serial
                 ? Status::invalid_key
                 : write_snapshot(out, kContactsMagic, kContactsVersion, [&](ByteWriter& writer) {
                     writer.put(kShapeKinds);
                     ContactsWriter(writer, *state_).put(*contacts.state_);
                   });
  }
  return logged(status, "Scene::save_contacts");
}

Status Scene::load_contacts(std::span<const std::byte> saved, Contacts& contacts) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::load_contacts");
  ByteReader in = open_snapshot(saved, kContactsMagic, kContactsVersion);
  if (in.get<std::uint32_t>() != kShapeKinds) in.fail();
  if (!in.ok()) return logged(status_of(in), "Scene::load_contacts");
  auto* fresh = new_in<ContactsState>(contacts.memory_, contacts.memory_);
  if (fresh == nullptr) return logged(Status::out_of_memory, "Scene::load_contacts");
  const Status status = ContactsReader(in, *state_, *fresh).run();
  if (status == Status::ok) std::swap(contacts.state_, fresh);
  delete_in(contacts.memory_, fresh);
  if (is_observed(status, state_))
    state_->observer->load_contacts(saved, contacts.state_->origin());
  return logged(status, "Scene::load_contacts");
}

}  // namespace winnow
