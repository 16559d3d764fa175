#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <string>
#include <utility>
#include <vector>

/// Times a program and alternatives side by side in one run. Without arguments the program runs a
/// small size, as a test; with `--race` it runs the size of its published figure.
class Race {
 public:
  Race(int argc, char** argv) : full_(argc > 1 && std::strcmp(argv[1], "--race") == 0) {}

  /// The size of a problem, in a test and in a race.
  [[nodiscard]] std::size_t size(std::size_t test, std::size_t race) const {
    return full_ ? race : test;
  }

  /// Runs the work of one frame and records its time. The first contender of a program is winnow.
  template <typename Work>
  void time(const std::string& name, Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - begin;
    of(name).milliseconds.push_back(taken.count());
  }

  /// Prints the median frame of each contender. Returns the exit status for main.
  [[nodiscard]] int finish(const std::string& what) {
    std::printf("%s\n", what.c_str());
    for (Contender& one : contenders_) {
      std::printf("  %-34s %9.3f ms a frame", one.name.c_str(), median(one));
      if (&one != &contenders_.front()) {
        const double times = median(one) / median(contenders_.front());
        std::printf("  winnow is %.2f times as fast", times);
      }
      std::printf("\n");
    }
    return EXIT_SUCCESS;
  }

 private:
  struct Contender {
    std::string name;
    std::vector<double> milliseconds;
  };

  Contender& of(const std::string& name) {
    for (Contender& one : contenders_) {
      if (one.name == name) return one;
    }
    return contenders_.emplace_back(Contender{name, {}});
  }
  [[nodiscard]] static double median(Contender& one) {
    const auto middle =
        one.milliseconds.begin() + static_cast<std::ptrdiff_t>(one.milliseconds.size() / 2);
    std::nth_element(one.milliseconds.begin(), middle, one.milliseconds.end());
    return *middle;
  }

  bool full_;
  std::deque<Contender> contenders_;
};
