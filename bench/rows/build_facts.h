#pragma once

namespace winnow::bench {

// What is known when the tool is configured, and the commit whenever it is built.
extern const char* const kVersion;       ///< "0.1.0"
extern const char* const kCommit;        ///< with "+" behind it if the source was changed since
extern const char* const kBuildType;     ///< and the compiler's options
extern const char* const kDependencies;  ///< "Eigen 3.4.0, ...", as far as known
extern const char* const kPeersFound;    ///< "Bullet FCL", other libraries that were found

}  // namespace winnow::bench
