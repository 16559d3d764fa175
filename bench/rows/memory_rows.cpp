#include "bench/rows/memory_rows.h"

#include <winnow/simd/isa.h>
#include "bench/contenders/partitions.h"
#include "bench/rows/own_process.h"

#include <stdexcept>

namespace winnow::bench {
namespace {

void require_exact(const Results& results, const NamedScene& scene) {
  if (!results.rows("memory", {{"scene", scene.name}, {"exact", "NO"}}).empty()) {
    throw std::runtime_error("a footprint does not equal what was allocated");
  }
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
  ratio["from"] =
      derived("ratio", "ratio", "bytes_per_object",
              {(*resident)["id"].get<std::string>(), (*reserved)["id"].get<std::string>()});
  ratio["command"] = command;
  results.add("memory_ratio", std::move(ratio));
}

}  // namespace

void declare_memory(Results& results) {
  std::vector<ValueColumn> values;
  for (const Purpose& purpose : kPurposes) {
    values.push_back({purpose.name, purpose.label, "bytes/object"});
  }
  values.push_back({"reserved", "reserved", "bytes/object", Better::less});
  values.push_back({"peak_first", "peak of the first frame", "bytes/object", Better::less});
  values.push_back({"peak_later", "peak of a later frame", "bytes/object", Better::less});
  for (const Purpose& purpose : kPurposes) {
    const std::string name = purpose.name;
    values.push_back({name + "_used", std::string(purpose.label) + ", used", "bytes/object"});
  }
  values.push_back({"used", "used", "bytes/object"});
  values.push_back({"pair_buffer", "the caller's pairs", "bytes/object"});
  values.push_back({"exact", "equals what was allocated", "", Better::neither, Format::text});
  results.declare({"memory",
                   "memory",
                   "bytes an object by purpose",
                   {"scene", "objects", "partition", "threads"},
                   std::move(values)});
  results.declare({"memory_check",
                   "memory",
                   "the whole partition, measured in three ways",
                   {"scene", "objects", "partition", "threads", "by"},
                   {{"bytes_per_object", "memory", "bytes/object"}}});
  results.declare({"memory_ratio",
                   "memory",
                   "resident memory over the reserved memory that footprint() returns",
                   {"scene", "objects", "partition", "threads"},
                   {{"ratio", "resident / reserved", "times"}}});
}

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
  require_exact(results, scene);
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
  for (Json row : run_own(arguments)) {
    const std::string id = row["id"];
    const std::string table = id.substr(0, id.find('/'));
    // Rows of the other process contain its name of the scene, which may differ. The ratio, which
    // refers to ids of such rows, is derived again below.
    if (table == "memory_ratio") continue;
    row.erase("id");
    row["scene"] = scene.name;
    results.add(table, row);
    if (table != "memory_check" || row["by"] != kByResident) continue;
    const std::string command = row["command"];
    for (const char* member : {"by", "bytes_per_object", "command"}) row.erase(member);
    derive_ratio(results, row, command);
  }
  require_exact(results, scene);
}

}  // namespace winnow::bench
