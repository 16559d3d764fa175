#include "pipeline/mesh/leaf_corners.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::uint32_t kLeafCorners = 3 * kMeshFanout;

/// Quantised positions are stored only if triangles have no boxes and leaves have on average at
/// most this many blocks of vertices. A mesh then takes at most 24 bytes per triangle.
constexpr double kBlocksWithPoints = 1.25;

/// The distinct vertices of one leaf, in the order in which its corners use them.
class LeafVertices {
 public:
  LeafVertices() noexcept { std::fill_n(table_, kTable, kNone); }

  /// Returns the index of a vertex in the list; appends it if it is new.
  std::uint8_t place_of(std::uint32_t vertex) noexcept {
    std::uint32_t at = vertex % kTable;
    for (; table_[at] != kNone; at = (at + 1) % kTable) {
      if (vertex_[table_[at]] == vertex) return table_[at];
    }
    vertex_[count_] = vertex;
    return table_[at] = static_cast<std::uint8_t>(count_++);
  }
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  /// Blocks of sixteen that the list needs beyond the first.
  [[nodiscard]] std::uint32_t more_blocks() const noexcept { return (count_ - 1) / kMeshFanout; }
  /// Writes one block of the list, padded with the last vertex.
  void write(std::uint32_t block, std::uint32_t* out) const noexcept {
    for (std::uint32_t i = 0; i < kMeshFanout; ++i) {
      out[i] = vertex_[std::min(block * kMeshFanout + i, count_ - 1)];
    }
  }

 private:
  static constexpr std::uint32_t kTable = 128;
  static constexpr std::uint8_t kNone = 255;
  std::uint8_t table_[kTable];
  std::uint32_t vertex_[kLeafCorners];
  std::uint32_t count_ = 0;
};

}  // namespace

bool LeafCorners::take(const MeshView& view) noexcept {
  const std::uint32_t leaves = view.count[0];
  const auto each_corner = [&](std::uint32_t leaf, auto&& visit) {
    for (std::uint32_t i = 0; i < kLeafCorners; ++i) {
      const std::size_t slot = std::size_t{leaf} * kMeshFanout + i % kMeshFanout;
      visit(i, view.corner[i / kMeshFanout][slot]);
    }
  };
  std::uint32_t blocks = leaves;
  std::uint32_t crowded = 0;
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
    LeafVertices vertices;
    each_corner(leaf, [&](std::uint32_t, std::uint32_t vertex) { vertices.place_of(vertex); });
    blocks += vertices.more_blocks();
    crowded += vertices.more_blocks() != 0 ? 1U : 0U;
    if (crowded > leaves / 4 * 3) return true;
  }
  const bool with_points = view.box == nullptr && blocks <= kBlocksWithPoints * leaves;
  LeafCorners fresh(vertex_.memory());
  if (!fresh.vertex_.resize(std::size_t{blocks} * kMeshFanout) ||
      !fresh.point_.resize(with_points ? fresh.vertex_.size() : 0) ||
      !fresh.more_.resize(crowded != 0 ? leaves + std::size_t{1} : 0) ||
      !fresh.place_.resize(std::size_t{leaves} * kLeafCorners)) {
    return false;
  }
  std::uint32_t next_block = 0;
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
    LeafVertices vertices;
    std::uint8_t* const place = fresh.place_.data() + std::size_t{leaf} * kLeafCorners;
    each_corner(
        leaf, [&](std::uint32_t i, std::uint32_t vertex) { place[i] = vertices.place_of(vertex); });
    vertices.write(0, fresh.vertex_.data() + std::size_t{leaf} * kMeshFanout);
    if (crowded != 0) fresh.more_[leaf] = next_block;
    for (std::uint32_t k = 1; k <= vertices.more_blocks(); ++k) {
      vertices.write(k, fresh.vertex_.data() + std::size_t{leaves + next_block++} * kMeshFanout);
    }
  }
  if (crowded != 0) fresh.more_[leaves] = next_block;
  vertex_.swap(fresh.vertex_);
  point_.swap(fresh.point_);
  more_.swap(fresh.more_);
  place_.swap(fresh.place_);
  return true;
}

void LeafCorners::link(MeshView& view) const noexcept {
  for (const std::uint32_t*& column : view.corner) column = nullptr;
  view.leaf_vertex = vertex_.data();
  view.leaf_point = point_.data();
  view.leaf_more = more_.data();
  view.leaf_place = place_.data();
}

Bytes LeafCorners::bytes() const noexcept {
  Bytes sum = vertex_.bytes();
  sum += point_.bytes();
  sum += more_.bytes();
  sum += place_.bytes();
  return sum;
}

}  // namespace winnow
