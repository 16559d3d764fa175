#include <winnow/pipeline/mesh/mesh_walks.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

struct SlotBox {
  double low[3];
  double high[3];
};

SlotBox box_of(const MeshView& mesh, std::uint32_t slot) {
  SlotBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const float* x = mesh.vertex[axis];
    const float a = x[mesh.corner[0][slot]];
    const float b = x[mesh.corner[1][slot]];
    const float c = x[mesh.corner[2][slot]];
    box.low[axis] = static_cast<double>(std::min({a, b, c}));
    box.high[axis] = static_cast<double>(std::max({a, b, c}));
  }
  return box;
}

bool meet(const SlotBox& box, const double min[3], const double max[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box.low[axis] <= max[axis] && min[axis] <= box.high[axis])) return false;
  }
  return true;
}

void put(SlotSink& out, std::uint32_t slot) {
  if (out.size < out.capacity) out.slot[out.size] = slot;
  ++out.size;
}

double meeting_time(const SlotBox& box, const double min[3], const double max[3],
                    const double direction[3], double limit) {
  double first = 0.0;
  double last = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double near = box.low[axis] - max[axis];
    const double far = box.high[axis] - min[axis];
    if (direction[axis] == 0.0) {
      if (near > 0.0 || far < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = near / direction[axis];
    const double b = far / direction[axis];
    first = std::max(first, std::min(a, b) * (1.0 - 1e-15));
    last = std::min(last, std::max(a, b) * (1.0 + 1e-15));
  }
  return first <= last ? first : std::numeric_limits<double>::infinity();
}

}  // namespace

void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  SlotSink& out) noexcept {
  for (std::uint32_t slot = 0; slot < mesh.triangle_count; ++slot) {
    if (meet(box_of(mesh, slot), min, max)) put(out, slot);
  }
}

void mesh_overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                        const double margin[3], SlotPairSink& out) noexcept {
  for (std::uint32_t j = 0; j < b.triangle_count; ++j) {
    SlotBox moved;
    for (int axis = 0; axis < 3; ++axis) {
      moved.low[axis] = std::numeric_limits<double>::infinity();
      moved.high[axis] = -moved.low[axis];
      for (int k = 0; k < 3; ++k) {
        double x = b_in_a.offset[axis];
        for (int i = 0; i < 3; ++i) {
          x += b_in_a.matrix[axis][i] * static_cast<double>(b.vertex[i][b.corner[k][j]]);
        }
        const double slack = margin[axis] + 1e-12 * std::abs(x);
        moved.low[axis] = std::min(moved.low[axis], x - slack);
        moved.high[axis] = std::max(moved.high[axis], x + slack);
      }
    }
    for (std::uint32_t i = 0; i < a.triangle_count; ++i) {
      if (!meet(box_of(a, i), moved.low, moved.high)) continue;
      if (out.size < out.capacity) {
        out.first[out.size] = i;
        out.second[out.size] = j;
      }
      ++out.size;
    }
  }
}

void mesh_sweep(const MeshView& mesh, const double min[3], const double max[3],
                const double direction[3], double limit, const SlotVisitor& visitor) noexcept {
  for (std::uint32_t slot = 0; slot < mesh.triangle_count && limit >= 0.0; ++slot) {
    if (meeting_time(box_of(mesh, slot), min, max, direction, limit) <= limit) {
      limit = visitor.visit(visitor.context, &slot, 1, limit);
    }
  }
}

void mesh_near(const MeshView& mesh, const double scale[3], const double min[3],
               const double max[3], double limit, const SlotVisitor& visitor) noexcept {
  for (std::uint32_t slot = 0; slot < mesh.triangle_count && limit >= 0.0; ++slot) {
    const SlotBox box = box_of(mesh, slot);
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = box.low[axis] * scale[axis];
      const double b = box.high[axis] * scale[axis];
      const double gap = std::max({0.0, min[axis] - std::max(a, b), std::min(a, b) - max[axis]});
      square += gap * gap;
    }
    if (std::sqrt(square) * (1.0 - 1e-15) <= limit) {
      limit = visitor.visit(visitor.context, &slot, 1, limit);
    }
  }
}

}  // namespace winnow
