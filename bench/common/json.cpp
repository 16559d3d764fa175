#include "bench/common/json.h"

#include "bench/common/errors.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace winnow::bench {
namespace {

/// Returns the deepest nesting of lists and objects. The text need not be valid JSON.
std::size_t depth_of(const std::string& text) {
  std::size_t depth = 0;
  std::size_t deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') ++i;
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return deepest;
}

}  // namespace

Json read_json(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw ArgumentError(path + ": it cannot be read");
  if (const std::size_t depth = depth_of(text.str()); depth > kDeepestJson) {
    throw ArgumentError(path + ": nested " + std::to_string(depth) + " deep, and no more than " +
                        std::to_string(kDeepestJson) + " are read");
  }
  try {
    return Json::parse(text.str());
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
