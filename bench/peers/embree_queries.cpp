// Adapter of Embree for queries on boxes: rays, boxes, balls and nearest neighbours, each query by
// a call of its own; it registers itself in registry.h; bench/micro times it.

#include "bench/contenders/engines.h"
#include "bench/peers/registry.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <winnow/core/eigen.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

namespace winnow::bench {
namespace {

/// Four floats in one register; the last one is unused.
using Four = float __attribute__((vector_size(16)));

struct PaddedBox {
  Four min;
  Four max;
};

constexpr Four padded(const float* xyz) noexcept {
  return Four{xyz[0], xyz[1], xyz[2], 0.0F};
}

PaddedBox padded(const Aabb& box) noexcept {
  return {padded(box.min.data()), padded(box.max.data())};
}

bool overlap(const PaddedBox& a, const PaddedBox& b) noexcept {
  return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] &&
         b.min[1] <= a.max[1] && a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
}

/// Returns the squared distance of a point from a box.
double squared_distance(const PaddedBox& box, const Eigen::Vector3f& point) noexcept {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto p = static_cast<double>(point[axis]);
    const double gap = std::max(
        {static_cast<double>(box.min[axis]) - p, p - static_cast<double>(box.max[axis]), 0.0});
    sum += gap * gap;
  }
  return sum;
}

/// Data of the current ray for the callbacks.
struct RayContext {
  RTCIntersectContext context;  // first, because the callbacks get its address
  Four origin;
  Four inverse;              // of the direction
  std::vector<Found>* hits;  // null: the ray is shortened to the hit

  explicit RayContext(const Ray& ray, std::vector<Found>* all) noexcept : hits(all) {
    rtcInitIntersectContext(&context);
    origin = padded(ray.origin.data());
    for (int axis = 0; axis < 3; ++axis) {
      // The least slope that Embree uses; avoids infinity times zero.
      const float d = ray.direction[axis];
      inverse[axis] = 1.0F / (std::abs(d) < 1e-18F ? std::copysign(1e-18F, d) : d);
    }
    inverse[3] = 0.0F;
  }

  /// Returns where the ray enters the box, or infinity if it does not within [near_t, far_t].
  [[nodiscard]] float enter(const PaddedBox& box, float near_t, float far_t) const noexcept {
    const Four a = (box.min - origin) * inverse;
    const Four b = (box.max - origin) * inverse;
    const Four low = a < b ? a : b;
    const Four high = a < b ? b : a;
    const float enter = std::max({low[0], low[1], low[2], near_t});
    const float leave = std::min({high[0], high[1], high[2], far_t});
    return enter <= leave ? enter : std::numeric_limits<float>::infinity();
  }
};

