// Comparisons of given boxes with other boxes: with stored fat boxes (FatSource), with boxes in
// skins (RestingPairs), and with the box of a rank of a cluster (RankBodies).

#include "partitions/rows/box_compare.kernel.h"
#include "simd/lanes/boxes.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kFloats = 6;

/// Returns the negated length of the longest edge of each box; axes with an infinite end do not
/// count.
Floats minus_longest_edge(const Box16& box) {
  // Infinite ends are stored as the largest float, so every finite end is at most the float below
  // it.
  constexpr float kMaxFinite = 0x1.fffffcp127F;
  static_assert(kMaxFinite < kLargest<float>);
  Floats least = Floats(0.0F);
  for (int axis = 0; axis < 3; ++axis) {
    Floats edge = box.low[axis] - box.high[axis];
    edge = or_infinity(-kLargest<float> <= edge, edge);
    edge = or_infinity(box.high[axis] <= kMaxFinite, edge);
    edge = or_infinity(-kMaxFinite <= box.low[axis], edge);
    least = min(least, edge);
  }
  return least;
}

void within(const float* const* given, const float* const* stored, std::size_t count,
            float distance, float share, std::uint64_t* words) {
  for (std::size_t at = 0; at < count; at += kLanes) {
    const Box16 box = load_slabs_unaligned<3>(given, at);
    const Box16 old = load_slabs_unaligned<3>(stored, at);
    const Floats margin = distance - share * minus_longest_edge(box);
    const Floats spare = 4.0F * margin;
    Mask16 ok = kAllRows;
    for (int axis = 0; axis < 3; ++axis) {
      const Floats most = box.high[axis] - box.low[axis] + spare;
      ok &= bits(old.low[axis] <= box.low[axis]) & bits(box.high[axis] <= old.high[axis]) &
            bits(old.high[axis] - old.low[axis] <= most);
    }
    const unsigned shift = at % 64;
    words[at / 64] = (shift == 0 ? 0 : words[at / 64]) | std::uint64_t{ok} << shift;
  }
}

/// Calls visit(box), ascending, for each of 16 boxes that has a float without its bit in `good`.
template <typename Visit>
[[gnu::always_inline]] inline void for_each_bad_box(const Mask16* good, const Visit& visit) {
  unsigned last = kLanes;
  for (unsigned part = 0; part < kFloats; ++part) {
    for (unsigned bad = ~good[part] & kAllRows; bad != 0; bad &= bad - 1) {
      const unsigned box = (part * kLanes + static_cast<unsigned>(__builtin_ctz(bad))) / kFloats;
      if (box != last) visit(box);
      last = box;
    }
  }
}

/// The comparison by == covers infinite ends, whose difference is NaN.
bool is_near(const float* box, const float* near, float skin) {
  for (std::size_t c = 0; c < kFloats; ++c) {
    const float d = box[c] - near[c];
    if (!((d <= skin && -skin <= d) || box[c] == near[c])) return false;
  }
  return true;
}

std::uint32_t copy_near(const float* boxes, const float* near, float* to, std::size_t count,
                        float skin, std::uint32_t* departed, std::uint32_t most) {
  const Floats limit = Floats(skin);
  std::uint32_t found = 0;
  const auto look = [&](std::size_t i) {
    departed[found] = static_cast<std::uint32_t>(i);
    found += is_near(boxes + i * kFloats, near + i * kFloats, skin) ? 0U : 1U;
  };
  std::size_t i = 0;
  for (; i + kLanes <= count && found <= most; i += kLanes) {
    Mask16 good[kFloats];
    Mask16 all = kAllRows;
    for (std::size_t part = 0; part < kFloats; ++part) {
      const std::size_t at = i * kFloats + part * kLanes;
      const Floats box = Floats::load_unaligned(boxes + at);
      const Floats old = Floats::load_unaligned(near + at);
      good[part] = bits((box - old <= limit) & (old - box <= limit)) | bits(box == old);
      all &= good[part];
      box.store_unaligned(to + at);
    }
    if (all == kAllRows) continue;
    for_each_bad_box(
        good, [&](unsigned box) { departed[found++] = static_cast<std::uint32_t>(i + box); });
  }
  for (; i < count && found <= most; ++i) {
    for (std::size_t c = 0; c < kFloats; ++c) to[i * kFloats + c] = boxes[i * kFloats + c];
    look(i);
  }
  return found;
}

bool is_within(const float* box, const float* around) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(around[c] <= box[c] && box[3 + c] <= around[3 + c])) return false;
  }
  return true;
}

/// The pattern of lower and upper ends repeats after 48 floats (three registers, eight boxes).
std::uint32_t beyond(const float* boxes, const float* around, std::size_t count,
                     std::uint32_t* out) {
  constexpr std::size_t kOrders = 3;
  alignas(64) float least[kOrders * kLanes];
  alignas(64) float most[kOrders * kLanes];
  for (std::size_t k = 0; k < kOrders * kLanes; ++k) {
    const std::size_t c = k % kFloats;
    least[k] = c < 3 ? around[c] : -__builtin_inff();
    most[k] = c < 3 ? __builtin_inff() : around[c];
  }
  std::uint32_t found = 0;
  const auto look = [&](std::size_t i) {
    out[found] = static_cast<std::uint32_t>(i);
    found += is_within(boxes + i * kFloats, around) ? 0U : 1U;
  };
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    Mask16 good[kFloats];
    Mask16 all = kAllRows;
    for (std::size_t part = 0; part < kFloats; ++part) {
      const Floats end = Floats::load_unaligned(boxes + i * kFloats + part * kLanes);
      const std::size_t order = part % kOrders * kLanes;
      good[part] = bits((Floats::load(least + order) <= end) & (end <= Floats::load(most + order)));
      all &= good[part];
    }
    if (all == kAllRows) continue;
    for_each_bad_box(good,
                     [&](unsigned box) { out[found++] = static_cast<std::uint32_t>(i + box); });
  }
  for (; i < count; ++i) look(i);
  return found;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BoxCompareKernels WINNOW_KERNEL_TABLE(box_compare_kernels) = {
    WINNOW_ISA_NAME::within, WINNOW_ISA_NAME::copy_near, WINNOW_ISA_NAME::beyond};

}  // namespace winnow
