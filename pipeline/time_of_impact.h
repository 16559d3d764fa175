#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// What impacts are found with, which is winnow's own.
namespace impact {
struct Impact;
}  // namespace impact
class PartTraversal;

/// What moves: body i has shape shapes[i] and moves by motions[i].
struct MovingBodies {
  std::span<const ShapeId> shapes;       ///< by body
  std::span<const RigidMotion> motions;  ///< by body; as many
};

/// How near shapes must be to have met.
struct ImpactOptions {
  /// The gap at the time of impact is at most this share of the smaller shape's size: its largest
  /// distance from its middle, the other's if it is a point; of composite shapes, of the parts that
  /// meet. In (0, 1]. At least what double
  /// resolves: some 1e-13 of the sizes, of the way between the positions and of what turning
  /// sweeps; of cylinders and cones beside shapes many times as large some 1e-8 of the larger.
  double tolerance = 1e-6;
  /// On whose threads; answers are the same on all.
  Execution execution = Execution::serial();
  /// What holds meshes, height fields and compounds; null where there are none.
  const MidPhase* composites = nullptr;
};

/// When moving shapes first meet: columns, one element for each pair in the order given. The
/// caller's, reused from call to call.
class WINNOW_API ImpactResult {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// use.
  explicit ImpactResult(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Answers, one for each pair that was asked about.
  [[nodiscard]] std::size_t size() const noexcept { return time_.size(); }
  /// `ok`; `invalid_key` for a pair with a shape that is not there, `unsupported` for one with a
  /// composite shape where no composites are given, `invalid_pose` for one with a motion that is
  /// not valid: the other columns then hold zeros.
  [[nodiscard]] Status status(std::size_t i) const noexcept { return status_[i]; }
  /// The same of all.
  [[nodiscard]] std::span<const Status> status() const noexcept {
    return {status_.data(), status_.size()};
  }
  /// True if they meet. False is certain: they are apart all the time.
  [[nodiscard]] bool hits(std::size_t i) const noexcept { return hit_[i] != 0; }
  /// The same of all, not 0 where they do.
  [[nodiscard]] std::span<const std::uint8_t> hit() const noexcept {
    return {hit_.data(), hit_.size()};
  }
  /// In [0, 1], 1 where they do not meet. At every earlier time they are apart.
  [[nodiscard]] std::span<const double> time() const noexcept { return span(time_); }
  /// Distance at that time, within the tolerance; 0 where they do not meet. Not above 0, and then
  /// by how deep they overlap, of shapes that share a point at the start: their time is 0.
  [[nodiscard]] std::span<const double> gap() const noexcept { return span(gap_); }
  /// The true distance at that time is within gap +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return span(error_bound_); }
  /// Unit vectors from a to b at that time, in the axes of the world; 0 where they do not meet.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept {
    return span(normal_[axis]);
  }
  /// The point of a at that time, relative to the position of body a then, in the axes of the
  /// world. That of b is gap * normal farther.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept {
    return span(point_[axis]);
  }

  /// Which triangle or child of a it is that meets b, the same each time; kWholeShape of a convex
  /// shape, and where they do not meet.
  [[nodiscard]] std::span<const std::uint32_t> part_a() const noexcept {
    return {part_a_.data(), part_a_.size()};
  }
  /// The same of b.
  [[nodiscard]] std::span<const std::uint32_t> part_b() const noexcept {
    return {part_b_.data(), part_b_.size()};
  }

  /// All columns under `results`, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend WINNOW_API Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                                          std::span<const BodyPair> pairs,
                                          const ImpactOptions& options, ImpactResult& result);
  [[nodiscard]] bool resize(std::size_t count) noexcept;
  void find_stretch(const PartTraversal& parts, const MovingBodies& bodies,
                    std::span<const BodyPair> pairs, const ImpactOptions& options,
                    std::size_t first, std::size_t end);
  void write(std::size_t i, const impact::Impact& impact, std::uint32_t part_a,
             std::uint32_t part_b) noexcept;
  [[nodiscard]] static std::span<const double> span(const Column<double>& c) noexcept {
    return {c.data(), c.size()};
  }

  Column<Status> status_;
  Column<std::uint8_t> hit_;
  Column<double> time_;
  Column<double> gap_;
  Column<double> error_bound_;
  Column<double> normal_[3];
  Column<double> point_[3];
  Column<std::uint32_t> part_a_;
  Column<std::uint32_t> part_b_;
};

/// When the shapes of each pair first meet. Never late: at every time before the answer they are
/// apart, which planes between them prove, rounding included; and it is early by no more than it
/// takes to close a gap of the tolerance. Shapes that share a point at the start meet at time 0.
/// Shapes that pass each other nearer than the tolerance, or part from such a gap only to close it
/// again, may meet or not; those that stay within it as they slide, rest or part do not meet.
///
/// Conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body systems",
/// 1996) along the normal of the closest points: what a body reaches along a direction is, of each
/// of its points, a cosine in time, and hence between two times above its chord by no less than a
/// square of the angle; so that two looks at the shapes prove that they are apart between, with an
/// error of second order, and few steps are needed. Composite shapes are traversed in their own
/// frame by a box that sweeps through it with the other shape, turning included, what is met first
/// first: part by part, and no part after the first time found. Of shapes that share a point at the
/// start the gap is that of the parts that overlap the deepest.
///
/// `invalid_argument` for a bad tolerance or a pair of a body that does not exist, `size_mismatch`
/// for spans of different lengths, `out_of_memory`: then `result` is empty. What is wrong with one
/// pair is in its status. Usually some three looks for closest points per pair, of fast turns
/// seven; where shapes whirl around each other without touching, up to |turn| / sqrt(tolerance).
/// Where neither turns, the looks are steps of one search for closest points (van den Bergen, "Ray
/// casting against general convex objects with application to continuous collision detection",
/// 2004): some six, of smooth shapes up to fifteen, among which are guesses by the secant method
/// where the normal leads from one to the other. Eight pairs of the same kinds look at once, in
/// double, 256 being sorted by kind at a time; two half-spaces, and what double can hardly tell
/// apart, do so one by one. What is said of a pair does not depend on the others. Of composite
/// shapes that for each pair of parts whose boxes meet on the way, and a traversal for each half
/// radian or so that they turn past each other within reach.
WINNOW_API Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                                 std::span<const BodyPair> pairs, const ImpactOptions& options,
                                 ImpactResult& result);

}  // namespace winnow
