#pragma once

#include <winnow/core/volumes.h>
#include "bench/common/interface.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace winnow::bench {

/// Provides the boxes of the same objects frame by frame: a built-in scene or a recording. A scene
/// that grows appends rows.
class FrameSource : public NamedInterface {
 public:
  /// Returns bounds that contain every box of every frame.
  [[nodiscard]] virtual Aabb world() const = 0;
  /// Returns the boxes of the current frame, row = object; valid until `advance`.
  [[nodiscard]] virtual std::span<const Aabb> boxes() const = 0;
  /// Returns the final number of objects.
  [[nodiscard]] virtual std::size_t objects() const { return boxes().size(); }
  /// Moves to the next frame; returns false without a change if there is none.
  virtual bool advance() = 0;
};

/// Finds the objects whose boxes change from frame to frame.
class ChangedRows {
 public:
  /// Returns the rows of the previous frame, in ascending order, whose boxes differ in `boxes`, the
  /// next frame. Valid until the next call.
  std::span<const std::uint32_t> next(std::span<const Aabb> boxes) {
    rows_.clear();
    for (std::uint32_t i = 0; i < last_.size(); ++i) {
      if (std::memcmp(&boxes[i], &last_[i], sizeof(Aabb)) != 0) rows_.push_back(i);
    }
    last_.assign(boxes.begin(), boxes.end());
    return rows_;
  }

 private:
  std::vector<Aabb> last_;
  std::vector<std::uint32_t> rows_;
};

}  // namespace winnow::bench
