#pragma once

#include "tests/c/trace.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace winnow::test {

/// The noted values, in order.
class Notes {
 public:
  Notes() = default;
  Notes(const Notes&) = delete;
  Notes& operator=(const Notes&) = delete;

  [[nodiscard]] const trace* where() const noexcept { return &trace_; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::uint64_t>>& all() const noexcept {
    return notes_;
  }

 private:
  std::vector<std::pair<std::string, std::uint64_t>> notes_;
  trace trace_{&notes_, [](void* notes, const char* what, std::uint64_t value) {
                 static_cast<decltype(notes_)*>(notes)->emplace_back(what, value);
               }};
};

// The scenarios of the C files, run through the C++ interface.
void run_partitions_in_cpp(const trace* t);
void run_volumes_in_cpp(const trace* t);
void run_shapes_in_cpp(const trace* t);
void run_narrow_phase_in_cpp(const trace* t);
void run_scenes_in_cpp(const trace* t);
void run_watchers_in_cpp(const trace* t);
void run_impacts_in_cpp(const trace* t);

}  // namespace winnow::test
