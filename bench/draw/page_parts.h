#pragma once

namespace winnow::bench {

// The files of draw/page, embedded so that the tool does not depend on its source folder.
extern const char* const kPageStyle;
extern const char* const kPageBody;
extern const char* const kPageScript;
/// The licence of three.js, which each page must include.
extern const char* const kThreeJsNotice;
/// The folder of three.js found at configure time, or its path on Debian.
extern const char* const kThreeJsFolder;

}  // namespace winnow::bench
