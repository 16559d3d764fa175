#include <winnow/pipeline/time_of_impact.h>
#include "core/sort/stretches.h"
#include "pipeline/motion/impact_search.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

[[nodiscard]] Status status_of(const ShapePool& shapes, const MovingBodies& bodies,
                               const BodyPair& pair) noexcept {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    const ShapeId shape = bodies.shapes[body];
    if (shape.is_composite()) return Status::unsupported;
    if (!shapes.contains(shape)) return Status::invalid_key;
    if (!bodies.motions[body].is_valid()) return Status::invalid_pose;
  }
  return Status::ok;
}

}  // namespace

ImpactResult::ImpactResult(std::pmr::memory_resource* memory) noexcept
    : status_(memory),
      hit_(memory),
      time_(memory),
      gap_(memory),
      error_bound_(memory),
      normal_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point_{Column<double>(memory), Column<double>(memory), Column<double>(memory)} {}

bool ImpactResult::resize(std::size_t count) noexcept {
  bool ok = status_.resize(count) && hit_.resize(count);
  for (Column<double>* column : {&time_, &gap_, &error_bound_}) ok = ok && column->resize(count);
  for (Column<double>& column : normal_) ok = ok && column.resize(count);
  for (Column<double>& column : point_) ok = ok && column.resize(count);
  return ok;
}

Footprint ImpactResult::footprint() const noexcept {
  Footprint footprint;
  Bytes& bytes = footprint.results;
  bytes += status_.bytes();
  bytes += hit_.bytes();
  bytes += time_.bytes();
  bytes += gap_.bytes();
  bytes += error_bound_.bytes();
  for (const Column<double>& column : normal_) bytes += column.bytes();
  for (const Column<double>& column : point_) bytes += column.bytes();
  return footprint;
}

Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                      std::span<const BodyPair> pairs, const ImpactOptions& options,
                      ImpactResult& result) {
  const auto refuse = [&result](Status status) {
    static_cast<void>(result.resize(0));
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
  if (!result.resize(pairs.size())) return refuse(Status::out_of_memory);
  constexpr std::size_t kPairsPerStretch = 64;
  for_stretches(
      options.execution, pairs.size(), kPairsPerStretch, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
          const auto [a, b] = pairs[i];
          const Status status = status_of(shapes, bodies, pairs[i]);
          impact::Impact found;
          if (status == Status::ok) {
            found = impact::find_impact(shapes.tables(), bodies.shapes[a], bodies.motions[a],
                                        bodies.shapes[b], bodies.motions[b], options.tolerance);
          } else {
            found.time = 0.0;
          }
          result.status_[i] = status;
          result.hit_[i] = found.hit ? 1 : 0;
          result.time_[i] = found.time;
          result.gap_[i] = found.gap;
          result.error_bound_[i] = found.error_bound;
          for (int axis = 0; axis < 3; ++axis) {
            result.normal_[axis][i] = found.normal[axis];
            result.point_[axis][i] = found.point[axis];
          }
        }
      });
  return Status::ok;
}

}  // namespace winnow
