#include "bench/common/json.h"

#include "bench/common/errors.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace winnow::bench {

Json read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file || file.peek() == std::ifstream::traits_type::eof()) {
    throw ArgumentError(path + ": it cannot be read");
  }
  const auto check_depth = [&](int depth, Json::parse_event_t event, const Json&) {
    using enum Json::parse_event_t;
    const bool opens = event == array_start || event == object_start;
    if (!opens || depth < static_cast<int>(kDeepestJson)) return true;
    throw ArgumentError(path + ": nested deeper than " + std::to_string(kDeepestJson));
  };
  try {
    return Json::parse(file, check_depth);
  } catch (const Json::exception& error) {
    // Skips the error number with which the library begins its message.
    const std::string what = error.what();
    const std::size_t end = what.find("] ");
    throw ArgumentError(path + ": " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
}

void write_json(const std::string& path, const Json& value) {
  if (path.empty()) return;
  std::ofstream file(path);
  file << value.dump(1) << '\n';
  file.close();
  if (!file) throw ArgumentError("--json: cannot write " + path + ": " + std::strerror(errno));
}

}  // namespace winnow::bench
