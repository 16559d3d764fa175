#pragma once

#include <winnow/core/pose.h>
#include <winnow/core/volumes.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>

namespace winnow::test {

/// Reads the bytes of a fuzzer as the choices of a test: any bytes are valid, and all bytes beyond
/// the end are zero.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  /// Returns a number in [0, count); count is at most 256.
  std::size_t below(std::size_t count) { return byte() % count; }
  bool chance(std::size_t one_in) { return below(one_in) == one_in - 1; }

  /// Returns any value of a plain type, for floats including NaN and infinities.
  template <typename T>
  T any() {
    std::array<std::uint8_t, sizeof(T)> raw{};
    for (std::uint8_t& one : raw) one = byte();
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }

  /// Returns a multiple of 1/4 in [-32, 31.75], so that shapes touch exactly.
  double grid_value() { return 0.25 * (byte() - 128); }
  /// Returns mostly a multiple of 1/4 in [-30, 29.75]; sometimes an infinity, a number near an end
  /// of the range of float, or any float, including NaN.
  float wild() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    constexpr std::array kEnds{inf,    -inf,    -0.0F,   1e30F,      -3e38F,
                               1e-40F, -1e-30F, 3.4e38F, 16777216.0F};
    const std::uint8_t choice = byte();
    if (choice < 240) return 0.25F * static_cast<float>(choice - 120);
    if (choice < 240 + kEnds.size()) return kEnds[choice - 240U];
    return any<float>();
  }
  /// Returns an extent from 0 to 100.
  double extent() {
    constexpr std::array kExtents{0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 100.0};
    return kExtents[below(kExtents.size())];
  }

  /// Returns a valid box of grid values.
  Aabb grid_box() {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = static_cast<float>(grid_value());
      box.max[axis] = box.min[axis] + static_cast<float>(extent());
    }
    return box;
  }
  /// Returns a box of grid values, or for some bytes a box of wild numbers, which may be invalid.
  Aabb box() {
    if (!chance(8)) return grid_box();
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      const float a = wild();
      const float b = wild();
      box.min[axis] = a < b ? a : b;
      box.max[axis] = a < b ? b : a;
    }
    return box;
  }

  /// Returns a valid pose. Coordinates are multiples of 1/16. For half of the values of a byte, the
  /// orientation is a quaternion of grid values; else it is the identity.
  Pose pose() {
    Pose pose;
    for (double& x : pose.position) x = 0.25 * grid_value();
    if (chance(2)) {
      for (double& q : pose.orientation) q = grid_value();
    }
    if (!pose.is_valid()) pose.orientation[0] = 1.0;
    return pose;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace winnow::test
