#pragma once

namespace winnow::bench {

/// The text of report/readme.json.
extern const char* const kReadmeJson;

}  // namespace winnow::bench
