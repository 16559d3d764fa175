#pragma once

namespace winnow::bench {

// The files of draw/page, compiled in so that the tool can be moved.
extern const char* const kPageStyle;
extern const char* const kPageBody;
extern const char* const kPageScript;
/// The licence of three.js, which goes with every copy.
extern const char* const kThreeJsNotice;
/// Where the library was found when the tool was configured, or where Debian would put it.
extern const char* const kThreeJsFolder;

}  // namespace winnow::bench
