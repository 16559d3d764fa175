#include <winnow/pipeline/shapes.h>

namespace winnow {

const char* to_string(ShapeKind kind) noexcept {
  constexpr const char* kNames[kShapeKinds] = {"sphere", "capsule", "box",      "cylinder",
                                               "cone",   "hull",    "triangle", "half_space"};
  const auto index = static_cast<std::uint32_t>(kind);
  return index < kShapeKinds ? kNames[index] : "none";
}

}  // namespace winnow
