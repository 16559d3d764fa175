#include "tests/simd/rows_ops.h"

#include "simd/lanes/rows.h"
#include "simd/lanes/triangle_lanes.h"

namespace winnow::WINNOW_ISA_NAME {
namespace {

template <int Count>
void store_columns(const Doubles (&columns)[Count], double* out) {
  for (int k = 0; k < Count; ++k) columns[k].store_unaligned(out + 8 * k);
}

void rows4(const double* const* rows, double* out) {
  Doubles columns[4];
  load_rows4([&](int lane) { return rows[lane]; }, columns);
  store_columns(columns, out);
}
void differences4(const double* const* rows, const double* const* base, double* out) {
  Doubles columns[4];
  load_differences4([&](int lane) { return rows[lane]; }, [&](int lane) { return base[lane]; },
                    columns);
  store_columns(columns, out);
}
void rows2(const double* const* rows, double* out) {
  Doubles columns[2];
  load_rows2([&](int lane) { return rows[lane]; }, columns);
  store_columns(columns, out);
}
void rows1(const double* const* rows, double* out) {
  load_rows1([&](int lane) { return rows[lane]; }).store_unaligned(out);
}
void single(const double* in, float* out) {
  to_single(Doubles::load_unaligned(in), Doubles::load_unaligned(in + 8)).store_unaligned(out);
}
void both_halves(const float* in, double* out) {
  const Floats v = Floats::load_unaligned(in);
  to_double<0>(v).store_unaligned(out);
  to_double<1>(v).store_unaligned(out + 8);
}
void bytes_to_words(std::uint64_t bytes, std::uint32_t base, std::uint32_t* out) {
  store_bytes(bytes, base, out);
}
void negative(const double* in, double* out) {
  (-Doubles::load_unaligned(in)).store_unaligned(out);
}
void corners(const float* const* from, bool next, double* out) {
  CornerDoubles axis[3];
  load_points(from[0], from[1], from[2], axis);
  for (int k = 0; k < 3; ++k) {
    alignas(64) double lane[CornerDoubles::kCount];
    (next ? of_next(axis[k]) : axis[k]).store(lane);
    for (int i = 0; i < 4; ++i) out[4 * k + i] = lane[i];
  }
}
void joined_corners(const double* in, double* out) {
  alignas(64) double lane[CornerDoubles::kCount];
  join_corners(in[0], in[1], in[2]).store(lane);
  for (int i = 0; i < 4; ++i) out[i] = lane[i];
}

}  // namespace
}  // namespace winnow::WINNOW_ISA_NAME

namespace winnow::test {

namespace isa = winnow::WINNOW_ISA_NAME;

extern const RowsOps WINNOW_KERNEL_TABLE(rows_ops);
const RowsOps WINNOW_KERNEL_TABLE(rows_ops){
    .load_rows4 = isa::rows4,
    .load_differences4 = isa::differences4,
    .load_rows2 = isa::rows2,
    .load_rows1 = isa::rows1,
    .to_single = isa::single,
    .to_double = isa::both_halves,
    .store_bytes = isa::bytes_to_words,
    .negate = isa::negative,
    .load_corners = isa::corners,
    .join_corners = isa::joined_corners,
};

}  // namespace winnow::test
