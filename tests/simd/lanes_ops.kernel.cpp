// The operations of lanes_ops.h, compiled once for each instruction set; lanes_test.cpp calls them.

#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/lanes.h"
#include "simd/lanes/packed_points.h"
#include "simd/lanes/permute.h"
#include "simd/lanes/positive_min_max.h"
#include "simd/lanes/rows.h"
#include "simd/lanes/scalar_lane.h"

#include "tests/simd/lanes_ops.h"

#define WINNOW_TEXT_2(name) #name
#define WINNOW_TEXT(name) WINNOW_TEXT_2(name)

namespace winnow::WINNOW_ISA_NAME {
namespace {

void load_store_floats(const float* in, float* out) {
  Floats::load(in).store_unaligned(out);
}
void load_unaligned_store_floats(const float* in, float* out) {
  Floats::load_unaligned(in).store_unaligned(out);
}
void load_store_uints(const std::uint32_t* in, std::uint32_t* out) {
  Uints::load_unaligned(in).store_unaligned(out);
}
void broadcast_float(float value, float* out) {
  Floats(value).store_unaligned(out);
}
void broadcast_uint(std::uint32_t value, std::uint32_t* out) {
  Uints(value).store_unaligned(out);
}
void count_from_base(std::uint32_t base, std::uint32_t* out) {
  count_from(base).store_unaligned(out);
}
void min_lanes(const float* a, const float* b, float* out) {
  min(Floats::load_unaligned(a), Floats::load_unaligned(b)).store_unaligned(out);
}
void max_lanes(const float* a, const float* b, float* out) {
  max(Floats::load_unaligned(a), Floats::load_unaligned(b)).store_unaligned(out);
}
void add_lanes(const float* a, const float* b, float* out) {
  (Floats::load_unaligned(a) + Floats::load_unaligned(b)).store_unaligned(out);
}
void multiply_lanes(const float* a, const float* b, float* out) {
  (Floats::load_unaligned(a) * Floats::load_unaligned(b)).store_unaligned(out);
}
void divide_lanes(const float* a, const float* b, float* out) {
  (Floats::load_unaligned(a) / Floats::load_unaligned(b)).store_unaligned(out);
}
void sqrt_lanes(const float* in, float* out) {
  sqrt(Floats::load_unaligned(in)).store_unaligned(out);
}
void multiply_add_lanes(const float* a, const float* b, const float* c, float* out) {
  multiply_add(Floats::load_unaligned(a), Floats::load_unaligned(b), Floats::load_unaligned(c))
      .store_unaligned(out);
}
void keep_less_equal_lanes(const float* a, const float* b, const float* v, float* out) {
  or_infinity(Floats::load_unaligned(a) <= Floats::load_unaligned(b), Floats::load_unaligned(v))
      .store_unaligned(out);
}
std::uint32_t less_equal_lanes(const float* a, const float* b) {
  return bits(Floats::load_unaligned(a) <= Floats::load_unaligned(b));
}
float reduce_min_lanes(const float* in) {
  return reduce_min(Floats::load_unaligned(in));
}
float reduce_max_lanes(const float* in) {
  return reduce_max(Floats::load_unaligned(in));
}
/// Writes kScalarResults results, each of an operation on two vectors of lanes. All lanes of a
/// vector hold the same number.
template <typename T>
void do_all(double first, double second, double* out) {
  const Lanes<T> a = Lanes<T>(T(first));
  const Lanes<T> b = Lanes<T>(T(second));
  const auto put = [&](const Lanes<T>& v) {
    alignas(64) T lane[Lanes<T>::kCount];
    v.store(lane);
    *out++ = static_cast<double>(lane[0]);
  };
  const auto put_mask = [&](const LaneMask<T>& mask) { *out++ = bits(mask) & 1U; };
  put(a + b);
  put(a - b);
  put(a * b);
  put(a / b);
  put(-a);
  put(abs(a));
  put(sqrt(a));
  put(min(a, b));
  put(max(a, b));
  put(select(a < b, a, b));
  put_mask(a < b);
  put_mask(a <= b);
  put_mask(a > b);
  put_mask(a >= b);
  put_mask(a == b);
  put_mask((a < b) & (a == a));
  put_mask((a < b) | (b == b));
  put_mask(!(a < b));
  Lanes<T> sum = a;
  sum += b;
  sum *= b;
  put(sum);
  put(sign_or_one(a));
}
unsigned count_bits(std::uint32_t mask) {
  return count(mask);
}
unsigned first_bit(std::uint32_t mask) {
  return first(mask);
}
std::uint32_t lanes_below_n(unsigned lanes) {
  return lanes_below(lanes);
}

template <int Slabs>
std::uint32_t overlap_rows(const float* const* columns, std::size_t row, const float* low,
                           const float* high) {
  return overlap(load_slabs<Slabs>(columns, row), low, high);
}
std::uint32_t overlap_unaligned_rows(const float* const* columns, std::size_t row, const float* low,
                                     const float* high) {
  return overlap(load_slabs_unaligned<3>(columns, row), low, high);
}

unsigned compress_lanes(std::uint32_t mask, const std::uint32_t* in, std::uint32_t* out) {
  return compress_store(mask, Uints::load_unaligned(in), out);
}
unsigned compress_float_lanes(std::uint32_t mask, const float* in, float* out) {
  return compress_store(mask, Floats::load_unaligned(in), out);
}
template <bool Sorted>
unsigned emit_lanes(std::uint32_t mask, const std::uint32_t* in, std::uint32_t q,
                    std::uint32_t* out) {
  return emit_pairs<Sorted>(mask, Uints::load_unaligned(in), q, out);
}

void load_packed_points(const std::uint32_t* p, float (*axis)[kLanes]) {
  for (std::uint32_t k = 0; k < 3; ++k) load_packed(p, k).store_unaligned(axis[k]);
}
template <int Blocks>
void pick_lanes(const float* from, const std::uint8_t* place, float* out) {
  Floats block[Blocks];
  for (int k = 0; k < Blocks; ++k) block[k] = Floats::load_unaligned(from + k * kLanes);
  LanePermutation(place).pick(block).store_unaligned(out);
}
template <unsigned Limit>
bool are_below_limit(const std::uint8_t* place) {
  return are_below<Limit>(place);
}
void larger_positive_lanes(const float* a, const float* b, float* out) {
  larger_positive(Floats::load_unaligned(a), Floats::load_unaligned(b)).store_unaligned(out);
}
void smaller_positive_lanes(const float* a, const float* b, float* out) {
  smaller_positive(Floats::load_unaligned(a), Floats::load_unaligned(b)).store_unaligned(out);
}
std::uint32_t reduce_min_positive_lanes(const float* in) {
  return reduce_min_positive(Floats::load_unaligned(in));
}

}  // namespace
}  // namespace winnow::WINNOW_ISA_NAME

