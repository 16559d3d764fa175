#include "bench/common/other_work.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace winnow::bench {
namespace {

// Returns the seconds that all processors were busy, including time stolen by the host of a virtual
// machine.
std::optional<double> busy_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0.0;
  double nice = 0.0;
  double system = 0.0;
  double idle = 0.0;
  double waiting = 0.0;
  double interrupts = 0.0;
  double soft_interrupts = 0.0;
  double stolen = 0.0;
  file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >>
      stolen;
  const auto ticks = static_cast<double>(::sysconf(_SC_CLK_TCK));
  if (!file || name != "cpu" || !(ticks > 0.0)) return std::nullopt;
  return (user + nice + system + interrupts + soft_interrupts + stolen) / ticks;
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
