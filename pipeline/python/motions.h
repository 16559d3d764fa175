#pragma once

#include "pipeline/python/arrays.h"

#include <winnow/pipeline/rigid_motion.h>

#include <cstddef>
#include <span>
#include <vector>

namespace winnow::python {

/// Numbers of a RigidMotion: the pose at the start, the translation and the rotation.
inline constexpr std::size_t kMotionNumbers = 13;
static_assert(sizeof(RigidMotion) == kMotionNumbers * sizeof(double));

/// Motions as rows of numbers, (n, 13).
class RigidMotionInput {
 public:
  explicit RigidMotionInput(py::handle object) : numbers_(object, "motions", {kMotionNumbers}) {}

  [[nodiscard]] std::size_t count() const noexcept { return numbers_.count(); }
  [[nodiscard]] RigidMotion operator[](std::size_t i) const noexcept;
  /// Returns the array itself if it is of double and contiguous, else copies in `room`.
  [[nodiscard]] std::span<const RigidMotion> packed(std::vector<RigidMotion>& room) const;

 private:
  Numbers numbers_;
};

void add_motions(py::module_& module);

}  // namespace winnow::python
