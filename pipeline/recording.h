#pragma once

// Recording of the calls that a program makes, by wrappers with the same functions as Partition,
// Scene, SceneQueries, ContinuousCollision and Sensors. RecordingPlayer (replay.h) replays the
// result. The implementation is in recording/.

#include <winnow/core/export.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

struct RecorderState;
struct AcceptedPairs;
enum class RecordedCall : std::uint8_t;

/// Destination of a recording: a function that takes the next bytes and returns false on failure.
/// It is called by one thread at a time and must not throw.
struct RecordingSink {
  bool (*write)(void* context, std::span<const std::byte> bytes) = nullptr;  ///< null: discards
  void* context = nullptr;                                                   ///< passed to `write`
};

/// Records the calls that a program makes to partitions and scenes, to be replayed elsewhere
/// (RecordingPlayer) and measured (`winnow advise FILE`). Objects to be recorded are declared as
/// RecordedPartition or RecordedScene, which have the same functions:
///
///     winnow::Recorder recorder("run.winnow");
///     winnow::RecordedPartition partition(recorder, winnow::linear_bvh());
///     partition.insert(boxes, data, keys);
///     partition.self_pairs(pairs);
///     recorder.end_frame();
///
/// Other partitions and scenes pay nothing. pipeline/FORMATS.md has the format. Failed calls are
/// not recorded. Calls from several threads are recorded in the order in which they end. After any
/// error the recording stops, and the program goes on.
class WINNOW_API Recorder {
 public:
  /// Records to a file, which is created or overwritten. `memory` must outlive the recorder.
  explicit Recorder(const char* path,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Records to a sink.
  explicit Recorder(const RecordingSink& sink,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Closes the recording. Recorded objects must be destroyed first.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Marks the end of a frame and writes buffered data. If a program marks no frames, tools count
  /// each query for all pairs or contacts as the end of a frame.
  void end_frame() noexcept;
  /// Writes the end of the recording; later calls are not recorded. Returns `status()`.
  Status close() noexcept;

  /// Returns `ok`; `out_of_memory`, also if the sink fails or the disk is full; `invalid_argument`
  /// for a file that cannot be opened; `unsupported` after a call that cannot be recorded (see
  /// RecordedScene).
  [[nodiscard]] Status status() const noexcept;
  /// Returns the number of bytes written.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Returns the number of calls recorded.
  [[nodiscard]] std::uint64_t calls() const noexcept;

 private:
  friend class RecordedPartition;
  friend class RecordedQueries;
  friend class RecordedScene;

  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  RecorderState* state_;
};

/// A Partition whose calls are recorded; see Partition for each function. Results are not changed.
/// A query is recorded with a digest of its results. For a query with a predicate, the results are
/// recorded in place of the predicate's answers. An incremental query, whose buffer or events
/// contain the result of an earlier query, is replayed from that result if the earlier query is one
/// of the last 16.
class WINNOW_API RecordedPartition {
 public:
  /// Creates the partition. The recorder must outlive it.
  explicit RecordedPartition(Recorder& recorder, StructureKind structure,
                             const PartitionOptions& options = {}) noexcept;
  ~RecordedPartition();
  RecordedPartition(const RecordedPartition&) = delete;
  RecordedPartition& operator=(const RecordedPartition&) = delete;

  /// Returns the partition, for const calls that are not recorded.
  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// Accesses the partition, for const calls that are not recorded.
  [[nodiscard]] const Partition* operator->() const noexcept { return &partition_; }
  /// Reserves memory. Not recorded, because it does not change results.
  Status reserve(std::size_t objects, Pages pages = Pages::untouched) {
    return partition_.reserve(objects, pages);
  }

  /// See the functions of Partition.
  /// @{
  Status set_structure(StructureKind structure);
  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Answer<Key> insert(const Aabb& box, ClientData data = 0);
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  Status update(std::span<const Key> keys, const BoxView& boxes);
  Status update(Key key, const Aabb& box);
  Status update(std::span<const Key> keys, const BoxView& boxes, const IndexSubset& entries);
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
  Answer<Hit> closest(const Cast& cast, const Filter& filter = {}) const;
  Answer<Hit> any(const Cast& cast, const Filter& filter = {}) const;
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
  void record(RecordedCall kind, const RayBatch& rays, const HitColumns& hits,
              const Filter& filter) const;

  RecorderState* recorder_;
  std::uint32_t world_;
  Partition partition_;
  /// Returns the number of the recorded query whose result the buffer contains; 0 if it is none of
  /// the last kPairHistory queries.
  [[nodiscard]] std::uint64_t source_query(const PairBuffer& out) const noexcept;
  void store_provenance(const PairBuffer& out) const noexcept;

  /// Contents of the buffers after the last pair queries; query i is at i % kPairHistory.
  static constexpr std::size_t kPairHistory = 16;
  mutable PairBuffer::Provenance provenances_[kPairHistory];
  mutable std::uint64_t pair_queries_ = 0;
};

/// A shape that was recorded.
struct RecordedShape {
  ShapeId id;            ///< id in the program's pools
  std::uint32_t number;  ///< number in the recording
  std::uint64_t digest;  ///< digest of the shape when it was recorded
  std::uint64_t form;    ///< digest of the part of the shape that no in-place change affects
};

/// A Scene whose calls are recorded, with the shapes of its bodies; see Scene for each function.
/// Composite shapes are recorded if the scene is created with their CompositePool; in-place changes
/// of them are recorded with the next query. For a predicate, the pairs that it accepts are
/// recorded.
///
/// The recording ends with `unsupported` on: a body whose shape is in another CompositePool, is
/// one-sided or a solid, or has a support function; SceneOptions::suppress_ghost_contacts; and a
/// `collide` into Contacts that this scene filled, but not in its last `collide`. So use one
/// Contacts per scene; it may be cleared, filled by another scene in between, or loaded by
/// `load_contacts`. RecordedQueries, RecordedContinuousCollision and RecordedSensors record the
/// other queries of a scene.
class WINNOW_API RecordedScene {
 public:
  /// Creates a scene without composite shapes. The recorder must outlive it.
  explicit RecordedScene(Recorder& recorder, const ShapePool& shapes,
                         const SceneOptions& options = {}) noexcept;
  /// Creates a scene with composite shapes, which replace `options.composites`.
  RecordedScene(Recorder& recorder, const ShapePool& shapes, const CompositePool& composites,
                const SceneOptions& options = {}) noexcept;
  ~RecordedScene();
  RecordedScene(const RecordedScene&) = delete;
  RecordedScene& operator=(const RecordedScene&) = delete;

  /// Returns the scene, for calls that are not recorded, such as const functions and plain
  /// SceneQueries.
  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  /// Accesses the scene, for const calls that are not recorded.
  [[nodiscard]] const Scene* operator->() const noexcept { return &scene_; }
  /// Reserves memory. Not recorded, because it does not change results.
  Status reserve(const SceneCapacity& room, Pages pages = Pages::untouched) {
    return scene_.reserve(room, pages);
  }

  /// See the functions of Scene.
  /// @{
  Answer<Key> add(const BodyDefinition& body);
  Status add(std::span<const BodyDefinition> bodies, std::span<Key> keys);
  Status remove(Key key);
  Status remove(std::span<const Key> keys);
  void clear() noexcept;
  Status move(Key key, const Pose& pose);
  Status move(std::span<const Key> keys, const PoseView& poses);
  Status set_body_state(Key key, BodyState state);
  Status set_body_state(std::span<const Key> keys, BodyState state);
  Status set_shape(Key key, ShapeId shape);
  Status set_filter(Key key, const ObjectFilter& filter);
  Status set_offsets(Key key, const ContactOffsets& offsets);
  Status set_layer(Key key, std::uint16_t layer);
  Status set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide = true);
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
  friend class RecordedContinuousCollision;
  RecordedScene(Recorder& recorder, const ShapePool& shapes, const SceneOptions& options,
                const CompositePool* composites) noexcept;
  /// Clock of the `collide` that filled contacts, and serial number of its pairs.
  using Provenance = std::pair<std::uint32_t, std::uint64_t>;
  [[nodiscard]] static Provenance source_query(const Contacts& contacts) noexcept;
  [[nodiscard]] bool is_filled_by_this(const Contacts& contacts) const noexcept;

  [[nodiscard]] bool can_hold(ShapeId id) const noexcept;
  [[nodiscard]] RecordedShape* find_shape(ShapeId id) noexcept;
  [[nodiscard]] std::uint32_t number_of(ShapeId id) noexcept;
  void stop_recording(Status why) noexcept;
  void describe(RecordedShape& shape) const noexcept;
  void insert_shape(const RecordedShape& shape) noexcept;
  void record_shape(const RecordedShape& shape) noexcept;
  void record_composite(const RecordedShape& shape) noexcept;
  void record_composite_changes() noexcept;
  void record_passed() noexcept;
  void record_passed_so_far() noexcept;
  void forget_passed() noexcept;

  void record_offsets(Key key, const ContactOffsets& offsets) noexcept;
  void record_layer(Key key, std::uint16_t layer) noexcept;

  RecorderState* recorder_;
  std::uint32_t world_;
  const ShapePool& shapes_;
  const CompositePool* composites_;
  std::uint64_t composites_seen_;
  Scene scene_;
  /// Recorded shapes by id, in the recorder's memory.
  Column<RecordedShape> recorded_shapes_;
  std::uint32_t shapes_recorded_ = 0;
  std::uint32_t sensors_recorded_ = 0;
  Provenance last_provenance_;
  /// Pairs that the predicate accepted, in the recorder's memory; null without a predicate.
  AcceptedPairs* passed_ = nullptr;
};

/// SceneQueries that are recorded; see SceneQueries for each function. A query is recorded with its
/// filter, a digest of its results, and the bodies that the predicate accepted. Query shapes are
/// recorded like the shapes of bodies.
///
///     winnow::RecordedQueries queries(scene);  // a RecordedScene; one per thread
///     queries.closest(ray, hit);
class WINNOW_API RecordedQueries {
 public:
  /// Creates queries on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it, except for the recorded data: they use the recorder's
  /// memory, by one thread at a time.
  explicit RecordedQueries(RecordedScene& scene,
                           std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Returns the queries, for calls that are not recorded.
  [[nodiscard]] SceneQueries& queries() noexcept { return queries_; }

  /// See the functions of SceneQueries.
  /// @{
  Answer<SceneHit> closest(const ShapeRay& ray, const Filter& filter = {});
  Answer<SceneHit> any(const ShapeRay& ray, const Filter& filter = {});
  Answer<std::span<const SceneHit>> all(const ShapeRay& ray, const Filter& filter = {});
  Status closest(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  Status any(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  Answer<SceneHitLists> all(const ShapeRayBatch& rays, const Filter& filter = {});
  Answer<std::span<const SceneOverlap>> overlap(ShapeId shape, const Pose& pose,
                                                const Filter& filter = {});
  Answer<SceneHit> closest(const ShapeCast& cast, const Filter& filter = {},
                           double tolerance = 1e-6);
  Answer<std::span<const SceneHit>> all(const ShapeCast& cast, const Filter& filter = {},
                                        double tolerance = 1e-6);
  Answer<SceneHit> closest(const MotionCast& cast, const Filter& filter = {},
                           double tolerance = 1e-6);
  Answer<std::span<const SceneHit>> all(const MotionCast& cast, const Filter& filter = {},
                                        double tolerance = 1e-6);
  Answer<SceneDistance> distance(Key a, Key b,
                                 double limit = std::numeric_limits<double>::infinity(),
                                 PairRules rules = PairRules::scene);
  Answer<SetDistance> least_distance(std::span<const Key> a, std::span<const Key> b,
                                     double limit = std::numeric_limits<double>::infinity(),
                                     PairRules rules = PairRules::scene);
  Answer<std::span<const KeyPair>> overlaps(
      std::span<const Key> a, std::span<const Key> b,
      std::size_t most = std::numeric_limits<std::size_t>::max(),
      PairRules rules = PairRules::scene);
  Answer<KeyPair> any_contact(std::span<const Key> a, std::span<const Key> b,
                              double contact_margin = 0.0, PairRules rules = PairRules::scene);
  Answer<KeyPair> any_contact(double contact_margin = 0.0, PairRules rules = PairRules::scene);
  Answer<std::span<const SceneDistance>> nearest(const Vec3d& point, std::size_t count,
                                                 double radius, const Filter& filter = {});
  /// @}

 private:
  template <typename Query, typename Write>
  auto record(RecordedCall kind, const Filter& filter, Query&& query, Write&& write);
  template <typename Query, typename Write>
  auto record_with(ShapeId shape, RecordedCall kind, const Filter& filter, Query&& query,
                   Write&& write);
  [[nodiscard]] std::uint32_t number_of(ShapeId shape) noexcept;
  [[nodiscard]] RecordedCall call_by_rules(PairRules rules, RecordedCall any_two,
                                           RecordedCall by_rules) noexcept;

  RecordedScene& scene_;
  SceneQueries queries_;
  /// Bodies that the predicate of the current query accepted.
  Column<ObjectId> passed_;
};

/// A ContinuousCollision that is recorded; see ContinuousCollision for each function.
///
///     winnow::RecordedContinuousCollision ccd(scene);  // a RecordedScene
///     ccd.find_impacts(keys, end_poses);
///     ccd->impacts();
class WINNOW_API RecordedContinuousCollision {
 public:
  /// Works on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it, except for the recorded data.
  explicit RecordedContinuousCollision(
      RecordedScene& scene, std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Accesses the results of the last call.
  [[nodiscard]] const ContinuousCollision* operator->() const noexcept { return &ccd_; }

  /// See the functions of ContinuousCollision.
  /// @{
  Status find_impacts(std::span<const Key> keys, const PoseView& ends,
                      const ContinuousOptions& options = {});
  Status find_impacts(std::span<const Key> keys, std::span<const RigidMotion> motions,
                      const ContinuousOptions& options = {});
  /// @}

 private:
  template <typename Put>
  Status record(RecordedCall kind, Status status, std::span<const Key> keys,
                const ContinuousOptions& options, Put&& put);

  RecordedScene& scene_;
  ContinuousCollision ccd_;
};

/// Sensors that are recorded; see Sensors for each function. Their shapes are recorded like the
/// shapes of bodies.
///
///     winnow::RecordedSensors sensors(scene);  // a RecordedScene
///     sensors.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)}, goal);
///     sensors.sense();
///     sensors->sensed();
class WINNOW_API RecordedSensors {
 public:
  /// Creates sensors on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it, except for the recorded data.
  explicit RecordedSensors(RecordedScene& scene,
                           std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~RecordedSensors();
  RecordedSensors(const RecordedSensors&) = delete;
  RecordedSensors& operator=(const RecordedSensors&) = delete;

  /// Returns the sensors, for const calls that are not recorded.
  [[nodiscard]] const Sensors& operator*() const noexcept { return sensors_; }
  /// Accesses the sensors, for const calls that are not recorded.
  [[nodiscard]] const Sensors* operator->() const noexcept { return &sensors_; }

  /// See the functions of Sensors.
  /// @{
  Answer<Key> add(const SensorDefinition& sensor);
  Status remove(Key key);
  Status move(Key key, const Pose& pose);
  Status set(Key key, const SensorDefinition& sensor);
  Status sense();
  /// @}

 private:
  void record(RecordedCall kind, Key key, const SensorDefinition& sensor) noexcept;

  RecordedScene& scene_;
  std::uint32_t number_;
  Sensors sensors_;
};

}  // namespace winnow
