// Draws seeded sets of partition queries about given boxes: ray casts, overlap tests, swept volumes
// and nearest objects. Query races and their references run them.

#include "bench/scenes/query_set.h"

#include <winnow/core/eigen.h>
#include "bench/common/random.h"
#include "bench/scenes/random_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow::bench {
namespace {

constexpr float kFieldOfView = 1.0471976F;
constexpr float kAspect = 1.6F;

/// Returns whether the box intersects the frustum's bounds and is not entirely behind one of its
/// planes.
bool sees(const Frustum& camera, const Aabb& box) noexcept {
  if (!camera.bounds.overlaps(box)) return false;
  for (const Plane& plane : camera.planes) {
    const Eigen::Vector3f corner =
        (as_eigen(plane.normal).array() > 0.0F).select(as_eigen(box.max), as_eigen(box.min));
    if (plane.normal.dot(corner) + plane.offset < 0.0F) return false;
  }
  return true;
}

/// Returns the share of boxes that are visible, estimated from about 2,000 of them.
double share_seen(const Frustum& camera, std::span<const Aabb> boxes) noexcept {
  const std::size_t step = std::max<std::size_t>(1, boxes.size() / 2000);
  std::size_t seen = 0;
  std::size_t sampled = 0;
  for (std::size_t i = 0; i < boxes.size(); i += step, ++sampled) seen += sees(camera, boxes[i]);
  return sampled == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(sampled);
}

/// Returns a random camera with a vertical field of view of 60 degrees that sees about this share
/// of the boxes. The camera is inside the world for small shares and outside for large ones; its
/// far plane is chosen so that the share is right.
Frustum camera_that_sees(double share, std::span<const Aabb> boxes, const Aabb& world,
                         Random& random) {
  const Vec3f center = 0.5F * (world.min + world.max);
  const Vec3f half = 0.5F * (world.max - world.min);
  const float diagonal = 2.0F * half.norm();
  Frustum camera;
  // A camera at the border that looks outward cannot see enough boxes, so another one is drawn.
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Vec3f forward = random_unit(random).cast<float>();
    const Vec3f up = random_unit(random).cast<float>();
    Vec3f eye = center - 0.7F * diagonal * forward;
    if (share < 0.1) {
      eye = random.in((center - half).cast<double>(), (center + half).cast<double>()).cast<float>();
    }
    const float near_t = 1e-3F * diagonal;
    float low = 2.0F * near_t;
    float high = 2.0F * diagonal;
    const auto camera_to = [&](float far_t) {
      return Frustum::perspective(eye, forward, up, kFieldOfView, kAspect, near_t, far_t);
    };
    if (share_seen(camera_to(high), boxes) < share) continue;
    for (int step = 0; step < 16; ++step) {
      const float middle = 0.5F * (low + high);
      (share_seen(camera_to(middle), boxes) < share ? low : high) = middle;
    }
    camera = camera_to(high);
    if (camera.is_valid()) return camera;
  }
  const Vec3f forward{1.0F, 0.0F, 0.0F};
  return Frustum::perspective(center - 0.7F * diagonal * forward, forward, {0.0F, 0.0F, 1.0F},
                              kFieldOfView, kAspect, 1e-3F * diagonal, 2.0F * diagonal);
}

/// Draws the parts of queries about boxes.
class QueryDrawing {
 public:
  QueryDrawing(std::span<const Aabb> boxes, std::uint64_t seed)
      : boxes_(boxes), world_(world_of(boxes)), random_(seed) {
    double sum = 0.0;
    std::size_t finite = 0;
    for (const Aabb& box : boxes) {
      const Eigen::Vector3d edges = (box.max - box.min).cast<double>();
      if (!edges.allFinite()) continue;
      sum += edges.sum();
      ++finite;
    }
    // If all objects are points, queries still need a size.
    edge_ = sum > 0.0
                ? sum / (3.0 * static_cast<double>(finite))
                : 0.01 * (as_eigen(world_.max) - as_eigen(world_.min)).cast<double>().maxCoeff();
  }

  /// Returns a length in mean edges of the boxes.
  [[nodiscard]] float length(double edges) const { return static_cast<float>(edges * edge_); }
  Vec3f point() {
    return random_.in(world_.min.cast<double>(), world_.max.cast<double>()).cast<float>();
  }
  Vec3f direction() { return random_unit(random_).cast<float>(); }
  Ray ray() { return {.origin = point(), .direction = direction()}; }
  Sphere sphere(double edges) { return {point(), length(edges)}; }
  Aabb cube(double edges) {
    const Vec3f half = Vec3f::constant(length(0.5 * edges));
    const Vec3f center = point();
    return {center - half, center + half};
  }
  Frustum frustum(double share) { return camera_that_sees(share, boxes_, world_, random_); }

 private:
  std::span<const Aabb> boxes_;
  Aabb world_;
  double edge_ = 1.0;
  Random random_;
};

