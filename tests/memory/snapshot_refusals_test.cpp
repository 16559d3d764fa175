// Refuses each memory request of saving, loading, recording and replaying in turn (refusals.h has
// the loop over requests for snapshots).

#include <winnow/pipeline/recording.h>
#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>

#include "tests/memory/refusals.h"
#include "tests/pipeline/composite_world.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

const Surface& some_hills() {
  static const Surface hills =
      grid(5, 1.0F, Cut::same, [](float x, float y) { return 0.4F * std::sin(x * y); });
  return hills;
}

const std::vector<float>& some_heights() {
  static const std::vector<float> heights{0.0F, 1.0F, 0.5F, 2.0F, 0.25F, 0.5F, 0.0F, 1.0F, 0.125F};
  return heights;
}

/// Two sides with one object of each type that can be saved: the original and the loaded copy.
struct SavedWorld {
  struct Side {
    Side(std::pmr::memory_resource* memory, Execution execution)
        : partition(flat_grid(), {.memory = memory, .execution = execution}),
          mesh(memory),
          field(memory),
          shapes(memory),
          composites(shapes, memory),
          scene(shapes, {.memory = memory,
                         .execution = execution,
                         .contact_margin = 0.1,
                         .warm_start = true,
                         .composites = &composites}),
          contacts(memory) {}

    Partition partition;
    TriangleMesh mesh;
    HeightField field;
    ShapePool shapes;
    CompositePool composites;
    Scene scene;
    Contacts contacts;
  };

  SavedWorld(std::pmr::memory_resource* memory, Execution execution)
      : one(memory, execution), other(memory, execution), bytes(memory) {}

  void describe(Digest& digest) const {
    for (const Side* side : {&one, &other}) {
      digest.insert(digest.end(),
                    {side->partition.size(), side->mesh.triangles(), side->mesh.vertices(),
                     side->field.columns(), side->shapes.size(ShapeKind::box),
                     side->composites.size(CompositeKind::mesh), side->scene.size()});
    }
    digest.insert(digest.end(), answers.begin(), answers.end());
    // Only the size: the bytes contain key stamps, which differ in every world.
    digest.push_back(bytes.size());
  }

  Status add_shapes() {
    if (!ids.empty()) return Status::ok;
    ShapeId box;
    ShapeId hills;
    Status status = one.shapes.add(BoxShape{{0.6, 0.5, 0.4}}).get(box);
    if (status != Status::ok) return status;
    const std::vector<Vec3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    ShapeId hull;
    status = one.shapes.add_hull(corners, 0.0).get(hull);
    if (status == Status::ok) {
      status = one.composites
                   .add_mesh(std::span<const Point>(some_hills().vertices),
                             std::span<const std::uint32_t>(some_hills().corners))
                   .get(hills);
      if (status != Status::ok) {
        EXPECT_EQ(one.shapes.remove(hull), Status::ok);
      }
    }
    if (status != Status::ok) {
      EXPECT_EQ(one.shapes.remove(box), Status::ok);
      return status;
    }
    ids = {box, hull, hills};
    return status;
  }
  Status add_bodies() {
    Random random(4);
    std::vector<BodyDefinition> bodies;
    for (std::size_t i = 0; i < 12; ++i) {
      bodies.push_back({.shape = ids[i % 3],
                        .pose = Pose::at(random.uniform(-1, 1), random.uniform(-1, 1), 0.0),
                        .data = i});
    }
    std::vector<Key> keys(bodies.size());
    return one.scene.add(bodies, keys);
  }
  /// Leaves out events: a refusal clears the contacts and with them the last frame.
  Status collide(Side& side) {
    const Status status = side.scene.collide(ContactLevel::manifold, side.contacts);
    if (status != Status::ok) return status;
    for (std::size_t i = 0; i < side.contacts.size(); ++i) {
      answers.insert(answers.end(), {side.contacts.data_a()[i], side.contacts.data_b()[i]});
    }
    return status;
  }
  /// Appends to the earlier snapshots.
  template <typename Save>
  Status save(Save&& how) {
    const std::size_t before = bytes.size();
    const Status status = how(bytes);
    if (status == Status::ok) begin = before;
    return status;
  }
  /// Returns the last snapshot.
  [[nodiscard]] std::span<const std::byte> saved() const {
    return std::span(bytes.data(), bytes.size()).subspan(begin);
  }

  Side one;
  Side other;
  Column<std::byte> bytes;
  std::size_t begin = 0;
  std::vector<ShapeId> ids;
  Digest answers;
};

using SavedCalls = std::vector<Call<SavedWorld>>;

void add_parts(SavedCalls& calls) {
  calls.push_back({"boxes", [](auto& w) {
                     static const std::vector<Aabb> boxes = mixed_boxes(70, 3);
                     std::vector<Key> keys(boxes.size());
                     return w.one.partition.insert(boxes, {}, keys);
                   }});
  calls.push_back({"mesh", [](auto& w) {
                     return w.one.mesh.build(std::span<const Point>(some_hills().vertices),
                                             std::span<const std::uint32_t>(some_hills().corners));
                   }});
  calls.push_back({"field", [](auto& w) { return w.one.field.build({some_heights(), 3, 3}); }});
  calls.push_back({"save boxes", [](auto& w) {
                     return w.save([&](auto& to) { return w.one.partition.save(to); });
                   }});
  calls.push_back({"load boxes", [](auto& w) { return w.other.partition.load(w.saved()); }});
  calls.push_back(
      {"save mesh", [](auto& w) { return w.save([&](auto& to) { return w.one.mesh.save(to); }); }});
  calls.push_back({"load mesh", [](auto& w) { return w.other.mesh.load(w.saved()); }});
  calls.push_back({"save field",
                   [](auto& w) { return w.save([&](auto& to) { return w.one.field.save(to); }); }});
  calls.push_back({"load field", [](auto& w) { return w.other.field.load(w.saved()); }});
}

