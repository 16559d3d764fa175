#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>

#include <cstdint>
#include <span>
#include <string_view>

namespace winnow {

/// Instruction sets that kernels can be built for.
enum class Isa : std::uint8_t {
  sse42,   ///< SSE4.2, the x86-64 baseline of winnow
  avx2,    ///< AVX2 and FMA
  avx512,  ///< AVX-512 F, CD, DQ, BW, VL
  neon64,  ///< NEON of AArch64
};

/// Returns the enumerator's name, never null.
[[nodiscard]] WINNOW_API const char* to_string(Isa isa) noexcept;

/// Returns the instruction sets of this build that this machine and operating system can run,
/// narrowest first. Never empty on a machine that winnow supports.
[[nodiscard]] WINNOW_API std::span<const Isa> available_isas() noexcept;

/// Returns the instruction set in use: the widest available, unless the environment variable
/// WINNOW_ISA (read once) or `set_isa` selected another available one.
[[nodiscard]] WINNOW_API Isa active_isa() noexcept;

/// Returns the name of the active instruction set.
[[nodiscard]] WINNOW_API const char* isa_name() noexcept;

/// Sets the instruction set of the whole process. Returns `invalid_argument`, and changes nothing,
/// if this build or machine does not have it. Queries in progress continue with the previous one.
WINNOW_API Status set_isa(Isa isa) noexcept;

/// As above, by name ("sse42", "avx2", "avx512", "neon64").
WINNOW_API Status set_isa(std::string_view name) noexcept;

}  // namespace winnow
