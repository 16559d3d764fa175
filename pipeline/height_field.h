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

/// Heights where the caller keeps them: sample (column, row) is `heights[row * row_stride +
/// column]` and stands at (column * spacing[0], row * spacing[1], height) in the shape's frame. NaN
/// is a hole: squares with one have no triangles.
struct HeightSamples {
  std::span<const float> heights;  ///< at least (rows - 1) * row_stride + columns of them
  std::uint32_t columns = 0;       ///< samples along x, 2 or more
  std::uint32_t rows = 0;          ///< samples along y, 2 or more
  std::uint32_t row_stride = 0;    ///< 0: columns
  double spacing[2] = {1.0, 1.0};  ///< along x and y; positive and finite
};

/// A surface over a regular grid, z up: each square is two triangles that share the diagonal from
/// its lowest column and row to its highest. No tree of boxes: cells are found by division, and a
/// pyramid of the least and greatest heights of 16 x 16 squares, and of 4 x 4 of what lies below,
/// prunes: 4 bytes per sample, and a thirtieth of a byte for the pyramid. Triangle 2 * square is
/// the one with the corner at (column + 1, row), 2 * square + 1 that at (column, row + 1); squares
/// are numbered row by row.
class WINNOW_API HeightField {
 public:
  /// A field without samples. Every allocation comes from `memory`, which must outlive the field.
  explicit HeightField(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  /// Takes over the samples and the resource; `other` is left without samples.
  HeightField(HeightField&& other) noexcept;
  ~HeightField();
  HeightField(const HeightField&) = delete;
  HeightField& operator=(const HeightField&) = delete;

  /// Takes a copy. `invalid_shape` for fewer than 2 x 2 samples, an infinite height, a spacing that
  /// is not positive and finite or with which the field leaves the range of float; `size_mismatch`
  /// if `heights` is too short; `invalid_argument` for a row stride below the columns;
  /// `too_many_objects` beyond 2^28 triangles. A refused build, or one without memory, leaves the
  /// field as it was. O(n).
  Status build(const HeightSamples& samples);
  /// New heights for the samples [column, column + columns) x [row, row + rows); the spacing is not
  /// read. `invalid_argument` if they are not all in the field, otherwise as `build`. O(samples).
  Status update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples);

  /// Appends spacing and heights to bytes; pipeline/CONTRACT.md has the format. `out_of_memory`
  /// leaves `out` as it was. O(n).
  Status save(Column<std::byte>& out) const;
  /// Becomes the field that was saved. `invalid_argument` for anything that was not saved so,
  /// whoever made it, and `out_of_memory`, leave it as it was. O(n).
  Status load(std::span<const std::byte> saved);

  /// Of all squares, those of holes included, as high and low as those without go; empty if all
  /// are holes.
  [[nodiscard]] Aabb bounds() const noexcept;
  /// No point of a triangle is farther than this from the origin. 0 without triangles.
  [[nodiscard]] double radius() const noexcept;
  /// Samples along x; 0 before the first build.
  [[nodiscard]] std::uint32_t columns() const noexcept;
  /// Samples along y; 0 before the first build.
  [[nodiscard]] std::uint32_t rows() const noexcept;
  /// Triangles, those of holes included.
  [[nodiscard]] std::uint32_t triangles() const noexcept;
  /// False for a triangle of a hole, or a number that none has.
  [[nodiscard]] bool triangle(std::uint32_t number, TriangleShape& shape) const noexcept;
  /// Which of its edges bend outward, that is down on both sides, by more than the angle that
  /// MeshOptions have by default, or have no other triangle. All for a triangle of a hole.
  [[nodiscard]] std::uint8_t active_edges(std::uint32_t number) const noexcept;

  /// Heights and pyramid, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// As traversals read it.
  friend HeightGrid grid_of(const HeightField& field) noexcept;
  struct State;

  std::pmr::memory_resource* memory_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
