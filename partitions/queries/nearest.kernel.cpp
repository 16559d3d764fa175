#include "partitions/queries/nearest.kernel.h"
#include "partitions/queries/descent.wide.h"
#include "simd/lanes/boxes.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Squared distances to 16 boxes in float, rounded so that they are never too large.
class DistanceProbe {
 public:
  explicit DistanceProbe(const NearestQuery& query) : query_(query) {}

  Mask16 test(const float* const* column, std::size_t at, float limit, Floats& order) const {
    const Box16 box = load_slabs<3>(column, at);
    const Floats zero = Floats(0.0F);
    Floats square = zero;
    for (int i = 0; i < 3; ++i) {
      const Floats under = box.low[i] - query_.high[i];
      const Floats above = query_.low[i] - box.high[i];
      const Floats gap = max(max(under, above), zero);
      square = square + gap * gap;
    }
    const Floats below = square * 0.999999F;
    const LaneMask<float> near = (below <= limit) & (box.low[0] <= kLargest<float>);
    order = or_infinity(near, min(below, kMaxOrder));
    return bits(near);
  }

 private:
  const NearestQuery& query_;
};

/// Returns the distance to the box of a row, in double.
double distance(const NearestQuery& query, const float* const* column, std::size_t r) {
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double below = static_cast<double>(column[i][r]) - static_cast<double>(query.high[i]);
    const double above = static_cast<double>(query.low[i]) - static_cast<double>(column[3 + i][r]);
    const double gap = below > above ? below : above;
    if (gap > 0.0) square += gap * gap;
  }
  return __builtin_sqrt(square);
}

/// Returns an upper bound of the float square of any distance <= t.
float square_limit(float t) {
  const double square = static_cast<double>(t) * static_cast<double>(t);
  return square < 3e38 ? static_cast<float>(square) * 1.000001F + 1e-37F : __builtin_inff();
}

class Heap {
 public:
  explicit Heap(NearestHeap& heap) : heap_(heap) {}

  [[nodiscard]] bool full() const { return heap_.size == heap_.most; }
  [[nodiscard]] std::uint64_t worst() const { return heap_.entries[0]; }

  bool add(std::uint64_t entry) {
    if (full()) {
      sink(entry);
      return true;
    }
    if (heap_.size == heap_.room && !heap_.grow(heap_)) return false;
    std::size_t place = heap_.size++;
    while (place != 0 && heap_.entries[(place - 1) / 2] < entry) {
      heap_.entries[place] = heap_.entries[(place - 1) / 2];
      place = (place - 1) / 2;
    }
    heap_.entries[place] = entry;
    return true;
  }

 private:
  /// Replaces the worst entry.
  void sink(std::uint64_t entry) {
    std::size_t place = 0;
    for (;;) {
      std::size_t child = 2 * place + 1;
      if (child >= heap_.size) break;
      if (child + 1 < heap_.size && heap_.entries[child + 1] > heap_.entries[child]) ++child;
      if (heap_.entries[child] <= entry) break;
      heap_.entries[place] = heap_.entries[child];
      place = child;
    }
    heap_.entries[place] = entry;
  }

  NearestHeap& heap_;
};

bool nearest(const QueryView& view, const NearestQuery& query, const QueryFilter& filter,
             NearestHeap& nearest_heap) {
  const DistanceProbe probe(query);
  const CandidateFilter candidate_filter(view, filter);
  Heap heap(nearest_heap);
  float limit = square_limit(query.radius);
  return visit_nearest_first(view, probe, candidate_filter, limit, [&](std::uint32_t first_row) {
    Floats order;
    Mask16 mask = probe.test(view.column, first_row, limit, order);
    mask = candidate_filter.rows(first_row, mask);
    for (; mask != 0; mask &= mask - 1) {
      const unsigned lane = first(mask);
      const double far = distance(query, view.column, first_row + lane);
      if (far > static_cast<double>(query.radius)) continue;
      const std::uint32_t bits = order_of_rounded_down(far);
      const std::uint32_t id = view.id[first_row + lane];
      const std::uint64_t entry = std::uint64_t{bits} << 32U | id;
      if ((heap.full() && entry >= heap.worst()) || !candidate_filter.accepts(id)) continue;
      if (!heap.add(entry)) return false;
      if (!heap.full()) continue;
      // The limit is the next float, because an object with the same rounded distance may have a
      // smaller id.
      limit = square_limit(value_of(static_cast<std::uint32_t>(heap.worst() >> 32U) + 1));
    }
    return true;
  });
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const NearestKernels WINNOW_KERNEL_TABLE(nearest_kernels) = {WINNOW_ISA_NAME::nearest};

}  // namespace winnow
