// SpatialIndex: debug drawing of trees, structures and objects.

#include <winnow/core/sphere.h>
#include <winnow/partitions/debug_colours.h>
#include "partitions/index/spatial_index.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

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

void SpatialIndex::draw(DebugDraw& draw, std::size_t max_depth) const {
  if (rows_.size() == 0 || structure_->is_flat()) return;
  if (rows_.regions().regular != 0) structure_->draw(draw);
  draw_tree(draw, tree_.view(rows_.view()), max_depth);
}

void SpatialIndex::draw_objects(DebugDraw& draw, const DebugDrawOptions& options) const {
  const KeyTable& keys = rows_.keys();
  const BoundsPool& pool = rows_.pool();
  for (ObjectId id = 0; id < keys.slot_count(); ++id) {
    if (!keys.is_live(id)) continue;
    Aabb box;
    (void)rows_.bounds(keys.key_of(id), box);
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
