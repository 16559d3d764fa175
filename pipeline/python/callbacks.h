#pragma once

// Python functions that winnow calls during its work: from any of its threads, one at a time,
// because each call takes the GIL. If such a function raises an exception, the exception is stored,
// the work continues with a default result, and the winnow call in progress raises the exception at
// its end.

#include "pipeline/python/gil.h"
#include "pipeline/python/refusal.h"

#include <winnow/core/filter.h>

#include <atomic>
#include <cstdint>
#include <utility>

namespace winnow::python {

namespace py = pybind11;

/// While it exists, marks the current thread as being inside such a function.
class InCallback {
 public:
  InCallback() noexcept { ++depth_; }
  ~InCallback() { --depth_; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;

  /// Throws `unsupported` on such a thread: its caller holds locks that the call would block on.
  static void forbid() {
    if (depth_ != 0) {
      throw Refusal(Status::unsupported, "a function that winnow calls cannot call winnow");
    }
  }

 private:
  static inline thread_local int depth_ = 0;
};

/// Calls use(), which calls Python. If use() throws, calls keep() in the exception handler. Takes
/// the GIL for both calls; may be called on any thread.
template <typename Use, typename Keep>
void call_python(Use&& use, Keep&& keep) noexcept {
  const WithGil hold;
  const InCallback here;
  try {
    use();
  } catch (const ThreadEnds&) {
    stay_here();
  } catch (...) {
    keep();
  }
}

/// Returns the exception that is being handled, as a Python object. Requires the GIL.
[[nodiscard]] py::object caught_exception() noexcept;
/// Raises a Python exception. Requires the GIL.
[[noreturn]] void raise(const py::object& exception);

/// Stores exceptions of functions that any call may run (support functions), for all calls in
/// progress. Requires the GIL.
class Raised {
 public:
  /// Stores the exception that is being handled. If no call is in progress, reports it as
  /// unraisable.
  void keep() noexcept;
  /// Returns work(), or raises the exception that was stored meanwhile.
  template <typename Work>
  auto during(Work&& work) {
    const CallScope meanwhile(*this);
    try {
      auto answer = std::forward<Work>(work)();
      meanwhile.raise();
      return answer;
    } catch (const Refusal&) {
      meanwhile.raise();
      throw;
    }
  }

 private:
  class CallScope {
   public:
    explicit CallScope(Raised& all) noexcept : all_(all), before_(all.count_) { ++all_.calls_; }
    ~CallScope();
    CallScope(const CallScope&) = delete;
    CallScope& operator=(const CallScope&) = delete;
    void raise() const;

   private:
    Raised& all_;
    std::uint64_t before_;
  };

  py::object last_;
  std::uint64_t count_ = 0;
  unsigned calls_ = 0;
};

/// A Python function, released with the GIL.
class PythonFunction {
 public:
  /// Throws a TypeError if the object is not callable.
  PythonFunction(py::object function, const char* name);
  ~PythonFunction();
  PythonFunction(const PythonFunction&) = delete;
  PythonFunction& operator=(const PythonFunction&) = delete;

  [[nodiscard]] const py::object& object() const noexcept { return function_; }
  /// Calls use(function), as `call_python`.
  template <typename Use, typename Keep>
  void call(Use&& use, Keep&& keep) const noexcept {
    call_python([&] { use(function_); }, keep);
  }

 private:
  py::object function_;
};

/// A Python predicate. After it has raised an exception it is not called, and rejects everything,
/// until `begin`.
class Predicate {
 public:
  Predicate(py::object function, const char* name) : function_(std::move(function), name) {}

  [[nodiscard]] const py::object& object() const noexcept { return function_.object(); }
  void begin() noexcept { has_failed_.store(false, std::memory_order_relaxed); }
  [[nodiscard]] bool has_failed() const noexcept {
    return has_failed_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool passes(std::uint64_t first, std::uint64_t second) noexcept;
  /// Raises its exception. Requires the GIL.
  [[noreturn]] void raise();
  /// Raises its exception, if there is one.
  void raise_if_failed() {
    if (has_failed()) raise();
  }

 private:
  PythonFunction function_;
  std::atomic<bool> has_failed_{false};
  py::object raised_;
};

/// The predicate as a PairPredicate.
[[nodiscard]] PairPredicate pair_predicate(Predicate& predicate) noexcept;

}  // namespace winnow::python
