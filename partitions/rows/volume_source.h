#pragma once

// Sources of volumes for inserts and updates: each validates entry i and writes it into the columns
// of a row. Infinite ends become +-FLT_MAX (see BoundsPool). volume_input.cpp and overlaps.cpp use
// them. Included by source files, not by headers.

#include <winnow/core/box_view.h>
#include <winnow/core/execution.h>
#include <winnow/core/kdop.h>
#include <winnow/core/key.h>
#include <winnow/core/sphere.h>
#include <winnow/core/volume.h>
#include "core/memory/bounds_pool.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/rows/box_input.kernel.h"
#include "partitions/rows/update_subset.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cstddef>
#include <limits>
#include <span>

namespace winnow {

/// Column pointers of a pool.
using ColumnPointers = float* const*;

struct PoolColumns {
  explicit PoolColumns(BoundsPool& pool) noexcept {
    for (std::size_t c = 0; c < pool.columns(); ++c) pointers[c] = pool.column(c);
  }
  float* pointers[kMaxColumns] = {};
};

inline void write_slab(ColumnPointers columns, std::size_t low, std::size_t high, std::size_t row,
                       float a, float b) noexcept {
  columns[low][row] = std::max(a, -FLT_MAX);
  columns[high][row] = std::min(b, FLT_MAX);
}

inline constexpr std::size_t kEntriesPerTask = 8192;

// Prefetch distance, in entries, for boxes and rows that are read in arbitrary order.
inline constexpr std::size_t kFetchAhead = 12;

/// Calls work(begin, end) for ranges that cover [0, count), in parallel.
template <typename Work>
void for_ranges(const Execution& execution, std::size_t count, Work&& work) {
  for_each_even_range(execution, count, kEntriesPerTask, work);
}

/// True if all entries are legal.
template <typename Source>
[[nodiscard]] bool all_valid(const Source& source, const UpdateSubset& entries,
                             const Execution& execution) {
  std::atomic<bool> valid{true};
  for_ranges(execution, entries.count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    if constexpr (requires { source.valid_entries(entries, begin, end); }) {
      ok = source.valid_entries(entries, begin, end);
    } else {
      for (std::size_t j = begin; j < end; ++j) ok = ok && source.valid(entries[j]);
    }
    if (!ok) valid.store(false, std::memory_order_relaxed);
  });
  return valid.load();
}

/// Maps a row to the entry of its object in an update; kNoObject if it has none.
struct EntryOfRow {
  BoxOfId of_id;
  const ObjectId* id;  ///< by row

  [[nodiscard]] std::size_t operator[](std::size_t row) const noexcept {
    const ObjectId k = id[row] - of_id.first;
    if (k >= of_id.ids) return kNoObject;
    return of_id.table == nullptr ? k : of_id.table[k];
  }
};

/// Writes boxes into AABB columns.
struct BoxSource {
  static constexpr Volume kVolume = Volume::aabb;

  const BoxView& boxes;

