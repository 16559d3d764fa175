#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/pair_buffer.h>
#include "bench/common/sample.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

/// Thrown by an engine that gives up a frame, see Engine::give_up_after.
struct GaveUp {};

/// Anything that can be raced on a scene: a partition of winnow or another library. The harness
/// times `start` and `frame` from outside and calls the rest outside its timers, so whatever a
/// user would have to pay for a frame (update, rebuild, sorting out duplicates, copying pairs out
/// of a callback) belongs inside those two.
///
/// An object is its row, 0..N-1, and keeps it for the whole run; there may come more. Calls come
/// from one thread, inside a `tbb::task_arena` of the thread count the engine was made for.
class Engine {
 public:
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  /// Short and stable, e.g. "FlatGrid" or "Bullet dbvt". The same on every call.
  [[nodiscard]] virtual std::string name() const = 0;

  /// Objects above which a run would take unreasonably long; such scenes are skipped by name where
  /// its time is not bounded.
  [[nodiscard]] virtual std::size_t largest() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Whether it uses one thread, whatever number it was made for.
  [[nodiscard]] virtual bool is_serial() const { return false; }

  /// From now on a `start` or `frame` that takes longer ends with GaveUp, and nothing but `bytes`
  /// is asked of it any more. Only engines whose frames may take minutes look at the time.
  void give_up_after(double ms) noexcept { most_ms_ = ms; }

  /// Frame 0: takes the boxes (row = index) and finds their pairs. Called once, before anything
  /// but what is above.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// A later frame. `changed_rows` (ascending, each once, maybe empty) are the objects whose boxes
  /// differ from the last frame; `all_boxes` holds every object's box, changed or not; rows that
  /// the last frame did not have are new objects. Brings them in and finds all pairs. `all_boxes`
  /// is not kept alive after the call.
  virtual void frame(std::span<const std::uint32_t> changed_rows,
                     std::span<const Aabb> all_boxes) = 0;

  /// What the last `start` or `frame` found: pairs of rows, each unordered pair once, (i, j) or
  /// (j, i), any order. All truly overlapping pairs (closed boxes: touching is overlapping) must be
  /// there; pairs that do not overlap may be there too, they are filtered out and counted as
  /// reported. Valid until the next non-const call.
  [[nodiscard]] virtual std::span<const Pair> pairs() const = 0;

  /// Bytes held now, without the pairs found; 0 if the library cannot tell.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  /// Milliseconds of the last `start` or `frame` that went into bringing boxes in, before the
  /// search for pairs; 0 if the two cannot be told apart.
  [[nodiscard]] virtual double update_ms() const { return 0.0; }

 protected:
  Engine() = default;

  /// Throws GaveUp if more than the bound has gone by.
  void check_time(const Stopwatch& since_start) const {
    if (since_start.ms() > most_ms_) throw GaveUp{};
  }

 private:
  double most_ms_ = std::numeric_limits<double>::infinity();
};

}  // namespace winnow::bench
