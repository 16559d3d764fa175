// Kernels of box input: validate given boxes and write them into the columns of rows. BoxSource
// calls them (row_input.h).

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

bool legal_listed(const float* floats, const std::uint32_t* entry, std::size_t count) {
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  const auto at = [&](std::size_t i) { return floats + std::size_t{entry[i]} * kFloats; };
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

constexpr std::uint32_t kNoEntry = ~0U;

/// Returns the entry of an id, or kNoEntry.
template <bool Listed>
[[gnu::always_inline]] inline std::uint32_t entry_of(const EntryOfId& entry_of_id,
                                                     std::uint32_t id) {
  const std::uint32_t k = id - entry_of_id.first;
  if constexpr (!Listed) return k < entry_of_id.ids ? k : kNoEntry;
  return k < entry_of_id.ids ? entry_of_id.table[k] : kNoEntry;
}

/// Pointers to the boxes of 16 rows; lanes in `missing` have none.
struct BoxesOfRows {
  const float* box[kLanes];
  Mask16 missing;
};

template <bool Listed>
[[gnu::always_inline]] inline void find_boxes(const float* floats, const EntryOfId& entry_of_id,
                                              const std::uint32_t* id, BoxesOfRows& rows) {
  rows.missing = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t entry = entry_of<Listed>(entry_of_id, id[lane]);
    const bool none = entry == kNoEntry;
    rows.missing |= static_cast<Mask16>(unsigned{none} << lane);
    rows.box[lane] = floats + (none ? 0 : std::size_t{entry} * kFloats);
    __builtin_prefetch(rows.box[lane]);
  }
}

template <bool Listed>
void write_boxes(const float* floats, const EntryOfId& entry_of_id, const std::uint32_t* id,
                 float* const* column, std::size_t begin, std::size_t end) {
  const Floats most = Floats(kLargest<float>);
  const Floats least = Floats(-kLargest<float>);
  // Boxes are read in arbitrary order, so the boxes of the next two blocks are prefetched.
  constexpr std::size_t kBlocks = 3;
  BoxesOfRows blocks[kBlocks];
  const auto find = [&](std::size_t row, std::size_t block) {
    if (row < end) find_boxes<Listed>(floats, entry_of_id, id + row, blocks[block % kBlocks]);
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

void write_rows(const float* floats, const EntryOfId& entry_of_id, const std::uint32_t* id,
                float* const* column, std::size_t begin, std::size_t end) {
  if (entry_of_id.table == nullptr) {
    write_boxes<false>(floats, entry_of_id, id, column, begin, end);
  } else {
    write_boxes<true>(floats, entry_of_id, id, column, begin, end);
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

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BoxInputKernels WINNOW_KERNEL_TABLE(box_input_kernels) = {
    WINNOW_ISA_NAME::legal, WINNOW_ISA_NAME::legal_listed, WINNOW_ISA_NAME::write_rows,
    WINNOW_ISA_NAME::write_in_order};

}  // namespace winnow
