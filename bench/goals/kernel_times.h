#pragma once

#include <map>
#include <optional>
#include <string>

namespace winnow::bench {

/// Nanoseconds by kernel and then by instruction set.
using KernelTimes = std::map<std::string, std::map<std::string, double>>;

/// Runs the kernels' micro benchmarks, a program that is built beside this one. None if it is not
/// there or fails.
[[nodiscard]] std::optional<KernelTimes> measure_kernels();

}  // namespace winnow::bench