void add_scene(SavedCalls& calls) {
  calls.push_back({"shapes", [](auto& w) { return w.add_shapes(); }});
  calls.push_back({"bodies", [](auto& w) { return w.add_bodies(); }});
  calls.push_back({"contacts", [](auto& w) { return w.collide(w.one); }});
  calls.push_back({"save shapes", [](auto& w) {
                     return w.save([&](auto& to) { return w.one.shapes.save(to); });
                   }});
  calls.push_back({"load shapes", [](auto& w) { return w.other.shapes.load(w.saved()); }});
  calls.push_back({"save composites", [](auto& w) {
                     return w.save([&](auto& to) { return w.one.composites.save(to); });
                   }});
  calls.push_back({"load composites", [](auto& w) {
                     return w.other.composites.load(w.saved(), Execution::serial());
                   }});
  calls.push_back({"save scene",
                   [](auto& w) { return w.save([&](auto& to) { return w.one.scene.save(to); }); }});
  calls.push_back({"load scene", [](auto& w) { return w.other.scene.load(w.saved()); }});
  calls.push_back({"save contacts", [](auto& w) {
                     return w.save(
                         [&](auto& to) { return w.one.scene.save_contacts(w.one.contacts, to); });
                   }});
  calls.push_back({"load contacts", [](auto& w) {
                     return w.other.scene.load_contacts(w.saved(), w.other.contacts);
                   }});
  calls.push_back({"contacts of the loaded scene", [](auto& w) { return w.collide(w.other); }});
}

TEST(SnapshotRefusals, refused_memory_changes_nothing) {
  for (const int threads : {1, 2}) {
    SavedCalls calls;
    add_parts(calls);
    add_scene(calls);
    const Execution execution = threads == 1 ? Execution::serial() : Execution::parallel();
    EXPECT_GT((RefusedPlay<SavedWorld, Execution>(calls, threads, execution).check()),
              is_quick() ? 50U : 100U);
  }
}

/// Runs a program whose recorder is refused the k-th memory request, and returns true if there was
/// such a request. Checks that the program's own results do not change, and that the recording is
/// complete unless `close` returns an error. The recorder may get by without memory that was
/// refused.
bool record(std::size_t k, std::vector<std::byte>& recording) {
  CountingMemory memory;
  const RecordingSink sink{[](void* to, std::span<const std::byte> bytes) {
                             auto& out = *static_cast<std::vector<std::byte>*>(to);
                             out.insert(out.end(), bytes.begin(), bytes.end());
                             return true;
                           },
                           &recording};
  memory.refuse_one_after(k);
  {
    Recorder recorder(sink, &memory);
    Partition partition(linear_bvh(), {.recorder = &recorder});
    const std::vector<Aabb> boxes = mixed_boxes(60, 5);
    std::vector<Key> keys(boxes.size());
    EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    PairBuffer pairs;
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
      recorder.end_frame();
    }
    EXPECT_GT(pairs.size(), 0U);
    const Status status = recorder.close();
    EXPECT_TRUE(status == Status::ok ||
                (status == Status::out_of_memory && memory.refusals() != 0));
    const RecordingPlayer player(recording);
    EXPECT_EQ(status == Status::ok, player.status() == Status::ok && player.is_whole());
  }
  EXPECT_EQ(memory.outstanding(), 0U);
  return memory.refusals() != 0;
}

TEST(RecordingRefusals, refused_recorder_ends_recording_but_not_program) {
  std::size_t refused = 0;
  for (std::vector<std::byte> recording; record(refused, recording); recording.clear()) {
    ++refused;
    ASSERT_FALSE(HasFailure()) << "request " << refused;
  }
  EXPECT_GT(refused, 2U);
}

/// Replays a recording with a player that is refused the k-th request, and returns true if there
/// was such a request.
bool play(std::span<const std::byte> recording, std::size_t k) {
  CountingMemory memory;
  memory.refuse_one_after(k);
  {
    RecordingPlayer player(recording, {.memory = &memory, .execution = Execution::serial()});
    const Status status = player.play_all();
    EXPECT_TRUE(status == Status::ok ||
                (status == Status::out_of_memory && memory.refusals() != 0));
    if (status == Status::ok) {
      EXPECT_EQ(player.counts().frames, 3U);
    }
    EXPECT_EQ(player.counts().differences, 0U);
  }
  EXPECT_EQ(memory.outstanding(), 0U);
  return memory.refusals() != 0;
}

TEST(RecordingRefusals, refused_player_returns_out_of_memory) {
  std::vector<std::byte> recording;
  ASSERT_FALSE(record(100'000, recording));
  std::size_t refused = 0;
  while (play(recording, refused)) {
    ++refused;
    ASSERT_FALSE(HasFailure()) << "request " << refused;
  }
  EXPECT_GT(refused, 5U);
}

}  // namespace
}  // namespace winnow::test
