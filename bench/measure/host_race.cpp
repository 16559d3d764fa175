#include "bench/measure/host_race.h"

#include "bench/common/arena.h"
#include "bench/common/need.h"
#include "bench/common/sample.h"
#include "bench/common/thread_pool.h"
#include "bench/contenders/partitions.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace winnow::bench {
namespace {

constexpr std::size_t kWarmingFrames = 5;

/// A partition that follows a scene.
struct Follower {
  Partition partition;
  std::vector<Key> keys;
  PairBuffer pairs{};

  void frame(std::span<const Aabb> boxes) {
    if (keys.size() < boxes.size()) {
      keys.resize(boxes.size());
      need(partition.insert(boxes, {}, keys), "objects");
    } else {
      need(partition.update(keys, boxes), "objects");
    }
    need(partition.self_pairs(pairs), "pairs");
  }
};

double ms_of_frame(Follower& follower, std::span<const Aabb> boxes) {
  const Stopwatch clock;
  follower.frame(boxes);
  return clock.ms();
}

// Idle threads spin for a while. This pause lets the threads of one host go to sleep, so that they
// take no time from the other.
void let_threads_sleep() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

HostRace race_hosts(FrameSource& source, std::string_view partition, int threads,
                    std::size_t frames) {
  ThreadPool pool(static_cast<std::size_t>(threads));
  Arenas arenas(threads);
  Follower in_arena{make_named(partition, {.execution = execution_for(threads)}), {}};
  Follower in_pool{make_named(partition, {.execution = Execution::on(pool.jobs())}), {}};
  HostRace race;
  for (std::size_t frame = 0; frame < kWarmingFrames + frames; ++frame) {
    double arena_ms = 0.0;
    double pool_ms = 0.0;
    for (const bool arena_now : {frame % 2 == 0, frame % 2 != 0}) {
      let_threads_sleep();
      if (arena_now) {
        arenas.run(threads, [&] { arena_ms = ms_of_frame(in_arena, source.boxes()); });
      } else {
        pool_ms = ms_of_frame(in_pool, source.boxes());
      }
    }
    if (!std::ranges::equal(in_arena.pairs.pairs(), in_pool.pairs.pairs())) {
      throw std::runtime_error("the threads of a pool find other pairs");
    }
    if (frame >= kWarmingFrames) {
      race.arena_ms.push_back(arena_ms);
      race.pool_ms.push_back(pool_ms);
    }
    if (!source.advance()) break;
  }
  return race;
}

}  // namespace winnow::bench
