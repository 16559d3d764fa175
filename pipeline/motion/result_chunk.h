#pragma once

#include <winnow/core/memory.h>
#include <winnow/pipeline/deformable_mesh.h>

#include <cstddef>
#include <memory_resource>

namespace winnow {

/// Collects results and passes them to the caller whenever a chunk is full.
template <typename Result>
class ResultChunk {
 public:
  ResultChunk(std::pmr::memory_resource* memory, ResultChunks<Result> chunks) noexcept
      : results_(memory), chunks_(chunks) {}
  [[nodiscard]] bool reserve(std::size_t most) noexcept {
    most_ = most;
    return results_.reserve(most);
  }
  void add(const Result& result) noexcept {
    if (results_.size() == most_) flush();
    static_cast<void>(results_.push_back(result));
  }
  void flush() noexcept {
    if (!results_.empty()) chunks_.take(chunks_.context, {results_.data(), results_.size()});
    results_.clear();
  }

 private:
  Column<Result> results_;
  ResultChunks<Result> chunks_;
  std::size_t most_ = 0;
};

}  // namespace winnow
