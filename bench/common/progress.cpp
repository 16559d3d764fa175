#include "bench/common/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace winnow::bench {

void Progress::step(const std::string& what) {
  char text[256];
  std::snprintf(text, sizeof text, "[%zu/%zu, %.0f s] %s", done_ + 1, std::max(steps_, done_ + 1),
                clock_.ms() / 1000.0, what.c_str());
  ++done_;
  const std::string line = text;
  if (::isatty(STDERR_FILENO) != 0) {
    const std::size_t blanks = width_ > line.size() ? width_ - line.size() : 0;
    std::fprintf(stderr, "\r%s%*s", line.c_str(), static_cast<int>(blanks), "");
  } else {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
  std::fflush(stderr);
  width_ = line.size();
}

void Progress::clear() {
  if (::isatty(STDERR_FILENO) != 0 && width_ != 0) {
    std::fprintf(stderr, "\r%*s\r", static_cast<int>(width_), "");
    std::fflush(stderr);
  }
  width_ = 0;
}

}  // namespace winnow::bench
