// Recorded programs are replayed with bit-identical results on any configuration, and invalid
// recordings are rejected or replayed without a crash.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "pipeline/recording/format.h"
#include "tests/recording/mutations.h"
#include "tests/recording/programs.h"
#include "tests/recording/version_1.h"
#include "tests/recording/version_2.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

/// Replays on every instruction set and number of threads: all results must equal the recorded
/// ones, except for this number of differences.
void expect_same_everywhere(const Bytes8& bytes, std::uint64_t differences = 0) {
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const Workers& workers : all_workers()) {
      RecordingPlayer player(bytes, {.execution = workers.execution()});
      Threads threads(workers.threads);
      EXPECT_EQ(threads.run([&] { return player.play_all(); }), Status::ok) << to_string(isa);
      EXPECT_TRUE(player.is_whole());
      EXPECT_GT(player.counts().questions, 0U);
      EXPECT_EQ(player.counts().differences, differences)
          << to_string(isa) << " " << to_string(workers);
    }
  }
}

TEST(ProgramRecordings, partitions_are_replayed_bit_identical) {
  for (const StructureKind& structure : all_structures()) {
    Bytes8 bytes;
    Recorder recorder(kept_in(bytes));
    record_partition(recorder, structure, structure.name() == "NSquared" ? 60 : scaled(600), 9);
    ASSERT_EQ(recorder.close(), Status::ok);
    EXPECT_EQ(recorder.bytes(), bytes.size());
    SCOPED_TRACE(structure.name());
    expect_same_everywhere(bytes);
  }
}

TEST(ProgramRecordings, all_volumes_are_replayed_bit_identical) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  record_volumes(recorder, scaled(500));
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, scenes_are_replayed_bit_identical) {
  for (const double cache_tolerance : {0.0, 0.02}) {
    Bytes8 bytes;
    Recorder recorder(kept_in(bytes));
    record_scene(recorder, scaled(300), 8,
                 {.contact_margin = 0.02, .cache_tolerance = cache_tolerance, .warm_start = true});
    ASSERT_EQ(recorder.close(), Status::ok);
    expect_same_everywhere(bytes);
  }
}

/// Balls in a row, each of which overlaps its neighbours.
struct Row {
  Row() {
    ball = expect_ok(shapes.add(SphereShape{0.6}));
    for (int i = 0; i < 30; ++i) bodies.push_back({.shape = ball, .pose = Pose::at(i, 0, 0)});
    keys.resize(bodies.size());
  }

  ShapePool shapes;
  ShapeId ball;
  std::vector<BodyDefinition> bodies;
  std::vector<Key> keys;
};

/// Writes the version, which follows the eight characters.
Bytes8 as_version(Bytes8 bytes, std::uint32_t version) {
  std::memcpy(bytes.data() + 8, &version, sizeof version);
  return bytes;
}

TEST(ProgramRecordings, predicate_results_are_recorded) {
  const auto refuse_even = [](void*, ObjectId first, ObjectId) { return first % 2 != 0; };
  Row row;
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  Contacts contacts;
  {
    Scene scene(row.shapes, {.recorder = &recorder});
    ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
    scene.set_predicate({refuse_even, nullptr});
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_EQ(scene.move(row.keys[4], Pose::at(4, 0.1 * frame, 0)), Status::ok);
      EXPECT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
      EXPECT_EQ(contacts.size(), 14U);
    }
    scene.set_predicate({});
    EXPECT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), 29U);
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
  RecordingPlayer player(bytes);
  std::vector<std::size_t> touching;
  for (Played played = player.step(); played != Played::end; played = player.step()) {
    if (played == Played::pairs) touching.push_back(player.world(0).contacts->size());
  }
  EXPECT_EQ(touching, (std::vector<std::size_t>{14, 14, 14, 29}));
}

