#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/pair_order.h"

#include <atomic>

namespace winnow {
namespace {

constinit std::atomic<const NarrowKernels& (*)() noexcept> linked[KindPairs::kCount]{};

}  // namespace

void link_kernels(ShapeKind a, ShapeKind b, const NarrowKernels& (*kernels)() noexcept) noexcept {
  linked[KindPairs::index(a, b)].store(kernels, std::memory_order_relaxed);
}

const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept {
  const auto kernels = linked[KindPairs::index(a, b)].load(std::memory_order_relaxed);
  return kernels == nullptr ? nullptr : &kernels();
}

}  // namespace winnow
