#pragma once

#include "pipeline/motion/impact_lanes.kernel.h"
#include "pipeline/motion/impact_search.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow::impact {

/// Pairs of moving convex shapes, solved many at a time: in SIMD lanes, grouped by pair of kinds,
/// and by `find_impact` if the lanes cannot decide. The result of a pair does not depend on the
/// other pairs.
class ImpactBatch {
 public:
  /// Capacity; if it is reached, call `run`.
  static constexpr std::size_t kRoom = 256;

  ImpactBatch(const ShapeTables& tables, double tolerance) noexcept
      : tables_(tables), tolerance_(tolerance) {}

  [[nodiscard]] bool is_full() const noexcept { return count_ == kRoom; }
  /// Whether the batch supports a pair of these shapes.
  [[nodiscard]] static bool takes(ShapeId a, ShapeId b) noexcept {
    return !a.is_composite() && !b.is_composite();
  }
  /// Adds a pair; `name` identifies its result. The motions must outlive the next run. An impact
  /// after `until` may be reported as none.
  void add(std::size_t name, ShapeId a, const RigidMotion& of_a, ShapeId b, const RigidMotion& of_b,
           double until = 1.0) noexcept;

  /// Calls take(name, impact, valid) for each pair, in the order of the calls of `add`, and clears
  /// the batch. `valid` is false, and there is no impact, if a motion is not valid.
  template <typename Take>
  void run(Take&& take) {
    find();
    for (std::size_t i = 0; i < count_; ++i) {
      finish(i);
      take(names_[i], found_[i], verdicts_[i] != ImpactVerdict::invalid);
    }
    count_ = 0;
    alike_ = true;
  }

 private:
  void find() noexcept;
  void sort_by_kinds() noexcept;
  /// Runs the scalar search if the lanes left the pair undecided, and restores the caller's order
  /// of a and b.
  void finish(std::size_t i) noexcept {
    if (verdicts_[i] == ImpactVerdict::unsure) search(i);
    if (mirrored_[i] && found_[i].hit) {
      mirror_impact(*queries_[i].motion[1], *queries_[i].motion[0], found_[i]);
    }
  }
  void refuse_invalid(const ImpactJob& job) noexcept;
  void find_starts(const ImpactJob& job) noexcept;
  void search(std::size_t i) noexcept;

  const ShapeTables& tables_;
  double tolerance_;
  std::size_t count_ = 0;
  std::array<std::size_t, kRoom> names_;
  std::array<bool, kRoom> mirrored_;
  // The arrays are in unions, so their elements are not initialised. Initialisation would take as
  // long as some queries.
  union {
    std::array<ImpactQuery, kRoom> queries_;
  };
  union {
    std::array<Impact, kRoom> found_;
  };
  std::array<ImpactVerdict, kRoom> verdicts_;
  /// The key by which pairs are grouped into jobs (kinds_of).
  std::array<std::uint16_t, kRoom> kinds_;
  /// All keys are equal.
  bool alike_ = true;
  /// Indices sorted by key.
  std::array<std::uint16_t, kRoom> order_;
};

}  // namespace winnow::impact
