#pragma once

#include <winnow/core/export.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/scene_sweep.h>
#include <winnow/pipeline/sensors.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

struct RecorderState;
struct PassedPairs;
enum class RecordedCall : std::uint8_t;

/// Where a recording goes: a function that takes the next bytes and says whether it could. Called
/// by one thread at a time; it must not throw.
struct RecordingSink {
  bool (*write)(void* context, std::span<const std::byte> bytes) = nullptr;  ///< null: nowhere
  void* context = nullptr;                                                   ///< handed to `write`
};

/// Writes down what a program does with partitions and scenes, so that it can be played again
/// elsewhere (RecordingPlayer) and measured (`winnow advise FILE`). What is recorded is declared as
/// a RecordedPartition or RecordedScene, with the same calls:
///
///     winnow::Recorder recorder("run.winnow");
///     winnow::RecordedPartition partition(recorder, winnow::linear_bvh());
///     partition.insert(boxes, data, keys);
///     partition.self_pairs(pairs);
///     recorder.end_frame();
///
/// Partitions and scenes that are not declared so pay nothing. pipeline/CONTRACT.md has the format.
/// Calls that were refused are not recorded. Calls from several threads are recorded in the order
/// in which they end. Where anything goes wrong the recording ends, and the program goes on.
class WINNOW_API Recorder {
 public:
  /// Into a file, which is made or overwritten. `memory` must outlive the recorder.
  explicit Recorder(const char* path,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Wherever the sink takes it.
  explicit Recorder(const RecordingSink& sink,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Closes the recording; what it records must be gone by then.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Says that a frame of the program is over, and writes out what there is. Where a program tells
  /// no frames, tools take each question for all pairs or contacts for the end of one.
  void end_frame() noexcept;
  /// Writes the end; nothing is recorded from then on. What `status` answers.
  Status close() noexcept;

  /// `ok`; `out_of_memory`, also of the sink or the disk; `invalid_argument` for a file that cannot
  /// be opened; `unsupported` after a call that cannot be recorded, see RecordedScene.
  [[nodiscard]] Status status() const noexcept;
  /// Written so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Recorded so far.
  [[nodiscard]] std::uint64_t calls() const noexcept;

 private:
  friend class RecordedPartition;
  friend class RecordedQueries;
  friend class RecordedScene;

  std::pmr::memory_resource* memory_;
  /// Null where memory was refused.
  RecorderState* state_;
};

/// A Partition whose calls are recorded: see there for what each does. Its answers are those of the
/// partition; besides the questions a digest of each answer is written. Of a question with a
/// predicate what was found stands for what the predicate would say. A question whose buffer or
/// events hold the answer to an earlier one goes on from it where that is one of the last 16.
class WINNOW_API RecordedPartition {
 public:
  /// The recorder must outlive the partition.
  explicit RecordedPartition(Recorder& recorder, StructureKind structure,
                             const PartitionOptions& options = {}) noexcept;
  ~RecordedPartition();
  RecordedPartition(const RecordedPartition&) = delete;
  RecordedPartition& operator=(const RecordedPartition&) = delete;

  /// The partition itself, for everything that is not recorded: what it holds, how it stands.
  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// The same.
  [[nodiscard]] const Partition* operator->() const noexcept { return &partition_; }
  /// Not recorded: makes no difference to any answer.
  Status reserve(std::size_t objects, Pages pages = Pages::untouched) {
    return partition_.reserve(objects, pages);
  }

  /// As those of Partition.
  /// @{
  Status set_structure(StructureKind structure);
  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Status insert(const Aabb& box, ClientData data, Key& key);
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  Status update(std::span<const Key> keys, const BoxView& boxes);
  Status update(Key key, const Aabb& box);
  Status update(std::span<const Key> keys, const BoxView& boxes, const Entries& entries);
  Status update(std::span<const Key> keys, std::span<const Sphere> spheres);
  template <int K>
  Status update(std::span<const Key> keys, std::span<const Kdop<K>> kdops);
  Status remove(std::span<const Key> keys);
  Status remove(Key key);
  void clear() noexcept;
  void release_memory() noexcept;
  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  Status set_filter(Key key, const ObjectFilter& filter);
  Status refresh() const;
  Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const;
  Status self_pairs(PairBuffer& out, PairEvents& events, const PairOptions& options = {}) const;
  Status self_pairs(PairEvents& events, const PairOptions& options = {}) const;
  Status pairs_with(const RecordedPartition& other, PairBuffer& out,
                    const PairOptions& options = {}) const;
  Status closest(const Cast& cast, Hit& hit, const Filter& filter = {}) const;
  Status any(const Cast& cast, Hit& hit, const Filter& filter = {}) const;
  Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const;
  Status closest(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  Status any(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const;
  Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                 Order order = Order::fast) const;
  Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                 Order order = Order::fast) const;
  Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                 const Filter& filter = {}) const;
  /// @}

 private:
  void record(RecordedCall question, const RayBatch& rays, const HitColumns& hits,
              const Filter& filter) const;

  RecorderState* recorder_;
  std::uint32_t world_;
  Partition partition_;
  /// Number of the recorded question whose answer a buffer holds; 0 if it is none of the last ones.
  [[nodiscard]] std::uint64_t asked_as(const PairBuffer& out) const noexcept;
  void note_asked(const PairBuffer& out) const noexcept;

  /// What the last questions for pairs, of which question i stands at i % kAskedPairs, left in
  /// buffers.
  static constexpr std::size_t kAskedPairs = 16;
  mutable PairBuffer::Provenance asked_[kAskedPairs];
  mutable std::uint64_t questions_ = 0;
};

/// A shape that a recording has.
struct RecordedShape {
  ShapeId id;            ///< of the program's pools
  std::uint32_t number;  ///< by which the recording knows it
  std::uint64_t digest;  ///< of what it was then
  std::uint64_t form;    ///< of that part of it which no change in place changes
};

/// A Scene whose calls are recorded, with the shapes of its bodies: see there for what each does.
/// Composite shapes are recorded where the CompositePool was given that they are of, and what
/// changes them in place is with the next question. A body of one that is of another MidPhase,
/// one-sided or a solid, or that has a support function, and SceneOptions::seamless_floors end the
/// recording with `unsupported`. So does a question with contacts that this scene filled, but not
/// as its last answer: a scene is asked with one Contacts, which may be cleared, be another scene's
/// in between, or be loaded by `load_contacts`. Of a predicate it is recorded which pairs it let
/// pass. See RecordedQueries, RecordedSweep and RecordedSensors for what else a scene is asked.
class WINNOW_API RecordedScene {
 public:
  /// The recorder must outlive the scene.
  explicit RecordedScene(Recorder& recorder, const ShapePool& shapes,
                         const SceneOptions& options = {}) noexcept;
  /// The same with composite shapes, which take the place of `options.composites`.
  RecordedScene(Recorder& recorder, const ShapePool& shapes, const CompositePool& composites,
                const SceneOptions& options = {}) noexcept;
  ~RecordedScene();
  RecordedScene(const RecordedScene&) = delete;
  RecordedScene& operator=(const RecordedScene&) = delete;

