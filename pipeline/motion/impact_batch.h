#pragma once

#include "pipeline/motion/impact_lanes.kernel.h"
#include "pipeline/motion/impact_search.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow::impact {

/// Pairs of convex shapes that move, which are answered many at a time: by lanes, one kind of pair
/// after the other, and by `find_impact` where lanes cannot tell. What is said of a pair does not
/// depend on the others.
class ImpactBatch {
 public:
  /// Of as many as that, `run` has to be called.
  static constexpr std::size_t kRoom = 256;

  ImpactBatch(const ShapeTables& tables, double tolerance) noexcept
      : tables_(tables), tolerance_(tolerance) {}

  [[nodiscard]] bool is_full() const noexcept { return count_ == kRoom; }
  /// Whether pairs of these shapes are to be put in.
  [[nodiscard]] static bool takes(ShapeId a, ShapeId b) noexcept {
    return !a.is_composite() && !b.is_composite();
  }
  /// `name` is what the answer is given with. The motions outlive the next run. An impact after
  /// `until` may be given as none.
  void add(std::size_t name, ShapeId a, const RigidMotion& of_a, ShapeId b, const RigidMotion& of_b,
           double until = 1.0) noexcept;

  /// Calls take(name, impact, valid) for every pair that was added, in any order, and forgets them.
  /// Of motions that are not both valid there is no impact.
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
  /// What lanes have left, and the caller's order.
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
  // In unions they are not initialised, which would take as long as some answers do.
  union {
    std::array<ImpactQuery, kRoom> queries_;
  };
  union {
    std::array<Impact, kRoom> found_;
  };
  std::array<ImpactVerdict, kRoom> verdicts_;
  /// What a job has in common.
  std::array<std::uint16_t, kRoom> kinds_;
  /// All kinds are the same.
  bool alike_ = true;
  /// By kinds.
  std::array<std::uint16_t, kRoom> order_;
};

}  // namespace winnow::impact
