#pragma once

#include <winnow/pipeline/scene_queries.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

class ObservedFilter;

/// Which hits of a ray or shape cast are requested. `from_touch`: without bodies that are only
/// touched at the start (ShapeCast::touching is false). Recordings contain the values;
/// `with_min_t`: recorded rays that have a min_t.
enum class HitForm : std::uint8_t {
  closest,
  any,
  all,
  closest_from_touch,
  all_from_touch,
  closest_with_min_t,
  any_with_min_t,
  all_with_min_t,
};

[[nodiscard]] inline std::span<const SceneHit> one_hit(const SceneHit& hit) noexcept {
  return {&hit, 1};
}

/// Receives the successful queries of a recorded scene, each with its arguments and then its
/// results. Several threads may call it at the same time. pipeline/recording/ implements it.
class QueryObserver {
 public:
  QueryObserver(const QueryObserver&) = delete;
  QueryObserver& operator=(const QueryObserver&) = delete;

  // For HitForm::closest and HitForm::any, `hits` is one_hit(hit); the hit may be null.

  virtual void ray(HitForm form, const ShapeRay& ray, ObservedFilter& filter,
                   std::span<const SceneHit> hits) noexcept = 0;
  virtual void rays(HitForm form, const ShapeRayBatch& rays, ObservedFilter& filter,
                    const SceneHitColumns& hits) noexcept = 0;
  virtual void rays(const ShapeRayBatch& rays, ObservedFilter& filter,
                    const SceneHitLists& lists) noexcept = 0;
  virtual void crossings(const ShapeRay& ray, ObservedFilter& filter,
                         std::span<const SceneCrossing> points) noexcept = 0;
  virtual void cast(HitForm form, const ShapeCast& cast, ObservedFilter& filter, double tolerance,
                    std::span<const SceneHit> hits) noexcept = 0;
  virtual void cast(HitForm form, const MotionCast& cast, ObservedFilter& filter, double tolerance,
                    std::span<const SceneHit> hits) noexcept = 0;
  virtual void overlap(ShapeId shape, const Pose& pose, ObservedFilter& filter,
                       std::span<const SceneOverlap> bodies) noexcept = 0;
  virtual void distances(ShapeId shape, const Pose& pose, double limit, ObservedFilter& filter,
                         std::span<const SceneDistance> bodies) noexcept = 0;
  virtual void nearest(const Vec3d& point, std::size_t count, double radius, ObservedFilter& filter,
                       std::span<const SceneDistance> bodies) noexcept = 0;

  virtual void distance(Key a, Key b, double limit, PairRules rules,
                        const SceneDistance& answer) noexcept = 0;
  virtual void least_distance(std::span<const Key> a, std::span<const Key> b, double limit,
                              PairRules rules, const SetDistance& answer) noexcept = 0;
  virtual void overlaps(std::span<const Key> a, std::span<const Key> b, std::size_t most,
                        PairRules rules, std::span<const KeyPair> pairs) noexcept = 0;
  virtual void any_contact(std::span<const Key> a, std::span<const Key> b, double contact_margin,
                           PairRules rules, const KeyPair& pair) noexcept = 0;
  virtual void any_contact(double contact_margin, PairRules rules,
                           const KeyPair& pair) noexcept = 0;

 protected:
  QueryObserver() = default;
  ~QueryObserver() = default;
};

}  // namespace winnow
