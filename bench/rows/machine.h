#pragma once

#include "bench/common/json.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

// Facts from the configuration of the tool, and the commit at the time of the build.
extern const char* const kVersion;       ///< "0.1.0"
extern const char* const kCommit;        ///< followed by "+" if the source was changed
extern const char* const kBuildType;     ///< build type and the compiler's options
extern const char* const kDependencies;  ///< "Eigen 3.4.0, ...", if the version is available
extern const char* const kPeersFound;    ///< "Bullet FCL": other libraries that were found

/// Returns the origin of a measurement: processor, cores, memory, system, compiler, build type,
/// commit, instruction sets, versions of the libraries, date, and the median of the reference sweep
/// in ms, by which machines are compared.
[[nodiscard]] Json machine_facts();

/// Returns the instruction sets that both the machine and the build support, narrowest first.
[[nodiscard]] std::vector<std::string> isa_names();

/// A library that winnow can be compared with.
struct Peer {
  std::string name;
  std::string package;  ///< Debian's package
};
/// Returns the libraries that this tool was built without.
[[nodiscard]] std::vector<Peer> missing_peers();

/// Returns whether the tool was built with at least one other library.
[[nodiscard]] bool has_peers() noexcept;

/// Returns whether the tool was built with the yardstick.
[[nodiscard]] bool has_yardstick();

/// Returns whether a key of a row names another library, installed or not ("FCL", "Bullet dbvt"),
/// or the yardstick.
[[nodiscard]] bool is_peer(std::string_view name);

}  // namespace winnow::bench
