#pragma once

#include <map>
#include <optional>
#include <string>

namespace winnow::bench {

/// Nanoseconds by kernel and then by instruction set.
using KernelTimes = std::map<std::string, std::map<std::string, double>>;

/// By the kernels' micro benchmarks, a program that is built beside this one, which is run once.
/// None if it is not there or fails.
[[nodiscard]] const std::optional<KernelTimes>& kernel_times();

}  // namespace winnow::bench
