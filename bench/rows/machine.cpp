#include "bench/rows/machine.h"

#include <winnow/simd/isa.h>
#include "bench/contenders/reference_sweep.h"
#include "bench/peers/peers.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace winnow::bench {
namespace {

/// Returns the value of `name` in a file of lines "name : value" or "name=value".
std::string line_of(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(name)) continue;
    const std::size_t at = line.find_first_of(":=");
    if (at == std::string::npos) continue;
    const std::size_t from = line.find_first_not_of(" \t\"", at + 1);
    if (from == std::string::npos) continue;
    return line.substr(from, line.find_last_not_of(" \"") + 1 - from);
  }
  return "unknown";
}

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

std::string system_name() {
  utsname name{};
  if (uname(&name) != 0) return "unknown";
  return line_of("/etc/os-release", "PRETTY_NAME") + ", " + name.sysname + " " + name.release;
}

const Peer kPeers[] = {{"Bullet", "libbullet-dev"}, {"FCL", "libfcl-dev"},
                       {"CGAL", "libcgal-dev"},     {"Embree", "libembree-dev"},
                       {"ODE", "libode-dev"},       {"libccd", "libccd-dev"}};

}  // namespace

Json machine_facts() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const double gigabytes =
      static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e9;
  return {{"date", date_now()},
          {"executable", "winnow"},
          {"num_cpus", std::thread::hardware_concurrency()},
          {"machine", line_of("/proc/cpuinfo", "model name")},
          {"memory_GB", static_cast<int>(gigabytes + 0.5)},
          {"system", system_name()},
          {"compiler",
#ifdef __clang__
           "clang " __clang_version__
#else
           "g++ " __VERSION__
#endif
          },
          {"build", kBuildType},
          {"libraries", kDependencies},
          {"commit", kCommit},
          {"isa", isa_name()},
          {"isas", isa_names()},
          {"reference_sweep_ms", reference_sweep_ms()}};
}

std::vector<std::string> isa_names() {
  std::vector<std::string> names;
  for (const Isa isa : available_isas()) names.emplace_back(to_string(isa));
  return names;
}

std::vector<Peer> missing_peers() {
  const std::string found = std::string(" ") + kPeersFound + " ";
  std::vector<Peer> missing(std::begin(kPeers), std::end(kPeers));
  std::erase_if(missing, [&](const Peer& peer) {
    return found.find(" " + peer.name + " ") != std::string::npos;
  });
  return missing;
}

bool has_peers() noexcept {
  return *kPeersFound != '\0';
}

bool has_yardstick() {
  return make_yardstick(1) != nullptr;
}

bool is_peer(std::string_view name) {
  return name == kYardstickName ||
         std::ranges::any_of(kPeers, [&](const Peer& peer) { return name.starts_with(peer.name); });
}

}  // namespace winnow::bench
