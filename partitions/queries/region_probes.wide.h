#pragma once

// Sixteen boxes against each kind of region.

#include "partitions/queries/region.kernel.h"
#include "partitions/queries/sweep.wide.h"
#include "simd/lanes/boxes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Which of 16 boxes may meet a region, which surely lie inside, and of which only the exact test
/// knows.
struct Met {
  Mask16 met = 0;
  Mask16 inside = 0;
  Mask16 open = 0;
};

/// The largest coordinate of each box.
inline Floats reach_of(const Box16& box) {
  const Floats high = max(box.high[0], max(box.high[1], box.high[2]));
  const Floats low = min(box.low[0], min(box.low[1], box.low[2]));
  return max(high, 0.0F - low);
}

/// Six planes, as a frustum has, against rows in no order, of which most miss: all that the planes
/// need stays in registers from block to block.
class FrustumScan {
 public:
  static constexpr std::uint32_t kPlanes = 6;

  FrustumScan(const PlaneRegion& region, const float* const* column)
      : region_(region), column_(column), rounding_(region.rounding), margin_(region.margin) {
    for (std::uint32_t k = 0; k < kPlanes; ++k) {
      const WidePlane& plane = region.planes[k];
      offset_[k] = Floats(plane.offset);
      for (int i = 0; i < 3; ++i) {
        normal_[k][i] = Floats(plane.normal[i]);
        end_[k][i] = column[plane.farthest[i]];
      }
    }
  }

  /// False if none of the 16 boxes from `at` on meets the region.
  [[nodiscard]] bool may_meet(std::size_t at) const {
    const Box16 box = load_slabs<3>(column_, at);
    Mask16 met = overlap(box, region_.low, region_.high);
    const Floats below = -kSweepTiny - multiply_add(reach_of(box), rounding_, margin_);
    for (std::uint32_t k = 0; k < kPlanes; ++k) {
      Floats most = offset_[k];
      for (int i = 0; i < 3; ++i)
        most = multiply_add(Floats::load(end_[k][i] + at), normal_[k][i], most);
      met &= ~bits(most <= below);
    }
    return met != 0;
  }

 private:
  const PlaneRegion& region_;
  const float* const* column_;
  Floats rounding_;
  Floats margin_;
  Floats offset_[kPlanes];
  Floats normal_[kPlanes][3];
  const float* end_[kPlanes][3];
};

class PlaneProbe {
 public:
  explicit PlaneProbe(const PlaneRegion& region) : region_(region) {}

  [[nodiscard]] const PlaneRegion& region() const { return region_; }
  [[nodiscard]] bool is_frustum() const { return region_.count == FrustumScan::kPlanes; }

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard]] Met test(const float* const* column, std::size_t at) const {
    const Box16 box = load_slabs<3>(column, at);
    Met result;
    result.met = overlap(box, region_.low, region_.high);
    if (result.met == 0) return result;
    const Floats slack = region_.count != 0 ? rounding_of(box) : Floats(0.0F);
    Mask16 surely = result.met;
    // All planes, whether or not boxes are left: the next plane costs less than a wrong guess.
    for (std::uint32_t k = 0; k < region_.count; ++k) {
      const WidePlane& plane = region_.planes[k];
      const Floats most = height(plane, column[plane.farthest[0]] + at,
                                 column[plane.farthest[1]] + at, column[plane.farthest[2]] + at);
      result.met &= ~bits(most + slack <= -kSweepTiny);
      surely &= bits(slack <= most);
    }
    if (result.met == 0) return result;
    find_inside(box, column, at, slack, surely, result);
    return result;
  }

 private:
  /// `surely`: the boxes that reach inside of all planes by more than rounding.
  void find_inside(const Box16& box, const float* const* column, std::size_t at,
                   const Floats& slack, Mask16 surely, Met& result) const {
    result.open = result.met;
    if (region_.more) return;
    result.inside = result.met;
    for (int i = 0; i < 3; ++i) {
      result.inside &= bits(region_.low[i] <= box.low[i]) & bits(box.high[i] <= region_.high[i]);
    }
    Mask16 perhaps = result.met;
    const Floats below = 0.0F - slack;
    for (std::uint32_t k = 0; k < region_.count; ++k) {
      const WidePlane& plane = region_.planes[k];
      const Floats least = height(plane, column[opposite(plane.farthest[0])] + at,
                                  column[opposite(plane.farthest[1])] + at,
                                  column[opposite(plane.farthest[2])] + at);
      result.inside &= bits(slack <= least);
      perhaps &= bits(below <= least);
    }
    result.open &= ~result.inside;
    if (region_.planes_decide) result.open &= ~surely | perhaps;
  }

  static unsigned opposite(unsigned column) { return column < 3 ? column + 3 : column - 3; }

  /// What the heights of these boxes' corners may be off by.
  [[nodiscard]] Floats rounding_of(const Box16& box) const {
    return multiply_add(reach_of(box), Floats(region_.rounding), Floats(region_.margin));
  }

  /// normal . p + offset of a corner of each box. Each step is monotone in the box's ends: what
  /// holds for a node holds for the boxes below it.
  static Floats height(const WidePlane& plane, const float* x, const float* y, const float* z) {
    const Floats a = multiply_add(Floats::load(x), Floats(plane.normal[0]), Floats(plane.offset));
    const Floats b = multiply_add(Floats::load(y), Floats(plane.normal[1]), a);
    return multiply_add(Floats::load(z), Floats(plane.normal[2]), b);
  }

  const PlaneRegion& region_;
};

class BallProbe {
 public:
  explicit BallProbe(const BallRegion& region) : region_(region) {}

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard]] Met test(const float* const* column, std::size_t at) const {
    // More than the rounding of either side; squares may also be lost below the smallest float.
    constexpr float kMore = 1.000002F;
    constexpr float kTiny = 1e-36F;
    const Box16 box = load_slabs<3>(column, at);
    Floats near = Floats(-kTiny);
    Floats far = Floats(kTiny);
    const Floats zero = Floats(0.0F);
    for (int i = 0; i < 3; ++i) {
      const Floats center = Floats(region_.center[i]);
      const Floats below = box.low[i] - center;
      const Floats above = center - box.high[i];
      const Floats gap = max(max(below, above), zero);
      const Floats span = max(zero - below, zero - above);
      near = near + gap * gap;
      far = far + span * span;
    }
    constexpr float kLargest = 3.4028234e38F;
    const float square = region_.radius * region_.radius;
    // A square that overflows says nothing about what lies inside.
    const float finite_square = square < kLargest ? square : kLargest;
    const Mask16 live = bits(box.low[0] <= kLargest);
    Met result;
    result.met = bits(near <= square * kMore) & live;
    result.inside = bits(far * kMore <= finite_square) & result.met;
    result.open = result.met & ~result.inside;
    return result;
  }

 private:
  const BallRegion& region_;
};

class SweptProbe {
 public:
  explicit SweptProbe(const SweptRegion& region)
      : region_(region),
        test_(region.sweep),
        limit_(scaled_limit(region.sweep, region.sweep.max_t)) {}

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard]] Met test(const float* const* column, std::size_t at) const {
    Floats enter;
    const Mask16 met = test_.test(column, at, limit_, enter);
    return {met, 0, met};
  }

 private:
  const SweptRegion& region_;
  SweepTest test_;
  float limit_;
};

}  // namespace winnow::WINNOW_ISA_NAME
