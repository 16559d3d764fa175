#pragma once

#include "partitions/index/query_view.h"
#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Max-heap of the nearest objects so far; an entry is (bits of the distance) << 32 | id.
struct NearestHeap {
  std::uint64_t* entries = nullptr;
  std::size_t size = 0;
  std::size_t room = 0;
  std::size_t most = 0;  ///< number of objects to find
  bool (*grow)(NearestHeap& heap) = nullptr;
  void* owner = nullptr;
};

struct NearestQuery {
  float low[3];
  float high[3];
  float radius;
};

struct NearestKernels {
  /// Fills the heap. False if it cannot grow.
  bool (*nearest)(const QueryView&, const NearestQuery&, const QueryFilter&, NearestHeap&);
};

WINNOW_KERNELS(NearestKernels, nearest_kernels);

}  // namespace winnow
