#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstring>
#include <new>

namespace winnow::python {

// If Python makes an object by `__new__` only, without `__init__`, pybind11 allocates memory for it
// at its first use and does not initialize it.

/// Base of classes that are unusable in that state: pybind11 then calls this operator new, which
/// throws. `std::make_shared`, by which `__init__` makes the objects, does not call it.
struct NeedsInit {
  [[noreturn]] static void* operator new(std::size_t) {
    throw pybind11::type_error("__init__ was not called");
  }
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void*) noexcept {}
};

/// Base of classes that are empty if all their bytes are 0.
struct EmptyIfZero {
  static void* operator new(std::size_t bytes) {
    return std::memset(::operator new(bytes), 0, bytes);
  }
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void* p) noexcept { ::operator delete(p); }
};

}  // namespace winnow::python
