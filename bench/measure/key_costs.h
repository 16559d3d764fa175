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

/// Returns medians over rounds in which a tenth of the objects (at most 100,000) is removed,
/// inserted again and moved; the partition is refreshed before each operation. With `random_order`
/// the keys are in random order, otherwise in the order in which they were given.
[[nodiscard]] KeyCosts measure_key_costs(std::string_view partition, std::size_t objects,
                                         bool random_order);

}  // namespace winnow::bench
