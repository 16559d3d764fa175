#pragma once

// Functions of Python's that winnow calls while it works: from any of its threads, one at a time,
// for each waits for the GIL. What they raise is kept, the work goes on with some answer, and the
// call that was under way raises it in the end.

#include "pipeline/python/gil.h"
#include "pipeline/python/refusal.h"

#include <winnow/core/filter.h>

#include <atomic>
#include <cstdint>
#include <utility>

namespace winnow::python {

namespace py = pybind11;

/// On a thread in such a function, while it is there.
class InCallback {
 public:
  InCallback() noexcept { ++depth_; }
  ~InCallback() { --depth_; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;

  /// Throws `unsupported` on such a thread: what asks holds locks that the call would wait for.
  static void refuse() {
    if (depth_ != 0) {
      throw Refusal(Status::unsupported, "a function that winnow calls cannot call winnow");
    }
  }

 private:
  static inline thread_local int depth_ = 0;
};

/// Calls use(), which calls Python, and keep() while an exception that left it is handled; both
/// with the GIL. On any thread.
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

/// The exception that is being handled, as Python has it. With the GIL.
[[nodiscard]] py::object caught_exception() noexcept;
/// Raises it. With the GIL.
[[noreturn]] void raise(const py::object& exception);

/// What functions raised that any call may ask, for all calls that were under way. With the GIL.
class Raised {
 public:
  /// Of an exception that is being handled. Where no call is under way, Python is told that it
  /// could not be raised.
  void keep() noexcept;
  /// What work() answers, unless something is kept meanwhile, which is raised then.
  template <typename Work>
  auto during(Work&& work) {
    const Meanwhile meanwhile(*this);
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
  class Meanwhile {
   public:
    explicit Meanwhile(Raised& all) noexcept : all_(all), before_(all.count_) { ++all_.calls_; }
    ~Meanwhile();
    Meanwhile(const Meanwhile&) = delete;
    Meanwhile& operator=(const Meanwhile&) = delete;
    void raise() const;

   private:
    Raised& all_;
    std::uint64_t before_;
  };

  py::object last_;
  std::uint64_t count_ = 0;
  unsigned calls_ = 0;
};

/// A function of Python's, that is let go of with the GIL.
class PythonFunction {
 public:
  /// A TypeError for what cannot be called.
  PythonFunction(py::object function, const char* name);
  ~PythonFunction();
  PythonFunction(const PythonFunction&) = delete;
  PythonFunction& operator=(const PythonFunction&) = delete;

  [[nodiscard]] const py::object& object() const noexcept { return function_; }
  /// Calls use(function), else as `call_python`.
  template <typename Use, typename Keep>
  void ask(Use&& use, Keep&& keep) const noexcept {
    call_python([&] { use(function_); }, keep);
  }

 private:
  py::object function_;
};

/// Whether what is answered lets something pass. Once it has raised, nothing passes and nobody asks
/// it, until `begin`.
class Predicate {
 public:
  Predicate(py::object function, const char* name) : function_(std::move(function), name) {}

  [[nodiscard]] const py::object& object() const noexcept { return function_.object(); }
  void begin() noexcept { has_failed_.store(false, std::memory_order_relaxed); }
  [[nodiscard]] bool has_failed() const noexcept {
    return has_failed_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool passes(std::uint64_t first, std::uint64_t second) noexcept;
  /// What it raised. With the GIL.
  [[noreturn]] void raise();
  /// The same, if it has.
  void raise_if_failed() {
    if (has_failed()) raise();
  }

 private:
  PythonFunction function_;
  std::atomic<bool> has_failed_{false};
  py::object raised_;
};

/// Asked about pairs, as winnow asks.
[[nodiscard]] PairPredicate pair_predicate(Predicate& predicate) noexcept;

}  // namespace winnow::python
