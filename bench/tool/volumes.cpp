#include "engine/fingerprint.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_volumes.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"
#include "volumes/quantised.h"
#include "volumes/volume_race.h"

#include <iostream>
#include <optional>

namespace winnow::bench {
namespace {

struct Volumes {
  VolumeSettingOptions objects_are;
  std::string recording;
  std::vector<std::string> settings;
  double step = -1.0;  // below 0: the setting's own
  std::string isa;
  std::string json;
  VolumeRaceOptions race;

  int run();
};

std::string price(const VolumeRow& row, const VolumeRow& boxes) {
  const bool saves = row.reported < boxes.reported;
  return saves ? short_number(pays_from_ns(row, boxes)) + " ns/pair" : "-";
}

void print(const std::vector<VolumeRow>& rows, std::size_t frames) {
  Table table({"volume", "reported", "overlap", "false", "make ms", "broad ms", "narrow ms",
               "sum ms", "pays from", "bytes/object"});
  for (const VolumeRow& row : rows) {
    table.add({row.volume, grouped(row.reported / frames), grouped(row.overlapping / frames),
               percent(row.false_positives()), short_number(row.make_ms()),
               short_number(row.broad_ms()), short_number(row.narrow_ms()),
               short_number(row.sum_ms()), price(row, rows.front()),
               short_number(row.bytes_per_object)});
  }
  std::cout << table << "least sum: " << best_of(rows).volume << '\n';
}

void print(const std::vector<BoxWidth>& widths) {
  Table table({"boxes", "at once", "hits", "overlap", "false", "make ms", "test ms", "bytes/box"});
  for (const BoxWidth& width : widths) {
    table.add({width.boxes, std::to_string(width.lanes), grouped(width.hits),
               grouped(width.overlapping), percent(width.false_positives()),
               short_number(median_of(width.make)), short_number(median_of(width.test)),
               short_number(width.bytes_per_box)});
  }
  std::cout << table;
}

Json to_json(const VolumeRow& row, const VolumeRow& boxes, const std::string& setting, double step,
             std::size_t objects, std::size_t frames) {
  return {{"objects_are", setting},
          {"step", step},
          {"objects", objects},
          {"volume", row.volume},
          {"reported", row.reported / frames},
          {"overlapping", row.overlapping / frames},
          {"missed", row.missed},
          {"false_positives", row.false_positives()},
          {"make_ms", row.make_ms()},
          {"broad_ms", row.broad_ms()},
          {"narrow_ms", row.narrow_ms()},
          {"sum_ms", row.sum_ms()},
          {"pays_from_ns_a_pair", pays_from_ns(row, boxes)},
          {"bytes_per_object", row.bytes_per_object},
          {"fingerprint", to_hex(row.fingerprint)}};
}

Json to_json(const BoxWidth& width, const std::string& setting, std::size_t objects) {
  return {{"objects_are", setting},
          {"objects", objects},
          {"boxes", width.boxes},
          {"lanes", width.lanes},
          {"hits", width.hits},
          {"overlapping", width.overlapping},
          {"false_positives", width.false_positives()},
          {"make_ms", median_of(width.make)},
          {"test_ms", median_of(width.test)},
          {"bytes_per_box", width.bytes_per_box}};
}

int Volumes::run() {
  choose_isa(isa);
  std::optional<Recording> file;
  if (!recording.empty()) file = read_recording(recording);
  objects_are.recording = file ? &*file : nullptr;
  Json rows_json = Json::array();
  Json widths_json = Json::array();
  bool missed = false;
  Progress progress(settings.size());
  for (const std::string& name : settings) {
    progress.step(name);
    VolumeSetting setting = make_volume_setting(name, objects_are);
    const std::size_t objects = setting.solids.size();
    VolumeRaceOptions how = race;
    how.step = step < 0.0 ? setting.step : step;
    if (step < 0.0) {
      how.frames = setting.frames(race.frames);
      how.recorded = setting.recorded;
    }
    const std::vector<BoxWidth> widths = race_widths(setting.solids.bounds(), how.frames);
    const std::vector<VolumeRow> rows = race_volumes(std::move(setting.solids), how);
    progress.clear();
    std::cout << '\n'
              << setting.what << ", " << grouped(objects) << " objects that go "
              << short_number(how.step) << " of an edge in a frame, " << race.partition
              << ", 1 thread, " << isa_name() << '\n';
    print(rows, how.frames);
    if (name != "slow") {
      std::cout << "16-bit ends against floats, rows against groups of 256:\n";
      print(widths);
    }
    for (const VolumeRow& row : rows) {
      missed = missed || row.missed != 0;
      rows_json.push_back(to_json(row, rows.front(), setting.what, how.step, objects, how.frames));
    }
    for (const BoxWidth& width : widths) {
      widths_json.push_back(to_json(width, setting.what, objects));
    }
  }
  write_json(json, {{"volumes", rows_json}, {"box_widths", widths_json}});
  if (missed) std::cerr << "winnow: a volume missed pairs that overlap\n";
  return missed ? kFailed : kDone;
}

}  // namespace

Command add_volumes(CLI::App& app) {
  auto volumes = std::make_shared<Volumes>();
  const auto names = volume_setting_names();
  const auto partitions = volume_partitions();
  volumes->settings.assign(names.begin(), names.end());
  CLI::App* sub = app.add_subcommand(
      "volumes",
      "Bounding volumes and margins side by side: false positives against what they cost, the "
      "exact test of the pairs included");
  CLI::Option* scene =
      sub->add_option("--scene", volumes->objects_are.scene, "Built-in scene for the first table")
          ->capture_default_str();
  sub->add_option("--recording", volumes->recording, "The frames of a recording instead")
      ->excludes(scene);
  sub->add_option("--setting", volumes->settings,
                  "Only these: the scene, turned cubes, turned rods, slow turned cubes")
      ->delimiter(',')
      ->check(CLI::IsMember(volumes->settings));
  sub->add_option(
         "--step", volumes->step,
         "How far objects go in a frame, in their mean edges; default: as suits each, and as "
         "recorded")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--objects", volumes->objects_are.objects, "How many")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  sub->add_option("--partition", volumes->race.partition, "Where the volumes are")
      ->check(CLI::IsMember(std::vector<std::string>(partitions.begin(), partitions.end())))
      ->capture_default_str();
  sub->add_option("--frames", volumes->race.frames, "Frames that are timed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--seed", volumes->objects_are.seed, "Of the scenes")->capture_default_str();
  sub->add_option("--isa", volumes->isa, "Instruction set");
  add_json_option(*sub, volumes->json);
  return {sub, [volumes] { return volumes->run(); }};
}

}  // namespace winnow::bench
