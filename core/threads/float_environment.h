#pragma once

#if defined(__SSE__) && !defined(__wasm__)
#include <xmmintrin.h>
#elif !defined(__wasm__) && !defined(__aarch64__)
#include <cfenv>
#endif

#include <cstdint>

namespace winnow {

// FloatControl is the register with the rounding direction and the flushing of denormals: MXCSR on
// x86, which also has the masks and flags of exceptions, and FPCR on AArch64. On other systems it
// is the rounding direction; WebAssembly has no modes.

#if defined(__SSE__) && !defined(__wasm__)

using FloatControl = unsigned;
/// DAZ, the two bits of the rounding direction, and FTZ.
inline constexpr FloatControl kFloatModes = 0xE040U;
inline FloatControl float_control() noexcept {
  return _mm_getcsr();
}
inline void set_float_control(FloatControl control) noexcept {
  _mm_setcsr(control);
}

#elif defined(__aarch64__)

using FloatControl = std::uint64_t;
/// FZ, the two bits of the rounding direction, and FIZ and AH of newer processors, which flush only
/// inputs and change the handling of denormals.
inline constexpr FloatControl kFloatModes = 0x1C00003U;
inline FloatControl float_control() noexcept {
  FloatControl control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  return control;
}
inline void set_float_control(FloatControl control) noexcept {
  asm volatile("msr fpcr, %0" : : "r"(control) : "memory");
}

#elif defined(__wasm__)

using FloatControl = unsigned;
inline constexpr FloatControl kFloatModes = 0;
inline FloatControl float_control() noexcept {
  return 0;
}
inline void set_float_control(FloatControl) noexcept {}

#else

using FloatControl = unsigned;
/// FE_TONEAREST is 0 on all systems, which the assertion below checks.
inline constexpr FloatControl kFloatModes = ~0U;
static_assert(FE_TONEAREST == 0);
inline FloatControl float_control() noexcept {
  return static_cast<FloatControl>(std::fegetround());
}
inline void set_float_control(FloatControl control) noexcept {
  static_cast<void>(std::fesetround(static_cast<int>(control)));
}

#endif

/// The floating-point environment of winnow's computations, for one scope: rounds to nearest and
/// keeps denormals. Every public function that computes opens one, so that a host's modes cannot
/// lose a denormal slack, gap or bound, and results are equal in all modes. Masks of exceptions
/// stay the caller's. A scope inside another only reads the register.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment() noexcept : caller_modes_(float_control() & kFloatModes) {
    if (caller_modes_ != 0) [[unlikely]]
      enter(caller_modes_);
  }
  ~DefaultFloatEnvironment() {
    if (caller_modes_ != 0) [[unlikely]]
      leave(caller_modes_);
  }
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

 private:
  // Not inline, so that no arithmetic moves across the change of modes.
  static void enter(FloatControl modes) noexcept;
  static void leave(FloatControl modes) noexcept;

  const FloatControl caller_modes_;
};

/// Restores the thread's own modes inside a DefaultFloatEnvironment, for a scope in which code of
/// the host may run.
class HostFloatEnvironment {
 public:
  HostFloatEnvironment() noexcept;
  ~HostFloatEnvironment();
  HostFloatEnvironment(const HostFloatEnvironment&) = delete;
  HostFloatEnvironment& operator=(const HostFloatEnvironment&) = delete;

 private:
  const FloatControl host_modes_;
};

}  // namespace winnow
