#pragma once

#include <winnow/core/aabb.h>
#include "bench/common/interface.h"

#include <cstddef>
#include <span>
#include <string>

namespace winnow::bench {

/// Provides the boxes of the same objects frame by frame: a built-in scene or a recording. A scene
/// that grows appends rows.
class FrameSource : public Interface {
 public:
  [[nodiscard]] virtual std::string name() const = 0;
  /// Returns bounds that contain every box of every frame.
  [[nodiscard]] virtual Aabb world() const = 0;
  /// Returns the boxes of the current frame, row = object; valid until `advance`.
  [[nodiscard]] virtual std::span<const Aabb> boxes() const = 0;
  /// Returns the final number of objects.
  [[nodiscard]] virtual std::size_t objects() const { return boxes().size(); }
  /// Moves to the next frame; returns false without a change if there is none.
  virtual bool advance() = 0;
};

}  // namespace winnow::bench
