#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace winnow::bench {

enum class KeyMode : std::size_t { bulk, single };

inline constexpr std::array<std::string_view, 3> kKeyOperations{"insert", "update", "remove"};
inline constexpr std::array<std::string_view, 2> kKeyModes{"bulk", "single"};

/// Nanoseconds of one operation on one object, by operation and mode.
using KeyCosts = std::array<std::array<double, 2>, 3>;

/// Medians over rounds in which a tenth of the objects (100,000 at most) is removed, put back in
/// and moved, with the partition brought up to date before each. `random_order`: keys in an order
/// that has nothing to do with the one in which they were handed out; else in that one.
[[nodiscard]] KeyCosts measure_key_costs(std::string_view partition, std::size_t objects,
                                         bool random_order);

}  // namespace winnow::bench
