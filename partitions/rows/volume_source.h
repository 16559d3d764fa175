#pragma once

// Sources of spheres and k-DOPs for inserts and updates: each validates entry i and writes it into
// the columns of a row, like BoxSource. Included by source files, not by headers.

#include <winnow/core/volumes.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/volume_columns.h"
#include "partitions/rows/row_input.h"

#include <cstddef>
#include <span>

namespace winnow {

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
