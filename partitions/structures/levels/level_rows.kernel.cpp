// Kernels that compute the octaves, longest edges and places of rows when HierarchicalGrid plans a
// build.

#include "partitions/structures/levels/level_rows.kernel.h"
#include "simd/lanes/float_to_uint.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);

/// Loads values of a column for rows[0, 16); the rows are usually consecutive.
class RowGather {
 public:
  RowGather(const std::uint32_t* rows, std::size_t left) : rows_(rows), left_(left) {
    std::uint32_t apart = left < kStep ? 1U : 0U;
    for (std::uint32_t k = 0; k < kLanes && apart == 0; ++k) apart = rows[k] ^ (rows[0] + k);
    runs_ = apart == 0;
  }
  [[nodiscard]] Floats of(const float* column) const {
    if (runs_) return Floats::load_unaligned(column + rows_[0]);
    alignas(64) float some[kLanes];
    for (std::size_t k = 0; k < kStep; ++k) some[k] = column[rows_[k < left_ ? k : 0]];
    return Floats::load(some);
  }

 private:
  const std::uint32_t* rows_;
  std::size_t left_;
  bool runs_;
};

void octaves(const float* const* boxes, std::size_t begin, std::size_t end, std::uint32_t* octave) {
  for (std::size_t row = begin; row < end; row += kStep) {
    Floats edge = Floats(0.0F);
    for (int a = 0; a < 3; ++a) {
      edge = max(edge, Floats::load(boxes[3 + a] + row) - Floats::load(boxes[a] + row));
    }
    const Mask16 bounded = bits(edge < kUnboundedEdge);
    const Mask16 live = bits(Floats::load(boxes[0] + row) <= Floats::load(boxes[3] + row));
    alignas(64) float lane_edge[kLanes];
    edge.store(lane_edge);
    __builtin_memcpy(octave + row, lane_edge, sizeof lane_edge);
    // Drops the sign, because an edge may be -0.
    for (std::size_t r = row; r < row + kStep; ++r) octave[r] = octave[r] >> 23U & 0xFFU;
    for (Mask16 left = ~(bounded & live) & kAllRows; left != 0; left &= left - 1) {
      octave[row + first(left)] = kNoOctave;
    }
  }
}

void longest(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
             std::size_t end, float* result) {
  Floats edge[3] = {Floats(0.0F), Floats(0.0F), Floats(0.0F)};
  for (std::size_t i = begin; i < end; i += kStep) {
    const RowGather own(rows + i, end - i);
    for (int a = 0; a < 3; ++a) edge[a] = max(edge[a], own.of(boxes[3 + a]) - own.of(boxes[a]));
  }
  for (int a = 0; a < 3; ++a) result[a] = reduce_max(edge[a]);
}

/// Computes cell_at for each lane.
void write_cells(const LevelAxis& axis, const Floats& x, std::uint32_t* cell) {
  if (axis.inverse == 0.0F) {
    for (int lane = 0; lane < kLanes; ++lane) cell[lane] = 0;
    return;
  }
  const Floats place = (x - axis.origin) * axis.inverse;
  float_to_uint(min(max(place, Floats(0.0F)), Floats(axis.last))).store(cell);
}

void places(const GridLevel& level, const float* const* boxes, const std::uint32_t* rows,
            std::size_t begin, std::size_t end, unsigned step_bits, bool step_only,
            std::uint64_t* items) {
  alignas(64) std::uint32_t mid[kLanes];
  alignas(64) std::uint32_t slow[kLanes];
  alignas(64) std::uint32_t step[kLanes];
  alignas(64) std::uint32_t key[kLanes];
  const std::uint32_t mids = level.mids;
  const std::uint32_t lines = step_only ? 0U : ~0U;
  for (std::size_t i = begin; i < end; i += kStep) {
    const RowGather own(rows + i, end - i);
    write_cells(level.mid, own.of(boxes[level.mid.axis]), mid);
    write_cells(level.slow, own.of(boxes[level.slow.axis]), slow);
    write_cells(level.fast, own.of(boxes[level.fast.axis]), step);
    // Without a branch: the lines of odd cells of the slow axis, and the steps of odd lines, run
    // backwards.
    for (std::size_t k = 0; k < kStep; ++k) {
      const std::uint32_t odd_row = 0U - (slow[k] & 1U);
      const std::uint32_t line = slow[k] * mids + ((mid[k] ^ odd_row) + (mids & odd_row));
      const std::uint32_t odd_line = 0U - (line & 1U);
      key[k] = (line & lines) << step_bits | (step[k] ^ (level.steps & odd_line));
    }
    const std::size_t here = end - i < kStep ? end - i : kStep;
    for (std::size_t k = 0; k < here; ++k) {
      items[i + k] = std::uint64_t{key[k]} << 32U | rows[i + k];
    }
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const LevelRowsKernels WINNOW_KERNEL_TABLE(level_rows_kernels) = {
    WINNOW_ISA_NAME::octaves, WINNOW_ISA_NAME::longest, WINNOW_ISA_NAME::places};

}  // namespace winnow
