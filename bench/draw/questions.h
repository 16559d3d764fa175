#pragma once

#include <winnow/partitions/partition.h>

#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

struct RayResult {
  Ray ray;
  Hit closest;
  std::vector<Hit> hits;  ///< all hits, sorted by t
};

struct BoxResult {
  Aabb box;
  std::vector<ObjectId> inside;
  std::vector<ObjectId> crossing;
};

/// Parses "ox,oy,oz,dx,dy,dz". Throws ArgumentError, as does parse_box.
[[nodiscard]] Ray parse_ray(const std::string& text);
/// Parses "x0,y0,z0,x1,y1,z1"; ends may be inf or -inf.
[[nodiscard]] Aabb parse_box(const std::string& text);

/// Runs the queries. Throws std::runtime_error if the partition returns an error.
[[nodiscard]] std::vector<RayResult> query_rays(const Partition& partition,
                                                std::span<const Ray> rays);
[[nodiscard]] std::vector<BoxResult> query_boxes(const Partition& partition,
                                                 std::span<const Aabb> boxes);

}  // namespace winnow::bench
