#pragma once

#include <winnow/core/status.h>
#include "core/memory/byte_stream.h"

#include <cstdint>
#include <string_view>

namespace winnow {

// Every snapshot begins with a header: eight characters for its type, the version, 4 zero bytes,
// the number of bytes that follow, and their digest.

inline constexpr std::size_t kSnapshotHeader = 32;

/// Writes a snapshot: the header, then the content that write(writer) appends. If memory is
/// refused, `out` is unchanged.
template <typename Write>
[[nodiscard]] Status write_snapshot(Column<std::byte>& out, std::string_view magic,
                                    std::uint32_t version, Write&& write) noexcept {
  const std::size_t begin = out.size();
  ByteWriter writer(out);
  writer.put_bytes(magic.data(), magic.size());
  writer.put(version);
  writer.put(std::uint32_t{0});
  writer.put(std::uint64_t{0});
  writer.put(std::uint64_t{0});
  write(writer);
  if (!writer.ok()) {
    out.set_size(begin);
    return Status::out_of_memory;
  }
  const std::span<const std::byte> content(out.data() + begin + kSnapshotHeader,
                                           out.size() - begin - kSnapshotHeader);
  Digest digest;
  digest.add(content);
  const std::uint64_t frame[2] = {content.size(), digest.value()};
  std::memcpy(out.data() + begin + 16, frame, sizeof frame);
  return Status::ok;
}

/// Returns a reader behind the header of a snapshot of this type and version; if the header is
/// wrong, the reader has failed.
[[nodiscard]] inline ByteReader open_snapshot(std::span<const std::byte> saved,
                                              std::string_view magic,
                                              std::uint32_t version) noexcept {
  ByteReader in(saved);
  char begin[8] = {};
  (void)in.get_bytes(begin, sizeof begin);
  const bool known = std::string_view(begin, sizeof begin) == magic &&
                     in.get<std::uint32_t>() == version && in.get<std::uint32_t>() == 0;
  const auto size = in.get<std::uint64_t>();
  const auto recorded = in.get<std::uint64_t>();
  Digest digest;
  digest.add(in.rest());
  if (!known || size != in.rest().size() || recorded != digest.value()) in.fail();
  return in;
}

}  // namespace winnow
