#include "bench/measure/continuous_race.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include "bench/common/interleaved_runs.h"
#include "bench/common/need.h"
#include "bench/common/timed.h"
#include "bench/contenders/partitions.h"
#include "bench/scenes/body_scenes.h"
#include "bench/scenes/random_shapes.h"

#include <utility>

namespace winnow::bench {
namespace {

/// In sizes of the bodies, which are about 1.
constexpr double kFarthest = 10.0;

/// A heap, and the poses of its bodies at the end of a frame.
class MovingHeap {
 public:
  explicit MovingHeap(const ContinuousRaceOptions& options)
      : set_(make_heap(options.bodies, options.seed)),
        scene_(set_->pool, {.execution = execution_for(options.threads)}),
        ccd_(scene_),
        keys_(options.bodies),
        bullets_(options.bodies),
        random_(options.seed) {
    std::vector<BodyDefinition> bodies(options.bodies);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i].shape = set_->shapes[i];
      bodies[i].pose = set_->poses[i];
    }
    need(scene_.add(bodies, keys_), "the bodies");
    // The kinds of shapes are consecutive in the heap: fast bodies are spread evenly over all of
    // them.
    for (std::size_t i = 0; i < options.fast; ++i) {
      bullets_[i * options.bodies / options.fast] = 1;
    }
  }

  void next_frame(std::uint64_t frame) {
    apply_pose_noise(*set_, kMoving, frame, poses_);
    need(scene_.move(keys_, poses_), "poses");
    apply_pose_noise(*set_, kMoving, frame + 1, ends_);
    fast_keys_.clear();
    fast_ends_.clear();
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (bullets_[i] == 0) continue;
      const Eigen::Vector3d way = random_.in(0.1, 1.0) * kFarthest * random_unit(random_);
      for (int axis = 0; axis < 3; ++axis) ends_[i].position[axis] += way[axis];
      fast_keys_.push_back(keys_[i]);
      fast_ends_.push_back(ends_[i]);
    }
  }

  void collide() { need(scene_.collide(ContactLevel::manifold, contacts_), "contacts"); }
  void find_impacts_of_fast() {
    need(ccd_.find_impacts(fast_keys_, std::span<const Pose>(fast_ends_), {.first_only = true}),
         "impacts");
  }
  void find_all_impacts() {
    need(ccd_.find_impacts(
             keys_, std::span<const Pose>(ends_),
             {.pairs = ContinuousPairs::bullets, .bullets = bullets_, .first_only = true}),
         "impacts");
  }
  [[nodiscard]] const ContinuousCollision& ccd() const { return ccd_; }

 private:
  std::unique_ptr<BodySet> set_;
  Scene scene_;
  ContinuousCollision ccd_;
  Contacts contacts_;
  std::vector<Key> keys_;
  std::vector<std::uint8_t> bullets_;
  std::vector<Pose> poses_;
  std::vector<Pose> ends_;
  std::vector<Key> fast_keys_;
  std::vector<Pose> fast_ends_;
  Random random_;
};

}  // namespace

ContinuousTiming measure_continuous_collision(const ContinuousRaceOptions& options) {
  MovingHeap heap(options);
  Arenas arenas(options.threads);
  ContinuousTiming timing;
  auto ms = run_interleaved(3, options.frames, 2, [&](std::size_t frame, std::size_t turn) {
    if (turn == 0) heap.next_frame(frame);
    const double taken = timed(options.threads, arenas, [&] {
      if (turn == 0) heap.collide();
      if (turn == 1) heap.find_all_impacts();
      if (turn == 2) heap.find_impacts_of_fast();
    });
    timing.pairs = heap.ccd().statistics().body_pairs;
    timing.impacts = heap.ccd().impacts().size();
    return taken;
  });
  timing.collide_ms = std::move(ms[0]);
  timing.all_ms = std::move(ms[1]);
  timing.impacts_ms = std::move(ms[2]);
  return timing;
}

}  // namespace winnow::bench
