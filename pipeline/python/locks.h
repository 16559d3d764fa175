#pragma once

#include <pybind11/pybind11.h>

#include <mutex>
#include <shared_mutex>
#include <utility>

namespace winnow::python {

// Work is done without the GIL, and a lock keeps threads from changing what others look at. It is
// waited for without the GIL, and let go before that is taken again: no two threads can wait for
// each other.

/// For calls that may run at once.
template <typename Body>
auto reading(std::shared_mutex& mutex, Body&& body) {
  const pybind11::gil_scoped_release release;
  const std::shared_lock lock(mutex);
  return std::forward<Body>(body)();
}

/// For calls that want the object to themselves.
template <typename Body>
auto changing(std::shared_mutex& mutex, Body&& body) {
  const pybind11::gil_scoped_release release;
  const std::unique_lock lock(mutex);
  return std::forward<Body>(body)();
}

}  // namespace winnow::python
