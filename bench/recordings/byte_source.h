#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace winnow::bench {

/// A file read from front to back.
class ByteSource {
 public:
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;

  /// Fills `out`; less than its size only at the end of the file. Throws RecordingError.
  virtual std::size_t read(std::span<std::byte> out) = 0;
  /// The whole size in bytes, if known before reading.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const = 0;

 protected:
  ByteSource() = default;
};

/// Opens a file; one that starts like an .xz is decompressed. Throws RecordingError.
[[nodiscard]] std::unique_ptr<ByteSource> open_bytes(const std::string& path);

/// The decompressing one; throws RecordingError if built without liblzma.
[[nodiscard]] std::unique_ptr<ByteSource> make_xz_source(std::unique_ptr<ByteSource> compressed,
                                                         const std::string& path);

}  // namespace winnow::bench