namespace winnow::test {

namespace isa = winnow::WINNOW_ISA_NAME;

extern const LanesOps WINNOW_KERNEL_TABLE(lanes_ops);
const LanesOps WINNOW_KERNEL_TABLE(lanes_ops){
    .load_store = isa::load_store_floats,
    .load_unaligned_store = isa::load_unaligned_store_floats,
    .load_store_uint = isa::load_store_uints,
    .broadcast = isa::broadcast_float,
    .broadcast_uint = isa::broadcast_uint,
    .count_from = isa::count_from_base,
    .min = isa::min_lanes,
    .max = isa::max_lanes,
    .add = isa::add_lanes,
    .multiply = isa::multiply_lanes,
    .divide = isa::divide_lanes,
    .sqrt = isa::sqrt_lanes,
    .multiply_add = isa::multiply_add_lanes,
    .less_equal = isa::less_equal_lanes,
    .keep_less_equal = isa::keep_less_equal_lanes,
    .reduce_min = isa::reduce_min_lanes,
    .reduce_max = isa::reduce_max_lanes,
    .count = isa::count_bits,
    .first = isa::first_bit,
    .lanes_below = isa::lanes_below_n,
    .overlap3 = isa::overlap_rows<3>,
    .overlap13 = isa::overlap_rows<13>,
    .overlap3_unaligned = isa::overlap_unaligned_rows,
    .compress_store = isa::compress_lanes,
    .compress_store_floats = isa::compress_float_lanes,
    .emit_pairs = isa::emit_lanes<false>,
    .emit_sorted_pairs = isa::emit_lanes<true>,
    .load_packed = isa::load_packed_points,
    .pick_of_16 = isa::pick_lanes<1>,
    .pick_of_32 = isa::pick_lanes<2>,
    .are_below_16 = isa::are_below_limit<16>,
    .are_below_32 = isa::are_below_limit<32>,
    .larger_positive = isa::larger_positive_lanes,
    .smaller_positive = isa::smaller_positive_lanes,
    .reduce_min_positive = isa::reduce_min_positive_lanes,
    .scalar = isa::do_all<isa::ScalarLane>,
    .in_lanes = isa::do_all<double>,
    .isa_name = WINNOW_TEXT(WINNOW_ISA_NAME),
};

}  // namespace winnow::test
