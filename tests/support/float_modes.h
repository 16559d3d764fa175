#pragma once

// Floating-point modes that a host may set: the rounding direction and the treatment of denormal
// numbers. Independent of the tests and of winnow.

#include <cfenv>
#include <cstdint>
#include <string>
#include <vector>

#if defined(__SSE__) && !defined(__wasm__)
#include <xmmintrin.h>
#endif

namespace winnow::test {

struct FloatMode {
  int rounding = FE_TONEAREST;
  bool results_flushed = false;  ///< FTZ; on AArch64 one bit flushes inputs and results
  bool inputs_flushed = false;   ///< DAZ
};

[[nodiscard]] inline const char* direction_of(const FloatMode& mode) {
  switch (mode.rounding) {
#ifdef FE_DOWNWARD
    case FE_DOWNWARD:
      return "down";
    case FE_UPWARD:
      return "up";
    case FE_TOWARDZERO:
      return "zero";
#endif
    default:
      return "nearest";
  }
}

[[nodiscard]] inline std::string to_string(const FloatMode& mode) {
  return std::string(direction_of(mode)) + (mode.results_flushed ? " FTZ" : "") +
         (mode.inputs_flushed ? " DAZ" : "");
}

/// Returns all modes of the platform, the default one first.
[[nodiscard]] inline std::vector<FloatMode> all_float_modes() {
  std::vector<FloatMode> modes;
  for (const int rounding : {FE_TONEAREST,
#ifdef FE_DOWNWARD
                             FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO
#endif
       }) {
    modes.push_back({rounding});
#if defined(__SSE__) && !defined(__wasm__)
    modes.push_back({rounding, true, false});
    modes.push_back({rounding, false, true});
    modes.push_back({rounding, true, true});
#elif defined(__aarch64__)
    modes.push_back({rounding, true, true});
#endif
  }
  return modes;
}

/// Sets a mode for one scope.
class FloatModeScope {
 public:
  explicit FloatModeScope(const FloatMode& mode) {
    std::fegetenv(&before_);
    std::fesetround(mode.rounding);
#if defined(__SSE__) && !defined(__wasm__)
    // On some systems fesetenv does not restore the whole register.
    _mm_setcsr(_mm_getcsr() | (mode.results_flushed ? 0x8000U : 0U) |
               (mode.inputs_flushed ? 0x40U : 0U));
#elif defined(__aarch64__)
    std::uint64_t control = 0;
    asm volatile("mrs %0, fpcr" : "=r"(control));
    if (mode.results_flushed) control |= std::uint64_t{1} << 24U;
    asm volatile("msr fpcr, %0" : : "r"(control));
#endif
  }
  ~FloatModeScope() {
    std::fesetenv(&before_);
#if defined(__SSE__) && !defined(__wasm__)
    _mm_setcsr(register_before_);
#endif
  }
  FloatModeScope(const FloatModeScope&) = delete;
  FloatModeScope& operator=(const FloatModeScope&) = delete;

 private:
  std::fenv_t before_{};
#if defined(__SSE__) && !defined(__wasm__)
  unsigned register_before_ = _mm_getcsr();
#endif
};

}  // namespace winnow::test
