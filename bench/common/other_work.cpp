#include "bench/common/other_work.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>
#include <string>

namespace winnow::bench {
namespace {

// Returns the seconds that all processors were busy, including time stolen by the host of a virtual
// machine.
std::optional<double> busy_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  // user, nice, system, idle, waiting, interrupts, soft interrupts, stolen
  std::array<double, 8> times{};
  file >> name;
  for (double& time : times) file >> time;
  const auto ticks = static_cast<double>(::sysconf(_SC_CLK_TCK));
  if (!file || name != "cpu" || !(ticks > 0.0)) return std::nullopt;
  return (std::accumulate(times.begin(), times.end(), 0.0) - times[3] - times[4]) / ticks;
}

double own_seconds() noexcept {
  double sum = 0.0;
  for (const int scope : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    if (::getrusage(scope, &usage) != 0) continue;
    for (const timeval& part : {usage.ru_utime, usage.ru_stime}) {
      sum += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
    }
  }
  return sum;
}

}  // namespace

OtherWork::OtherWork() : busy_before_(busy_seconds()), own_before_(own_seconds()) {}

std::optional<double> OtherWork::cores() const {
  const std::optional<double> busy = busy_seconds();
  const double seconds = clock_.ms() / 1000.0;
  if (!busy || !busy_before_ || !(seconds > 0.0)) return std::nullopt;
  const double others = *busy - *busy_before_ - (own_seconds() - own_before_);
  return std::max(0.0, others / seconds);
}

}  // namespace winnow::bench
