#pragma once

#if defined(__SSE__) && !defined(__wasm__)
#include <xmmintrin.h>
#elif !defined(__wasm__) && !defined(__aarch64__)
#include <cfenv>
#endif

#include <cstdint>

namespace winnow {

// The register that says how a thread rounds and whether it flushes denormal numbers. x86 keeps
// both, with the masks and flags of exceptions, in MXCSR; AArch64 keeps them in FPCR. Elsewhere it
// stands for the direction of rounding, and WebAssembly has nothing to set.

#if defined(__SSE__) && !defined(__wasm__)

using FloatControl = unsigned;
/// Denormals are zero, the two bits of the direction, flush to zero.
inline constexpr FloatControl kFloatModes = 0xE040U;
inline FloatControl float_control() noexcept {
  return _mm_getcsr();
}
inline void set_float_control(FloatControl control) noexcept {
  _mm_setcsr(control);
}

#elif defined(__aarch64__)

using FloatControl = std::uint64_t;
/// Flush to zero, the two bits of the direction, and the two bits by which newer processors flush
/// inputs alone and handle denormal numbers in another way.
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
/// To nearest is 0 wherever C++ has names for the directions.
inline constexpr FloatControl kFloatModes = ~0U;
static_assert(FE_TONEAREST == 0);
inline FloatControl float_control() noexcept {
  return static_cast<FloatControl>(std::fegetround());
}
inline void set_float_control(FloatControl control) noexcept {
  static_cast<void>(std::fesetround(static_cast<int>(control)));
}

#endif

/// The floating-point environment that winnow computes in, for one scope: rounds to nearest and
/// keeps denormal numbers. Every public function that computes opens one, so a host's modes cannot
/// lose a denormal slack, gap or bound, and answers are the same in all of them. Masks of
/// exceptions stay the caller's. The code of a scope inside another only reads the register.
class DefaultEnvironment {
 public:
  DefaultEnvironment() noexcept : callers_(float_control() & kFloatModes) {
    if (callers_ != 0) [[unlikely]]
      enter(callers_);
  }
  ~DefaultEnvironment() {
    if (callers_ != 0) [[unlikely]]
      leave(callers_);
  }
  DefaultEnvironment(const DefaultEnvironment&) = delete;
  DefaultEnvironment& operator=(const DefaultEnvironment&) = delete;

 private:
  // Calls, so that no arithmetic moves across them.
  static void enter(FloatControl modes) noexcept;
  static void leave(FloatControl modes) noexcept;

  const FloatControl callers_;
};

/// Inside a DefaultEnvironment, the modes of the thread's own code for one scope, in which the host
/// may run what is not winnow's.
class HostEnvironment {
 public:
  HostEnvironment() noexcept;
  ~HostEnvironment();
  HostEnvironment(const HostEnvironment&) = delete;
  HostEnvironment& operator=(const HostEnvironment&) = delete;

 private:
  const FloatControl hosts_;
};

}  // namespace winnow
