#pragma once

#include "bench/common/json.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Where and from what a measurement comes: processor, cores, memory, system, compiler, build type,
/// commit, instruction sets, versions of the libraries, date, and the median of the reference sweep
/// in ms, by which machines are compared.
[[nodiscard]] Json machine_facts();

/// The median of the reference sweep in ms.
[[nodiscard]] double reference_sweep_ms();

/// All that the machine and the build have, narrowest first.
[[nodiscard]] std::vector<std::string> isa_names();

/// A library that winnow can be measured against but was not built with.
struct MissingPeer {
  std::string name;
  std::string package;  ///< of Debian
};
[[nodiscard]] std::vector<MissingPeer> missing_peers();

/// Whether it was built with any of them.
[[nodiscard]] bool has_peers() noexcept;

/// Whether it was built with the yardstick.
[[nodiscard]] bool has_yardstick();

/// Whether a key of a row names one of them, installed or not: "FCL", "Bullet dbvt"; or the
/// yardstick.
[[nodiscard]] bool is_peer(std::string_view name);

}  // namespace winnow::bench