/// Embree 3: the boxes are one user geometry whose callbacks test slabs in float. Every query is
/// one call.
/// Settings, the best of those tried on 100,000 unit cubes and one thread (measured by `winnow
/// queries`): high build quality; robust mode, which was as fast and misses nothing; single rays,
/// for which the callbacks get an inverse direction (streams and packets of incoherent rays were
/// slower). All hits are collected by a callback of rtcIntersect1 that does not shorten the ray,
/// and sorted. Box queries use rtcPointQuery, which find_in_box() makes search a box instead of the
/// ball around it; rtcCollide with a scene of all query boxes was not faster.
class EmbreeQueries final : public QueryEngine {
 public:
  EmbreeQueries() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) throw std::runtime_error("Embree: no device");
  }
  ~EmbreeQueries() override {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] std::string name() const override { return "Embree"; }

  [[nodiscard]] bool takes(const QuerySet& set, QueryMode mode) const override {
    const auto is_sphere = [](const auto& region) {
      return std::holds_alternative<Sphere>(region);
    };
    return mode == QueryMode::single && set.casts.empty() &&
           std::all_of(set.regions.begin(), set.regions.end(), is_sphere);
  }

  void start(std::span<const Aabb> boxes) override {
    for (const Aabb& box : boxes) boxes_.push_back(padded(box));
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes_.size()));
    rtcSetGeometryUserData(geometry, boxes_.data());
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcSetGeometryBoundsFunction(geometry, give_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occluded);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  std::uint64_t run(const QuerySet& set, QueryMode /*mode*/, std::size_t count) override {
    if (tbb::this_task_arena::max_concurrency() == 1) return run_part(set, 0, count);
    std::atomic<std::uint64_t> found{0};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
      found += run_part(set, range.begin(), range.end());
    });
    return found;
  }

  [[nodiscard]] QueryResults answers(const QuerySet& set, QueryMode /*mode*/,
                                     std::size_t count) override {
    QueryResults result;
    for (std::size_t i = 0; i < count; ++i) {
      for (const Found& found : run_one(set, i, hits_.local())) result.add(found);
      result.next();
    }
    return result;
  }

 private:
  using Hits = std::vector<Found>;

  static void give_bounds(const RTCBoundsFunctionArguments* arguments) {
    const PaddedBox& box =
        static_cast<const PaddedBox*>(arguments->geometryUserPtr)[arguments->primID];
    *arguments->bounds_o = {box.min[0], box.min[1], box.min[2], 0.0F,
                            box.max[0], box.max[1], box.max[2], 0.0F};
  }

  static void intersect(const RTCIntersectFunctionNArguments* arguments) {
    const auto& ray = *reinterpret_cast<const RayContext*>(arguments->context);
    auto& state = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    const PaddedBox& box =
        static_cast<const PaddedBox*>(arguments->geometryUserPtr)[arguments->primID];
    const float t = ray.enter(box, state.ray.tnear, state.ray.tfar);
    if (t == std::numeric_limits<float>::infinity()) return;
    if (ray.hits != nullptr) {
      ray.hits->push_back({arguments->primID, t});
      return;
    }
    state.ray.tfar = t;
    state.hit.primID = arguments->primID;
    state.hit.geomID = arguments->geomID;
  }

  static void occluded(const RTCOccludedFunctionNArguments* arguments) {
    const auto& ray = *reinterpret_cast<const RayContext*>(arguments->context);
    auto& state = *reinterpret_cast<RTCRay*>(arguments->ray);
    const PaddedBox& box =
        static_cast<const PaddedBox*>(arguments->geometryUserPtr)[arguments->primID];
    const float t = ray.enter(box, state.tnear, state.tfar);
    if (t == std::numeric_limits<float>::infinity()) return;
    state.tfar = -std::numeric_limits<float>::infinity();
    state.id = arguments->primID;
  }

  std::uint64_t run_part(const QuerySet& set, std::size_t begin, std::size_t end) {
    Hits& hits = hits_.local();
    std::uint64_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += run_one(set, i, hits).size();
    return found;
  }

  /// Runs one query; the results are in `hits`.
  std::span<const Found> run_one(const QuerySet& set, std::size_t i, Hits& hits) {
    hits.clear();
    if (!set.rays.empty()) {
      cast(set.rays[i], set.query_type, hits);
    } else if (!set.regions.empty()) {
      find_in_ball(std::get<Sphere>(set.regions[i]), hits);
    } else if (set.query_type == QueryType::nearest) {
      find_nearest(set.boxes[i].min, set.count, hits);
    } else {
      find_in_box(set.boxes[i], hits);
    }
    return hits;
  }

  void cast(const Ray& ray, QueryType query_type, Hits& hits) {
    RayContext context(ray, query_type == QueryType::all ? &hits : nullptr);
    RTCRayHit state{};
    state.ray = {ray.origin.x(),
                 ray.origin.y(),
                 ray.origin.z(),
                 ray.min_t,
                 ray.direction.x(),
                 ray.direction.y(),
                 ray.direction.z(),
                 0.0F,
                 ray.max_t,
                 ~0U,
                 0U,
                 0U};
    state.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (query_type == QueryType::any) {
      rtcOccluded1(scene_, &context.context, &state.ray);
      if (state.ray.tfar < 0.0F) hits.push_back({state.ray.id, 0.0F});
      return;
    }
    rtcIntersect1(scene_, &context.context, &state);
    if (query_type == QueryType::all) {
      std::sort(hits.begin(), hits.end(), [](const Found& a, const Found& b) { return a.t < b.t; });
    } else if (state.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      hits.push_back({state.hit.primID, state.ray.tfar});
    }
  }

  /// Calls `accept(query, row)` for every object whose box may be within the radius; `accept`
  /// returns true if it reduced the radius.
  template <typename Accept>
  void search(const Eigen::Vector3f& center, float radius, RTCPointQueryContext& context,
              Accept accept) const {
    RTCPointQuery query{center.x(), center.y(), center.z(), 0.0F, radius};
    const RTCPointQueryFunction call = [](RTCPointQueryFunctionArguments* arguments) {
      return (*static_cast<Accept*>(arguments->userPtr))(*arguments->query, arguments->primID);
    };
    rtcPointQuery(scene_, &query, &context, call, &accept);
  }
  template <typename Accept>
  void search(const Eigen::Vector3f& center, float radius, Accept accept) const {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    search(center, radius, context, accept);
  }

  /// The query context describes the scene as an instance that is scaled about the centre, by
  /// different factors on the axes: Embree then searches the bounding box of the scaled ball.
  void find_in_box(const Aabb& box, Hits& hits) const {
    const Eigen::Vector3f center = 0.5F * (box.min + box.max);
    // Enlarged by more than rounding; candidates are tested exactly.
    const float slack = 1e-6F * center.cwiseAbs().maxCoeff() + 1e-30F;
    const Eigen::Vector3f half = 1.00001F * (as_eigen(box.max) - center).array() + slack;
    const float radius = half.maxCoeff();
    Eigen::Vector3f scale = (half / radius).cwiseMax(0.001F);
    if (scale.minCoeff() > 0.999F) scale.z() = 1.001F;
    RTCPointQueryContext context{};
    context.instStackSize = 1;
    for (int axis = 0; axis < 3; ++axis) {
      context.world2inst[0][5 * axis] = scale[axis];
      context.world2inst[0][12 + axis] = center[axis] * (1.0F - scale[axis]);
      context.inst2world[0][5 * axis] = 1.0F / scale[axis];
      context.inst2world[0][12 + axis] = center[axis] * (1.0F - 1.0F / scale[axis]);
    }
    context.world2inst[0][15] = context.inst2world[0][15] = 1.0F;
    search(center, radius, context, [&, query = padded(box)](RTCPointQuery&, unsigned row) {
      if (overlap(boxes_[row], query)) hits.push_back({row, 0.0F});
      return false;
    });
  }

  void find_in_ball(const Sphere& ball, Hits& hits) const {
    const double square = static_cast<double>(ball.radius) * static_cast<double>(ball.radius);
    search(ball.center, 1.00001F * ball.radius, [&](RTCPointQuery&, unsigned row) {
      if (squared_distance(boxes_[row], ball.center) <= square) hits.push_back({row, 0.0F});
      return false;
    });
  }

  /// Keeps the best results sorted by insertion; the radius shrinks to the last of them.
  void find_nearest(const Eigen::Vector3f& point, std::size_t count, Hits& hits) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    search(point, kFar, [&](RTCPointQuery& query, unsigned row) {
      const auto distance = static_cast<float>(std::sqrt(squared_distance(boxes_[row], point)));
      if (hits.size() == count) {
        if (distance >= hits.back().t) return false;
        hits.pop_back();
      }
      const auto at = std::upper_bound(hits.begin(), hits.end(), distance,
                                       [](float d, const Found& found) { return d < found.t; });
      hits.insert(at, {row, distance});
      if (hits.size() < count) return false;
      query.radius = hits.back().t;
      return true;
    });
  }

  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::vector<PaddedBox> boxes_;
  tbb::enumerable_thread_specific<Hits> hits_;
};

const RegisteredPeer<QueryEngine, EmbreeQueries> kEmbreeQueries;

}  // namespace
}  // namespace winnow::bench
