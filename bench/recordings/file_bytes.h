#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// Returns the contents of a file, or of a pipe, decompressed if they are xz data. Throws
/// RecordingError, also for xz data if built without liblzma.
[[nodiscard]] std::vector<std::byte> read_bytes(const std::string& path);

}  // namespace winnow::bench
