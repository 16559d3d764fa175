#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/pair_buffer.h>
#include "bench/common/interface.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

/// Base of everything that is raced on a scene: winnow's partitions and other libraries. The
/// harness times `start` and `frame` from outside and calls everything else outside its timers. All
/// work that a user pays for in a frame (update, rebuild, removal of duplicates, copying pairs out
/// of a callback) therefore belongs in these two functions.
///
/// An object is identified by its row, 0..N-1, for the whole run; later frames may add rows. All
/// calls come from one thread, inside a `tbb::task_arena` of the thread count that the engine was
/// made for.
class Engine : public Interface {
 public:
  /// A short constant name, e.g. "FlatGrid" or "Bullet dbvt".
  [[nodiscard]] virtual std::string name() const = 0;

  /// Number of objects above which a run takes unreasonably long. Larger scenes are skipped, and
  /// reported as skipped.
  [[nodiscard]] virtual std::size_t largest() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// True if it uses one thread, whatever number it was made for.
  [[nodiscard]] virtual bool is_serial() const { return false; }

  /// Frame 0: takes the boxes (row = index) and finds their pairs. Called once, before `frame`,
  /// `pairs`, `bytes` and `update_ms`.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// A later frame: updates the boxes and finds all pairs. `changed_rows` (ascending, unique, maybe
  /// empty) are the objects whose boxes differ from the last frame. `all_boxes` are the boxes of
  /// all objects, changed or not; rows that the last frame did not have are new objects. The spans
  /// are valid only during the call.
  virtual void frame(std::span<const std::uint32_t> changed_rows,
                     std::span<const Aabb> all_boxes) = 0;

  /// Pairs of rows that the last `start` or `frame` found: each unordered pair once, as (i, j) or
  /// (j, i), in any order. All overlapping pairs (closed boxes: touching is overlapping) must be
  /// included. Other pairs may be included; the harness filters them out and counts them as
  /// reported. Valid until the next non-const call.
  [[nodiscard]] virtual std::span<const Pair> pairs() const = 0;

  /// Bytes allocated now, without the pairs found; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  /// Milliseconds that the last `start` or `frame` spent on updating boxes before the search for
  /// pairs; 0 if the update and the search cannot be separated.
  [[nodiscard]] virtual double update_ms() const { return 0.0; }
};

}  // namespace winnow::bench
