#include "bench/goals/measurement_cache.h"

#include "bench/goals/measurements.h"

#include <stdexcept>
#include <vector>

namespace winnow::bench {

const Measured& MeasurementCache::measured(const Json& request) {
  const std::string text = request.dump();
  if (const auto at = measured_.find(text); at != measured_.end()) return at->second;
  const std::string name = request.begin().key();
  const Json& options = request.begin().value();
  const Measurer* measurer = find_measurer(name);
  if (measurer == nullptr) throw std::runtime_error("goals.json: nothing measures " + name);
  Measured measured;
  try {
    (*measurer)(options, *this, measured);
  } catch (const Json::exception& error) {
    throw std::runtime_error("goals.json: " + text + ": " + error.what());
  } catch (const std::exception& error) {
    measured.fault = error.what();
  }
  return measured_.emplace(text, std::move(measured)).first->second;
}

Spread MeasurementCache::machine_ms() const {
  std::vector<double> times;
  for (const auto& [request, one] : measured_) {
    if (one.machine_ms > 0.0) times.push_back(one.machine_ms);
  }
  return spread_of(times);
}

}  // namespace winnow::bench
