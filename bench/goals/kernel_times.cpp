#include "bench/goals/kernel_times.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

namespace winnow::bench {
namespace {

/// What a shell command prints; none if it fails.
std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  std::array<char, 4096> portion{};
  while (const std::size_t count = std::fread(portion.data(), 1, portion.size(), pipe)) {
    text.append(portion.data(), count);
  }
  return ::pclose(pipe) == 0 ? std::optional(text) : std::nullopt;
}

/// For a shell, whatever the path holds.
std::string quoted(const std::string& path) {
  std::string text = "'";
  for (const char c : path) {
    if (c == '\'') {
      text += "'\\''";
    } else {
      text += c;
    }
  }
  return text + "'";
}

std::optional<KernelTimes> measured_times() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / "micro" / "winnow_micro";
  if (error || !std::filesystem::exists(program)) return std::nullopt;
  const auto text = output_of(quoted(program.string()) +
                              " --benchmark_filter=^kernel: --benchmark_format=json 2>/dev/null");
  if (!text) return std::nullopt;
  const auto report = nlohmann::json::parse(*text, nullptr, false);
  if (report.is_discarded() || !report.contains("benchmarks")) return std::nullopt;

  KernelTimes times;
  for (const nlohmann::json& row : report["benchmarks"]) {
    if (row.value("aggregate_name", "") != "median") continue;
    // "kernel: grid query/avx2/real_time"
    const std::string name = row.value("run_name", "");
    const std::size_t isa = name.find('/');
    if (isa == std::string::npos) continue;
    const std::size_t end = name.find('/', isa + 1);
    times[name.substr(0, isa)][name.substr(isa + 1, end - isa - 1)] = row.value("real_time", 0.0);
  }
  return times;
}

}  // namespace

const std::optional<KernelTimes>& kernel_times() {
  static const std::optional<KernelTimes> times = measured_times();
  return times;
}

}  // namespace winnow::bench
