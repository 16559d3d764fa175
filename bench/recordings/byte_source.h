#pragma once

#include "bench/common/interface.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace winnow::bench {

/// A file read from front to back.
class ByteSource : public Interface {
 public:
  /// Fills `out` and returns the number of bytes, less than its size only at the end of the file.
  /// Throws RecordingError.
  virtual std::size_t read(std::span<std::byte> out) = 0;
  /// Returns the whole size in bytes, if it is available before reading.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const = 0;
};

/// Opens a file and decompresses it if it has the magic bytes of xz. Throws RecordingError.
[[nodiscard]] std::unique_ptr<ByteSource> open_bytes(const std::string& path);

/// Wraps a source of xz data. Throws RecordingError if built without liblzma.
[[nodiscard]] std::unique_ptr<ByteSource> make_xz_source(std::unique_ptr<ByteSource> compressed,
                                                         const std::string& path);

}  // namespace winnow::bench
