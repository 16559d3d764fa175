#include "bench/contenders/engines.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/registry.h"

#include <embree3/rtcore.h>
#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// Embree 3: rtcCollide of a scene with itself; the boxes are one user geometry. Building and
/// colliding run on the threads of the calling arena. The device setting `threads=N` is not used,
/// as it would limit the threads of every TBB user in the process.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): a dynamic scene
/// of low build quality, committed every frame. Medium quality was slower, and so was refitting,
/// which gets worse as objects move. Embree has no cheaper update for few moved or new objects.
/// rtcCollide reports each pair in both orders, and other pairs of primitives that share a leaf;
/// the callback filters them.
class EmbreeEngine final : public PairsAdapter {
 public:
  EmbreeEngine() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) throw std::runtime_error("Embree: no device");
    rtcSetDeviceMemoryMonitorFunction(device_, count_memory, &bytes_);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
  }
  ~EmbreeEngine() override {
    rtcReleaseScene(scene_);
    if (geometry_ != nullptr) rtcReleaseGeometry(geometry_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] std::string name() const override { return "Embree"; }

  /// Bytes according to the device.
  [[nodiscard]] std::size_t bytes() const override {
    return static_cast<std::size_t>(bytes_.load());
  }

 private:
  void build(std::span<const Aabb> boxes) override {
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(boxes.size()));
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, give_bounds, nullptr);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_LOW);
    boxes_ = boxes;
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
  }

  void update(std::span<const std::uint32_t> changed_rows,
              std::span<const Aabb> all_boxes) override {
    const bool has_grown = all_boxes.size() != boxes_.size();
    boxes_ = all_boxes;
    if (has_grown)
      rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(boxes_.size()));
    if (has_grown || !changed_rows.empty()) {
      rtcCommitGeometry(geometry_);
      rtcCommitScene(scene_);
    }
  }

  static bool count_memory(void* bytes, std::ptrdiff_t change, bool) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(bytes) += change;
    return true;
  }

  static void give_bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& engine = *static_cast<const EmbreeEngine*>(arguments->geometryUserPtr);
    const Aabb& box = engine.boxes_[arguments->primID];
    *arguments->bounds_o = {box.min.x(), box.min.y(), box.min.z(), 0.0F,
                            box.max.x(), box.max.y(), box.max.z(), 0.0F};
  }

  static void collect(void* self, RTCCollision* found, unsigned count) {
    auto& engine = *static_cast<EmbreeEngine*>(self);
    std::vector<Pair>& pairs = engine.found_.local();
    for (unsigned i = 0; i < count; ++i) {
      const unsigned a = found[i].primID0;
      const unsigned b = found[i].primID1;
      if (a < b && engine.boxes_[a].overlaps(engine.boxes_[b])) pairs.push_back({a, b});
    }
  }

  void find_pairs(std::span<const Aabb>) override {
    pairs_.clear();
    if (boxes_.size() < 2) return;
    for (std::vector<Pair>& pairs : found_) pairs.clear();
    rtcCollide(scene_, scene_, collect, this);
    for (const std::vector<Pair>& pairs : found_) {
      pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
    }
  }

  std::atomic<std::ptrdiff_t> bytes_{0};
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  std::span<const Aabb> boxes_;
  tbb::enumerable_thread_specific<std::vector<Pair>> found_;
};

const RegisteredPeer<Engine, EmbreeEngine> kEmbreeEngine;

}  // namespace
}  // namespace winnow::bench
