#pragma once

#include <winnow/core/key.h>
#include <winnow/core/vec3.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow {

/// Corners of few of many objects, found by their ids: a bit of each object tells whether it has
/// one, and how many bits before it are set, where it lies.
class CornersById {
 public:
  /// Forgets all, for ids below `ids`.
  void begin(std::size_t ids) {
    words_.assign((ids + 63) / 64, Word{});
    corners_.clear();
  }
  /// Ids ascend.
  void put(ObjectId id, const Vec3f& corner) {
    Word& word = words_[id / 64];
    if (word.bits == 0) word.before = static_cast<std::uint32_t>(corners_.size());
    word.bits |= std::uint64_t{1} << id % 64;
    corners_.push_back(corner);
  }

  /// Of one that is there.
  [[nodiscard]] const Vec3f& of(ObjectId id) const noexcept {
    const Word& word = words_[id / 64];
    const std::uint64_t below = word.bits & ((std::uint64_t{1} << id % 64) - 1);
    return corners_[word.before + static_cast<std::size_t>(std::popcount(below))];
  }

 private:
  struct Word {
    std::uint64_t bits = 0;
    std::uint32_t before = 0;
  };

  std::vector<Word> words_;
  std::vector<Vec3f> corners_;
};

}  // namespace winnow
