#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace winnow {

/// The Hilbert curve in N dimensions, one level per step: the order in which the curve visits the
/// 2^N cells of a cube, and its orientation within each cell. A state is the corner at which the
/// curve enters a cube and the axis along which it leaves (Hamilton, "Compact Hilbert Indices",
/// Dalhousie University CS-2006-07, 2006, section 2).
template <unsigned N>
struct HilbertCurve {
  static constexpr unsigned kCells = 1U << N;
  static constexpr unsigned kStates = N * kCells;

  /// Element state * kCells + cell (bit a of a cell selects its half on axis a) is next << N |
  /// place: the place of the cell on the curve, and the state within the cell.
  std::array<std::uint8_t, kStates * kCells> step{};
  /// Element state * kCells + place is next << N | cell: the cell at this place, and the state
  /// within it.
  std::array<std::uint8_t, kStates * kCells> back{};

  constexpr HilbertCurve() noexcept {
    for (unsigned state = 0; state < kStates; ++state) {
      const unsigned entry = state / N;
      const unsigned axis = state % N;
      for (unsigned cell = 0; cell < kCells; ++cell) {
        const unsigned place = gray_inverse(rotate_right(cell ^ entry, axis + 1));
        const unsigned next_entry = entry ^ rotate_left(entry_of(place), axis + 1);
        const unsigned next_axis = (axis + axis_of(place) + 1) % N;
        const unsigned next = (next_entry * N + next_axis) << N;
        step[state * kCells + cell] = static_cast<std::uint8_t>(next | place);
        back[state * kCells + place] = static_cast<std::uint8_t>(next | cell);
      }
    }
  }

  /// Returns the Morton code (axis 0 in the lowest bit) of the cell at a place of the curve through
  /// a cube that is halved `levels` times.
  [[nodiscard]] constexpr std::uint32_t morton_code(std::uint32_t place,
                                                    unsigned levels) const noexcept {
    std::uint32_t code = 0;
    unsigned state = 0;
    for (unsigned level = levels; level-- > 0;) {
      const unsigned one = back[state << N | (place >> (N * level) & (kCells - 1))];
      code = code << N | (one & (kCells - 1));
      state = one >> N;
    }
    return code;
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
  /// The corner at which the curve enters the cell at this place.
  static constexpr unsigned entry_of(unsigned place) noexcept {
    return place == 0 ? 0 : gray((place - 1) & ~1U);
  }
  /// The axis along which the curve crosses the cell at this place.
  static constexpr unsigned axis_of(unsigned place) noexcept {
    if (place == 0) return 0;
    return static_cast<unsigned>(std::countr_one(place % 2 == 0 ? place - 1 : place)) % N;
  }
};

/// As HilbertCurve, with `Levels` levels per step.
template <unsigned N, unsigned Levels>
struct HilbertSteps {
  static constexpr unsigned kAxes = N;
  static constexpr unsigned kBits = N * Levels;  // of a cell, and of a place on the curve
  static constexpr unsigned kPlaceMask = (1U << kBits) - 1U;

  /// Element state << kBits | cell is next << kBits | place: the place of the cell on the curve,
  /// and the state within the cell. The coordinate of a cell on axis a is shifted left by `Levels`
  /// * a bits.
  std::array<std::uint16_t, std::size_t{HilbertCurve<N>::kStates} << kBits> step{};

  constexpr HilbertSteps() noexcept {
    constexpr HilbertCurve<N> kCurve;
    for (unsigned first = 0; first < HilbertCurve<N>::kStates; ++first) {
      for (unsigned cell = 0; cell <= kPlaceMask; ++cell) {
        unsigned state = first;
        unsigned place = 0;
        for (unsigned bit = Levels; bit-- > 0;) {
          const unsigned one = kCurve.step[state << N | half_at(cell, bit)];
          place = place << N | (one & ((1U << N) - 1U));
          state = one >> N;
        }
        step[first << kBits | cell] = static_cast<std::uint16_t>(state << kBits | place);
      }
    }
  }

 private:
  /// The halves that contain the cell on one level, one bit per axis.
  static constexpr unsigned half_at(unsigned cell, unsigned bit) noexcept {
    unsigned half = 0;
    for (unsigned a = 0; a < N; ++a) half |= (cell >> (Levels * a + bit) & 1U) << a;
    return half;
  }
};

}  // namespace winnow
