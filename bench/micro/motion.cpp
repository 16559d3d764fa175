// Benchmarks of continuous collision detection: times of impact of moving shapes (winnow and other
// libraries), and impacts of a heap with some fast bodies beside its contacts.

#include "bench/micro/micro.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include "bench/common/need.h"
#include "bench/contenders/partitions.h"
#include "bench/contenders/winnow_engines.h"
#include "bench/measure/impact_judge.h"
#include "bench/scenes/body_scenes.h"
#include "bench/scenes/random_shapes.h"

#include <cmath>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kMovingPairs = 2048;

/// Moving pairs of one kind, with what is known about them.
struct JudgedMotions {
  MovingPairSet set;
  ImpactJudge judge;

  JudgedMotions(const PairKind& kind, PairTurn turn)
      : set(make_moving_pairs(kind, turn, {.pairs = kMovingPairs})), judge(set) {}
};

using MakeImpacts = std::function<std::unique_ptr<ImpactEngine>()>;

void add_impacts(const PairKind& kind, PairTurn turn, const std::string& name,
                 const MakeImpacts& make, bool is_winnow) {
  const std::string path = "toi/" + std::string(kind.name) + "/turn:" + word_of(to_text(turn));
  add(path + "/" + name, [=](benchmark::State& state) {
    auto& motions = prepared<JudgedMotions>(path, kind, turn);
    ImpactEngine& engine = started<ImpactEngine>(path + name, make, motions.set);
    const ImpactFaults faults = motions.judge.judge(engine);
    if (is_winnow) check(faults.missed + faults.late + faults.loose == 0, "an impact is wrong");
    const std::vector<BodyPair>& pairs = motions.set.middle->pairs;
    run(state, 1, [&] { engine.run(pairs); });
    count_ns(state, "ns_per_pair", pairs.size());
    count(state, "pairs", faults.judged);
    count(state, "hits", faults.hits);
    count(state, "missed", faults.missed);
    count(state, "late", faults.late);
    count(state, "loose", faults.loose);
    count(state, "median_gap", faults.median_gap);
    count(state, "worst_gap", faults.worst_gap);
  });
}

/// A heap in which some bodies move by up to ten times their size in a frame, and all others by a
/// little.
class MovingHeap {
 public:
  MovingHeap(std::size_t bodies, std::size_t fast, int threads)
      : set_(make_heap(bodies, 1)),
        scene_(set_->pool, {.execution = execution_for(threads)}),
        ccd_(scene_),
        keys_(add_bodies(*set_, scene_)),
        bullets_(bodies) {
    // The kinds of shapes are consecutive in the heap: fast bodies are spread evenly over all of
    // them.
    for (std::size_t i = 0; i < fast; ++i) bullets_[i * bodies / fast] = 1;
    for (std::uint64_t frame = 0; frame < 2; ++frame) next_frame();
  }

  void next_frame() {
    apply_pose_noise(*set_, kMoving, frame_, poses_);
    need(scene_.move(keys_, poses_), "poses");
    apply_pose_noise(*set_, kMoving, ++frame_, ends_);
    fast_keys_.clear();
    fast_ends_.clear();
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (bullets_[i] == 0) continue;
      ends_[i].position += random_.in(0.1, 1.0) * kFarthest * random_unit(random_);
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
  [[nodiscard]] const Contacts& contacts() const { return contacts_; }
  [[nodiscard]] const ContinuousCollision& ccd() const { return ccd_; }

 private:
  /// In sizes of the bodies, which are about 1.
  static constexpr double kFarthest = 10.0;

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
  Random random_{1};
  std::uint64_t frame_ = 0;
};

/// Registers one call on a heap. Every iteration has new poses, which are set outside of the time.
void add_heap(const std::string& what, void (MovingHeap::*call)(), std::size_t bodies,
              std::size_t fast, int threads) {
  const std::string of_heap = "/bodies:" + std::to_string(bodies) +
                              "/fast:" + std::to_string(fast) +
                              "/threads:" + std::to_string(threads);
  add("continuous/" + what + of_heap, threads, [=](benchmark::State& state) {
    auto& heap = prepared<MovingHeap>(of_heap, bodies, fast, threads);
    run(state, threads, [&] {
      state.PauseTiming();
      heap.next_frame();
      state.ResumeTiming();
      (heap.*call)();
    });
    const bool contacts = what == "collide";
    const std::size_t found = contacts ? heap.contacts().size() : heap.ccd().impacts().size();
    if (found == 0) return state.SkipWithError("nothing was hit");
    count(state, contacts ? "contacts" : "impacts", found);
    if (!contacts) count(state, "pairs", std::size_t{heap.ccd().statistics().body_pairs});
  });
}

}  // namespace

void add_motion() {
  for (const PairKind& kind : pair_kinds()) {
    for (const PairTurn turn : kPairTurns) {
      add_impacts(kind, turn, "winnow", make_winnow_impacts, true);
      each_peer<ImpactEngine>([&](const ImpactEngine& peer, const MakeImpacts& make) {
        if (peer.takes(kind, turn)) add_impacts(kind, turn, word_of(peer.name()), make, false);
      });
    }
  }
  for (const int threads : {1, 2}) {
    add_heap("collide", &MovingHeap::collide, 10'000, 1'000, threads);
    add_heap("fast", &MovingHeap::find_impacts_of_fast, 10'000, 1'000, threads);
    add_heap("all", &MovingHeap::find_all_impacts, 10'000, 1'000, threads);
  }
}

}  // namespace winnow::bench::micro
