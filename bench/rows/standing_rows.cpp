#include "bench/rows/standing_rows.h"

#include <winnow/simd/isa.h>
#include "bench/common/table.h"
#include "bench/measure/fingerprint.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Simulated seconds before the drift is measured: until then the contact springs are compressed
/// by the weight.
constexpr double kSettling = 1.0;

std::string command_of(const StandingRowOptions& row_options) {
  return "bench/run simulate --standing " + name_of(row_options.scene) + " --seconds " +
         short_number(row_options.seconds) + " --threads " + std::to_string(row_options.threads) +
         " --isa " + isa_name();
}

}  // namespace

bool add_standing(Results& results, const StandingRowOptions& row_options) {
  StandingOptions options;
  options.contact_reduction = row_options.reduced;
  options.execution = row_options.threads == 1 ? Execution::serial() : Execution::parallel();
  Standing standing(row_options.scene, options);
  while (standing.time() < std::min(kSettling, row_options.seconds)) standing.step();
  const double settled = standing.drift();
  standing.mark();
  double kept = 1.0;
  while (standing.time() < row_options.seconds) {
    standing.step();
    kept = std::min(kept, standing.kept_points());
  }
  results.add("standing", {{"structure", name_of(row_options.scene)},
                           {"manifolds", row_options.reduced ? "one a region" : "of all parts"},
                           {"seconds", row_options.seconds},
                           {"bodies", standing.bodies()},
                           {"points", standing.contacts().points()},
                           {"settled", settled},
                           {"drift", standing.drift()},
                           {"tilt", standing.tilt()},
                           {"deepest", standing.deepest()},
                           {"kept", kept},
                           {"islands", standing.islands()},
                           {"colours", standing.colours()},
                           {"fingerprint", to_hex(standing.fingerprint())},
                           {"command", command_of(row_options)}});
  return standing.drift() < kStandingDrift;
}

std::vector<std::string> standing_names() {
  std::vector<std::string> names;
  for (const StandingScene scene : kStandingScenes) names.push_back(name_of(scene));
  return names;
}

StandingScene standing_named(const std::string& name) {
  for (const StandingScene scene : kStandingScenes) {
    if (name == name_of(scene)) return scene;
  }
  throw std::invalid_argument("no structure " + name);
}

}  // namespace winnow::bench
