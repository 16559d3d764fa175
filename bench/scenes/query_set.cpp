// Draws seeded sets of partition queries about given boxes: ray casts, overlap tests, swept volumes
// and nearest objects. Query races and their references run them.

#include "bench/scenes/query_set.h"

#include <winnow/core/eigen.h>
#include "bench/common/random.h"
#include "bench/scenes/cameras.h"
#include "bench/scenes/random_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow::bench {
namespace {

constexpr std::array<std::string_view, 14> kNames{
    "closest_ray", "any_ray",      "all_rays",          "all_near_rays",      "box_1",
    "box_5",       "box_20",       "frustum_1_percent", "frustum_50_percent", "sphere",
    "swept_box",   "swept_sphere", "nearest_1",         "nearest_16"};

class QuerySetBuilder {
 public:
  QuerySetBuilder(std::span<const Aabb> boxes, std::size_t rays, std::uint64_t seed)
      : boxes_(boxes), world_(world_of(boxes)), rays_(rays), seed_(seed) {
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

  QuerySet make(std::string_view name) {
    random_ = Random(seed_);
    QuerySet set;
    set.name = name;
    if (name == "box_1") return overlaps(std::move(set), 1.0, rays_);
    if (name == "box_5") return overlaps(std::move(set), 5.0, rays_ / 10);
    if (name == "box_20") return overlaps(std::move(set), 20.0, rays_ / 100);
    if (name == "frustum_1_percent") return frusta(std::move(set), 0.01, rays_ / 1000);
    if (name == "frustum_50_percent") return frusta(std::move(set), 0.5, rays_ / 5000);
    if (name == "sphere") return spheres(std::move(set));
    if (name.starts_with("swept")) return casts(std::move(set));
    if (name == "nearest_1") return nearest(std::move(set), 1);
    if (name == "nearest_16") return nearest(std::move(set), 16);
    return rays(std::move(set));
  }

 private:
  static std::size_t at_least_one(std::size_t count) { return std::max<std::size_t>(1, count); }

  Eigen::Vector3f point() {
    Eigen::Vector3f p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = static_cast<float>(
          random_.in(static_cast<double>(world_.min[axis]), static_cast<double>(world_.max[axis])));
    }
    return p;
  }

  Aabb cube(double edges) {
    const auto half = static_cast<float>(0.5 * edges * edge_);
    const Eigen::Vector3f center = point();
    return {center.array() - half, center.array() + half};
  }

  QuerySet rays(QuerySet set) {
    set.query_type = set.name == "closest_ray" ? QueryType::closest
                     : set.name == "any_ray"   ? QueryType::any
                                               : QueryType::all;
    for (std::size_t i = 0; i < rays_; ++i) {
      Ray& ray = set.rays.emplace_back();
      ray.origin = point();
      ray.direction = random_unit(random_).cast<float>();
      if (set.name == "all_near_rays") ray.max_t = static_cast<float>(10.0 * edge_);
    }
    return set;
  }

  QuerySet overlaps(QuerySet set, double edges, std::size_t count) {
    set.query_type = QueryType::overlap;
    for (std::size_t i = 0; i < at_least_one(count); ++i) set.boxes.push_back(cube(edges));
    return set;
  }

  QuerySet frusta(QuerySet set, double share, std::size_t count) {
    set.query_type = QueryType::overlap;
    for (std::size_t i = 0; i < std::clamp<std::size_t>(count, 1, 100); ++i) {
      set.regions.emplace_back(camera_that_sees(share, boxes_, world_, random_));
    }
    return set;
  }

  QuerySet spheres(QuerySet set) {
    set.query_type = QueryType::overlap;
    for (std::size_t i = 0; i < at_least_one(rays_ / 10); ++i) {
      set.regions.emplace_back(Sphere{point(), static_cast<float>(2.5 * edge_)});
    }
    return set;
  }

  QuerySet casts(QuerySet set) {
    set.query_type = QueryType::closest;
    for (std::size_t i = 0; i < at_least_one(rays_ / 10); ++i) {
      if (set.name == "swept_box") {
        BoxCast cast{.box = cube(0.5)};
        cast.direction = random_unit(random_).cast<float>();
        set.casts.emplace_back(cast);
      } else {
        SphereCast cast{.sphere = {point(), static_cast<float>(0.25 * edge_)}};
        cast.direction = random_unit(random_).cast<float>();
        set.casts.emplace_back(cast);
      }
    }
    return set;
  }

  QuerySet nearest(QuerySet set, std::size_t count) {
    set.query_type = QueryType::nearest;
    set.count = count;
    for (std::size_t i = 0; i < at_least_one(rays_ / 10); ++i) set.boxes.push_back(cube(0.0));
    return set;
  }

  std::span<const Aabb> boxes_;
  Aabb world_;
  double edge_ = 1.0;
  std::size_t rays_;
  std::uint64_t seed_;
  Random random_{0};
};

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
  return QuerySetBuilder(boxes, rays, seed).make(name);
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
