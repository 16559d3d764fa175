#pragma once

#include <winnow/partitions/partition.h>

#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

struct RayAnswer {
  Ray ray;
  Hit closest;
  std::vector<Hit> hits;  ///< all of them, sorted by t
};

struct BoxAnswer {
  Aabb box;
  std::vector<ObjectId> inside;
  std::vector<ObjectId> crossing;
};

/// From "ox,oy,oz,dx,dy,dz". Throws ArgumentError, as the next one does.
[[nodiscard]] Ray parse_ray(const std::string& text);
/// From "x0,y0,z0,x1,y1,z1"; ends may be inf or -inf.
[[nodiscard]] Aabb parse_box(const std::string& text);

/// What the partition answers. Throws std::runtime_error if it refuses.
[[nodiscard]] std::vector<RayAnswer> ask_rays(const Partition& partition,
                                              std::span<const Ray> rays);
[[nodiscard]] std::vector<BoxAnswer> ask_boxes(const Partition& partition,
                                               std::span<const Aabb> boxes);

}  // namespace winnow::bench
