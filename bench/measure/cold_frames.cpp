// Times the first frame of new partitions, on fresh and on used memory, with and without reserved
// room. bench/rows/frame_rows.cpp calls `race_cold_frames`.

#include "bench/measure/cold_frames.h"

#include <winnow/core/memory.h>
#include "bench/common/address_range.h"
#include "bench/common/arena.h"
#include "bench/common/need.h"
#include "bench/common/stage_clock.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/fingerprint.h"
#include "bench/peers/peers.h"

#include <algorithm>
#include <memory>
#include <memory_resource>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Bytes of address space for all allocations of a first frame, including freed ones.
std::size_t room_for(std::size_t objects) {
  constexpr std::size_t kEach = 8192;
  return (std::size_t{1} << 28U) + kEach * objects;
}

/// Milliseconds from the start of a first frame to the end of each part.
struct Parts {
  double inserted = 0.0;
  double built = 0.0;
  double found = 0.0;
};

Parts run_frame(std::span<const Aabb> boxes, Partition& partition, std::vector<Key>& keys,
                PairBuffer& pairs, const Stopwatch& clock) {
  // Calling `refresh` before would change the measurement: programs query pairs directly, and the
  // structure built for other queries takes longer.
  const StageClock build(WorkStage::refresh);
  Parts parts;
  need(partition.insert(boxes, {}, keys), "objects");
  parts.inserted = clock.ms();
  need(partition.self_pairs(pairs), "pairs");
  parts.found = clock.ms();
  parts.built = parts.inserted + build.ms();
  return parts;
}

/// Runs first frames, each of a new partition.
struct FirstFrames {
  std::span<const Aabb> boxes;
  int threads;
  AddressRange fresh{room_for(boxes.size())};
  std::vector<Key> keys = std::vector<Key>(boxes.size());

  [[nodiscard]] Partition make(const ColdFrames& frames, std::pmr::memory_resource& memory) {
    return make_named(frames.partition, {.memory = &memory, .execution = execution_for(threads)});
  }
  /// Runs one first frame and returns its pairs.
  PairSummary run(ColdFrames& frames, std::pmr::memory_resource& memory) {
    const Stopwatch clock;
    Partition partition = make(frames, memory);
    PairBuffer pairs(&memory);
    const Parts parts = run_frame(boxes, partition, keys, pairs, clock);
    frames.times["insert_ms"].push_back(parts.inserted);
    frames.times["build_ms"].push_back(parts.built - parts.inserted);
    frames.times["pairs_ms"].push_back(parts.found - parts.built);
    frames.times["total_ms"].push_back(parts.found);
    frames.times["pages_ms"].push_back(write_to_pages(partition.footprint().total().reserved +
                                                      pairs.footprint().total().reserved));
    return summarize(pairs.pairs(), boxes);
  }
  /// Milliseconds of the first write to `bytes` of ordinary pages.
  [[nodiscard]] double write_to_pages(std::size_t bytes) {
    fresh.forget();
    const Stopwatch clock;
    detail::prefault_pages(fresh.begin(), std::min(bytes, fresh.bytes()));
    return clock.ms();
  }
  /// As `run`, but reserves room for the objects and `count` pairs before the frame.
  PairSummary run_reserved(ColdFrames& frames, std::pmr::memory_resource& memory, std::size_t count,
                           Pages pages) {
    Partition partition = make(frames, memory);
    PairBuffer pairs(&memory);
    const Stopwatch before;
    need(partition.reserve(boxes.size(), pages), "room for objects");
    need(partition.reserve_pairs(pairs, count, pages), "room for pairs");
    const double reserved = before.ms();
    const Stopwatch clock;
    const Parts parts = run_frame(boxes, partition, keys, pairs, clock);
    if (pages == Pages::prefaulted) frames.times["reserve_ms"].push_back(reserved);
    frames.times[pages == Pages::prefaulted ? "ready_ms" : "reserved_ms"].push_back(parts.found);
    return summarize(pairs.pairs(), boxes);
  }
};

/// Memory that is handed out again after each frame. No allocation may be alive then.
struct ReusedMemory {
  AddressRange range;
  std::pmr::monotonic_buffer_resource resource{range.begin(), range.bytes(),
                                               std::pmr::null_memory_resource()};
};

}  // namespace

ColdRace race_cold_frames(std::span<const Aabb> boxes, const std::vector<std::string>& partitions,
                          int threads, std::size_t rounds, bool with_yardstick) {
  ColdRace race;
  for (const std::string& partition : partitions) {
    for (const std::string_view memory : {kUntouched, kTouched, kLargePages}) {
      race.frames.push_back({.partition = partition, .memory = memory});
    }
  }
  FirstFrames frames{boxes, threads};
  ReusedMemory untouched{AddressRange(room_for(boxes.size()))};
  ReusedMemory prefaulted{AddressRange(room_for(boxes.size()))};
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
        prefaulted.resource.release();
        found.push_back(frames.run(one, prefaulted.resource));
        continue;
      }
      const auto on_fresh_pages = [&](const auto& run) {
        if (one.memory == kUntouched) {
          untouched.resource.release();
          untouched.range.forget();
          found.push_back(run(untouched.resource));
        } else {
          LargePages large;
          found.push_back(run(large));
        }
      };
      on_fresh_pages([&](auto& memory) { return frames.run(one, memory); });
      const std::size_t pairs = found.back().reported;
      for (const Pages pages : {Pages::untouched, Pages::prefaulted}) {
        on_fresh_pages(
            [&](auto& memory) { return frames.run_reserved(one, memory, pairs, pages); });
      }
    }
  };
  Arenas arenas(threads);
  arenas.run(threads, [&] {
    run_all();  // warms up code and the yardstick's own memory
    for (ColdFrames& one : race.frames) one.times.clear();
    race.yardstick_ms.clear();
    for (std::size_t round = 0; round < rounds; ++round) run_all();
  });
  for (const PairSummary& one : found) {
    if (!one.same_pairs(found.front())) throw std::runtime_error("not all found the same pairs");
  }
  return race;
}

}  // namespace winnow::bench
