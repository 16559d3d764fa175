#pragma once

#include <winnow/core/footprint.h>
#include "bench/scenes/frame_source.h"

#include <array>
#include <cstddef>
#include <string>

namespace winnow::bench {

/// A purpose that bytes are held for.
struct Purpose {
  const char* name;   ///< as in JSON
  const char* label;  ///< as in tables
  Bytes Footprint::*bytes;
};

inline constexpr std::array<Purpose, 6> kPurposes{
    {{"bounds", "bounds", &Footprint::bounds},
     {"keys", "keys", &Footprint::keys},
     {"client_data", "client data", &Footprint::client_data},
     {"structure", "structure", &Footprint::structure},
     {"scratch", "scratch", &Footprint::scratch},
     {"results", "results", &Footprint::results}}};

inline constexpr std::size_t kFootprintFrames = 5;

/// What a partition holds after some frames.
struct Held {
  std::string partition;
  std::size_t objects = 0;
  Footprint footprint;
  Footprint buffer;             ///< the caller's pair buffer
  std::size_t outstanding = 0;  ///< at the memory resource
  std::size_t peak_first = 0;   ///< the most that was, in the frame in which it was built
  std::size_t peak_later = 0;   ///< the same of the frames after it
  std::size_t resident = 0;     ///< by which the process's resident set shrinks without it

  [[nodiscard]] bool exact() const { return footprint.total().reserved == outstanding; }
};

/// Shows a partition the next kFootprintFrames frames of the source. `resident` is right if
/// keep_resident_set_exact was called before.
[[nodiscard]] Held measure_held(const std::string& partition, FrameSource& source, int threads);

}  // namespace winnow::bench
