#pragma once

#include <mutex>

namespace winnow {

#ifdef _LIBCPP_HAS_NO_THREADS  // <mutex> says so

/// Where a program has one thread there is nobody to wait for.
struct Mutex {};

class Lock {
 public:
  Lock() noexcept = default;
  explicit Lock(Mutex&) noexcept : owns_(true) {}
  [[nodiscard]] static Lock deferred(Mutex&) noexcept { return {}; }
  [[nodiscard]] static Lock if_free(Mutex& mutex) noexcept { return Lock(mutex); }
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
  /// Holds it from `lock` on.
  [[nodiscard]] static Lock deferred(Mutex& mutex) noexcept { return {mutex, std::defer_lock}; }
  /// Holds it if nobody else does.
  [[nodiscard]] static Lock if_free(Mutex& mutex) { return {mutex, std::try_to_lock}; }

 private:
  using std::unique_lock<Mutex>::unique_lock;
};

#endif

}  // namespace winnow
