#pragma once

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace winnow {

struct ClusterQueryState;

/// Where a ray meets a body: as SceneHit, of a body of any rank.
struct ClusterHit {
  BodyName name = 0;                   ///< the body
  double t = 0.0;                      ///< in units of the direction
  double normal[3] = {0.0, 0.0, 0.0};  ///< unit, of its surface, against the ray
  double point[3] = {0.0, 0.0, 0.0};   ///< where they meet, in the world
  std::uint32_t part = kWholeShape;    ///< triangle or child
};

/// A body that a shape overlaps: as SceneOverlap.
struct ClusterOverlap {
  BodyName name = 0;                 ///< the body
  std::uint32_t part = kWholeShape;  ///< a part of it that does
};

/// A body near a point: as SceneDistance.
struct ClusterDistance {
  BodyName name = 0;                   ///< the body
  double distance = 0.0;               ///< negative within a solid
  double error_bound = 0.0;            ///< the true distance is within distance +- it
  double normal[3] = {0.0, 0.0, 0.0};  ///< unit, from the point to the body
  double point[3] = {0.0, 0.0, 0.0};   ///< of the body, in the world
  std::uint32_t part = kWholeShape;    ///< the closest of its parts
};

/// A shape at a pose, which bodies may overlap.
struct ShapeProbe {
  ShapeId shape;  ///< convex or composite
  Pose pose;      ///< where it is
};

/// A point that bodies may be near.
struct NearestProbe {
  double point[3] = {0.0, 0.0, 0.0};                        ///< finite
  std::size_t count = 1;                                    ///< at most so many
  double radius = std::numeric_limits<double>::infinity();  ///< no farther than this; >= 0
};

/// What one rank asks: questions, and whom they are about. The filter has no predicate
/// (`unsupported`).
template <typename Question>
struct ClusterQuestions {
  std::span<const Question> questions;  ///< of that rank
  Filter filter{};                      ///< of all of them
};

/// What one rank is answered: to question i, answers[first[i]] to answers[first[i + 1]], that
/// excluded.
template <typename Answer>
struct ClusterAnswers {
  std::span<const Answer> answers;     ///< to all questions, one after the other
  std::span<const std::size_t> first;  ///< one more than there are questions
};

/// Questions to the exact shapes of all ranks of a ClusterScene, answered as SceneQueries would
/// answer them of one Scene to which the bodies were added in the order of their names, bit for
/// bit. Each hosted rank asks a batch, which may be empty, and gets its own answers; those who have
/// nothing to ask take part. Bodies are where they were moved to last: they go where they belong
/// first, as in `collide`.
///
/// All questions are collective. A batch with a bad question is refused as SceneQueries refuses it;
/// others are answered. Answers are valid until the next question of their kind.
class WINNOW_API ClusterQueries {
 public:
  /// Asks `cluster`, which must outlive this.
  explicit ClusterQueries(ClusterScene& cluster) noexcept;
  ~ClusterQueries();
  ClusterQueries(const ClusterQueries&) = delete;
  ClusterQueries& operator=(const ClusterQueries&) = delete;

  /// The hit of each ray with the least t, of equal ones that with the least name. A ray is sent to
  /// the ranks whose regions it meets.
  Status closest(std::span<const ClusterQuestions<ShapeRay>> rays, std::span<Status> answers);
  /// The first hit of every body that each ray meets, sorted by t and then by name.
  Status all(std::span<const ClusterQuestions<ShapeRay>> rays, std::span<Status> answers);
  /// Whether each ray hits anything.
  Status any(std::span<const ClusterQuestions<ShapeRay>> rays, std::span<Status> answers);
  /// Every body that each shape shares a point with, sorted by name. A shape is sent to the ranks
  /// whose regions its box meets.
  Status overlap(std::span<const ClusterQuestions<ShapeProbe>> shapes, std::span<Status> answers);
  /// The bodies nearest to each point, sorted by distance and then by name. A point is sent to all
  /// ranks.
  Status nearest(std::span<const ClusterQuestions<NearestProbe>> points, std::span<Status> answers);

  /// Of the last `closest` or `all` of a hosted rank.
  [[nodiscard]] ClusterAnswers<ClusterHit> hits(std::uint32_t rank) const noexcept;
  /// Of the last `any` of a hosted rank: not 0 for each ray that hits something.
  [[nodiscard]] std::span<const std::uint8_t> blocked(std::uint32_t rank) const noexcept;
  /// Of the last `overlap` of a hosted rank.
  [[nodiscard]] ClusterAnswers<ClusterOverlap> overlaps(std::uint32_t rank) const noexcept;
  /// Of the last `nearest` of a hosted rank.
  [[nodiscard]] ClusterAnswers<ClusterDistance> neighbours(std::uint32_t rank) const noexcept;

 private:
  /// Null where memory was refused.
  ClusterQueryState* state_ = nullptr;
};

}  // namespace winnow
