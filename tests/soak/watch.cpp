#include <algorithm>
#include <bit>

#include "tests/soak/soak.h"

namespace winnow::test {

std::int64_t FrameTimes::now() const {
  timespec time{};
  clock_gettime(clock_, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void FrameTimes::end() {
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(1, now() - start_));
  const auto octave = static_cast<std::size_t>(std::bit_width(ns) - 1);
  const std::size_t within =
      octave >= 6 ? (ns >> (octave - 6)) % kSteps : (ns << (6 - octave)) % kSteps;
  ++counts_[octave * kSteps + within];
  ++frames_;
}

double FrameTimes::quantile(double share) const {
  const auto rank = static_cast<std::uint64_t>(share * static_cast<double>(frames_));
  std::uint64_t passed = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    passed += counts_[i];
    if (passed <= rank) continue;
    const double size = static_cast<double>(std::uint64_t{1} << (i / kSteps));
    return 1e-3 * size * (1.0 + static_cast<double>(i % kSteps) / kSteps);
  }
  return 0.0;
}

void MemoryWatch::look(std::uint64_t frame, std::size_t held) {
  const std::size_t bytes = memory_.outstanding() + saved_.outstanding();
  require(held == bytes, "a footprint differs from the allocated memory");
  std::size_t& peak = 2 * frame < frames_ ? tally_.first_peak : tally_.last_peak;
  peak = std::max(peak, bytes);
  if (memory_.requests() != tally_.requests) last_request_ = frame;
  tally_.requests = memory_.requests();
  tally_.frames_without_requests = frame - last_request_;
}

}  // namespace winnow::test
