#include "bench/measure/cold_frames.h"

#include "bench/common/arena.h"
#include "bench/common/need.h"
#include "bench/common/reused_memory.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/fingerprint.h"
#include "bench/peers/yardstick.h"

#include <memory>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// All that a first frame asks for, blocks that it gives back included.
std::size_t room_for(std::size_t objects) {
  constexpr std::size_t kEach = 8192;
  return (std::size_t{1} << 28U) + kEach * objects;
}

/// The first frame of a fresh partition; what it finds.
PairSummary run_cold_frame(std::span<const Aabb> boxes, int threads, ReusedMemory& memory,
                           std::vector<Key>& keys, ColdFrames& frames) {
  const Stopwatch clock;
  Partition partition =
      make_named(frames.partition, {.memory = &memory, .execution = execution_for(threads)});
  PairBuffer pairs(&memory);
  need(partition.insert(boxes, {}, keys), "objects");
  const double inserted = clock.ms();
  need(partition.refresh(), "a structure");
  const double built = clock.ms();
  need(partition.self_pairs(pairs), "pairs");
  const double found = clock.ms();
  frames.insert_ms.push_back(inserted);
  frames.build_ms.push_back(built - inserted);
  frames.pairs_ms.push_back(found - built);
  frames.total_ms.push_back(found);
  return summarize(pairs.pairs(), boxes);
}

void forget_frames(ColdRace& race) {
  for (ColdFrames& one : race.frames) {
    for (auto* times : {&one.insert_ms, &one.build_ms, &one.pairs_ms, &one.total_ms})
      times->clear();
  }
  race.yardstick_ms.clear();
}

}  // namespace

ColdRace race_cold_frames(std::span<const Aabb> boxes, const std::vector<std::string>& partitions,
                          int threads, std::size_t rounds, bool with_yardstick) {
  ColdRace race;
  for (const std::string& partition : partitions) {
    for (const std::string_view memory : {kUntouched, kTouched}) {
      race.frames.push_back({.partition = partition, .memory = memory});
    }
  }
  ReusedMemory memory(room_for(boxes.size()));
  std::vector<Key> keys(boxes.size());
  const std::unique_ptr<Engine> yardstick = with_yardstick ? make_yardstick(threads) : nullptr;
  std::vector<PairSummary> found;
  const auto run_all = [&] {
    if (yardstick != nullptr) {
      const Stopwatch clock;
      yardstick->start(boxes);
      race.yardstick_ms.push_back(clock.ms());
      found.push_back(summarize(yardstick->pairs(), boxes));
    }
    for (ColdFrames& one : race.frames) {
      if (one.memory == kTouched) {
        memory.rewind();
      } else {
        memory.rewind_untouched();
      }
      found.push_back(run_cold_frame(boxes, threads, memory, keys, one));
    }
  };
  Arenas arenas(threads);
  arenas.run(threads, [&] {
    run_all();  // code and the yardstick's own memory
    forget_frames(race);
    for (std::size_t round = 0; round < rounds; ++round) run_all();
  });
  for (const PairSummary& one : found) {
    if (!one.same_pairs(found.front())) throw std::runtime_error("not all found the same pairs");
  }
  return race;
}

}  // namespace winnow::bench