/// A set of queries: it has a query for each `rays_a_query` rays of a set of rays.
struct SetKind {
  std::string_view name;
  QueryType query_type;
  std::size_t rays_a_query;
  void (*add)(QueryDrawing& draw, QuerySet& set);  ///< draws a query
  std::size_t count = 0;                           ///< see QuerySet
};

void add_ray(QueryDrawing& draw, QuerySet& set) {
  set.rays.push_back(draw.ray());
}

template <int edges>
void add_cube(QueryDrawing& draw, QuerySet& set) {
  set.boxes.push_back(draw.cube(edges));
}

template <int percent>
void add_frustum(QueryDrawing& draw, QuerySet& set) {
  set.regions.emplace_back(draw.frustum(0.01 * percent));
}

constexpr std::array<SetKind, 14> kKinds{{
    {"closest_ray", QueryType::closest, 1, add_ray},
    {"any_ray", QueryType::any, 1, add_ray},
    {"all_rays", QueryType::all, 1, add_ray},
    {"all_near_rays", QueryType::all, 1,
     [](QueryDrawing& draw, QuerySet& set) {
       set.rays.push_back(draw.ray());
       set.rays.back().max_t = draw.length(10.0);
     }},
    {"box_1", QueryType::overlap, 1, add_cube<1>},
    {"box_5", QueryType::overlap, 10, add_cube<5>},
    {"box_20", QueryType::overlap, 100, add_cube<20>},
    {"frustum_1_percent", QueryType::overlap, 1000, add_frustum<1>},
    {"frustum_50_percent", QueryType::overlap, 5000, add_frustum<50>},
    {"sphere", QueryType::overlap, 10,
     [](QueryDrawing& draw, QuerySet& set) { set.regions.emplace_back(draw.sphere(2.5)); }},
    {"swept_box", QueryType::closest, 10,
     [](QueryDrawing& draw, QuerySet& set) {
       set.casts.emplace_back(BoxCast{.box = draw.cube(0.5), .direction = draw.direction()});
     }},
    {"swept_sphere", QueryType::closest, 10,
     [](QueryDrawing& draw, QuerySet& set) {
       set.casts.emplace_back(
           SphereCast{.sphere = draw.sphere(0.25), .direction = draw.direction()});
     }},
    {"nearest_1", QueryType::nearest, 10, add_cube<0>, 1},
    {"nearest_16", QueryType::nearest, 10, add_cube<0>, 16},
}};

constexpr auto kNames = [] {
  std::array<std::string_view, kKinds.size()> names;
  std::ranges::transform(kKinds, names.begin(), &SetKind::name);
  return names;
}();

bool are_same(QueryType query_type, std::span<const Found> expected, std::span<const Found> got,
              float rounding) {
  if (query_type == QueryType::any) return expected.empty() == got.empty();
  std::vector<Found> a(expected.begin(), expected.end());
  std::vector<Found> b(got.begin(), got.end());
  const bool in_any_order =
      query_type == QueryType::overlap || (query_type == QueryType::all && rounding > 0.0F);
  for (std::vector<Found>* const found : {&a, &b}) {
    if (in_any_order) std::ranges::sort(*found, {}, &Found::row);
  }
  const bool any_row = rounding > 0.0F && !in_any_order;
  return std::ranges::equal(a, b, [&](const Found& x, const Found& y) {
    const bool same_t = x.t == y.t || std::abs(x.t - y.t) <= rounding * std::max(x.t, y.t);
    return same_t && (any_row || x.row == y.row);
  });
}

}  // namespace

Aabb world_of(std::span<const Aabb> boxes) noexcept {
  Aabb world;
  for (const Aabb& box : boxes) {
    if (box.min.all_finite() && box.max.all_finite()) world.merge(box);
  }
  if (!world.is_valid()) world = {{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}};
  return world;
}

std::size_t count_differing(QueryType query_type, const QueryResults& expected,
                            const QueryResults& got, float rounding) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < std::min(expected.questions(), got.questions()); ++i) {
    if (!are_same(query_type, expected.of(i), got.of(i), rounding)) ++differing;
  }
  return differing;
}

std::span<const std::string_view> query_set_names() noexcept {
  return kNames;
}

QuerySet make_query_set(std::string_view name, std::span<const Aabb> boxes, std::size_t rays,
                        std::uint64_t seed) {
  const SetKind& kind = *std::ranges::find(kKinds, name, &SetKind::name);
  QuerySet set{.name = std::string(name), .query_type = kind.query_type, .count = kind.count};
  QueryDrawing draw(boxes, seed);
  const std::size_t size = std::max<std::size_t>(1, rays / kind.rays_a_query);
  for (std::size_t i = 0; i < size; ++i) kind.add(draw, set);
  return set;
}

std::vector<QuerySet> make_query_sets(std::span<const Aabb> boxes, std::size_t rays,
                                      std::uint64_t seed) {
  std::vector<QuerySet> sets;
  for (const std::string_view name : kNames) {
    sets.push_back(make_query_set(name, boxes, rays, seed));
  }
  return sets;
}

}  // namespace winnow::bench
