#include "report/sections/volumes.h"
#include "engine/fingerprint.h"
#include "report/scene_words.h"
#include "report/section.h"
#include "tool/arguments.h"
#include "tool/measure_volumes.h"
#include "volumes/quantised.h"
#include "volumes/volume_race.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Ways of objects in a frame, in edges, at which margins are compared.
constexpr double kMarginSteps[] = {0.001, 0.003, 0.01, 0.03, 0.1};

std::vector<ValueColumn> volume_values() {
  return {{"reported", "reported pairs", "a frame", Better::less, Format::count},
          {"overlapping", "of them overlap", "a frame", Better::neither, Format::count},
          {"missed", "missed pairs", "", Better::less, Format::count},
          {"false_positives", "false positives", "", Better::less, Format::percent},
          {"make_ms", "making the volumes", "ms", Better::less},
          {"broad_ms", "broad phase", "ms", Better::less},
          {"narrow_ms", "exact test", "ms", Better::less},
          {"found_ms", "making and broad phase", "ms", Better::less},
          {"sum_ms", "all three", "ms", Better::less},
          {"pays_from_ns", "pays if a test costs", "ns", Better::less},
          {"bytes_per_object", "memory", "bytes/object", Better::less},
          {"frames", "frames", "", Better::neither, Format::count},
          {"fingerprint", "overlapping pairs", "", Better::neither, Format::text}};
}

void declare_volumes(Results& results) {
  results.declare({"volumes",
                   "volumes",
                   "a frame with volumes of one kind",
                   {"objects_are", "objects", "step", "partition", "volume"},
                   volume_values()});
  results.declare({"margins",
                   "volumes",
                   "a frame of rotated cubes with a margin about their boxes",
                   {"objects", "step", "partition", "volume"},
                   volume_values()});
  results.declare({"box_widths",
                   "volumes",
                   "tests of boxes in float and in 16 bits",
                   {"objects_are", "objects", "boxes"},
                   {{"lanes", "tested at once", "", Better::neither, Format::count},
                    {"hits", "hits", "", Better::less, Format::count},
                    {"overlapping", "of them overlap", "", Better::neither, Format::count},
                    {"false_positives", "false positives", "", Better::less, Format::percent},
                    {"make_ms", "making", "ms", Better::less},
                    {"test_ms", "testing", "ms", Better::less},
                    {"bytes_per_box", "memory", "bytes/box", Better::less}}});
}

/// What one step measures.
struct VolumesCell {
  ReportOptions options{};
  std::string setting{};
  ReportScene scene{};
  std::size_t objects = 0;
  std::string partition = kVolumesPartition;
  double step = -1.0;  ///< below 0: the setting's own
  std::string table = "volumes";
  bool with_widths = false;

  [[nodiscard]] std::size_t frames() const { return options.quick ? 2 : volume_frames(objects); }
  void measure(Results& results) const;
  [[nodiscard]] std::string command(double taken_step) const;
};

std::string VolumesCell::command(double taken_step) const {
  std::string text = "bench/run volumes --setting " + setting;
  if (setting == "scene") {
    text += (scene.recording ? " --recording " : " --scene ") + shell_word(scene.argument);
  }
  if (setting != "scene" || !scene.recording) text += " --objects " + std::to_string(objects);
  if (setting != "scene" || !scene.recording) text += " --step " + key_text(taken_step);
  return text + " --partition " + partition + " --frames " + std::to_string(frames()) + " --seed " +
         std::to_string(options.seed) + " --isa " + isa_name();
}

Json volume_row_of(const VolumeRow& row, const VolumeRow& boxes) {
  const std::size_t frames = row.broad.size();
  Json values{{"volume", row.volume},
              {"reported", row.reported / frames},
              {"overlapping", row.overlapping / frames},
              {"missed", row.missed},
              {"false_positives", row.false_positives()},
              {"make_ms", to_value(row.make)},
              {"broad_ms", to_value(row.broad)},
              {"narrow_ms", to_value(row.narrow)},
              {"found_ms", to_value(row.found())},
              {"sum_ms", to_value(row.answered())},
              {"bytes_per_object", row.bytes_per_object},
              {"frames", frames},
              {"fingerprint", to_hex(row.fingerprint)}};
  if (row.reported < boxes.reported) values["pays_from_ns"] = pays_from_ns(row, boxes);
  return values;
}

