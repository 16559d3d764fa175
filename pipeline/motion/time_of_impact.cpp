// time_of_impact: checks each pair and distributes pairs of convex shapes to ImpactBatch, pairs
// with composite shapes to find_body_impact.

#include <winnow/pipeline/impacts.h>
#include "core/sort/parallel_ranges.h"
#include "core/threads/float_environment.h"
#include "pipeline/motion/body_impact.h"
#include "pipeline/motion/impact_batch.h"

#include <algorithm>
#include <array>

namespace winnow {
namespace {

/// A fast test whether a convex shape is in a pool, for kinds of which no shape was removed.
class KnownShapes {
 public:
  explicit KnownShapes(const ShapePool& pool) noexcept {
    for (const ShapeKind kind : kConvexKinds) {
      const auto index = static_cast<std::size_t>(kind);
      const std::uint32_t count = pool.tables().count[index];
      // If no shape of a kind was removed, all indices below the count are valid.
      if (pool.size(kind) == count) count_[index] = count;
    }
  }
  /// May be false for shapes that are in the pool.
  [[nodiscard]] bool surely_contain(ShapeId shape) const noexcept {
    return shape.kind_index() < kShapeKinds && shape.index() < count_[shape.kind_index()];
  }

 private:
  std::array<std::uint32_t, kShapeKinds> count_{};
};

/// Does not validate the motions of two convex shapes; ImpactBatch does.
[[nodiscard]] Status status_of(const SubShapeQuery& parts, const MovingBodies& bodies,
                               const ImpactOptions& options, const BodyPair& pair) noexcept {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    const ShapeId shape = bodies.shapes[body];
    if (shape.is_composite() && options.composites == nullptr) return Status::unsupported;
    if (!parts.contains(shape)) return Status::invalid_key;
  }
  if (impact::ImpactBatch::takes(bodies.shapes[pair.a], bodies.shapes[pair.b])) return Status::ok;
  const bool valid = bodies.motions[pair.a].is_valid() && bodies.motions[pair.b].is_valid();
  return valid ? Status::ok : Status::invalid_pose;
}

}  // namespace

ImpactResult::ImpactResult(std::pmr::memory_resource* memory) noexcept
    : status_(memory),
      hit_(memory),
      time_(memory),
      gap_(memory),
      error_bound_(memory),
      normal_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      part_a_(memory),
      part_b_(memory) {}

Footprint ImpactResult::footprint() const noexcept {
  Footprint footprint;
  Bytes& bytes = footprint.results;
  bytes += status_.bytes();
  bytes += hit_.bytes();
  bytes += part_a_.bytes();
  bytes += part_b_.bytes();
  bytes += time_.bytes();
  bytes += gap_.bytes();
  bytes += error_bound_.bytes();
  for (const Column<double>& column : normal_) bytes += column.bytes();
  for (const Column<double>& column : point_) bytes += column.bytes();
  return footprint;
}

/// Writes to the columns of a result.
struct ImpactColumns {
  bool resize(std::size_t count) noexcept {
    bool ok = to.status_.resize(count) && to.hit_.resize(count) && to.part_a_.resize(count) &&
              to.part_b_.resize(count);
    for (Column<double>* column : {&to.time_, &to.gap_, &to.error_bound_})
      ok = ok && column->resize(count);
    for (Column<double>& column : to.normal_) ok = ok && column.resize(count);
    for (Column<double>& column : to.point_) ok = ok && column.resize(count);
    return ok;
  }

  void write(std::size_t i, const impact::Impact& impact, std::uint32_t part_a,
             std::uint32_t part_b) noexcept {
    to.hit_[i] = impact.hit ? 1 : 0;
    to.time_[i] = impact.time;
    to.gap_[i] = impact.gap;
    to.error_bound_[i] = impact.error_bound;
    for (int axis = 0; axis < 3; ++axis) {
      to.normal_[axis][i] = impact.normal[axis];
      to.point_[axis][i] = impact.point[axis];
    }
    to.part_a_[i] = part_a;
    to.part_b_[i] = part_b;
  }

  /// Solves pairs [first, end), at most as many as fit a batch.
  void find_range(const SubShapeQuery& parts, const MovingBodies& bodies,
                  std::span<const BodyPair> pairs, const ImpactOptions& options, std::size_t first,
                  std::size_t end) {
    impact::ImpactBatch batch(parts.shapes().tables(), options.tolerance);
    const KnownShapes known(parts.shapes());
    impact::Impact none;
    none.time = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const auto [a, b] = pairs[i];
      const bool known_both =
          known.surely_contain(bodies.shapes[a]) && known.surely_contain(bodies.shapes[b]);
      to.status_[i] = known_both ? Status::ok : status_of(parts, bodies, options, pairs[i]);
      if (to.status_[i] != Status::ok) {
        write(i, none, kWholeShape, kWholeShape);
      } else if (impact::ImpactBatch::takes(bodies.shapes[a], bodies.shapes[b])) {
        batch.add(i, bodies.shapes[a], bodies.motions[a], bodies.shapes[b], bodies.motions[b]);
      } else {
        const impact::BodyImpact found =
            impact::find_body_impact(parts, {bodies.shapes[a], bodies.motions[a]},
                                     {bodies.shapes[b], bodies.motions[b]}, {options.tolerance});
        write(i, found.impact, found.part_a, found.part_b);
      }
    }
    batch.run([&](std::size_t i, const impact::Impact& found, bool valid) {
      if (!valid) to.status_[i] = Status::invalid_pose;
      write(i, valid ? found : none, kWholeShape, kWholeShape);
    });
  }

  ImpactResult& to;
};

Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                      std::span<const BodyPair> pairs, const ImpactOptions& options,
                      ImpactResult& result) {
  const DefaultFloatEnvironment environment;
  ImpactColumns writer{result};
  const auto refuse = [&writer](Status status) {
    static_cast<void>(writer.resize(0));
    return status;
  };
  const std::size_t count = bodies.shapes.size();
  if (count != bodies.motions.size()) return refuse(Status::size_mismatch);
  if (!(options.tolerance > 0.0 && options.tolerance <= 1.0)) {
    return refuse(Status::invalid_argument);
  }
  const bool exist = std::ranges::all_of(
      pairs, [count](const BodyPair& pair) { return pair.a < count && pair.b < count; });
  if (!exist) return refuse(Status::invalid_argument);
  if (!writer.resize(pairs.size())) return refuse(Status::out_of_memory);
  const SubShapeQuery parts(shapes, options.composites);
  for_each_range(options.execution, pairs.size(), impact::ImpactBatch::kRoom,
                 [&](std::size_t first, std::size_t end) {
                   writer.find_range(parts, bodies, pairs, options, first, end);
                 });
  return Status::ok;
}

}  // namespace winnow