  /// The scene itself, for everything that is not recorded: what it holds, its own SceneQueries.
  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  /// The same.
  [[nodiscard]] const Scene* operator->() const noexcept { return &scene_; }
  /// Not recorded: makes no difference to any answer.
  Status reserve(const SceneRoom& room, Pages pages = Pages::untouched) {
    return scene_.reserve(room, pages);
  }

  /// As those of Scene.
  /// @{
  Status add(const BodyDefinition& body, Key& key);
  Status add(std::span<const BodyDefinition> bodies, std::span<Key> keys);
  Status remove(Key key);
  Status remove(std::span<const Key> keys);
  void clear() noexcept;
  Status move(Key key, const Pose& pose);
  Status move(std::span<const Key> keys, const PoseView& poses);
  Status set_motion(Key key, Motion motion);
  Status set_motion(std::span<const Key> keys, Motion motion);
  Status set_shape(Key key, ShapeId shape);
  Status set_filter(Key key, const ObjectFilter& filter);
  Status set_offsets(Key key, const ContactOffsets& offsets);
  Status set_layer(Key key, std::uint16_t layer);
  Status set_layers_meet(std::uint16_t a, std::uint16_t b, bool meet = true);
  Status set_ignored(Key a, Key b, bool ignored = true);
  Status set_ignored(std::span<const KeyPair> pairs, bool ignored = true);
  void set_predicate(const PairPredicate& predicate) noexcept;
  Status refresh();
  Status collide(ContactLevel level, Contacts& contacts);
  Status load(std::span<const std::byte> saved);
  Status load_contacts(std::span<const std::byte> saved, Contacts& contacts);
  /// @}

