#include "bench/contenders/engines.h"
#include "bench/peers/registry.h"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

namespace winnow::bench {
namespace {

/// Embree 3: a triangle geometry of high build quality, in one of its two modes: fast, which may
/// miss hits at edges and vertices, or robust. Single rays use rtcIntersect1 and rtcOccluded1.
/// Batches use streams (rtcIntersect1M, rtcOccluded1M), the fastest of Embree's functions for
/// incoherent rays that takes rays in any order (measured by bench/micro). As there is one
/// mesh, all hits are the closest one.
class EmbreeRays final : public RayEngine {
 public:
  explicit EmbreeRays(bool robust)
      : robust_(robust), device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    if (device_ == nullptr) throw std::runtime_error("Embree: no device");
  }
  ~EmbreeRays() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] std::string name() const override {
    return robust_ ? "Embree robust" : "Embree fast";
  }

  void start(const Triangles& mesh) override {
    rtcSetSceneFlags(scene_, robust_ ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const vertex = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        vertex[3 * i + static_cast<std::size_t>(axis)] = static_cast<float>(mesh.vertices[i][axis]);
      }
    }
    void* const corner =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.size());
    std::memcpy(corner, mesh.corners.data(), mesh.corners.size() * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  [[nodiscard]] std::size_t bytes() const override { return 0; }

  void take(std::span<const ShapeRay> rays) override {
    rays_.clear();
    occluded_.clear();
    for (const ShapeRay& ray : rays) {
      RTCRayHit one{};
      one.ray.org_x = static_cast<float>(ray.origin[0]);
      one.ray.org_y = static_cast<float>(ray.origin[1]);
      one.ray.org_z = static_cast<float>(ray.origin[2]);
      one.ray.dir_x = static_cast<float>(ray.direction[0]);
      one.ray.dir_y = static_cast<float>(ray.direction[1]);
      one.ray.dir_z = static_cast<float>(ray.direction[2]);
      one.ray.tfar = static_cast<float>(ray.max_t);
      one.ray.mask = ~0U;
      one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rays_.push_back(one);
      occluded_.push_back(one.ray);
    }
  }

  void run(RayQueryType query_type, QueryMode mode) override {
    any_ = query_type == RayQueryType::any;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const auto count = static_cast<unsigned>(rays_.size());
    if (mode == QueryMode::batch && any_) {
      rtcOccluded1M(scene_, &context, occluded_.data(), count, sizeof(RTCRay));
    } else if (mode == QueryMode::batch) {
      rtcIntersect1M(scene_, &context, rays_.data(), count, sizeof(RTCRayHit));
    } else if (any_) {
      for (RTCRay& ray : occluded_) rtcOccluded1(scene_, &context, &ray);
    } else {
      for (RTCRayHit& ray : rays_) rtcIntersect1(scene_, &context, &ray);
    }
  }

  [[nodiscard]] std::vector<double> hits() const override {
    std::vector<double> result(rays_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (any_) {
        if (occluded_[i].tfar < 0.0F) result[i] = 0.0;
      } else if (rays_[i].hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        result[i] = static_cast<double>(rays_[i].ray.tfar);
      }
    }
    return result;
  }

 private:
  bool robust_;
  bool any_ = false;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCRayHit> rays_;
  std::vector<RTCRay> occluded_;
};

const RegisteredPeer<RayEngine, EmbreeRays, false> kFast;
const RegisteredPeer<RayEngine, EmbreeRays, true> kRobust;

}  // namespace
}  // namespace winnow::bench
