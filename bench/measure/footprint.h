#pragma once

#include <winnow/core/memory.h>
#include "bench/scenes/frame_source.h"

#include <array>
#include <cstddef>
#include <string>

namespace winnow::bench {

/// A member of Footprint, which counts the bytes allocated for one purpose.
struct Purpose {
  const char* name;  ///< in JSON
  Bytes Footprint::*bytes;
};

inline constexpr std::array<Purpose, 6> kPurposes{{{"bounds", &Footprint::bounds},
                                                   {"keys", &Footprint::keys},
                                                   {"client_data", &Footprint::client_data},
                                                   {"structure", &Footprint::structure},
                                                   {"scratch", &Footprint::scratch},
                                                   {"results", &Footprint::results}}};

inline constexpr std::size_t kFootprintFrames = 5;

/// Memory of a partition after some frames.
struct Held {
  std::string partition;
  std::size_t objects = 0;
  Footprint footprint;
  Footprint buffer;             ///< the caller's pair buffer
  std::size_t outstanding = 0;  ///< according to the memory resource
  std::size_t peak_first = 0;   ///< greatest `outstanding` in the frame in which it was built
  std::size_t peak_later = 0;   ///< greatest `outstanding` in the later frames
  std::size_t resident = 0;  ///< decrease of the process's resident set when the partition is freed

  [[nodiscard]] bool exact() const { return footprint.total().reserved == outstanding; }
};

/// Makes the resident set of the process follow its allocations page by page: large blocks get
/// pages of their own, which are returned to the system when freed, and huge pages are disabled.
/// Slows allocations down, so it must not be used in a process that times something afterwards.
void keep_resident_set_exact();

/// Runs the next kFootprintFrames frames of the source on a partition. `resident` is valid only if
/// keep_resident_set_exact was called before.
[[nodiscard]] Held measure_held(const std::string& partition, FrameSource& source, int threads);

}  // namespace winnow::bench
