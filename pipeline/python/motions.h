#pragma once

#include "pipeline/python/inputs.h"

#include <winnow/pipeline/rigid_motion.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace winnow::python {

/// Numbers of a RigidMotion: the pose at the start, the translation and the rotation.
inline constexpr std::size_t kMotionNumbers = 13;
static_assert(sizeof(RigidMotion) == kMotionNumbers * sizeof(double));

/// Motions as rows of numbers, (n, 13).
class RigidMotionInput : public Input {
 public:
  explicit RigidMotionInput(py::handle object, const char* name = "motions")
      : Input(name), numbers_(object, name, {kMotionNumbers}) {
    set(numbers_.count(), numbers_.is_one());
  }
  [[nodiscard]] RigidMotion operator[](std::size_t i) const noexcept;
  /// Returns the array itself if it is of double and contiguous, else copies in `room`.
  [[nodiscard]] std::span<const RigidMotion> packed(std::vector<RigidMotion>& room) const;

 private:
  void repeat() override { numbers_.expect(count()); }
  [[nodiscard]] std::string fault(Status status) const override;

  Numbers numbers_;
};

void add_motions(py::module_& module);

}  // namespace winnow::python
