#pragma once

#include "bench/contenders/engines.h"

#include <vector>

namespace winnow::bench {

/// Sweep and prune in its simplest form, on one thread. It measures the speed of the machine and
/// finds overlapping pairs independently: it uses none of winnow's algorithms.
class ReferenceSweep final : public Engine {
 public:
  /// `axis` is 0, 1 or 2; any other value selects the axis on which the boxes of the first frame
  /// are smallest relative to the range of all boxes.
  explicit ReferenceSweep(int axis = 0) : axis_(axis) {}

  [[nodiscard]] std::string name() const override { return "reference sweep"; }
  void start(std::span<const Aabb> boxes) override;
  void frame(std::span<const std::uint32_t> changed_rows, std::span<const Aabb> all_boxes) override;
  [[nodiscard]] std::span<const Pair> pairs() const override { return pairs_; }
  [[nodiscard]] std::size_t bytes() const override;

 private:
  struct Entry {
    Aabb box;
    std::uint32_t row = 0;
  };

  template <int Axis>
  void sweep();

  int axis_;
  std::vector<Entry> entries_;
  std::vector<Pair> pairs_;
};

/// Returns the median time in ms of sweeps on x over the 10,000 objects of `uniform`: how fast the
/// machine is now. Figures measured on other machines are scaled by it.
[[nodiscard]] double reference_sweep_ms();

}  // namespace winnow::bench
