#include "partitions/structures/cells/cell_drawing.h"

#include <winnow/core/debug_draw.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

namespace winnow {
namespace {

struct BoundedInterval {
  float low = kEndless;
  float high = -kEndless;
};

// Returns the range of the finite bounds of the first `count` rows; the whole axis if there are
// none.
BoundedInterval bounded_part(const RowView& rows, std::size_t axis, std::size_t count) noexcept {
  BoundedInterval part;
  for (std::size_t row = 0; row < count; ++row) {
    for (const float end : {rows.column[axis][row], rows.column[3 + axis][row]}) {
      if (!(std::abs(end) < FLT_MAX)) continue;
      part.low = std::min(part.low, end);
      part.high = std::max(part.high, end);
    }
  }
  return part.low <= part.high ? part : BoundedInterval{-kEndless, kEndless};
}

class CellPicture {
 public:
  CellPicture(const CellLayout& layout, const RowView& rows, std::size_t count) noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
      axes_[k] = layout.axis(k);
      if (axes_[k].count == 1) whole_[k] = bounded_part(rows, axes_[k].axis, count);
    }
  }

  [[nodiscard]] Aabb cell(std::size_t index) const noexcept {
    Aabb box;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t c = static_cast<std::uint32_t>(index % axes_[k].count);
      index /= axes_[k].count;
      const auto axis = axes_[k].axis;
      box.min[axis] = edge(k, c);
      box.max[axis] = edge(k, c + 1);
    }
    return box;
  }

  void arrow(DebugDraw& draw, std::string_view meaning) const;

 private:
  // The lower edge of cell c on axis k, which is the upper edge of cell c - 1.
  [[nodiscard]] float edge(std::size_t k, std::uint32_t c) const noexcept {
    const CellAxis& axis = axes_[k];
    if (axis.count == 1) return c == 0 ? whole_[k].low : whole_[k].high;
    const double at = static_cast<double>(axis.origin) +
                      static_cast<double>(c) / static_cast<double>(axis.inverse);
    return static_cast<float>(std::clamp<double>(at, -FLT_MAX, FLT_MAX));
  }

  std::array<CellAxis, 3> axes_;
  std::array<BoundedInterval, 3> whole_;
};

// The arrow is beside the cells and a little longer than they are, so that it does not cross them.
void CellPicture::arrow(DebugDraw& draw, std::string_view meaning) const {
  Vec3f from;
  std::array<double, 3> length{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = static_cast<double>(edge(k, 0));
    length[k] = static_cast<double>(edge(k, axes_[k].count)) - low;
    if (!std::isfinite(length[k])) return;
    from[axes_[k].axis] = static_cast<float>(low);
  }
  const double all = *std::max_element(length.begin(), length.end());
  const auto along = axes_[0].axis;
  const auto offset = [&from](std::size_t axis, double by) {
    const double at = static_cast<double>(from[axis]) + by;
    return static_cast<float>(std::clamp<double>(at, -FLT_MAX, FLT_MAX));
  };
  for (const std::size_t side : {axes_[1].axis, axes_[2].axis}) {
    from[side] = offset(side, -0.03 * all);
  }
  Vec3f to = from;
  to[along] = offset(axes_[0].axis, length[0] + 0.03 * all);
  draw.line(from, to, kAxisColour);
  for (const std::size_t side : {axes_[1].axis, axes_[2].axis}) {
    for (const double barb : {-0.015, 0.015}) {
      Vec3f back = to;
      back[along] = offset(axes_[0].axis, length[0]);
      back[side] = offset(side, barb * all);
      draw.line(to, back, kAxisColour);
    }
  }
  std::array<char, 64> text{"x "};
  text[0] = "xyz"[axes_[0].axis];
  const std::size_t length_of_text = std::min(meaning.size(), text.size() - 2);
  std::copy_n(meaning.begin(), length_of_text, text.begin() + 2);
  draw.text(to, {text.data(), 2 + length_of_text}, kAxisColour);
}

}  // namespace

void draw_cells(DebugDraw& draw, const CellLayout& layout, const RowView& rows,
                const Column<std::uint32_t>& start, std::string_view meaning) {
  const std::size_t cells = layout.cells();
  const CellPicture picture(layout, rows, start[cells]);
  for (std::size_t c = 0; c < cells; ++c) {
    Aabb contents;
    for (std::uint32_t row = start[c]; row < start[c + 1]; ++row) {
      contents.merge(stored_box(rows.column, row));
    }
    if (!contents.is_valid()) continue;  // empty, or only holes
    draw.box(picture.cell(c), kCellColour);
    draw.box(contents, kContentsColour);
  }
  picture.arrow(draw, meaning);
}

}  // namespace winnow
