#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace winnow::bench {

enum class KeyOperation : std::size_t { insert, update, remove };
enum class KeyMode : std::size_t { bulk, single };

inline constexpr std::array<std::string_view, 3> kKeyOperations{"insert", "update", "remove"};
inline constexpr std::array<std::string_view, 2> kKeyModes{"bulk", "single"};

/// Nanoseconds of one operation on one object.
struct KeyCosts {
  std::array<std::array<double, 2>, 3> ns{};  ///< by operation and mode

  [[nodiscard]] double of(KeyOperation operation, KeyMode mode) const noexcept {
    return ns[static_cast<std::size_t>(operation)][static_cast<std::size_t>(mode)];
  }
};

/// Medians over rounds in which a tenth of the objects (100,000 at most) is removed, put back in
/// and moved, with the partition brought up to date before each. `random_order`: keys in an order
/// that has nothing to do with the one in which they were handed out; else in that one.
[[nodiscard]] KeyCosts measure_key_costs(std::string_view partition, std::size_t objects,
                                         bool random_order);

}  // namespace winnow::bench
