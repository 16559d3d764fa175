#include "engine/key_costs.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <winnow/partitions/partition.h>

#include <iostream>

namespace winnow::bench {
namespace {

struct Keys {
  Choice choice;
  std::string json;

  int run();
};

int Keys::run() {
  if (choice.objects.empty()) choice.objects = {1'000, 10'000, 100'000, 1'000'000};
  std::vector<std::string> partitions = choice.partitions;
  if (partitions.front() == "all") {
    // No pairs are asked for, so the number of objects keeps none away.
    partitions.assign(partition_names().begin(), partition_names().end());
  }
  std::vector<std::string> header{"partition", "objects", "key order"};
  for (const std::string_view operation : kKeyOperations) {
    for (const std::string_view mode : kKeyModes) {
      header.push_back(std::string(operation) + " " + std::string(mode));
    }
  }
  Table table(std::move(header));
  Json rows = Json::array();
  Progress progress(partitions.size() * choice.objects.size() * 2);
  for (const std::string& partition : partitions) {
    for (const std::size_t objects : choice.objects) {
      for (const bool random : {false, true}) {
        const std::string order = random ? "random" : "insertion";
        progress.step(partition + ", " + grouped(objects) + " objects, " + order + " order");
        const KeyCosts costs = measure_key_costs(partition, objects, random);
        std::vector<std::string> row{partition, grouped(objects), order};
        Json json_row{{"partition", partition}, {"objects", objects}, {"order", order}};
        for (std::size_t op = 0; op < kKeyOperations.size(); ++op) {
          for (std::size_t mode = 0; mode < kKeyModes.size(); ++mode) {
            row.push_back(short_number(costs.ns[op][mode]));
            json_row[std::string(kKeyOperations[op]) + "_" + std::string(kKeyModes[mode]) + "_ns"] =
                costs.ns[op][mode];
          }
        }
        table.add(std::move(row));
        rows.push_back(std::move(json_row));
      }
    }
  }
  progress.clear();
  std::cout << "nanoseconds an object\n" << table;
  write_json(json, rows);
  return kDone;
}

}  // namespace

Command add_keys(CLI::App& app) {
  auto keys = std::make_shared<Keys>();
  CLI::App* sub = app.add_subcommand(
      "keys", "What inserting, updating and removing an object costs, in bulk and singly");
  add_objects_option(*sub, keys->choice);
  add_partitions_option(*sub, keys->choice);
  add_json_option(*sub, keys->json);
  return {sub, [keys] { return keys->run(); }};
}

}  // namespace winnow::bench
