#include "goals/kinds.h"
#include "recordings/recording.h"
#include "tool/table.h"

#include <algorithm>
#include <iterator>

namespace winnow::bench {
namespace {

/// Position of a name in a list of names, or an error.
template <typename Names>
std::size_t index_in(const Names& names, const Ask& ask, const char* member) {
  const std::string name = ask.text(member);
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) ask.fail(std::string(member) + ": unknown value " + name);
  return static_cast<std::size_t>(std::distance(names.begin(), at));
}

struct KeyQuestion {
  KeyOperation operation;
  KeyMode mode;
  bool random_order;
  std::string text;

  explicit KeyQuestion(const Ask& ask)
      : operation(static_cast<KeyOperation>(index_in(kKeyOperations, ask, "operation"))),
        mode(static_cast<KeyMode>(index_in(kKeyModes, ask, "mode"))),
        random_order(
            index_in(std::array<std::string_view, 2>{"insertion", "random"}, ask, "order") == 1),
        text(ask.text("operation") + " (" + ask.text("mode") + ", keys in " + ask.text("order") +
             " order)") {}

  [[nodiscard]] double ns(Lab& lab, const std::string& partition, std::size_t objects) const {
    return lab.keys(partition, objects, random_order).of(operation, mode);
  }
};

/// Runs everything there is against the reference.
Goal count_disagreeing(const Ask& ask, MeasureOptions options) {
  options.threads = ask.get<std::vector<int>>("threads");
  options.isas.assign(available_isas().begin(), available_isas().end());
  options.reference = true;
  const Measurement measured = measure(options);
  Goal goal{.what = measured.scene + ", " + grouped(measured.objects) +
                    " objects: runs that find other pairs than the reference",
            .unit = "runs",
            .asked = ask.number("asked"),
            .detail = "of " + std::to_string(measured.partition_runs)};
  for (const Run& run : measured.partitions()) {
    if (run.same_pairs(measured.runs.back())) continue;
    goal.measured += 1.0;
    goal.detail += "; " + run.engine + " " + to_string(run.isa) + " " + std::to_string(run.threads);
  }
  return goal;
}

}  // namespace

std::vector<Goal> bytes_per_object(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string partition = ask.text("partition");
  Goal goal{.what = grouped(ask.count("objects")) + " objects: " + partition + ", worst scene",
            .unit = "bytes/object",
            .asked = ask.number("asked")};
  for (const std::string& scene : ask.get<std::vector<std::string>>("scenes")) {
    const double bytes = lab.bytes_per_object(partition, scene, ask.count("objects"));
    if (bytes <= goal.measured) continue;
    goal.measured = bytes;
    goal.detail = scene;
  }
  return {goal};
}

std::vector<Goal> key_operation(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const KeyQuestion question(ask);
  Goal goal{
      .what = grouped(ask.count("objects")) + " objects: " + question.text + ", worst partition",
      .unit = "ns",
      .asked = ask.number("asked")};
  for (const std::string& partition : Lab::testing_partitions()) {
    const double ns = question.ns(lab, partition, ask.count("objects"));
    if (ns <= goal.measured) continue;
    goal.measured = ns;
    goal.detail = partition;
  }
  return {goal};
}

std::vector<Goal> key_flatness(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const KeyQuestion question(ask);
  const auto sizes = ask.get<std::vector<std::size_t>>("sizes");
  if (sizes.empty()) ask.fail("sizes: is empty");
  Goal goal{.what = grouped(sizes.front()) + " to " + grouped(sizes.back()) +
                    " objects: " + question.text + ", dearest over cheapest, worst partition",
            .unit = "ratio",
            .asked = ask.number("asked")};
  for (const std::string& partition : Lab::testing_partitions()) {
    std::vector<double> ns;
    for (const std::size_t objects : sizes) ns.push_back(question.ns(lab, partition, objects));
    const auto [low, high] = std::minmax_element(ns.begin(), ns.end());
    if (*high / *low <= goal.measured) continue;
    goal.measured = *high / *low;
    goal.detail = partition + ": " + short_number(*low) + " to " + short_number(*high) + " ns";
  }
  return {goal};
}

std::vector<Goal> same_pairs(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  MeasureOptions options;
  options.scene = ask.text("scene");
  options.objects = ask.count("objects");
  options.frames = 6;
  return {count_disagreeing(ask, options)};
}

std::vector<Goal> same_pairs_in_recordings(const Ask& ask, const std::vector<Ask>& /*all*/,
                                           Lab& /*lab*/) {
  std::vector<Goal> goals;
  for (const std::string& file : recordings_in(ask.text("folder"))) {
    const Recording recording = read_recording(file);
    MeasureOptions options;
    options.recording = &recording;
    options.frames = recording.frames.size();
    goals.push_back(count_disagreeing(ask, options));
  }
  return goals;
}

}  // namespace winnow::bench
