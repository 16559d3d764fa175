#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct HeightGrid;

/// Heights in the caller's memory: sample (column, row) is `heights[row * row_stride + column]`, at
/// (column * spacing[0], row * spacing[1], height) in the frame of the shape. NaN is a hole:
/// squares with such a corner have no triangles.
struct HeightSamples {
  std::span<const float> heights;  ///< at least (rows - 1) * row_stride + columns values
  std::uint32_t columns = 0;       ///< samples along x, 2 or more
  std::uint32_t rows = 0;          ///< samples along y, 2 or more
  std::uint32_t row_stride = 0;    ///< 0 means `columns`
  double spacing[2] = {1.0, 1.0};  ///< along x and y; positive, finite
};

/// A surface over a regular grid, z up. Each square consists of two triangles that share the
/// diagonal from its lowest column and row to its highest. There is no tree of boxes: cells are
/// found by division, and pruned by a pyramid of minimal and maximal heights, whose lowest level
/// covers 16 x 16 squares per entry, and each higher level 4 x 4 entries of the level below. A
/// field takes 4 bytes per sample, plus a thirtieth of a byte for the pyramid. Squares are numbered
/// row by row. Triangle 2 * square has a corner at (column + 1, row), triangle 2 * square + 1 has a
/// corner at (column, row + 1).
class WINNOW_API HeightField {
 public:
  /// Creates a field without samples. Every allocation comes from `memory`, which must outlive the
  /// field.
  explicit HeightField(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  /// Takes the samples and the resource of `other`, which is then without samples.
  HeightField(HeightField&& other) noexcept;
  ~HeightField();
  HeightField(const HeightField&) = delete;
  HeightField& operator=(const HeightField&) = delete;

  /// Copies the samples. `invalid_shape` for fewer than 2 x 2 samples, an infinite height, or a
  /// spacing that is not positive and finite or makes the field exceed the range of float;
  /// `size_mismatch` if `heights` is too short; `invalid_argument` for a row stride below the
  /// number of columns; `too_many_objects` beyond 2^28 triangles. After an error, also
  /// `out_of_memory`, the field is unchanged. O(n).
  Status build(const HeightSamples& samples);
  /// Replaces the heights of the samples [column, column + samples.columns) x [row, row +
  /// samples.rows); `spacing` is ignored. `invalid_argument` if they are not all in the field;
  /// other errors as for `build`. O(samples).
  Status update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples);

  /// Appends a snapshot of spacing and heights. pipeline/FORMATS.md has the format.
  /// `out_of_memory` leaves `out` unchanged. O(n).
  Status save(Column<std::byte>& out) const;
  /// Replaces the field by a snapshot. `invalid_argument` if the bytes are not a valid snapshot
  /// (untrusted bytes are safe); it and `out_of_memory` leave the field unchanged. O(n).
  Status load(std::span<const std::byte> saved);

  /// Returns the box of all squares: x and y include holes, z does not. Empty if all squares are
  /// holes.
  [[nodiscard]] Aabb bounds() const noexcept;
  /// Returns an upper bound on the distance of the triangles' points from the origin. 0 without
  /// triangles.
  [[nodiscard]] double radius() const noexcept;
  /// Returns the number of samples along x; 0 before the first build.
  [[nodiscard]] std::uint32_t columns() const noexcept;
  /// Returns the number of samples along y; 0 before the first build.
  [[nodiscard]] std::uint32_t rows() const noexcept;
  /// Returns the number of triangles, including triangles of holes.
  [[nodiscard]] std::uint32_t triangles() const noexcept;
  /// Writes a triangle. Returns false for a triangle of a hole, or a number out of range.
  [[nodiscard]] bool triangle(std::uint32_t number, TriangleShape& shape) const noexcept;
  /// Returns which edges of a triangle are active, bit k for edge k: edges that bend outward (down
  /// on both sides) by more than the default angle of MeshOptions, and edges without another
  /// triangle. All edges for a triangle of a hole.
  [[nodiscard]] std::uint8_t active_edges(std::uint32_t number) const noexcept;

  /// Returns the bytes of heights and pyramid: exactly what is allocated from the resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// Returns the field as traversals read it.
  friend HeightGrid grid_of(const HeightField& field) noexcept;
  struct State;

  std::pmr::memory_resource* memory_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
