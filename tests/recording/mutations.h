#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <new>
#include <span>
#include <vector>

#include "core/memory/byte_stream.h"
#include "tests/support/random.h"

namespace winnow::test {

/// Refuses requests that would bring the bytes in use above a limit.
class LimitedMemory final : public std::pmr::memory_resource {
 public:
  explicit LimitedMemory(std::size_t most) : left_(most) {}

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes > left_) throw std::bad_alloc();
    left_ -= bytes;
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* at, std::size_t bytes, std::size_t alignment) override {
    left_ += bytes;
    std::pmr::new_delete_resource()->deallocate(at, bytes, alignment);
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::size_t left_;
};

/// Writes the correct digest into every complete block of a recording.
inline void seal(std::vector<std::byte>& bytes) {
  std::size_t at = 16;
  while (bytes.size() >= at + 16) {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + at, sizeof size);
    if (size == 0 || size > bytes.size() - at - 16) return;
    Digest digest;
    digest.add(std::span<const std::byte>(bytes).subspan(at + 16, static_cast<std::size_t>(size)));
    const std::uint64_t value = digest.value();
    std::memcpy(bytes.data() + at + 8, &value, sizeof value);
    at += 16 + size;
  }
}

/// As above, for a snapshot; also writes its size.
inline void seal_snapshot(std::vector<std::byte>& bytes) {
  if (bytes.size() < 32) return;
  Digest digest;
  digest.add(std::span<const std::byte>(bytes).subspan(32));
  const std::uint64_t frame[2] = {bytes.size() - 32, digest.value()};
  std::memcpy(bytes.data() + 16, frame, sizeof frame);
}

/// Changes some bytes, a number of four or eight bytes, or the length.
inline void mutate(std::vector<std::byte>& bytes, Random& random) {
  const std::size_t changes = 1 + random.below(3);
  for (std::size_t i = 0; i < changes && bytes.size() > 8; ++i) {
    const std::size_t at = random.below(bytes.size() - 8);
    switch (random.below(6)) {
      case 0:
        bytes[at] = static_cast<std::byte>(random.below(256));
        break;
      case 1:
        bytes[at] ^= static_cast<std::byte>(1U << random.below(8));
        break;
      case 2: {
        constexpr std::uint32_t kNumbers[] = {0,          1,          0xFFFFFFFF, 0x7FFFFFFF,
                                              0x7FC00000, 0x7F800000, 0x80000000, 65536};
        const std::uint32_t number = kNumbers[random.below(8)];
        std::memcpy(bytes.data() + at, &number, sizeof number);
        break;
      }
      case 3: {
        const std::uint64_t number = std::uint64_t{1} << random.below(64);
        std::memcpy(bytes.data() + at, &number, sizeof number);
        break;
      }
      case 4: {
        const std::size_t from = random.below(bytes.size() - 8);
        std::memmove(bytes.data() + at, bytes.data() + from, 8);
        break;
      }
      default:
        if (random.below(8) == 0) bytes.resize(at);
        break;
    }
  }
}

}  // namespace winnow::test
