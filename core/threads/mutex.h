#pragma once

#include <mutex>

namespace winnow {

#ifdef _LIBCPP_HAS_NO_THREADS  // defined by <mutex>

/// A mutex that does nothing, for programs that have only one thread.
struct Mutex {};

class Lock {
 public:
  Lock() noexcept = default;
  explicit Lock(Mutex&) noexcept : owns_(true) {}
  [[nodiscard]] static Lock deferred(Mutex&) noexcept { return {}; }
  [[nodiscard]] static Lock try_acquire(Mutex& mutex) noexcept { return Lock(mutex); }
  void lock() noexcept { owns_ = true; }
  [[nodiscard]] bool owns_lock() const noexcept { return owns_; }

 private:
  bool owns_ = false;
};

#else

using Mutex = std::mutex;

/// Holds a mutex until it goes out of scope.
class Lock : public std::unique_lock<Mutex> {
 public:
  Lock() noexcept = default;
  explicit Lock(Mutex& mutex) : std::unique_lock<Mutex>(mutex) {}
  /// Does not lock until `lock` is called.
  [[nodiscard]] static Lock deferred(Mutex& mutex) noexcept { return {mutex, std::defer_lock}; }
  /// Locks if the mutex is free; `owns_lock` returns the result.
  [[nodiscard]] static Lock try_acquire(Mutex& mutex) { return {mutex, std::try_to_lock}; }

 private:
  using std::unique_lock<Mutex>::unique_lock;
};

#endif

}  // namespace winnow
