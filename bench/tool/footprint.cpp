#include "engine/arena.h"
#include "engine/partition_engine.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/output.h"
#include "tool/table.h"

#include <array>
#include <iostream>
#include <numeric>

namespace winnow::bench {
namespace {

constexpr std::size_t kFrames = 5;

struct Purpose {
  const char* name;
  Bytes Footprint::*bytes;
};

constexpr std::array<Purpose, 6> kPurposes{{{"bounds", &Footprint::bounds},
                                            {"keys", &Footprint::keys},
                                            {"client_data", &Footprint::client_data},
                                            {"structure", &Footprint::structure},
                                            {"scratch", &Footprint::scratch},
                                            {"results", &Footprint::results}}};

struct Held {
  std::string partition;
  Footprint footprint;
  Footprint buffer;             // the caller's pair buffer
  std::size_t outstanding = 0;  // at the memory resource

  [[nodiscard]] bool exact() const { return footprint.total().reserved == outstanding; }
};

Held measure_held(const std::string& partition, const std::string& scene, std::size_t objects,
                  std::uint64_t seed, int threads) {
  const auto source = scene_or_error(scene, objects, seed);
  PartitionEngine engine(partition, threads);
  std::vector<std::uint32_t> rows(objects);
  std::iota(rows.begin(), rows.end(), 0U);
  Arenas(threads).run(threads, [&] {
    engine.start(source->boxes());
    for (std::size_t f = 1; f < kFrames && source->advance(); ++f) {
      engine.frame(rows, source->boxes());
    }
  });
  return {partition, engine.partition().footprint(), engine.buffer().footprint(),
          engine.memory().outstanding()};
}

Json to_json(const Held& held, const std::string& scene, std::size_t objects, int threads) {
  Json row{
      {"scene", scene}, {"objects", objects}, {"partition", held.partition}, {"threads", threads}};
  for (const Purpose& purpose : kPurposes) {
    const Bytes& bytes = held.footprint.*purpose.bytes;
    row[purpose.name] = {{"used", bytes.used}, {"reserved", bytes.reserved}};
  }
  const std::size_t bytes = held.footprint.total().reserved - held.footprint.results.reserved;
  row["bytes"] = bytes;
  row["bytes_per_object"] = static_cast<double>(bytes) / static_cast<double>(objects);
  row["pair_buffer"] = held.buffer.total().reserved;
  row["allocated"] = held.outstanding;
  row["exact"] = held.exact();
  return row;
}

void print(const std::vector<Held>& all, const std::string& scene, std::size_t objects) {
  const auto each = [objects](std::size_t bytes) {
    return short_number(static_cast<double>(bytes) / static_cast<double>(objects));
  };
  std::cout << '\n'
            << scene << ", " << grouped(objects)
            << " objects: bytes an object, used / reserved, after " << kFrames << " frames\n";
  std::vector<std::string> header{"partition"};
  for (const Purpose& purpose : kPurposes) header.emplace_back(purpose.name);
  header.insert(header.end(), {"all but results", "pair buffer", "equals allocated"});
  Table table(std::move(header));
  for (const Held& held : all) {
    std::vector<std::string> row{held.partition};
    for (const Purpose& purpose : kPurposes) {
      const Bytes& bytes = held.footprint.*purpose.bytes;
      row.push_back(each(bytes.used) + " / " + each(bytes.reserved));
    }
    row.push_back(each(held.footprint.total().reserved - held.footprint.results.reserved));
    row.push_back(each(held.buffer.total().reserved));
    row.emplace_back(held.exact() ? "yes" : "NO");
    table.add(std::move(row));
  }
  std::cout << table;
}

struct FootprintCommand {
  Choice choice;
  std::string json;

  int run();
};

int FootprintCommand::run() {
  if (choice.scenes.empty()) choice.scenes = {"uniform"};
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  if (choice.threads.empty()) choice.threads = {usual_threads().back()};
  Json rows = Json::array();
  bool exact = true;
  for (const std::size_t objects : choice.objects) {
    const Partitions partitions = partitions_for(choice.partitions, objects);
    for (const std::string& scene : choice.scenes) {
      for (const int threads : choice.threads) {
        std::vector<Held> all;
        for (const std::string& name : partitions.taken) {
          all.push_back(measure_held(name, scene, objects, choice.seed, threads));
          rows.push_back(to_json(all.back(), scene, objects, threads));
          exact = exact && all.back().exact();
        }
        print(all, scene, objects);
        std::cout << skipped_line(partitions.skipped);
      }
    }
  }
  write_json(json, rows);
  if (exact) return kDone;
  std::cerr << "winnow: a footprint does not equal what was allocated\n";
  return kFailed;
}

}  // namespace

Command add_footprint(CLI::App& app) {
  auto command = std::make_shared<FootprintCommand>();
  CLI::App* sub = app.add_subcommand(
      "footprint", "Bytes an object by purpose, checked against what was really allocated");
  add_scenes_option(*sub, command->choice);
  add_objects_option(*sub, command->choice);
  add_threads_option(*sub, command->choice);
  add_partitions_option(*sub, command->choice);
  add_seed_option(*sub, command->choice);
  add_json_option(*sub, command->json);
  return {sub, [command] { return command->run(); }};
}

}  // namespace winnow::bench
