#include "bench/rows/rows.h"

#include "bench/contenders/partitions.h"
#include "bench/measure/footprint.h"

#include <unistd.h>

#include <cstdio>
#include <stdexcept>

namespace winnow::bench {
namespace {

void add_held(Results& results, const Json& keys, const Held& held, const std::string& command) {
  const auto each = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(held.objects);
  };
  const auto add = [&](const char* family, Json row) {
    row.update(keys);
    row["command"] = command;
    results.add(family, std::move(row));
  };
  Json row;
  for (const Purpose& purpose : kPurposes) {
    const Bytes& bytes = held.footprint.*purpose.bytes;
    row[purpose.name] = each(bytes.reserved);
    row[std::string(purpose.name) + "_used"] = each(bytes.used);
  }
  const Bytes total = held.footprint.total();
  row["reserved"] = each(total.reserved);
  row["used"] = each(total.used);
  row["peak_first"] = each(held.peak_first);
  row["peak_later"] = each(held.peak_later);
  row["pair_buffer"] = each(held.buffer.total().reserved);
  row["exact"] = held.exact() ? "yes" : "NO";
  add("memory", std::move(row));
  add("memory_check", {{"by", "footprint()"}, {"bytes_per_object", each(total.reserved)}});
  add("memory_check", {{"by", "memory resource"}, {"bytes_per_object", each(held.outstanding)}});
  if (held.resident == 0) return;  // not reported by the system
  add("memory_check", {{"by", "resident set"}, {"bytes_per_object", each(held.resident)}});
  add("memory_ratio", {{"ratio", each(held.resident) / each(total.reserved)}});
}

void require_exact(bool exact) {
  if (!exact) throw std::runtime_error("a footprint does not equal what was allocated");
}

/// Runs this tool in a second process with a subcommand and its options, and returns what it writes
/// with --json, whatever its exit status. An interrupt from the terminal does not reach it. Throws
/// std::runtime_error if it cannot start or wrote nothing.
Json run_own(const std::string& subcommand) {
  // The shell's standard output is the pipe, which becomes the JSON file of the tool.
  const std::string command = "trap '' INT; exec /proc/" + std::to_string(::getpid()) + "/exe " +
                              subcommand + " --json /dev/fd/3 3>&1 >/dev/null";
  std::FILE* const written = ::popen(command.c_str(), "r");
  if (written == nullptr) throw std::runtime_error("cannot start this tool once more");
  std::string text;
  char part[4096];
  while (const std::size_t size = std::fread(part, 1, sizeof part, written))
    text.append(part, size);
  ::pclose(written);
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw std::runtime_error(subcommand + " wrote nothing");
  return json;
}

}  // namespace

void add_footprints(Results& results, const NamedScene& scene, const MeasureOptions& options) {
  bool exact = true;
  for (const std::string& partition :
       partitions_for(options.partitions, scene.objects(options.objects)).taken) {
    const Held held = measure_held(partition, *scene.source(options.objects, options.seed),
                                   options.threads.front());
    const Json keys{{"scene", scene.name},
                    {"objects", held.objects},
                    {"partition", held.partition},
                    {"threads", options.threads.front()}};
    add_held(results, keys, held, partition_command("dev footprint", scene, options, partition));
    exact = exact && held.exact();
  }
  require_exact(exact);
}

void add_footprints_apart(Results& results, const NamedScene& scene,
                          const MeasureOptions& options) {
  const Json rows = run_own("dev footprint" + scene.words(options.objects, options.seed) +
                            settings_text(options.threads.front()))["benchmarks"];
  results.adopt(rows);
  for (const Json& row : rows) require_exact(row.value("exact", "yes") == "yes");
}

}  // namespace winnow::bench
