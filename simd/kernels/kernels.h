#pragma once

// Dispatch of kernels. A `*.kernel.cpp` is compiled once per instruction set and defines one
// constant table of function pointers, whose name ends in the instruction set. The header beside it
// declares the table's type and, by WINNOW_KERNELS, the tables and the function that returns the
// table of the active instruction set. Kernel files include only <cstdint>, <cstddef>, this file,
// simd/lanes/ and headers of plain structs: an inline function of the standard library that is
// compiled for a wide instruction set could be merged by the linker into code that runs everywhere.

#include <cstdint>

namespace winnow {
enum class Isa : std::uint8_t;
[[nodiscard]] Isa active_isa() noexcept;
}  // namespace winnow

#define WINNOW_CONCAT_2(a, b) a##_##b
#define WINNOW_CONCAT(a, b) WINNOW_CONCAT_2(a, b)

/// In a kernel file: the name of the table of its instruction set.
#define WINNOW_KERNEL_TABLE(name) WINNOW_CONCAT(name, WINNOW_ISA_NAME)

/// In a kernel header: declares the tables and the function `name()` that returns the active one.
#define WINNOW_KERNELS(Type, name) \
  extern const Type name##_sse42;  \
  extern const Type name##_avx2;   \
  extern const Type name##_avx512; \
  extern const Type name##_neon64; \
  [[nodiscard]] const Type& name() noexcept

#ifdef WINNOW_HAVE_AVX512
#define WINNOW_PICK_AVX512(name) \
  case 2:                        \
    return name##_avx512;
#else
#define WINNOW_PICK_AVX512(name)
#endif
#ifdef WINNOW_HAVE_AVX2
#define WINNOW_PICK_AVX2(name) \
  case 1:                      \
    return name##_avx2;
#else
#define WINNOW_PICK_AVX2(name)
#endif
#ifdef WINNOW_HAVE_NEON64
#define WINNOW_PICK_BASE(name) return name##_neon64
#else
#define WINNOW_PICK_BASE(name) return name##_sse42
#endif

/// In one ordinary source file per kernel table: defines `name()`.
#define WINNOW_DEFINE_KERNELS(Type, name)          \
  const Type& name() noexcept {                    \
    switch (static_cast<unsigned>(active_isa())) { \
      WINNOW_PICK_AVX512(name)                     \
      WINNOW_PICK_AVX2(name)                       \
      default:                                     \
        WINNOW_PICK_BASE(name);                    \
    }                                              \
  }
