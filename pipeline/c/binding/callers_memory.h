#pragma once

#include "core/memory/new_in.h"

#include <winnow/c/core.h>
#include <winnow/core/memory.h>

#include <memory_resource>
#include <utility>

namespace winnow::c {

/// Memory resource that calls the functions of a winnow_memory. If none is given, it uses the
/// default memory.
class CallersMemory final : public std::pmr::memory_resource {
 public:
  explicit CallersMemory(const winnow_memory* given) noexcept {
    if (given != nullptr) functions_ = *given;
  }
  /// True for null and for a struct with both functions.
  [[nodiscard]] static bool is_good(const winnow_memory* given) noexcept {
    return given == nullptr || (given->allocate != nullptr && given->deallocate != nullptr);
  }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  winnow_memory functions_{};
  std::pmr::memory_resource* fallback_ = default_memory();
};

/// Base of all handles of the C interface: a copy of the memory from which the handle and all its
/// content are allocated.
struct Handle {
  explicit Handle(const CallersMemory& given) noexcept : memory(given) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  CallersMemory memory;
};

/// Returns the options with their memory set.
template <typename Options>
[[nodiscard]] Options in(Options options, CallersMemory* memory) noexcept {
  options.memory = memory;
  return options;
}

}  // namespace winnow::c
