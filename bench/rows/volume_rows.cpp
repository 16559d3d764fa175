#include "bench/rows/volume_rows.h"

#include <winnow/simd/isa.h>
#include "bench/measure/fingerprint.h"

#include <stdexcept>

namespace winnow::bench {
namespace {

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

std::string volumes_command(const VolumeRowOptions& options, double step) {
  std::string text = "bench/run volumes --setting " + options.setting;
  const bool recorded = options.setting == "scene" && options.scene.is_recording();
  if (options.setting == "scene") {
    text += (recorded ? " --recording " : " --scene ") + shell_word(options.scene.argument);
  }
  if (!recorded)
    text += " --objects " + std::to_string(options.objects) + " --step " + key_text(step);
  return text + " --partition " + options.partition + " --frames " +
         std::to_string(options.frames) + " --seed " + std::to_string(options.seed) + " --isa " +
         isa_name();
}

}  // namespace

void add_volumes(Results& results, const VolumeRowOptions& options, const std::string& table) {
  VolumeSetting made =
      make_volume_setting(options.setting, {.scene = options.scene.argument,
                                            .recording = options.scene.recording.get(),
                                            .objects = options.objects,
                                            .seed = options.seed});
  const std::string what = options.setting == "scene" ? options.scene.name : made.what;
  // The step is rounded as in the command's text, so that the command repeats the same measurement.
  const double step = std::stod(key_text(options.step < 0.0 ? made.step : options.step));
  const std::size_t count = made.solids.size();
  const std::string again = volumes_command(options, step);
  const bool follows = options.step < 0.0;
  const auto rows =
      race_volumes(std::move(made.solids),
                   {.partition = options.partition,
                    .frames = follows ? made.frames(options.frames) : options.frames,
                    .step = step,
                    .recorded = follows ? made.recorded : std::span<const std::vector<Aabb>>()});
  bool missed = false;
  for (const VolumeRow& one : rows) {
    missed = missed || one.missed != 0;
    if (table == "margins" && !one.volume.starts_with("AABB")) continue;
    Json row = volume_row_of(one, rows.front());
    if (table == "volumes") row["objects_are"] = what;
    row.update(
        {{"objects", count}, {"step", step}, {"partition", options.partition}, {"command", again}});
    results.add(table, std::move(row));
  }
  if (missed) throw std::runtime_error("a volume missed pairs that overlap");
}

}  // namespace winnow::bench
