#pragma once

#include "pipeline/python/callbacks.h"
#include "pipeline/python/gil.h"

#include <functional>
#include <mutex>
#include <shared_mutex>
#include <utility>

namespace winnow::python {

// Work runs without the GIL, and a lock protects objects from changes by other threads. A thread
// waits for a lock only without the GIL, so a thread with a lock can always take the GIL, and the
// two cannot deadlock. A Python function that winnow calls runs under such locks and must not
// acquire any.

/// Runs body() with shared access.
template <typename Body>
auto reading(std::shared_mutex& mutex, Body&& body) {
  InCallback::forbid();
  const WithoutGil release;
  const std::shared_lock lock(mutex);
  return std::forward<Body>(body)();
}

/// Runs body() with shared access to two objects, which may be the same one. Takes no lock twice,
/// and two locks in the order of their addresses.
template <typename Body>
auto reading_two(std::shared_mutex& a, std::shared_mutex& b, Body&& body) {
  const bool in_order = std::less<>()(&a, &b);
  InCallback::forbid();
  const WithoutGil release;
  const std::shared_lock first(in_order ? a : b);
  std::shared_lock<std::shared_mutex> second;
  if (&a != &b) second = std::shared_lock(in_order ? b : a);
  return std::forward<Body>(body)();
}

/// Runs body() with exclusive access.
template <typename Body>
auto changing(std::shared_mutex& mutex, Body&& body) {
  InCallback::forbid();
  const WithoutGil release;
  const std::unique_lock lock(mutex);
  return std::forward<Body>(body)();
}

/// Runs body() with shared access; throws unless its status is ok. `call` is for messages.
template <typename Body>
void read_or_throw(std::shared_mutex& mutex, const char* call, Body&& body) {
  accept(reading(mutex, std::forward<Body>(body)), call);
}

/// Runs body() with exclusive access; throws unless its status is ok.
template <typename Body>
void change_or_throw(std::shared_mutex& mutex, const char* call, Body&& body) {
  accept(changing(mutex, std::forward<Body>(body)), call);
}

}  // namespace winnow::python
