#pragma once

#include "pipeline/python/callbacks.h"
#include "pipeline/python/gil.h"

#include <functional>
#include <mutex>
#include <shared_mutex>
#include <utility>

namespace winnow::python {

// Work is done without the GIL, and a lock keeps threads from changing what others look at. It is
// waited for without the GIL, and let go before that is taken again: no two threads can wait for
// each other. A function of Python's that winnow calls is under such locks, and takes none.

/// For calls that may run at once.
template <typename Body>
auto reading(std::shared_mutex& mutex, Body&& body) {
  InCallback::refuse();
  const WithoutGil release;
  const std::shared_lock lock(mutex);
  return std::forward<Body>(body)();
}

/// For calls that read two objects, or one twice: no lock is taken twice, and two always in the
/// order of their addresses.
template <typename Body>
auto reading_two(std::shared_mutex& a, std::shared_mutex& b, Body&& body) {
  const bool in_order = std::less<>()(&a, &b);
  InCallback::refuse();
  const WithoutGil release;
  const std::shared_lock first(in_order ? a : b);
  std::shared_lock<std::shared_mutex> second;
  if (&a != &b) second = std::shared_lock(in_order ? b : a);
  return std::forward<Body>(body)();
}

/// For calls that want the object to themselves.
template <typename Body>
auto changing(std::shared_mutex& mutex, Body&& body) {
  InCallback::refuse();
  const WithoutGil release;
  const std::unique_lock lock(mutex);
  return std::forward<Body>(body)();
}

}  // namespace winnow::python
