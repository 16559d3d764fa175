#include "partitions/index/debug_draw.h"

#include <winnow/core/debug_draw.h>
#include <winnow/core/volumes.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/memory/volume_columns.h"

namespace winnow {
namespace {

// Draws levels from the root down, so that `max_depth` cuts off the lower ones.
void draw_tree(DebugDraw& draw, const TreeShape& tree, std::size_t max_depth) {
  for (std::size_t depth = 0; depth < std::min<std::size_t>(tree.levels, max_depth); ++depth) {
    const std::size_t level = tree.levels - 1 - depth;
    for (std::size_t node = 0; node < tree.count[level]; ++node) {
      const Aabb box = stored_box(tree.node[level], node);
      if (box.is_valid()) draw.box(box, node_colour(depth));  // otherwise it has only holes
    }
  }
}

// The middle of a bounded axis; the finite end of a half-bounded axis; 0 on an unbounded axis.
Vec3f label_place(const Aabb& box) noexcept {
  Vec3f place;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box.min[axis];
    const float high = box.max[axis];
    const bool from = std::isfinite(low);
    const bool to = std::isfinite(high);
    place[axis] = from && to ? 0.5F * low + 0.5F * high : from ? low : to ? high : 0.0F;
  }
  return place;
}

void draw_label(DebugDraw& draw, const Aabb& box, ClientData data) {
  std::array<char, 20> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), data).ptr;
  draw.text(label_place(box), {text.data(), static_cast<std::size_t>(end - text.data())},
            kLabelColour);
}

}  // namespace

void draw_structure(DebugDraw& draw, const Rows& rows, const SpatialIndex& index,
                    std::size_t max_depth) {
  if (rows.size() == 0 || index.structure().is_flat()) return;
  if (rows.regions().regular != 0) index.structure().draw(draw);
  draw_tree(draw, index.tree().view(rows.view()), max_depth);
}

void draw_objects(DebugDraw& draw, const Rows& rows, const DebugDrawOptions& options) {
  const KeyTable& keys = rows.keys();
  const BoundsPool& pool = rows.pool();
  for (ObjectId id = 0; id < keys.slot_count(); ++id) {
    if (!keys.is_live(id)) continue;
    Aabb box;
    (void)rows.bounds(keys.key_of(id), box);
    if (options.objects && pool.volume() == Volume::sphere) {
      const std::size_t row = keys.row_of(id);
      const auto at = [&](std::size_t c) { return pool.column(kCenterColumn + c)[row]; };
      draw.sphere({{at(0), at(1), at(2)}, at(3)}, kObjectColour);
    } else if (options.objects) {
      draw.box(box, kObjectColour);
    }
    if (options.labels) draw_label(draw, box, keys.client_data(id));
  }
}

}  // namespace winnow
