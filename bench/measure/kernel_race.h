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
  std::vector<double> ns{};  ///< ns per call, one entry per round
  std::uint64_t tests = 0;   ///< box tests per call; 0 if it tests none
  std::uint64_t pairs = 0;   ///< pairs found per call
};

/// Races the kernels whose names contain `text` on all instruction sets of this machine,
/// interleaved, on unit cubes that fit the cache. Restores the active instruction set.
[[nodiscard]] std::vector<KernelTiming> race_kernels(std::size_t rounds,
                                                     const std::string& text = "");

}  // namespace winnow::bench
