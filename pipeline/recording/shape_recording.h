#pragma once

#include <winnow/core/memory.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/shape_pool.h>
#include "core/threads/mutex.h"
#include "pipeline/recording/recorder_state.h"

#include <cstdint>

namespace winnow {

/// A shape that was recorded.
struct RecordedShape {
  ShapeId id;            ///< id in the program's pools
  std::uint32_t number;  ///< number in the recording
  std::uint64_t digest;  ///< digest of the shape when it was recorded
  std::uint64_t form;    ///< digest of the part of the shape that no in-place change affects
};

/// The shapes of one scene in a recording. A shape is recorded when a body, sensor or query first
/// uses it, and again if another shape has its id now.
class ShapeRecording {
 public:
  /// `composites` is null for a scene without composite shapes.
  ShapeRecording(RecorderState& recorder, std::uint32_t world, const ShapePool& shapes,
                 const CompositePool* composites) noexcept;

  /// Returns the number of a shape in the recording, and records the shape if it is new. Ends the
  /// recording and returns 0 if a recording cannot contain the shape.
  [[nodiscard]] std::uint32_t number_of(ShapeId id) noexcept;
  /// As above, for a shape that has a number; 0 for any other.
  [[nodiscard]] std::uint32_t known_number_of(ShapeId id) noexcept {
    const RecordedShape* const at = find(id);
    return at == nullptr ? 0 : at->number;
  }
  /// As `number_of`, for queries, which several threads may make at the same time.
  [[nodiscard]] std::uint32_t number_in_query(ShapeId id) noexcept {
    const Lock lock(numbering_);
    return number_of(id);
  }
  /// Records composite shapes that were changed in place, and removes the numbers of shapes that
  /// were removed or replaced. If no shape was changed in place, records only that the pool
  /// changed: a scene then recomputes the contacts of all composite shapes.
  void record_changes() noexcept;
  /// Writes the ids and numbers of all shapes.
  void put_names(CallWriter& call) const noexcept;

 private:
  [[nodiscard]] bool can_record(ShapeId id) const noexcept;
  [[nodiscard]] RecordedShape* find(ShapeId id) noexcept;
  void describe(RecordedShape& shape) const noexcept;
  void insert(const RecordedShape& shape) noexcept;
  void record_shape(const RecordedShape& shape) noexcept;
  void record_composite(const RecordedShape& shape) noexcept;

  RecorderState& recorder_;
  const std::uint32_t world_;
  const ShapePool& shapes_;
  const CompositePool* const composites_;
  std::uint64_t composites_seen_;
  /// Sorted by id.
  Column<RecordedShape> recorded_;
  std::uint32_t count_ = 0;
  /// Locked while a query numbers its shape; before the mutex of the recorder.
  Mutex numbering_;
};

}  // namespace winnow
