#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstring>
#include <new>

namespace winnow::python {

// Where Python made an object by `__new__` alone, pybind11 gets memory for it when it is first
// used, and leaves that as it is.

/// Base of what is of no use then; it is made by `std::make_shared`, which does not come here.
struct NeedsInit {
  [[noreturn]] static void* operator new(std::size_t) {
    throw pybind11::type_error("__init__ was not called");
  }
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void*) noexcept {}
};

/// Base of what is empty if all of its bytes are 0.
struct EmptyIfZero {
  static void* operator new(std::size_t bytes) {
    return std::memset(::operator new(bytes), 0, bytes);
  }
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void* p) noexcept { ::operator delete(p); }
};

}  // namespace winnow::python
