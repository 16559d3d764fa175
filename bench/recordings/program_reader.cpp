// Converts a recording of a program's calls (winnow::Recorder) into frames of boxes and contacts.
// read_recording() in aabbs.cpp calls it. The calls are played twice: first to find the partition
// or scene with the most objects, then to read its boxes at each frame's end.

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/scene.h>
#include "bench/recordings/recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace winnow::bench {
namespace {

/// Plays a program's recording and reads the boxes of the partition or scene with the most objects.
class ProgramReader {
 public:
  ProgramReader(const std::string& path, std::span<const std::byte> bytes)
      : path_(path), bytes_(bytes) {}

  Recording read() {
    recording_.scene = std::filesystem::path(path_).stem().string();
    recording_.object_type = "box";
    play_once();
    take_frames();
    if (recording_.frames.empty()) fail("no partition or scene in it holds an object");
    park_absent();
    return std::move(recording_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw RecordingError(path_ + ": " + what);
  }

  /// Plays the recording once. Finds the partition or scene (`world_`) with the most objects, and
  /// whether the recording marks frames; if not, each query for all pairs or contacts ends a frame.
  void play_once() {
    RecordingPlayer player(bytes_);
    std::size_t most = 0;
    for (Played played = player.step(); played != Played::end; played = player.step()) {
      if (played != Played::pairs && played != Played::frame) continue;
      for (std::size_t world = 0; world < player.worlds(); ++world) {
        const std::size_t objects = size_of(player, world);
        if (objects > most) world_ = world;
        most = std::max(most, objects);
      }
    }
    if (player.status() != Status::ok) {
      fail(std::string("is no recording, or damaged: ") + to_string(player.status()) + " after " +
           std::to_string(player.counts().calls) + " calls");
    }
    frame_end_ = player.counts().frames != 0 ? Played::frame : Played::pairs;
    recording_.program = Recording::Program{.calls = player.counts().calls,
                                            .questions = player.counts().questions,
                                            .differences = player.counts().differences,
                                            .is_whole = player.is_whole()};
  }

  static std::size_t size_of(const RecordingPlayer& player, std::size_t world) {
    if (const Partition* const partition = player.world(world).partition) return partition->size();
    if (const Scene* const scene = player.world(world).scene) return scene->size();
    return 0;
  }

  /// Plays the recording again and takes the frames that have objects.
  void take_frames() {
    RecordingPlayer player(bytes_);
    std::size_t rows = 0;
    for (Played played = player.step(); played != Played::end; played = player.step()) {
      if (played != frame_end_ || size_of(player, world_) == 0) continue;
      std::vector<Aabb>& frame = recording_.frames.emplace_back(rows);
      take_boxes(player, frame);
      rows = frame.size();
      recording_.contacts.push_back(contacts_of(player));
    }
  }

  [[nodiscard]] std::vector<RecordedContact> contacts_of(const RecordingPlayer& player) const {
    std::vector<RecordedContact> found;
    const Contacts* const contacts = player.world(world_).contacts;
    if (contacts == nullptr || contacts->level() != ContactLevel::manifold) return found;
    for (std::size_t pair = 0; pair < contacts->size(); ++pair) {
      // Skips bodies that were removed after the contacts were computed.
      const Answer<BodyDefinition> body = player.world(world_).scene->body(contacts->a()[pair]);
      if (body.status != Status::ok) continue;
      const std::uint32_t last = contacts->manifold_first()[pair + 1];
      for (std::uint32_t m = contacts->manifold_first()[pair]; m < last; ++m) {
        take_points(*contacts, m, body.pose, found);
      }
    }
    return found;
  }

  static void take_points(const Contacts& contacts, std::uint32_t manifold, const Pose& pose,
                          std::vector<RecordedContact>& found) {
    const std::uint32_t last = contacts.point_first()[manifold + 1];
    for (std::uint32_t p = contacts.point_first()[manifold]; p < last; ++p) {
      const ContactPoint point = contacts.contact(p);
      RecordedContact& contact = found.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        contact.at[axis] = static_cast<float>(pose.position[axis] + point.position[axis]);
        contact.normal[axis] = static_cast<float>(contacts.normal(axis)[manifold]);
      }
    }
  }

  /// Stores each object's box in the row of its id. Rows without an object stay empty.
  void take_boxes(const RecordingPlayer& player, std::vector<Aabb>& frame) const {
    const auto put = [&](ObjectId id, const Aabb& box) {
      if (frame.size() <= id) frame.resize(id + std::size_t{1});
      frame[id] = box;
    };
    const Partition* const partition = player.world(world_).partition;
    const Scene* const scene = player.world(world_).scene;
    std::size_t left = size_of(player, world_);
    for (ObjectId id = 0; left != 0; ++id) {
      const Key key = partition != nullptr ? partition->key_of(id) : scene->key_of(id);
      if (key == Key{}) continue;
      --left;
      Aabb box;
      BodyDefinition body;
      if (partition != nullptr) {
        box = partition->bounds(key);
      } else if (scene->body(key).get(body) == Status::ok) {
        box = body.shape.is_composite()
                  ? player.world(world_).composites->bounds(body.shape, body.pose)
                  : player.world(world_).shapes->bounds(body.shape, body.pose);
      }
      put(id, box);
    }
  }

  /// Replaces each row without an object by a distinct point outside the bounds of all boxes.
  void park_absent() {
    Aabb& world = recording_.world;
    std::size_t rows = 0;
    for (const std::vector<Aabb>& frame : recording_.frames) {
      for (const Aabb& box : frame) {
        for (int axis = 0; axis < 3; ++axis) {
          if (std::isfinite(box.min[axis]))
            world.min[axis] = std::min(world.min[axis], box.min[axis]);
          if (std::isfinite(box.max[axis]))
            world.max[axis] = std::max(world.max[axis], box.max[axis]);
        }
      }
      rows = std::max(rows, frame.size());
    }
    int along = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // All boxes of all frames are infinite along this axis.
      if (!(world.min[axis] <= world.max[axis])) world.min[axis] = world.max[axis] = 0.0F;
      if (extent(axis) > extent(along)) along = axis;
    }
    const int beside = (along + 1) % 3;
    const float step = extent(along) / static_cast<float>(rows);
    const float off = world.max[beside] + std::max(1e-3F * extent(along), 1e-3F);
    for (std::vector<Aabb>& frame : recording_.frames) {
      for (std::size_t row = 0; row < frame.size(); ++row) {
        if (frame[row].is_valid()) continue;
        Vec3f at = world.min;
        at[along] += (static_cast<float>(row) + 0.5F) * step;
        at[beside] = off;
        frame[row] = {at, at};
      }
    }
    world.max[beside] = off;
  }

  [[nodiscard]] float extent(int axis) const {
    return recording_.world.max[axis] - recording_.world.min[axis];
  }

  const std::string& path_;
  std::span<const std::byte> bytes_;
  Recording recording_;
  std::size_t world_ = 0;
  Played frame_end_ = Played::frame;
};

}  // namespace

Recording read_program(const std::string& path, std::span<const std::byte> bytes) {
  return ProgramReader(path, bytes).read();
}

}  // namespace winnow::bench
