#pragma once

#include <winnow/core/point_view.h>
#include <winnow/pipeline/shape_pool.h>
#include "core/memory/byte_stream.h"

namespace winnow {

/// Writes a hull in the format of recordings and snapshots: three arrays of coordinates, one array
/// with the corners of all faces, the number of faces and the number of corners of each, the
/// rounding.
template <typename Writer>
void put_hull(Writer& out, const HullShape& hull) {
  std::size_t corners = 0;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) corners += hull.faces[f].count;
  for (const double* column : hull.vertex) {
    out.put_array(std::span<const double>(column, hull.vertex_count));
  }
  out.put_array(std::span<const std::uint32_t>(hull.loop, corners));
  out.put(std::uint64_t{hull.face_count});
  for (std::uint32_t f = 0; f < hull.face_count; ++f) out.put(hull.faces[f].count);
  out.put(hull.rounding);
}

/// A hull as read from a recording or snapshot.
struct ReadHull {
  explicit ReadHull(std::pmr::memory_resource* memory) noexcept
      : vertex{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
        loop(memory),
        sizes(memory) {}

  void read(ByteReader& in) noexcept {
    for (Column<double>& column : vertex) (void)in.get_array(column);
    (void)in.get_array(loop);
    (void)in.get_array(sizes);
    rounding = in.get<double>();
    if (vertex[1].size() != vertex[0].size() || vertex[2].size() != vertex[0].size()) in.fail();
  }
  [[nodiscard]] PointView points() const noexcept {
    return PointView({vertex[0].data(), vertex[1].data(), vertex[2].data()}, vertex[0].size());
  }
  [[nodiscard]] HullFaces faces() const noexcept {
    return {{loop.data(), loop.size()}, {sizes.data(), sizes.size()}};
  }

  Column<double> vertex[3];
  Column<std::uint32_t> loop;
  Column<std::uint32_t> sizes;
  double rounding = 0.0;
};

}  // namespace winnow
