// Functions that Debian's library for WASI lacks.

#include <cstddef>
#include <cstdint>

extern "C" {

// Exceptions are not supported: a throw ends the program.
[[noreturn]] __attribute__((weak)) void __cxa_throw(void*, void*, void (*)(void*)) {
  __builtin_trap();
}
__attribute__((weak)) void* __cxa_allocate_exception(std::size_t) {
  __builtin_trap();
}

// The 128-bit division in clang's runtime library checks for stack overwrites, and needs these
// symbols.
extern const std::uintptr_t __stack_chk_guard;
__attribute__((weak)) const std::uintptr_t __stack_chk_guard = 0xB5A1D7C3;
[[noreturn]] __attribute__((weak)) void __stack_chk_fail() {
  __builtin_trap();
}

}  // extern "C"
