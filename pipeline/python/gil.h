#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <thread>

#if defined(__GLIBCXX__)
#include <cxxabi.h>
#endif

namespace winnow::python {

/// The exception that unwinds a thread at thread exit, on platforms on which it can be caught.
#if defined(__GLIBCXX__)
using ThreadEnds = abi::__forced_unwind;
#else
struct ThreadEnds {};
#endif

/// Blocks the calling thread forever. For a thread that needs the GIL after the interpreter has
/// ended: CPython would unwind the thread, which must not happen in a noexcept function.
[[noreturn]] inline void stay_here() noexcept {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Handles the end of the interpreter: other threads then block instead of returning to Python.
class InterpreterEnd {
 public:
  /// Called with the GIL on the thread that ends the interpreter. Waits at most a second for
  /// threads that are inside Python.
  static void begin() {
    by_ = std::this_thread::get_id();
    begun_ = true;
    PyThreadState* const state = PyEval_SaveThread();
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (inside_ != 0 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    PyEval_RestoreThread(state);
  }
  static void stay_if_begun() noexcept {
    if (begun_ && std::this_thread::get_id() != by_) stay_here();
  }
  /// Counts this thread as inside Python until `leave`. Blocks it forever if the end has begun.
  static void enter() noexcept {
    ++inside_;
    if (!begun_ || std::this_thread::get_id() == by_) return;
    --inside_;
    stay_here();
  }
  static void leave() noexcept { --inside_; }

 private:
  static inline std::atomic<bool> begun_{false};
  static inline std::atomic<int> inside_{0};
  static inline std::thread::id by_;
};

/// Releases the GIL, which the thread must hold, for the scope.
class WithoutGil {
 public:
  WithoutGil() noexcept : state_(PyEval_SaveThread()) {}
  ~WithoutGil() {
    InterpreterEnd::stay_if_begun();
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {
      stay_here();
    }
  }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

/// Holds the GIL for the scope, on any thread.
class WithGil {
 public:
  WithGil() noexcept {
    InterpreterEnd::enter();
    try {
      state_ = PyGILState_Ensure();
    } catch (...) {
      stay_here();
    }
  }
  ~WithGil() {
    PyGILState_Release(state_);
    InterpreterEnd::leave();
  }
  WithGil(const WithGil&) = delete;
  WithGil& operator=(const WithGil&) = delete;

 private:
  PyGILState_STATE state_{};
};

}  // namespace winnow::python
