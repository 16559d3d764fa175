#pragma once

#include <atomic>

namespace winnow {

#ifdef __cpp_lib_atomic_ref
template <typename T>
using AtomicRef = std::atomic_ref<T>;
#else

/// The part of std::atomic_ref that winnow uses, for standard libraries without it (libc++).
template <typename T>
class AtomicRef {
 public:
  explicit AtomicRef(T& value) noexcept : value_(&value) {}
  [[nodiscard]] T load() const noexcept { return __atomic_load_n(value_, __ATOMIC_SEQ_CST); }
  T fetch_add(T summand, std::memory_order /*order*/) const noexcept {
    return __atomic_fetch_add(value_, summand, __ATOMIC_SEQ_CST);
  }
  bool compare_exchange_weak(T& expected, T desired) const noexcept {
    return exchange(expected, desired, true);
  }
  bool compare_exchange_strong(T& expected, T desired) const noexcept {
    return exchange(expected, desired, false);
  }

 private:
  bool exchange(T& expected, T desired, bool weak) const noexcept {
    return __atomic_compare_exchange_n(value_, &expected, desired, weak, __ATOMIC_SEQ_CST,
                                       __ATOMIC_SEQ_CST);
  }

  T* value_;
};

#endif

}  // namespace winnow
