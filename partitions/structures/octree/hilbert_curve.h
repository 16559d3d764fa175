#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace winnow {

/// The Hilbert curve in N dimensions, one level per step: which of the 2^N cells of a cube comes as
/// which, and how the curve lies within it. A state is where the curve enters a cube and along
/// which axis it leaves (Hamilton, "Compact Hilbert Indices", Dalhousie University CS-2006-07,
/// 2006, section 2).
template <unsigned N>
struct HilbertCurve {
  static constexpr unsigned kCells = 1U << N;
  static constexpr unsigned kStates = N * kCells;

  /// By state and cell (bit a of a cell is its half of axis a): place on the curve, and the state
  /// within, as next << N | place.
  std::array<std::uint8_t, kStates * kCells> step{};

  constexpr HilbertCurve() noexcept {
    for (unsigned state = 0; state < kStates; ++state) {
      const unsigned entry = state / N;
      const unsigned axis = state % N;
      for (unsigned cell = 0; cell < kCells; ++cell) {
        const unsigned place = gray_inverse(rotate_right(cell ^ entry, axis + 1));
        const unsigned next_entry = entry ^ rotate_left(entry_of(place), axis + 1);
        const unsigned next_axis = (axis + axis_of(place) + 1) % N;
        step[state * kCells + cell] =
            static_cast<std::uint8_t>((next_entry * N + next_axis) << N | place);
      }
    }
  }

 private:
  static constexpr unsigned rotate_right(unsigned value, unsigned by) noexcept {
    by %= N;
    return (value >> by | value << (N - by)) & (kCells - 1);
  }
  static constexpr unsigned rotate_left(unsigned value, unsigned by) noexcept {
    return rotate_right(value, N - by % N);
  }
  static constexpr unsigned gray(unsigned value) noexcept { return value ^ value >> 1U; }
  static constexpr unsigned gray_inverse(unsigned value) noexcept {
    unsigned result = 0;
    for (; value != 0; value >>= 1U) result ^= value;
    return result;
  }
  /// The corner at which the curve enters the cell of this place.
  static constexpr unsigned entry_of(unsigned place) noexcept {
    return place == 0 ? 0 : gray((place - 1) & ~1U);
  }
  /// The axis along which it crosses the cell of this place.
  static constexpr unsigned axis_of(unsigned place) noexcept {
    if (place == 0) return 0;
    return static_cast<unsigned>(std::countr_one(place % 2 == 0 ? place - 1 : place)) % N;
  }
};

}  // namespace winnow
