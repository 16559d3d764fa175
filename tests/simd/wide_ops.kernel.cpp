#include "simd/lanes/compress.h"
#include "simd/lanes/wide.h"

#include "wide_ops.h"

#define WINNOW_TEXT_2(name) #name
#define WINNOW_TEXT(name) WINNOW_TEXT_2(name)

namespace winnow::WINNOW_ISA_NAME {
namespace {

void load_store_floats(const float* in, float* out) {
  store_unaligned(out, load(in));
}
void load_unaligned_store_floats(const float* in, float* out) {
  store_unaligned(out, load_unaligned(in));
}
void load_store_uints(const std::uint32_t* in, std::uint32_t* out) {
  store_unaligned(out, load_unaligned(in));
}
void broadcast_float(float value, float* out) {
  store_unaligned(out, broadcast(value));
}
void broadcast_uint(std::uint32_t value, std::uint32_t* out) {
  store_unaligned(out, broadcast(value));
}
void count_from_base(std::uint32_t base, std::uint32_t* out) {
  store_unaligned(out, count_from(base));
}
void min_lanes(const float* a, const float* b, float* out) {
  store_unaligned(out, min(load_unaligned(a), load_unaligned(b)));
}
void max_lanes(const float* a, const float* b, float* out) {
  store_unaligned(out, max(load_unaligned(a), load_unaligned(b)));
}
void add_lanes(const float* a, const float* b, float* out) {
  store_unaligned(out, add(load_unaligned(a), load_unaligned(b)));
}
void multiply_lanes(const float* a, const float* b, float* out) {
  store_unaligned(out, multiply(load_unaligned(a), load_unaligned(b)));
}
void multiply_add_lanes(const float* a, const float* b, const float* c, float* out) {
  store_unaligned(out, multiply_add(load_unaligned(a), load_unaligned(b), load_unaligned(c)));
}
void keep_less_equal_lanes(const float* a, const float* b, const float* v, float* out) {
  store_unaligned(out, keep_less_equal(load_unaligned(a), load_unaligned(b), load_unaligned(v)));
}
std::uint32_t less_equal_lanes(const float* a, const float* b) {
  return less_equal(load_unaligned(a), load_unaligned(b));
}
float reduce_min_lanes(const float* in) {
  return reduce_min(load_unaligned(in));
}
float reduce_max_lanes(const float* in) {
  return reduce_max(load_unaligned(in));
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
  return compress_store(mask, load_unaligned(in), out);
}
unsigned compress_float_lanes(std::uint32_t mask, const float* in, float* out) {
  return compress_store(mask, load_unaligned(in), out);
}
template <bool Sorted>
unsigned emit_lanes(std::uint32_t mask, const std::uint32_t* in, std::uint32_t q,
                    std::uint32_t* out) {
  return emit_pairs<Sorted>(mask, load_unaligned(in), q, out);
}

}  // namespace
}  // namespace winnow::WINNOW_ISA_NAME

namespace winnow::test {

namespace isa = winnow::WINNOW_ISA_NAME;

extern const WideOps WINNOW_KERNEL_TABLE(wide_ops);
const WideOps WINNOW_KERNEL_TABLE(wide_ops){
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
    .isa_name = WINNOW_TEXT(WINNOW_ISA_NAME),
};

}  // namespace winnow::test
