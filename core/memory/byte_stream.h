#pragma once

// Serialisation of numbers: ByteWriter appends them, ByteReader reads them from untrusted bytes,
// Digest detects damage. Snapshots (snapshot_frame.h) and recordings use these classes.
#include <winnow/core/memory.h>
#include <winnow/core/status.h>
#include "core/memory/scattered.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

namespace winnow {

static_assert(std::endian::native == std::endian::little && std::numeric_limits<float>::is_iec559,
              "files are read and written as numbers lie in memory");

/// A checksum of all bytes and their order. It detects accidental damage, not forgery. Each step is
/// one of SplitMix64.
class Digest {
 public:
  void add(std::uint64_t value) noexcept {
    state_ = scattered((state_ ^ value) + 0x9E3779B97F4A7C15U);
  }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) noexcept { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  /// Adds eight bytes at a time, and then the number of bytes.
  void add(std::span<const std::byte> bytes) noexcept {
    std::size_t at = 0;
    for (; at + 8 <= bytes.size(); at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + at, 8);
      add(word);
    }
    std::uint64_t rest = 0;
    if (at < bytes.size()) std::memcpy(&rest, bytes.data() + at, bytes.size() - at);
    add(rest);
    add(std::uint64_t{bytes.size()});
  }
  /// Adds the bytes of an array of plain numbers.
  template <typename T>
  void add_array(std::span<const T> values) noexcept {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values));
  }

  [[nodiscard]] std::uint64_t value() const noexcept { return state_; }

 private:
  std::uint64_t state_ = 0;
};

template <typename T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Appends numbers to bytes, little-endian and without gaps. After memory was refused it writes
/// nothing more; see `ok`.
class ByteWriter {
 public:
  explicit ByteWriter(Column<std::byte>& out) noexcept : out_(out) {}

  template <PlainNumber T>
  void put(T value) noexcept {
    put_bytes(&value, sizeof value);
  }
  /// Writes a count, then the values: plain numbers, or structs of plain numbers without gaps.
  template <typename T>
  void put_array(std::span<const T> values) noexcept {
    static_assert(std::is_trivially_copyable_v<T>);
    put(std::uint64_t{values.size()});
    put_bytes(values.data(), values.size_bytes());
  }
  void put_text(std::string_view text) noexcept {
    put_array(std::span<const char>(text.data(), text.size()));
  }
  void put_bytes(const void* bytes, std::size_t count) noexcept {
    if (!ok_ || count == 0) return;
    const std::size_t at = out_.size();
    ok_ = out_.resize(at + count);
    if (ok_) std::memcpy(out_.data() + at, bytes, count);
  }

  /// Writes a byte count, then the bytes that save(column) appends to a column.
  template <typename Save>
  void put_nested(Save&& save) noexcept {
    const std::size_t at = out_.size();
    put(std::uint64_t{0});
    ok_ = ok_ && save(out_) == Status::ok;
    if (!ok_) return;
    const std::uint64_t count = out_.size() - at - sizeof(std::uint64_t);
    std::memcpy(out_.data() + at, &count, sizeof count);
  }

  /// Returns false if memory was refused.
  [[nodiscard]] bool ok() const noexcept { return ok_; }

 private:
  Column<std::byte>& out_;
  bool ok_ = true;
};

/// Reads bytes of a ByteWriter or of an untrusted source. Behind the end it reads zeros. After the
/// first error all reads fail, so callers may test `ok` once after several reads.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}

  template <PlainNumber T>
  requires(!std::is_enum_v<T> && !std::is_same_v<T, bool>) [[nodiscard]] T get() noexcept {
    T value{};
    (void)get_bytes(&value, sizeof value);
    return value;
  }
  /// Fails for bytes other than 0 and 1.
  [[nodiscard]] bool get_bool() noexcept {
    const auto byte = get<std::uint8_t>();
    if (byte > 1) fail();
    return byte == 1;
  }
  /// Reads an enumerator between the first, which is 0, and `last`.
  template <typename Enum>
  [[nodiscard]] Enum get_enum(Enum last) noexcept {
    const auto number = get<std::underlying_type_t<Enum>>();
    if (number <= static_cast<std::underlying_type_t<Enum>>(last)) return static_cast<Enum>(number);
    fail();
    return Enum{};
  }
  /// Replaces the content of a column. If the input has fewer bytes than the count needs, fails
  /// without allocating.
  template <typename T>
  [[nodiscard]] bool get_array(Column<T>& values) noexcept {
    values.clear();
    const auto count = get<std::uint64_t>();
    if (!ok_ || count > rest_.size() / sizeof(T)) return fail();
    if (!values.resize(static_cast<std::size_t>(count))) return refuse_memory();
    return get_bytes(values.data(), values.size() * sizeof(T));
  }
  /// Returns the bytes that `put_nested` or `put_text` wrote, as a part of the input.
  [[nodiscard]] std::span<const std::byte> get_nested() noexcept {
    const auto count = get<std::uint64_t>();
    if (!ok_ || count > rest_.size()) {
      fail();
      return {};
    }
    const std::span<const std::byte> nested = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(nested.size());
    return nested;
  }
  [[nodiscard]] std::string_view get_text() noexcept {
    const std::span<const std::byte> text = get_nested();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  [[nodiscard]] bool get_bytes(void* to, std::size_t count) noexcept {
    if (!ok_ || count > rest_.size()) return fail();
    if (count != 0) std::memcpy(to, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return true;
  }

  /// Makes all reads from here on fail; returns false.
  bool fail() noexcept {
    ok_ = false;
    return false;
  }
  /// As `fail`, because memory was refused.
  bool refuse_memory() noexcept {
    out_of_memory_ = true;
    return fail();
  }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  /// Returns true if the error is that memory was refused.
  [[nodiscard]] bool out_of_memory() const noexcept { return out_of_memory_; }
  [[nodiscard]] std::span<const std::byte> rest() const noexcept { return rest_; }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
  bool out_of_memory_ = false;
};

/// Returns the reason why the bytes cannot be read, or ok.
[[nodiscard]] inline Status status_of(const ByteReader& in) noexcept {
  if (in.ok()) return Status::ok;
  return in.out_of_memory() ? Status::out_of_memory : Status::invalid_argument;
}

}  // namespace winnow
