// Untrusted recordings and snapshots are replayed, loaded and queried, or refused. Their digests
// are made to fit, so that the code behind the digest check is reached.

#include <winnow/winnow.h>

#include "tests/fuzz/target.h"
#include "tests/recording/mutations.h"
#include "tests/recording/programs.h"

namespace winnow::test {
namespace {

constexpr std::size_t kMaxMemory = std::size_t{256} << 20U;

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void play(Bytes8 bytes) {
  seal(bytes);
  LimitedMemory memory(kMaxMemory);
  RecordingPlayer player(bytes, {.memory = &memory, .execution = Execution::serial()});
  const Status status = player.play_all();
  WINNOW_REQUIRE(status != Status::ok || player.counts().differences <= player.counts().questions);
}

void load(Bytes8 bytes) {
  seal_snapshot(bytes);
  LimitedMemory memory(kMaxMemory);
  Partition partition(linear_bvh(), {.memory = &memory, .execution = Execution::serial()});
  if (partition.load(bytes) == Status::ok) {
    PairBuffer pairs(&memory);
    (void)partition.self_pairs(pairs);
    Column<std::byte> again(&memory);
    const Status saved = partition.save(again);
    WINNOW_REQUIRE(saved == Status::ok || saved == Status::out_of_memory);
  }
  TriangleMesh mesh(&memory);
  if (mesh.load(bytes) == Status::ok) {
    Column<std::byte> again(&memory);
    WINNOW_REQUIRE(mesh.save(again) == Status::ok &&
                   text_of({again.data(), again.size()}) == text_of(bytes));
  }
}

/// A scene of bodies with seven kinds of convex shapes. `fuzz_seeds` saves its snapshots as seeds;
/// `load_scene` loads mutated snapshots into it.
struct FuzzedScene {
  FuzzedScene()
      : world(12),
        scene(world.pool, {.execution = Execution::serial(),
                           .contact_margin = 0.05,
                           .cache_tolerance = 0.01,
                           .warm_start = true}) {
    WINNOW_REQUIRE(add_all(scene, world) == Status::ok);
    WINNOW_REQUIRE(scene.collide(ContactLevel::manifold, contacts) == Status::ok);
  }

  SceneWorld world;
  Scene scene;
  Contacts contacts;
};

void load_scene(const Bytes8& saved) {
  Bytes8 bytes = saved;
  seal_snapshot(bytes);
  LimitedMemory memory(kMaxMemory);
  ShapePool shapes(&memory);
  Column<std::byte> again(&memory);
  if (shapes.load(bytes) == Status::ok) WINNOW_REQUIRE(shapes.save(again) == Status::ok);
  CompositePool composites(shapes, &memory);
  if (composites.load(bytes, Execution::serial()) == Status::ok) {
    WINNOW_REQUIRE(composites.save(again) == Status::ok);
  }
  FuzzedScene stage;
  const Status loaded = stage.scene.load_contacts(bytes, stage.contacts);
  if (loaded != Status::ok && stage.scene.load(bytes) != Status::ok) return;
  const Status status = stage.scene.collide(ContactLevel::manifold, stage.contacts);
  WINNOW_REQUIRE(status == Status::ok || status == Status::out_of_memory);
  WINNOW_REQUIRE(stage.scene.save_contacts(stage.contacts, again) == Status::ok ||
                 status != Status::ok);
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  const std::span<const std::byte> bytes = std::as_bytes(input);
  play({bytes.begin(), bytes.end()});
  load({bytes.begin(), bytes.end()});
  load_scene({bytes.begin(), bytes.end()});
}

std::vector<std::string> fuzz_seeds() {
  Bytes8 partitions;
  Bytes8 scenes;
  {
    Recorder recorder(kept_in(partitions));
    record_partition(recorder, linear_bvh(), 20, 7);
    record_volumes(recorder, 6);
  }
  {
    Recorder recorder(kept_in(scenes));
    record_scene(recorder, 12, 7, {.contact_margin = 0.02});
  }
  Column<std::byte> saved(std::pmr::get_default_resource());
  Partition partition(flat_grid(), {.volume = Volume::sphere});
  std::vector<Key> keys(20);
  (void)partition.insert(uniform_boxes(keys.size()), {}, keys);
  (void)partition.remove(keys[7]);
  (void)partition.save(saved);
  std::vector<std::string> seeds{"", text_of(partitions), text_of(scenes),
                                 text_of({saved.data(), saved.size()})};
  saved.clear();
  TriangleMesh mesh;
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> corners{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  (void)mesh.build(vertices, IndexView(std::span<const std::uint32_t>(corners)));
  (void)mesh.save(saved);
  seeds.push_back(text_of({saved.data(), saved.size()}));
  const FuzzedScene stage;
  CompositePool composites(stage.world.pool);
  const std::vector<CompoundChild> children(3, {stage.world.shapes[2], Pose::at(1, 0, 0)});
  ShapeId id;
  id = composites.add_compound(children);
  id = composites.add_mesh(vertices, IndexView(std::span<const std::uint32_t>(corners)));
  const auto keep = [&](auto&& save) {
    saved.clear();
    (void)save(saved);
    seeds.push_back(text_of({saved.data(), saved.size()}));
  };
  keep([&](auto& out) { return stage.world.pool.save(out); });
  keep([&](auto& out) { return composites.save(out); });
  keep([&](auto& out) { return stage.scene.save(out); });
  keep([&](auto& out) { return stage.scene.save_contacts(stage.contacts, out); });
  Random random(3);
  const std::size_t whole = seeds.size();
  for (std::size_t i = 0; i < scaled(300); ++i) {
    const std::string& seed = seeds[1 + i % (whole - 1)];
    const auto begin = std::as_bytes(std::span(seed));
    Bytes8 bytes(begin.begin(), begin.end());
    mutate(bytes, random);
    seeds.push_back(text_of(bytes));
  }
  return seeds;
}

}  // namespace winnow::test