  [[nodiscard]] bool valid(std::size_t i) const noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const Aabb box = boxes[i];
    // Bitwise instead of short-circuit: nearly every box needs all tests.
    int ok = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float lo = box.min[axis];
      const float hi = box.max[axis];
      ok &= static_cast<int>(lo <= hi) & static_cast<int>(lo < inf) & static_cast<int>(hi > -inf);
    }
    return ok != 0;
  }
  /// True if the boxes are consecutive groups of six floats (min xyz, max xyz).
  [[nodiscard]] bool packed() const noexcept {
    const float* const first = boxes.min[0];
    return boxes.stride == sizeof(Aabb) && boxes.min[1] == first + 1 && boxes.min[2] == first + 2 &&
           boxes.max[0] == first + 3 && boxes.max[1] == first + 4 && boxes.max[2] == first + 5;
  }
  /// True if entries [begin, end) are legal. Tests 16 packed boxes at a time.
  [[nodiscard]] bool valid_entries(const UpdateSubset& entries, std::size_t begin,
                                   std::size_t end) const noexcept {
    if (packed()) {
      const float* const floats = boxes.min[0];
      return entries.number == nullptr
                 ? box_input_kernels().legal(floats + 6 * begin, end - begin)
                 : box_input_kernels().legal_listed(floats, entries.number + begin, end - begin);
    }
    for (std::size_t j = begin; j < end; ++j) {
      if (!valid(entries[j])) return false;
    }
    return true;
  }
  /// Writes the rows of [begin, end) whose objects have a box; `begin` and `end` are multiples
  /// of 16. Requires packed boxes.
  void write_rows(const BoxOfId& box_of, const ObjectId* ids, ColumnPointers columns,
                  std::size_t begin, std::size_t end) const noexcept {
    box_input_kernels().write_rows(boxes.min[0], box_of, ids, columns, begin, end);
  }
  /// Writes entries [begin, end) to the rows from `row` on. Requires packed boxes.
  void write_in_order(std::size_t begin, std::size_t end, ColumnPointers columns,
                      std::size_t row) const noexcept {
    box_input_kernels().write_in_order(boxes.min[0] + 6 * begin, end - begin, columns, row);
  }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    const Aabb box = boxes[i];
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      write_slab(columns, a, 3 + a, row, box.min[axis], box.max[axis]);
    }
  }
};

inline void write_sphere(ColumnPointers columns, std::size_t row, const Sphere& s) noexcept {
  const Aabb box = s.bounds();
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = a;
    write_slab(columns, a, 3 + a, row, box.min[axis], box.max[axis]);
    columns[kCenterColumn + a][row] = s.center[axis];
  }
  columns[kRadiusColumn][row] = s.radius;
}

/// Writes spheres into sphere columns.
struct SphereSource {
  static constexpr Volume kVolume = Volume::sphere;

  std::span<const Sphere> spheres;

  void fetch(std::size_t i) const noexcept { __builtin_prefetch(&spheres[i]); }
  [[nodiscard]] bool valid(std::size_t i) const noexcept { return spheres[i].is_valid(); }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    write_sphere(columns, row, spheres[i]);
  }
};

/// Writes the sphere around each box into sphere columns; boxes must be finite.
struct SphereAroundBoxSource {
  static constexpr Volume kVolume = Volume::sphere;

  const BoxView& boxes;

  [[nodiscard]] bool valid(std::size_t i) const noexcept {
    const Aabb box = boxes[i];
    return box.is_valid() && Sphere::around(box).is_valid();
  }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    write_sphere(columns, row, Sphere::around(boxes[i]));
  }
};

template <int K>
[[nodiscard]] constexpr Volume kdop_volume() noexcept {
  return K == 14 ? Volume::kdop14 : K == 18 ? Volume::kdop18 : Volume::kdop26;
}

template <int K>
inline void write_kdop(ColumnPointers columns, std::size_t row, const Kdop<K>& kdop) noexcept {
  constexpr std::size_t slabs = Kdop<K>::kSlabs;
  for (std::size_t s = 0; s < slabs; ++s) {
    write_slab(columns, low_column(slabs, s), high_column(slabs, s), row, kdop.min[s], kdop.max[s]);
  }
}

/// Writes k-DOPs into k-DOP columns.
template <int K>
struct KdopSource {
  static constexpr Volume kVolume = kdop_volume<K>();

  std::span<const Kdop<K>> kdops;

  [[nodiscard]] bool valid(std::size_t i) const noexcept { return kdops[i].is_valid(); }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    write_kdop(columns, row, kdops[i]);
  }
};

/// Writes the k-DOP around each box into k-DOP columns.
template <int K>
struct KdopAroundBoxSource {
  static constexpr Volume kVolume = kdop_volume<K>();

  const BoxView& boxes;

  [[nodiscard]] bool valid(std::size_t i) const noexcept { return boxes[i].is_valid(); }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    write_kdop(columns, row, Kdop<K>::around(boxes[i]));
  }
};

}  // namespace winnow
