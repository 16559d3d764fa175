#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>

namespace winnow::bench {

/// Encodes bytes as base64 (RFC 4648, with padding).
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// Encodes the memory of the values.
template <typename T>
[[nodiscard]] std::string base64_of(std::span<const T> values) {
  static_assert(std::is_standard_layout_v<T>);
  return base64(std::as_bytes(values));
}

}  // namespace winnow::bench