void VolumesCell::measure(Results& results) const {
  VolumeSetting made = make_volume_setting(setting, {.scene = scene.argument,
                                                     .recording = scene.recording.get(),
                                                     .objects = objects,
                                                     .seed = options.seed});
  const std::string what = setting == "scene" ? scene.name : made.what;
  // As the command spells it.
  const double taken_step = std::stod(key_text(step < 0.0 ? made.step : step));
  const std::size_t count = made.solids.size();
  const std::string again = command(taken_step);
  if (with_widths) {
    for (const BoxWidth& width : race_widths(made.solids.bounds(), frames())) {
      results.add("box_widths", {{"objects_are", what},
                                 {"objects", count},
                                 {"boxes", width.boxes},
                                 {"lanes", width.lanes},
                                 {"hits", width.hits},
                                 {"overlapping", width.overlapping},
                                 {"false_positives", width.false_positives()},
                                 {"make_ms", to_value(width.make)},
                                 {"test_ms", to_value(width.test)},
                                 {"bytes_per_box", width.bytes_per_box},
                                 {"command", again}});
    }
  }
  const std::size_t timed = made.frames(frames());
  const auto rows = race_volumes(
      std::move(made.solids),
      {.partition = partition, .frames = timed, .step = taken_step, .recorded = made.recorded});
  bool missed = false;
  for (const VolumeRow& one : rows) {
    missed = missed || one.missed != 0;
    const bool is_box = one.volume.starts_with("AABB");
    if (table == "margins" && !is_box) continue;
    Json row = volume_row_of(one, rows.front());
    if (table == "volumes") row["objects_are"] = what;
    row.update(
        {{"objects", count}, {"step", taken_step}, {"partition", partition}, {"command", again}});
    results.add(table, std::move(row));
  }
  if (missed) throw std::runtime_error("a volume missed pairs that overlap");
}

/// Where a built-in scene was not asked for, one of them stands for all: their boxes lie upright.
std::vector<ReportScene> volumes_scenes(const ReportOptions& options) {
  std::vector<std::string> names;
  for (const ReportScene& scene : options.scenes) names.push_back(scene.name);
  if (names == main_scenes()) return {options.scenes.front()};
  return options.scenes;
}

std::vector<VolumesCell> volumes_cells(const ReportOptions& options) {
  const std::size_t objects = objects_up_to(options, 10'000);
  const VolumesCell turned{.options = options, .setting = "cubes", .objects = objects};
  std::vector<VolumesCell> cells;
  std::vector<VolumesCell> bases;
  for (const ReportScene& scene : volumes_scenes(options)) {
    VolumesCell cell = turned;
    cell.setting = "scene";
    cell.scene = scene;
    if (scene.recording) cell.objects = scene.recording->objects();
    cell.with_widths = true;
    if (scene.recording) bases.push_back(cell);
    cells.push_back(std::move(cell));
  }
  bases.push_back(turned);
  for (const char* setting : {"cubes", "rods", "slow"}) {
    VolumesCell cell = turned;
    cell.setting = setting;
    cell.with_widths = cell.setting != "slow";
    cells.push_back(std::move(cell));
  }
  for (VolumesCell cell : bases) {
    cell.with_widths = false;
    for (const std::string_view partition : volume_partitions()) {
      const bool is_quadratic = partition == "BoundsNSquared" && cell.objects > 2000;
      const bool is_left_out = options.quick && partition != "FlatGrid";
      if (partition == kVolumesPartition || is_quadratic || is_left_out) continue;
      cell.partition = partition;
      cells.push_back(cell);
    }
  }
  for (const double step : kMarginSteps) {
    if (options.quick && step != kMarginSteps[0] && step != 0.1) continue;
    VolumesCell cell = turned;
    cell.table = "margins";
    cell.step = step;
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::vector<ReportStep> plan_volumes(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const VolumesCell& cell : volumes_cells(options)) {
    const std::string what = cell.setting == "scene" ? cell.scene.name : cell.setting;
    const double each = cell.with_widths ? 4e-6 : 3e-6;  // seconds of an object in a frame
    steps.push_back(
        {what + " in " + cell.partition,
         each * static_cast<double>(cell.objects) * static_cast<double>(cell.frames() + 1) * 9,
         [cell](Results& results) { cell.measure(results); }});
  }
  return steps;
}

}  // namespace

const ReportSection kVolumesSection{"volumes", "Speed against error: broad phase", declare_volumes,
                                    plan_volumes, show_volumes};

}  // namespace winnow::bench
