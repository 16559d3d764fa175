// For WebAssembly, whose library for WASI cannot throw: what would ends the program.

#include <cstddef>

extern "C" {

[[noreturn]] __attribute__((weak)) void __cxa_throw(void*, void*, void (*)(void*)) {
  __builtin_trap();
}
__attribute__((weak)) void* __cxa_allocate_exception(std::size_t) {
  __builtin_trap();
}

}  // extern "C"