 private:
  friend class RecordedQueries;
  friend class RecordedSensors;
  friend class RecordedSweep;
  RecordedScene(Recorder& recorder, const ShapePool& shapes, const SceneOptions& options,
                const CompositePool* composites) noexcept;
  /// Which question left what contacts hold, and of which pairs it was.
  using Asked = std::pair<std::uint32_t, std::uint64_t>;
  [[nodiscard]] static Asked asked_as(const Contacts& contacts) noexcept;
  [[nodiscard]] bool is_filled_by_this(const Contacts& contacts) const noexcept;

  [[nodiscard]] bool can_hold(ShapeId id) const noexcept;
  [[nodiscard]] RecordedShape* find_shape(ShapeId id) noexcept;
  [[nodiscard]] std::uint32_t number_of(ShapeId id) noexcept;
  void refuse(Status why) noexcept;
  void describe(RecordedShape& shape) const noexcept;
  void know(const RecordedShape& shape) noexcept;
  void record_shape(const RecordedShape& shape) noexcept;
  void record_composite(const RecordedShape& shape) noexcept;
  void follow_composites() noexcept;
  void record_passed() noexcept;
  void show_passed() noexcept;
  void forget_passed() noexcept;

  void record_offsets(Key key, const ContactOffsets& offsets) noexcept;
  void record_layer(Key key, std::uint16_t layer) noexcept;

