#pragma once

#include <winnow/core/aabb.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

namespace winnow::bench {

static_assert(std::endian::native == std::endian::little && std::numeric_limits<float>::is_iec559,
              "recordings are read and written as they lie in memory");

/// Byte offsets and sizes of an .aabbs file.
inline constexpr std::size_t kTextSize = 128;
inline constexpr std::size_t kObjectsAt = 256;
inline constexpr std::size_t kStepsAt = 260;
inline constexpr std::size_t kWorldAt = 272;
inline constexpr std::size_t kHeaderSize = 304;
inline constexpr std::size_t kBoxSize = 32;

using BoxBytes = std::array<float, kBoxSize / sizeof(float)>;

[[nodiscard]] inline Aabb unpack(const std::byte* at) noexcept {
  BoxBytes f;
  std::memcpy(f.data(), at, kBoxSize);
  return {{f[0], f[1], f[2]}, {f[4], f[5], f[6]}};
}

inline void pack(const Aabb& box, std::byte* at) noexcept {
  const BoxBytes f{box.min.x(), box.min.y(), box.min.z(), 0.0F,
                   box.max.x(), box.max.y(), box.max.z(), 0.0F};
  std::memcpy(at, f.data(), kBoxSize);
}

}  // namespace winnow::bench
