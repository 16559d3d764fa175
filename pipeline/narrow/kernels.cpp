#include <winnow/pipeline/narrow/kernels.h>
#include <winnow/simd/isa.h>

namespace winnow {

WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_sphere_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, box_box_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, hull_hull_kernels)

namespace {

constexpr std::uint32_t code(ShapeKind a, ShapeKind b) {
  return static_cast<std::uint32_t>(a) * kShapeKinds + static_cast<std::uint32_t>(b);
}

}  // namespace

const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept {
  using enum ShapeKind;
  switch (code(a, b)) {
    case code(sphere, sphere):
      return &sphere_sphere_kernels();
    case code(box, box):
      return &box_box_kernels();
    case code(hull, hull):
      return &hull_hull_kernels();
    default:
      return nullptr;
  }
}

}  // namespace winnow
