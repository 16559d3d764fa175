// Kernels of box input: validate given boxes, write them into the columns of rows, and compare
// given boxes with stored ones. Called by the sources in volume_source.h and by VerletSkin.

#include "partitions/rows/box_input.kernel.h"
#include "simd/lanes/boxes.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kFloats = 6;

bool box_is_legal(const float* f, float infinity) {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = f[axis];
    const float high = f[3 + axis];
    if (!(low <= high && low < infinity && high > -infinity)) return false;
  }
  return true;
}

/// Tests 16 boxes (96 floats) at once. A load shifted by three floats puts each upper end into the
/// lane of its lower end; kLower selects the lanes of lower ends.
bool legal(const float* floats, std::size_t count) {
  const float infinity = __builtin_inff();
  // <= the largest finite float is the same test as < infinity.
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  constexpr Mask16 kLower[3] = {0x71C7U, 0xC71CU, 0x1C71U};
  std::size_t i = 0;
  // Stops one box before the end: the shifted loads read three floats further.
  for (; i + kLanes < count; i += kLanes) {
    Mask16 bad = 0;
    for (unsigned part = 0; part < kFloats; ++part) {
      const float* p = floats + i * kFloats + part * kLanes;
      const Floats low = Floats::load_unaligned(p);
      const Floats high = Floats::load_unaligned(p + 3);
      const Mask16 good = bits(low <= high) & bits(low <= most) & bits(least <= high);
      bad |= kLower[part % 3] & ~good;
    }
    if (bad != 0) return false;
  }
  for (; i < count; ++i) {
    if (!box_is_legal(floats + i * kFloats, infinity)) return false;
  }
  return true;
}

bool legal_listed(const float* floats, const std::uint32_t* number, std::size_t count) {
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  const auto at = [&](std::size_t i) { return floats + std::size_t{number[i]} * kFloats; };
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    // Boxes are read in arbitrary order, so the next 16 are prefetched.
    const std::size_t ahead = i + 2 * kLanes <= count ? i + 2 * kLanes : count;
    for (std::size_t k = i + kLanes; k < ahead; ++k) __builtin_prefetch(at(k));
    const Box16 box = load_boxes([&](int lane) { return at(i + static_cast<std::size_t>(lane)); });
    Mask16 good = kAllRows;
    for (int s = 0; s < 3; ++s) {
      good &=
          bits(box.low[s] <= box.high[s]) & bits(box.low[s] <= most) & bits(least <= box.high[s]);
    }
    if (good != kAllRows) return false;
  }
  for (; i < count; ++i) {
    if (!box_is_legal(at(i), __builtin_inff())) return false;
  }
  return true;
}

float clamp(float value) {
  const float least = value < -kLargest<float> ? -kLargest<float> : value;
  return least > kLargest<float> ? kLargest<float> : least;
}

constexpr std::uint32_t kNoBox = ~0U;

/// Index of the box of an id, or kNoBox.
template <bool Listed>
[[gnu::always_inline]] inline std::uint32_t number_of(const BoxOfId& box_of, std::uint32_t id) {
  const std::uint32_t k = id - box_of.first;
  if constexpr (!Listed) return k < box_of.ids ? k : kNoBox;
  return k < box_of.ids ? box_of.table[k] : kNoBox;
}

/// Pointers to the boxes of 16 rows; lanes in `missing` have none.
struct BoxesOfRows {
  const float* box[kLanes];
  Mask16 missing;
};

template <bool Listed>
[[gnu::always_inline]] inline void find_boxes(const float* floats, const BoxOfId& box_of,
                                              const std::uint32_t* id, BoxesOfRows& rows) {
  rows.missing = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t number = number_of<Listed>(box_of, id[lane]);
    const bool none = number == kNoBox;
    rows.missing |= static_cast<Mask16>(unsigned{none} << lane);
    rows.box[lane] = floats + (none ? 0 : std::size_t{number} * kFloats);
    __builtin_prefetch(rows.box[lane]);
  }
}

template <bool Listed>
void write_boxes(const float* floats, const BoxOfId& box_of, const std::uint32_t* id,
                 float* const* column, std::size_t begin, std::size_t end) {
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  // Boxes are read in arbitrary order, so the boxes of the next two blocks are prefetched.
  constexpr std::size_t kBlocks = 3;
  BoxesOfRows blocks[kBlocks];
  const auto find = [&](std::size_t row, std::size_t block) {
    if (row < end) find_boxes<Listed>(floats, box_of, id + row, blocks[block % kBlocks]);
  };
  find(begin, 0);
  find(begin + kLanes, 1);
  std::size_t now = 0;
  for (std::size_t row = begin; row < end; row += kLanes, now = (now + 1) % kBlocks) {
    find(row + 2 * kLanes, now + 2);
    BoxesOfRows& rows = blocks[now];
    if (rows.missing == kAllRows) continue;
    alignas(64) float old[kLanes][kFloats];
    for (unsigned missing = rows.missing; missing != 0; missing &= missing - 1) {
      const int lane = __builtin_ctz(missing);
      for (std::size_t c = 0; c < kFloats; ++c) {
        old[lane][c] = column[c][row + static_cast<std::size_t>(lane)];
      }
      rows.box[lane] = old[lane];
    }
    const Box16 boxes = load_boxes([&](int lane) { return rows.box[lane]; });
    for (int s = 0; s < 3; ++s) {
      max(boxes.low[s], least).store_unaligned(column[s] + row);
      min(boxes.high[s], most).store_unaligned(column[3 + s] + row);
    }
  }
}

void write_rows(const float* floats, const BoxOfId& box_of, const std::uint32_t* id,
                float* const* column, std::size_t begin, std::size_t end) {
  if (box_of.table == nullptr) {
    write_boxes<false>(floats, box_of, id, column, begin, end);
  } else {
    write_boxes<true>(floats, box_of, id, column, begin, end);
  }
}

void write_in_order(const float* floats, std::size_t count, float* const* column, std::size_t row) {
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    const float* const first = floats + i * kFloats;
    const Box16 boxes =
        load_boxes([&](int lane) { return first + static_cast<std::size_t>(lane) * kFloats; });
    for (int s = 0; s < 3; ++s) {
      max(boxes.low[s], least).store_unaligned(column[s] + row + i);
      min(boxes.high[s], most).store_unaligned(column[3 + s] + row + i);
    }
  }
  for (; i < count; ++i) {
    for (std::size_t c = 0; c < kFloats; ++c) column[c][row + i] = clamp(floats[i * kFloats + c]);
  }
}

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

extern const BoxInputKernels WINNOW_KERNEL_TABLE(box_input_kernels) = {
    WINNOW_ISA_NAME::legal,          WINNOW_ISA_NAME::legal_listed, WINNOW_ISA_NAME::write_rows,
    WINNOW_ISA_NAME::write_in_order, WINNOW_ISA_NAME::within,       WINNOW_ISA_NAME::copy_near,
    WINNOW_ISA_NAME::beyond};

}  // namespace winnow
