#include "tool/output.h"

#include "tool/command.h"

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

Json to_json(const Run& run, const std::string& scene, std::size_t objects) {
  Json pairs = Json::array();
  Json reported = Json::array();
  Json fingerprints = Json::array();
  for (const PairSummary& frame : run.pairs) {
    pairs.push_back(frame.pairs);
    reported.push_back(frame.reported);
    fingerprints.push_back(to_hex(frame.fingerprint));
  }
  const Spread spread = run.frame_spread();
  return {{"scene", scene},
          {"objects", objects},
          {"frames", run.frame_ms.size()},
          {"partition", run.engine},
          {"threads", run.threads},
          {"isa", to_string(run.isa)},
          {"build_ms", run.frame_ms.empty() ? 0.0 : run.frame_ms.front()},
          {"min_ms", spread.min},
          {"median_ms", spread.median},
          {"max_ms", spread.max},
          {"frame_ms", run.frame_ms},
          {"update_ms", run.update_ms},
          {"pairs", pairs},
          {"reported", reported},
          {"fingerprint", fingerprints},
          {"bytes", run.bytes},
          {"bytes_per_object", static_cast<double>(run.bytes) / static_cast<double>(objects)}};
}

}  // namespace winnow::bench
