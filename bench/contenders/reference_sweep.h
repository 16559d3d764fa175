#pragma once

#include "bench/contenders/engine.h"
#include "bench/scenes/frame_source.h"

#include <memory>
#include <vector>

namespace winnow::bench {

/// Sort and sweep as plainly as it can be written, on one thread: the yardstick of the machine, and
/// an independent opinion on what overlaps. It knows nothing of the rest of winnow.
class ReferenceSweep final : public Engine {
 public:
  /// `axis` 0, 1 or 2; any other value takes the axis of the first frame that spreads widest.
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

/// How fast the machine is at this moment: times sweeps on x over the 10,000 objects of `uniform`.
/// Figures measured elsewhere are scaled by it. One that is not wanted times nothing.
class MachineClock {
 public:
  explicit MachineClock(bool wanted = true);

  /// Times one more sweep.
  void tick();
  /// 0 if there was no tick.
  [[nodiscard]] double median_ms() const;

 private:
  std::unique_ptr<FrameSource> scene_;
  ReferenceSweep sweep_;
  std::vector<double> times_;
};

}  // namespace winnow::bench