/// A recorded row, one pair of which ends and begins in turn.
struct RecordedRow : Row {
  explicit RecordedRow(Recorder& recorder, const SceneOptions& options = {})
      : scene(shapes, recorded_by(recorder, options)) {
    EXPECT_EQ(scene.add(bodies, keys), Status::ok);
  }
  void step(Contacts& contacts, Status expected = Status::ok) {
    EXPECT_EQ(scene.move(keys[0], Pose::at(0, steps++ % 2 == 0 ? 0 : 9, 0)), Status::ok);
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), expected);
  }

  Scene scene;
  int steps = 0;
};

TEST(ProgramRecordings, contacts_shared_by_two_scenes_are_replayed) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    RecordedRow one(recorder, {.cache_tolerance = 0.02, .warm_start = true});
    RecordedRow other(recorder);
    Contacts contacts;
    for (int i = 0; i < 3; ++i) {
      for (RecordedRow* row : {&one, &other, &other}) {
        ASSERT_EQ(row->scene.collide(ContactLevel::manifold, contacts), Status::ok);
      }
      contacts.clear();
    }
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, change_back_to_earlier_contacts_ends_the_recording) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  RecordedRow row(recorder);
  Contacts one;
  Contacts other;
  for (Contacts* contacts : {&one, &one, &other, &other}) row.step(*contacts);
  EXPECT_EQ(recorder.status(), Status::ok);  // the second contacts were empty
  row.step(one);
  EXPECT_EQ(one.size(), 29U);
  EXPECT_EQ(recorder.close(), Status::unsupported);
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_EQ(player.counts().differences, 0U);
}

TEST(ProgramRecordings, loaded_contacts_are_replayed) {
  for (const bool into_others : {false, true}) {
    Bytes8 bytes;
    Recorder recorder(kept_in(bytes));
    {
      RecordedRow row(recorder);
      Contacts contacts;
      Contacts others;
      Contacts& loaded = into_others ? others : contacts;
      row.step(contacts);
      Column<std::byte> saved(std::pmr::get_default_resource());
      ASSERT_EQ(row.scene.save_contacts(contacts, saved), Status::ok);
      ASSERT_EQ(row.scene.load_contacts({saved.data(), saved.size()}, loaded), Status::ok);
      row.step(loaded);
      EXPECT_EQ(loaded.size(), 28U);
    }
    ASSERT_EQ(recorder.close(), Status::ok);
    expect_same_everywhere(bytes);
  }
}

/// A predicate that rejects pairs of some bodies.
struct RejectingPredicate {
  [[nodiscard]] PairPredicate predicate() {
    return {[](void* context, ObjectId first, ObjectId second) {
              const auto& of = *static_cast<const RejectingPredicate*>(context);
              return !of.out[first] && !of.out[second];
            },
            this};
  }

  std::vector<bool> out = std::vector<bool>(40);
};

TEST(ProgramRecordings, predicates_after_a_refused_query_are_replayed) {
  enum class Then { queried_again, another_predicate, another_body };
  for (const Then then : {Then::queried_again, Then::another_predicate, Then::another_body}) {
    Bytes8 bytes;
    Recorder recorder(kept_in(bytes));
    {
      RecordedRow row(recorder);
      RejectingPredicate all;
      RejectingPredicate most;
      most.out[4] = true;
      row.scene.set_predicate(all.predicate());
      CountingMemory memory;
      Contacts contacts(&memory);
      memory.refuse_after(0);
      row.step(contacts, Status::out_of_memory);  // after all pairs were tested
      memory.grant_all();
      row.steps = 0;
      if (then == Then::another_predicate) row.scene.set_predicate(most.predicate());
      if (then == Then::another_body) {
        ASSERT_EQ(row.scene.remove(row.keys[4]), Status::ok);
        Key key = expect_ok(row.scene.add(row.bodies[4]));
        all.out[key.id] = true;
      }
      row.step(contacts);
      EXPECT_EQ(contacts.size(), then == Then::queried_again ? 29U : 27U);
    }
    ASSERT_EQ(recorder.close(), Status::ok);
    expect_same_everywhere(bytes);
  }
}

