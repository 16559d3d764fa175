#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_footprint.h"
#include "tool/resident_set.h"
#include "tool/table.h"
#include "tool/target.h"

#include <algorithm>
#include <iostream>

namespace winnow::bench {
namespace {

void print(const std::vector<Held>& all, const std::string& scene) {
  const std::size_t objects = all.front().objects;
  const auto each = [objects](std::size_t bytes) {
    return short_number(static_cast<double>(bytes) / static_cast<double>(objects));
  };
  std::cout << '\n'
            << scene << ", " << grouped(objects)
            << " objects: bytes an object, used / reserved, after " << kFootprintFrames
            << " frames\n";
  std::vector<std::string> header{"partition"};
  for (const Purpose& purpose : kPurposes) header.emplace_back(purpose.label);
  header.insert(header.end(), {"all but results", "pair buffer", "equals allocated", "resident",
                               "peak, first frame", "peak, later"});
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
    row.push_back(held.resident != 0 ? each(held.resident) : "-");
    row.push_back(each(held.peak_first));
    row.push_back(each(held.peak_later));
    table.add(std::move(row));
  }
  std::cout << table;
}

struct FootprintCommand {
  Choice choice;
  std::string json;

  int run();

 private:
  [[nodiscard]] bool measure_all(const Target& target, int threads, Json& rows) const;
};

/// True if every footprint equals what was allocated.
bool FootprintCommand::measure_all(const Target& target, int threads, Json& rows) const {
  const auto first = target.source();
  const Partitions partitions = partitions_for(choice.partitions, first->boxes().size());
  std::vector<Held> all;
  for (const std::string& name : partitions.taken) {
    all.push_back(measure_held(name, *target.source(), threads));
    rows.push_back(to_json(all.back(), first->name(), threads));
  }
  if (!all.empty()) print(all, first->name());
  std::cout << skipped_line(partitions.skipped);
  return std::all_of(all.begin(), all.end(), [](const Held& held) { return held.exact(); });
}

int FootprintCommand::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = {"uniform"};
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  if (choice.threads.empty()) choice.threads = {usual_threads().back()};
  std::vector<Target> targets = open_targets(choice.scenes);
  Json rows = Json::array();
  bool exact = true;
  keep_resident_set_exact();
  for (const std::size_t objects : choice.objects) {
    for (Target& target : targets) {
      if (target.recording() != nullptr && objects != choice.objects.front()) continue;
      if (target.recording() == nullptr) {
        target.objects = objects;
        target.seed = choice.seed;
      }
      for (const int threads : choice.threads) exact = measure_all(target, threads, rows) && exact;
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
      "footprint",
      "Bytes an object by purpose, checked against what was really allocated and against the "
      "process's resident set");
  add_targets_option(*sub, command->choice);
  add_objects_option(*sub, command->choice);
  add_threads_option(*sub, command->choice);
  add_partitions_option(*sub, command->choice);
  add_isa_option(*sub, command->choice);
  add_seed_option(*sub, command->choice);
  add_json_option(*sub, command->json);
  return {sub, [command] { return command->run(); }};
}

}  // namespace winnow::bench
