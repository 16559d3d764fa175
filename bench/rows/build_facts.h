#pragma once

namespace winnow::bench {

// Facts from the configuration of the tool, and the commit at the time of the build.
extern const char* const kVersion;       ///< "0.1.0"
extern const char* const kCommit;        ///< followed by "+" if the source was changed
extern const char* const kBuildType;     ///< build type and the compiler's options
extern const char* const kDependencies;  ///< "Eigen 3.4.0, ...", if the version is available
extern const char* const kPeersFound;    ///< "Bullet FCL": other libraries that were found

}  // namespace winnow::bench
