#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>

#include <cstdint>
#include <span>
#include <string_view>

namespace winnow {

/// Instruction sets that kernels are built for.
enum class Isa : std::uint8_t {
  sse42,   ///< x86-64 baseline of winnow
  avx2,    ///< AVX2 and FMA
  avx512,  ///< AVX-512 F, CD, DQ, BW, VL
  neon64,  ///< AArch64
};

/// The enumerator's name. Never null.
[[nodiscard]] WINNOW_API const char* to_string(Isa isa) noexcept;

/// The instruction sets in this build that this machine and operating system can run, narrowest
/// first. Never empty on a machine that winnow supports.
[[nodiscard]] WINNOW_API std::span<const Isa> available_isas() noexcept;

/// The one in use: the widest available, unless the environment variable WINNOW_ISA (read once)
/// names another available one or `set_isa` chose.
[[nodiscard]] WINNOW_API Isa active_isa() noexcept;

/// Name of the active instruction set.
[[nodiscard]] WINNOW_API const char* isa_name() noexcept;

/// Chooses for the whole process. `invalid_argument`, and no change, if this build or machine does
/// not have it. Queries already under way keep the one they started with.
WINNOW_API Status set_isa(Isa isa) noexcept;

/// As above by name ("sse42", "avx2", "avx512", "neon64").
WINNOW_API Status set_isa(std::string_view name) noexcept;

}  // namespace winnow
