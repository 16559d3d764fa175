#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

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

  /// Objects above which a run would take unreasonably long; such scenes are skipped by name.
  [[nodiscard]] virtual std::size_t largest() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Whether a frame may have more boxes than the last one; scenes that grow are skipped by name if
  /// not.
  [[nodiscard]] virtual bool can_grow() const { return false; }

  /// Frame 0: takes the boxes (row = index) and finds their pairs. Called once, before anything
  /// but `name`, `largest` and `can_grow`.
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
};

}  // namespace winnow::bench
