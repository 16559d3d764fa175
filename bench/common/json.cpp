#include "bench/common/json.h"

#include "bench/common/errors.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace winnow::bench {

void write_json(const std::string& path, const Json& value) {
  if (path.empty()) return;
  std::ofstream file(path);
  file << value.dump(1) << '\n';
  file.close();
  if (!file) throw ArgumentError("--json: cannot write " + path + ": " + std::strerror(errno));
}

}  // namespace winnow::bench
