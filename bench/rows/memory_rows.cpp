#include "bench/rows/memory_rows.h"

#include <winnow/simd/isa.h>
#include "bench/contenders/partitions.h"
#include "bench/rows/own_process.h"

#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr const char* kInexact = "a footprint does not equal what was allocated";

bool is_inexact(const Json& row) {
  return row.value("exact", "yes") != "yes";
}

void add_held(Results& results, const Json& keys, const Held& held, const std::string& command) {
  const auto each = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(held.objects);
  };
  Json row = keys;
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
  row["command"] = command;
  results.add("memory", std::move(row));
  const auto add_check = [&](const char* by, std::size_t bytes) {
    Json check = keys;
    check["by"] = by;
    check["bytes_per_object"] = each(bytes);
    check["command"] = command;
    results.add("memory_check", std::move(check));
  };
  add_check(kByFootprint, total.reserved);
  add_check(kByResource, held.outstanding);
  if (held.resident != 0) add_check(kByResident, held.resident);  // 0: not reported by the system
}

void derive_ratio(Results& results, const Json& keys, const std::string& command) {
  const auto find_check = [&](const char* by) {
    Json where = keys;
    where["by"] = by;
    return results.row("memory_check", where);
  };
  const Json* resident = find_check(kByResident);
  const Json* reserved = find_check(kByFootprint);
  if (resident == nullptr || reserved == nullptr) return;
  Json ratio = keys;
  ratio["ratio"] =
      value_of(*resident, "bytes_per_object") / value_of(*reserved, "bytes_per_object");
  ratio["command"] = command;
  results.add("memory_ratio", std::move(ratio));
}

}  // namespace

void add_footprints(Results& results, const NamedScene& scene, std::size_t objects,
                    std::uint64_t seed, const std::vector<std::string>& partitions, int threads) {
  for (const std::string& partition : partitions) {
    const Held held = measure_held(partition, *scene.source(objects, seed), threads);
    const Json keys{{"scene", scene.name},
                    {"objects", held.objects},
                    {"partition", held.partition},
                    {"threads", threads}};
    const std::string command = "bench/run dev footprint" + scene.words(objects, seed) +
                                " --threads " + std::to_string(threads) + " --isa " + isa_name() +
                                " --partition " + partition;
    add_held(results, keys, held, command);
    derive_ratio(results, keys, command);
  }
  const auto rows = results.rows("memory", {{"scene", scene.name}});
  if (std::any_of(rows.begin(), rows.end(), [](const Json* row) { return is_inexact(*row); })) {
    throw std::runtime_error(kInexact);
  }
}

void add_footprints_apart(Results& results, const NamedScene& scene, std::size_t objects,
                          std::uint64_t seed, int threads) {
  std::vector<std::string> arguments{"dev",          "footprint", "--scene",
                                     scene.argument, "--threads", std::to_string(threads),
                                     "--isa",        isa_name()};
  if (!scene.is_recording()) {
    arguments.insert(arguments.end(),
                     {"--objects", std::to_string(objects), "--seed", std::to_string(seed)});
  }
  const Json rows = run_own(arguments)["benchmarks"];
  results.adopt(rows);
  if (std::any_of(rows.begin(), rows.end(), is_inexact)) throw std::runtime_error(kInexact);
}

}  // namespace winnow::bench
