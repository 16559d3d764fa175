#pragma once

#include <winnow/simd/isa.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// A kernel of the partitions on one instruction set.
struct KernelTiming {
  std::string kernel;
  Isa isa{};
  std::vector<double> ns{};  ///< a call, one entry a round
  std::uint64_t tests = 0;   ///< of a box against a box, a call; 0: it tests none
  std::uint64_t pairs = 0;   ///< found
};

/// Kernels whose names contain `text`, on unit cubes that stay in the cache, in rounds in which all
/// of them take turns on all instruction sets of this machine. The active one is what it was when
/// this returns.
[[nodiscard]] std::vector<KernelTiming> race_kernels(std::size_t rounds,
                                                     const std::string& text = "");

}  // namespace winnow::bench
