#pragma once

#include "pipeline/recording/accepted_pairs.h"
#include "pipeline/recording/shape_recording.h"
#include "pipeline/scene/queries/query_observer.h"

namespace winnow {

/// The recording of the queries of one scene.
class QueryRecording final : public QueryObserver {
 public:
  QueryRecording(RecorderState& recorder, std::uint32_t world, ShapeRecording& shapes,
                 AcceptedPairs& accepted) noexcept
      : recorder_(recorder), world_(world), shapes_(shapes), accepted_(accepted) {}

  void ray(HitForm form, const ShapeRay& ray, ObservedFilter& filter,
           std::span<const SceneHit> hits) noexcept override;
  void rays(HitForm form, const ShapeRayBatch& rays, ObservedFilter& filter,
            const SceneHitColumns& hits) noexcept override;
  void rays(const ShapeRayBatch& rays, ObservedFilter& filter,
            const SceneHitLists& lists) noexcept override;
  void crossings(const ShapeRay& ray, ObservedFilter& filter,
                 std::span<const SceneCrossing> points) noexcept override;
  void cast(HitForm form, const ShapeCast& cast, ObservedFilter& filter, double tolerance,
            std::span<const SceneHit> hits) noexcept override;
  void cast(HitForm form, const MotionCast& cast, ObservedFilter& filter, double tolerance,
            std::span<const SceneHit> hits) noexcept override;
  void overlap(ShapeId shape, const Pose& pose, ObservedFilter& filter,
               std::span<const SceneOverlap> bodies) noexcept override;
  void distances(ShapeId shape, const Pose& pose, double limit, ObservedFilter& filter,
                 std::span<const SceneDistance> bodies) noexcept override;
  void nearest(const Vec3d& point, std::size_t count, double radius, ObservedFilter& filter,
               std::span<const SceneDistance> bodies) noexcept override;
  void distance(Key a, Key b, double limit, PairRules rules,
                const SceneDistance& answer) noexcept override;
  void least_distance(std::span<const Key> a, std::span<const Key> b, double limit, PairRules rules,
                      const SetDistance& answer) noexcept override;
  void overlaps(std::span<const Key> a, std::span<const Key> b, std::size_t most, PairRules rules,
                std::span<const KeyPair> pairs) noexcept override;
  void any_contact(std::span<const Key> a, std::span<const Key> b, double contact_margin,
                   PairRules rules, const KeyPair& pair) noexcept override;
  void any_contact(double contact_margin, PairRules rules, const KeyPair& pair) noexcept override;

 private:
  void put_end(CallWriter& call, ObservedFilter& filter, const Digest& digest) noexcept;
  [[nodiscard]] RecordedCall call_by_rules(PairRules rules, RecordedCall any_two,
                                           RecordedCall by_rules) noexcept;

  RecorderState& recorder_;
  const std::uint32_t world_;
  ShapeRecording& shapes_;
  AcceptedPairs& accepted_;
};

}  // namespace winnow