TEST(ProgramRecordings, composites_without_a_body_are_replayed) {
  Row row;
  CompositePool composites(row.shapes);
  const std::vector<Vec3f> corners{{-9, -9, 0}, {90, -9, 0}, {-9, 90, 0}};
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  ShapeId floor;
  ShapeId unused;
  for (ShapeId* id : {&floor, &unused}) {
    *id = expect_ok(composites.add_mesh(corners, triangle));
  }
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(row.shapes,
                {.cache_tolerance = 0.01, .composites = &composites, .recorder = &recorder});
    Key key = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
    key = expect_ok(scene.add({.shape = row.ball, .pose = Pose::at(0, 0, 0.5)}));
    Contacts contacts;
    std::vector<std::size_t> cached_pairs;
    const auto collide = [&] {
      EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      cached_pairs.push_back(contacts.cached_pairs());
    };
    collide();
    collide();
    EXPECT_EQ(composites.refit_mesh(unused, corners), Status::ok);
    collide();
    collide();
    EXPECT_EQ(composites.remove(unused), Status::ok);
    collide();
    collide();
    // If a pool has changed, contacts of composite shapes are recomputed.
    EXPECT_EQ(cached_pairs, (std::vector<std::size_t>{0, 1, 0, 1, 0, 1}));
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, queries_of_several_threads_are_replayed) {
  Row row;
  std::vector<ShapeId> own(40);
  for (std::size_t i = 0; i < own.size(); ++i) {
    own[i] = expect_ok(row.shapes.add(SphereShape{0.1 + 0.02 * static_cast<double>(i)}));
  }
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(row.shapes, {.recorder = &recorder});
    ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
    ASSERT_EQ(scene.refresh(), Status::ok);
    std::vector<std::thread> threads;
    for (std::size_t thread = 0; thread < 4; ++thread) {
      threads.emplace_back([&, thread] {
        SceneQueries queries(scene);
        for (std::size_t i = 0; i < own.size(); ++i) {
          std::span<const SceneOverlap> found;
          const Pose pose = Pose::at(0.7 * static_cast<double>(thread + i), 0.3, 0);
          found = expect_ok(queries.overlap(own[(7 * thread + i) % own.size()], pose));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  // Shapes are compared as well.
  EXPECT_EQ(player.counts().questions, 4 * own.size() + own.size() + 1);
  EXPECT_EQ(player.counts().differences, 0U);
}

TEST(ProgramRecordings, queries_by_scene_rules_record_the_predicate) {
  Row row;
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(row.shapes, {.recorder = &recorder});
    ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
    scene.set_predicate({[](void*, ObjectId a, ObjectId b) { return (a + b) % 3 != 0; }});
    ASSERT_EQ(scene.refresh(), Status::ok);
    Contacts contacts;
    for (int frame = 0; frame < 3; ++frame) {
      std::vector<std::thread> threads;
      for (std::size_t thread = 0; thread < 4; ++thread) {
        threads.emplace_back([&, thread] {
          SceneQueries queries(scene);
          for (std::size_t i = 0; i + 4 < row.keys.size(); ++i) {
            const std::span<const Key> some(row.keys.data() + i, thread + 1);
            std::span<const KeyPair> pairs = expect_ok(queries.overlaps(some, row.keys));
            KeyPair pair = expect_ok(queries.any_contact(some, row.keys, 0.3));
            pair = expect_ok(queries.any_contact());
          }
        });
      }
      for (std::thread& thread : threads) thread.join();
      EXPECT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
      EXPECT_GT(contacts.size(), 0U);
      ASSERT_EQ(scene.move(row.keys[0], Pose::at(0, 0.1 * frame, 0)), Status::ok);
      ASSERT_EQ(scene.refresh(), Status::ok);
    }
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, version_3_ignores_scene_rules_in_queries) {
  Row row;
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(row.shapes, {.recorder = &recorder});
    ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
    ASSERT_EQ(scene.set_ignored(row.keys[0], row.keys[1]), Status::ok);
    ASSERT_EQ(scene.refresh(), Status::ok);
    SceneQueries queries(scene);
    SceneDistance gap = expect_ok(queries.distance(row.keys[0], row.keys[1], 9.0, PairRules::none));
    EXPECT_TRUE(gap);
    std::span<const KeyPair> pairs =
        expect_ok(queries.overlaps(row.keys, row.keys, 99, PairRules::none));
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(as_version(bytes, 3));
}

TEST(ProgramRecordings, queries_allocate_only_in_queries_and_recorder) {
  Row row;
  CompositePool composites(row.shapes);
  const std::vector<Vec3f> corners{{-9, -9, 0}, {90, -9, 0}, {-9, 90, 0}};
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  ShapeId floor = expect_ok(composites.add_mesh(corners, std::span<const std::uint32_t>(triangle)));
  ShapeId box = expect_ok(row.shapes.add(BoxShape{{0.5, 0.5, 0.5}}));
  Bytes8 bytes;
  CountingMemory of_scene;
  CountingMemory of_recorder;
  CountingMemory of_queries;
  Recorder recorder(kept_in(bytes), &of_recorder);
  {
    Scene scene(row.shapes,
                {.memory = &of_scene, .composites = &composites, .recorder = &recorder});
    ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
    ASSERT_EQ(scene.refresh(), Status::ok);
    SceneQueries queries(scene, &of_queries);
    std::span<const SceneOverlap> found;
    // The first query allocates the memory that all queries share.
    found = expect_ok(queries.overlap(row.ball, Pose{}));
    const std::size_t before = of_scene.requests();
    for (const ShapeId shape : {floor, box}) {
      found = expect_ok(queries.overlap(shape, Pose{}));
      EXPECT_GT(found.size(), 0U);
    }
    EXPECT_EQ(of_scene.requests(), before);
    EXPECT_GT(of_queries.requests(), 0U);
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, refused_queries_are_not_recorded) {
  Row row;
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  Scene scene(row.shapes, {.recorder = &recorder});
  ASSERT_EQ(scene.add(row.bodies, row.keys), Status::ok);
  ASSERT_EQ(scene.refresh(), Status::ok);
  ASSERT_EQ(scene.move(row.keys[0], Pose::at(0, 9, 0)), Status::ok);
  SceneQueries queries(scene);
  const std::uint64_t before = recorder.calls();
  expect_error(queries.closest(ShapeRay{}), Status::invalid_argument);  // not refreshed
  ASSERT_EQ(scene.refresh(), Status::ok);
  expect_error(queries.overlap(ShapeId{}, Pose{}), Status::invalid_key);
  expect_error(queries.distance(row.keys[0], Key{}), Status::invalid_key);
  EXPECT_EQ(recorder.calls(), before + 1);
  EXPECT_EQ(recorder.status(), Status::ok);
  SupportShape egg;
  egg.radius = 1.0;
  egg.function = [](const void*, const double direction[3], double point[3]) {
    for (int k = 0; k < 3; ++k) point[k] = direction[k];
  };
  const ShapeId function = expect_ok(row.shapes.add(egg));
  expect_ok(queries.overlap(function, Pose{}));
  EXPECT_EQ(recorder.status(), Status::unsupported);
}

void expect_played(std::span<const unsigned char> recording, std::uint64_t calls,
                   std::uint64_t frames, std::uint64_t differences = 0) {
  const auto bytes = std::as_bytes(recording);
  const Bytes8 old(bytes.begin(), bytes.end());
  expect_same_everywhere(old, differences);
  RecordingPlayer player(old);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_EQ(player.counts().calls, calls);
  EXPECT_EQ(player.counts().frames, frames);
}

TEST(ProgramRecordings, older_versions_are_replayed) {
  expect_played(kVersion1, 22, 1);
  // In version 2 the solver computed the distance and the nearest bodies; the lanes give other last
  // bits.
  expect_played(kVersion2, 23, 2, 2);
}

/// Two spheres on a box, in a pool whose ids differ from the numbers of the recording.
struct Pile {
  Pile() {
    for (int i = 0; i < 5; ++i) (void)pool.add(SphereShape{9.0 + i});
    ball = pool.add(SphereShape{0.5});
    box = pool.add(BoxShape{{3.0, 3.0, 0.5}});
  }
  template <typename Scene>
  void add_to(Scene& scene) {
    const BodyDefinition bodies[] = {{.shape = box, .pose = Pose::at(0, 0, -0.5)},
                                     {.shape = ball, .pose = Pose::at(0, 0, 0.45)},
                                     {.shape = ball, .pose = Pose::at(0.8, 0, 0.45)}};
    EXPECT_EQ(scene.add(bodies, keys), Status::ok);
  }

  ShapePool pool;
  ShapeId ball;
  ShapeId box;
  Key keys[3];
};

TEST(ProgramRecordings, loaded_scene_is_replayed) {
  Pile pile;
  Column<std::byte> bodies(std::pmr::get_default_resource());
  Column<std::byte> touching(std::pmr::get_default_resource());
  {
    Scene before(pile.pool, {.cache_tolerance = 0.05, .warm_start = true});
    pile.add_to(before);
    Contacts contacts;
    ASSERT_EQ(before.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.size(), 3U);
    ASSERT_EQ(before.save(bodies), Status::ok);
    ASSERT_EQ(before.save_contacts(contacts, touching), Status::ok);
  }
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(pile.pool, {.cache_tolerance = 0.05, .warm_start = true, .recorder = &recorder});
    expect_ok(scene.add({.shape = pile.ball}));
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(scene.load({bodies.data(), bodies.size()}), Status::ok);
    ASSERT_EQ(scene.load_contacts({touching.data(), touching.size()}, contacts), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), 3U);
    EXPECT_EQ(contacts.cached_pairs(), 3U);
    EXPECT_EQ(contacts.event()[0], ContactEvent::persisted);
    ASSERT_EQ(scene.load({bodies.data(), bodies.size()}), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(contacts.event()[0], ContactEvent::begun);
    const std::byte none[4] = {};
    EXPECT_EQ(scene.load(none), Status::invalid_argument);
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
}

TEST(ProgramRecordings, sensors_and_impacts_are_replayed_bit_identical) {
  Pile pile;
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Scene scene(pile.pool, {.recorder = &recorder});
    pile.add_to(scene);
    ContinuousCollision ccd(scene);
    const Pose end[] = {Pose::at(0.2, 0, 3.0)};
    ASSERT_EQ(ccd.find_impacts(std::span(pile.keys + 2, 1), end), Status::ok);
    EXPECT_GT(ccd.impacts().size(), 0U);
    EXPECT_EQ(ccd.find_impacts(pile.keys, end), Status::size_mismatch);
    Sensors sensors(scene);
    {
      Sensors others(scene);
      Key key = expect_ok(others.add({.shape = pile.ball, .carrier = pile.keys[1]}));
      EXPECT_EQ(others.move(Key{}, Pose::at(0, 0, 0)), Status::invalid_key);
      ASSERT_EQ(others.sense(), Status::ok);
      EXPECT_EQ(others.sensed().size(), 2U);
      ASSERT_EQ(others.move(key, Pose::at(9, 9, 9)), Status::ok);
      ASSERT_EQ(others.sense(), Status::ok);
      EXPECT_EQ(others.left().size(), 2U);
    }
    expect_ok(sensors.add({.shape = pile.box}));
    ASSERT_EQ(sensors.sense(), Status::ok);
    EXPECT_EQ(sensors.sensed().size(), 3U);
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_same_everywhere(bytes);
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_EQ(player.counts().questions, 4U + 2U);  // including the two shapes
}

TEST(ProgramRecordings, unknown_versions_and_newer_calls_are_refused) {
  Bytes8 newest;
  {
    Recorder recorder(kept_in(newest));
    record_scene(recorder, 40, 1, {.contact_margin = 0.02});
  }
  for (const std::uint32_t version : {0U, kRecordingVersion + 1, ~0U}) {
    const Bytes8 bytes = as_version(newest, version);
    EXPECT_EQ(RecordingPlayer(bytes).status(), Status::invalid_argument);
  }
  for (const std::uint32_t too_old : {1U, 2U, 3U}) {
    const Bytes8 bytes = as_version(newest, too_old);
    RecordingPlayer player(bytes);
    EXPECT_EQ(player.play_all(), Status::invalid_argument);
    EXPECT_GT(player.counts().calls, 0U);
  }
}

TEST(ProgramRecordings, recording_in_a_file_is_replayed) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "winnow_recording_test.winnow").string();
  {
    Recorder recorder(path.c_str());
    record_volumes(recorder, 50);
    EXPECT_EQ(recorder.close(), Status::ok);
    EXPECT_EQ(recorder.bytes(), std::filesystem::file_size(path));
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  RecordingPlayer player(std::as_bytes(std::span(text)));
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_EQ(player.counts().differences, 0U);
  std::filesystem::remove(path);
}

TEST(ProgramRecordings, truncated_recording_is_replayed_to_its_end) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  record_partition(recorder, linear_bvh(), 100, 3);
  ASSERT_EQ(recorder.close(), Status::ok);
  bytes.resize(bytes.size() - 20);
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_FALSE(player.is_whole());
  EXPECT_EQ(player.counts().differences, 0U);
  EXPECT_EQ(player.counts().frames, 3U);
}

TEST(ProgramRecordings, recorder_without_a_sink_returns_an_error) {
  Recorder nowhere(RecordingSink{});
  record_partition(nowhere, linear_bvh(), 50, 2);
  EXPECT_EQ(nowhere.status(), Status::out_of_memory);
  Recorder no_file("/no/such/folder/run.winnow");
  record_partition(no_file, linear_bvh(), 50, 2);
  EXPECT_EQ(no_file.close(), Status::invalid_argument);
}

TEST(ProgramRecordings, difference_from_the_recording_is_reported) {
  // Changes the boxes and keeps the recorded digest of the result.
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    Partition partition(linear_bvh(), {.recorder = &recorder});
    std::vector<Key> keys(2);
    EXPECT_EQ(partition.insert(std::vector<Aabb>(2, Aabb{{0, 0, 0}, {1, 1, 1}}), {}, keys),
              Status::ok);
    PairBuffer pairs;
    EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  const float one = 1.0F;
  const float none = 0.5F;
  // Moves the first box in the recorded bytes. Then seal() writes the correct digest of the block.
  auto* const block = bytes.data() + 32;
  const auto size = bytes.size() - 48;
  float bounds[12];
  for (std::size_t at = 0; at + sizeof bounds <= size; ++at) {
    std::memcpy(bounds, block + at, sizeof bounds);
    if (bounds[3] != one || bounds[4] != one || bounds[11] != one) continue;
    for (int i = 0; i < 3; ++i) bounds[i] = bounds[i + 3] = 3.0F + none;
    std::memcpy(block + at, bounds, sizeof bounds);
    break;
  }
  RecordingPlayer damaged(bytes);
  EXPECT_EQ(damaged.status(), Status::invalid_argument);
  seal(bytes);
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_EQ(player.counts().differences, 1U);
}

/// Replays mutated recordings; half of them have a valid digest.
void play_mutated(const Bytes8& good, std::size_t count) {
  Random random(11);
  std::size_t refused = 0;
  LimitedMemory memory(std::size_t{64} << 20U);
  for (std::size_t i = 0; i < count; ++i) {
    Bytes8 bytes = good;
    mutate(bytes, random);
    if (i % 8 != 0) seal(bytes);
    RecordingPlayer player(bytes, {.memory = &memory, .execution = Execution::serial()});
    if (player.play_all() != Status::ok) ++refused;
  }
  EXPECT_GT(refused, count / 16);
}

TEST(ProgramRecordings, untrusted_recordings_are_read_or_refused) {
  Bytes8 partitions;
  {
    Recorder recorder(kept_in(partitions));
    record_partition(recorder, linear_bvh(), 40, 7);
    record_volumes(recorder, 10);
  }
  play_mutated(partitions, scaled(600));
  Bytes8 scenes;
  {
    Recorder recorder(kept_in(scenes));
    record_scene(recorder, 40, 7, {.contact_margin = 0.02, .cache_tolerance = 0.02});
  }
  play_mutated(scenes, scaled(400));
}

}  // namespace
}  // namespace winnow::test