  RecorderState* recorder_;
  std::uint32_t world_;
  const ShapePool& shapes_;
  const CompositePool* composites_;
  std::uint64_t composites_seen_;
  Scene scene_;
  /// By id, in the recorder's memory.
  Column<RecordedShape> known_;
  std::uint32_t shapes_recorded_ = 0;
  std::uint32_t sensors_recorded_ = 0;
  Asked asked_;
  /// Pairs that the predicate let pass, in the recorder's memory; null while there was none.
  PassedPairs* passed_ = nullptr;
};

/// SceneQueries whose questions are recorded: see there for what each does. Each with its filter, a
/// digest of its answer, and which bodies a predicate let pass. Shapes that it asks with are
/// recorded as those of bodies are.
///
///     winnow::RecordedQueries ask(scene);  // a RecordedScene; one per thread
///     ask.closest(ray, hit);
class WINNOW_API RecordedQueries {
 public:
  /// Asks `scene`, which must outlive this. Every allocation comes from `memory`, which must too,
  /// but for what is written: that comes from the recorder's, of one thread at a time.
  explicit RecordedQueries(RecordedScene& scene,
                           std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// The questions themselves, for everything that is not recorded.
  [[nodiscard]] SceneQueries& queries() noexcept { return queries_; }

  /// As those of SceneQueries.
  /// @{
  Status closest(const ShapeRay& ray, SceneHit& hit, const Filter& filter = {});
  Status any(const ShapeRay& ray, SceneHit& hit, const Filter& filter = {});
  Status all(const ShapeRay& ray, std::span<const SceneHit>& hits, const Filter& filter = {});
  Status closest(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  Status any(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  Status all(const ShapeRayBatch& rays, SceneHitLists& hits, const Filter& filter = {});
  Status overlap(ShapeId shape, const Pose& pose, std::span<const SceneOverlap>& bodies,
                 const Filter& filter = {});
  Status closest(const ShapeCast& cast, SceneHit& hit, const Filter& filter = {},
                 double tolerance = 1e-6);
  Status all(const ShapeCast& cast, std::span<const SceneHit>& hits, const Filter& filter = {},
             double tolerance = 1e-6);
  Status closest(const MotionCast& cast, SceneHit& hit, const Filter& filter = {},
                 double tolerance = 1e-6);
  Status all(const MotionCast& cast, std::span<const SceneHit>& hits, const Filter& filter = {},
             double tolerance = 1e-6);
  Status distance(Key a, Key b, SceneDistance& answer,
                  double limit = std::numeric_limits<double>::infinity(),
                  PairRules rules = PairRules::scene);
  Status least_distance(std::span<const Key> a, std::span<const Key> b, SetDistance& answer,
                        double limit = std::numeric_limits<double>::infinity(),
                        PairRules rules = PairRules::scene);
  Status overlaps(std::span<const Key> a, std::span<const Key> b, std::span<const KeyPair>& pairs,
                  std::size_t most = std::numeric_limits<std::size_t>::max(),
                  PairRules rules = PairRules::scene);
  Status any_contact(std::span<const Key> a, std::span<const Key> b, KeyPair& pair,
                     double margin = 0.0, PairRules rules = PairRules::scene);
  Status any_contact(KeyPair& pair, double margin = 0.0, PairRules rules = PairRules::scene);
  Status nearest(const double point[3], std::size_t count, double radius,
                 std::span<const SceneDistance>& bodies, const Filter& filter = {});
  /// @}

 private:
  template <typename Ask, typename Write>
  Status record(RecordedCall question, const Filter& filter, Ask&& ask, Write&& write);
  template <typename Ask, typename Write>
  Status record_with(ShapeId shape, RecordedCall question, const Filter& filter, Ask&& ask,
                     Write&& write);
  [[nodiscard]] std::uint32_t number_of(ShapeId shape) noexcept;
  [[nodiscard]] RecordedCall by(PairRules rules, RecordedCall any_two,
                                RecordedCall by_rules) noexcept;

  RecordedScene& scene_;
  SceneQueries queries_;
  /// Bodies that the predicate of the question let pass.
  Column<ObjectId> passed_;
};

/// A SceneSweep whose sweeps are recorded: see there for what each does.
///
///     winnow::RecordedSweep sweep(scene);  // a RecordedScene
///     sweep.sweep(keys, end_poses);
///     sweep->impacts();
class WINNOW_API RecordedSweep {
 public:
  /// Looks at bodies of `scene`, which must outlive this. Every allocation comes from `memory`,
  /// which must too, but for what is written.
  explicit RecordedSweep(RecordedScene& scene,
                         std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// What the last one answered.
  [[nodiscard]] const SceneSweep* operator->() const noexcept { return &sweep_; }

  /// As those of SceneSweep.
  /// @{
  Status sweep(std::span<const Key> keys, const PoseView& ends, const SweepOptions& options = {});
  Status sweep(std::span<const Key> keys, std::span<const RigidMotion> motions,
               const SweepOptions& options = {});
  /// @}

 private:
  template <typename Put>
  Status record(RecordedCall call, Status status, std::span<const Key> keys,
                const SweepOptions& options, Put&& put);

  RecordedScene& scene_;
  SceneSweep sweep_;
};

/// Sensors whose calls are recorded: see there for what each does. Shapes are recorded as those of
/// bodies are.
///
///     winnow::RecordedSensors sensors(scene);  // a RecordedScene
///     sensors.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)}, goal);
///     sensors.sense();
///     sensors->sensed();
class WINNOW_API RecordedSensors {
 public:
  /// Senses bodies of `scene`, which must outlive this. Every allocation comes from `memory`, which
  /// must too, but for what is written.
  explicit RecordedSensors(RecordedScene& scene,
                           std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~RecordedSensors();
  RecordedSensors(const RecordedSensors&) = delete;
  RecordedSensors& operator=(const RecordedSensors&) = delete;

  /// The sensors themselves, for everything that is not recorded: what is sensed, what they are.
  [[nodiscard]] const Sensors& operator*() const noexcept { return sensors_; }
  /// The same.
  [[nodiscard]] const Sensors* operator->() const noexcept { return &sensors_; }

  /// As those of Sensors.
  /// @{
  Status add(const SensorDefinition& sensor, Key& key);
  Status remove(Key key);
  Status move(Key key, const Pose& pose);
  Status set(Key key, const SensorDefinition& sensor);
  Status sense();
  /// @}

 private:
  void record(RecordedCall call, Key key, const SensorDefinition& sensor) noexcept;

  RecordedScene& scene_;
  std::uint32_t number_;
  Sensors sensors_;
};

}  // namespace winnow
