#include "engine/frame_limit.h"
#include "engine/sample.h"
#include "goals/kinds.h"

#include "tool/table.h"

#include <algorithm>

namespace winnow::bench {
namespace {

std::string cell_name(const Ask& ask) {
  return ask.text("scene") + ", " + on_size(ask.count("objects"), ask.threads());
}

std::string scaled(const Ask& ask, double scale) {
  return ask.text("existing") + " " + short_number(ask.number("existing_ms")) + " ms x " +
         short_number(scale);
}

/// What the best existing library would need on this machine.
double existing_ms(const Ask& ask, const Measurement& cell) {
  return ask.number("existing_ms") * Lab::scale(cell);
}

const Run& run_of(const Ask& ask, const Measurement& cell, const std::string& partition,
                  int threads) {
  const Run* run = cell.find(partition, threads);
  if (run == nullptr) ask.fail(partition + " does not run on " + on_size(cell.objects, threads));
  return *run;
}

/// The median over the frames of a's time over b's, the first frame left out.
double median_ratio(const Run& a, const Run& b) {
  std::vector<double> ratios;
  for (std::size_t f = 1; f < a.frame_ms.size(); ++f)
    ratios.push_back(a.frame_ms[f] / b.frame_ms[f]);
  return median_of(ratios);
}

}  // namespace

std::vector<Goal> fastest_partition(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const Measurement& cell = lab.cell(ask.text("scene"), ask.count("objects"));
  const Run* best = cell.fastest(ask.threads());
  if (best == nullptr) ask.fail("no partition runs there");
  std::string peer_text;
  if (const Run* peer = lab.peers(cell.scene, cell.objects).fastest_peer(ask.threads())) {
    peer_text = "; here " + peer->engine + " " + short_number(peer->median_ms()) + " ms";
  }
  return {{.what = cell_name(ask) + ": fastest partition",
           .unit = "ms",
           .asked = existing_ms(ask, cell) / ask.number("times_faster"),
           .measured = best->median_ms(),
           .detail = best->engine + "; " + scaled(ask, Lab::scale(cell)) + " / " +
                     short_number(ask.number("times_faster")) + peer_text}};
}

std::vector<Goal> no_slower_than_existing(const Ask& ask, const std::vector<Ask>& all, Lab& lab) {
  const std::string partition = ask.text("partition");
  const auto unfit = ask.get<std::vector<std::string>>("unfit");
  std::vector<Goal> goals{{.what = partition + ": scenes it is unfit for",
                           .unit = "scenes",
                           .asked = ask.number("most_unfit"),
                           .measured = static_cast<double>(unfit.size())}};
  for (const Ask& other : all) {
    if (other.kind() != "fastest_partition" || other.topic() != ask.topic() ||
        other.count("objects") > ask.count("largest") ||
        std::find(unfit.begin(), unfit.end(), other.text("scene")) != unfit.end()) {
      continue;
    }
    const Measurement& cell = lab.cell(other.text("scene"), other.count("objects"));
    goals.push_back({.what = cell_name(other) + ": " + partition,
                     .unit = "ms",
                     .asked = existing_ms(other, cell),
                     .measured = run_of(ask, cell, partition, other.threads()).median_ms(),
                     .detail = scaled(other, Lab::scale(cell))});
  }
  return goals;
}

std::vector<Goal> scene_ratio(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string partition = ask.text("partition");
  const double ratio =
      lab.scene_ratio(partition, ask.text("scene"), ask.text("of"), ask.count("objects"));
  if (ratio == 0.0) ask.fail(partition + " does not run there");
  return {{.what = ask.text("scene") + ", " + on_size(ask.count("objects"), 1) + ": " + partition +
                   " against " + ask.text("of"),
           .unit = "ratio",
           .asked = ask.number("asked"),
           .measured = ratio}};
}

std::vector<Goal> speedup(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const Measurement& cell = lab.cell(ask.text("scene"), ask.count("objects"));
  const Run* one = cell.fastest(1);
  const Run* many = cell.fastest(ask.threads());
  if (one == nullptr || many == nullptr) ask.fail("no partition runs there");
  return {{.what = cell_name(ask) + " against 1: fastest partition",
           .unit = "times faster",
           .sense = Goal::Sense::at_least,
           .asked = ask.number("asked"),
           .measured = one->median_ms() / many->median_ms(),
           .detail = one->engine + ", " + many->engine}};
}

std::vector<Goal> default_isa(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const Measurement& measured = lab.by_isa(ask.text("scene"), ask.count("objects"));
  Goal goal{.what = ask.text("scene") + ", " + grouped(ask.count("objects")) +
                    " objects: default instruction set against a narrower one, worst partition",
            .unit = "ratio",
            .asked = ask.number("asked")};
  for (const Run& usual : measured.partitions()) {
    if (usual.isa != active_isa()) continue;
    for (const Run& other : measured.partitions()) {
      if (other.engine != usual.engine || other.isa >= usual.isa) continue;
      const double ratio = median_ratio(usual, other);
      if (ratio <= goal.measured) continue;
      goal.measured = ratio;
      goal.detail = usual.engine + ", " + to_string(usual.isa) + " against " + to_string(other.isa);
    }
  }
  return {goal};
}

std::vector<Goal> kernel_speedup(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string wide = ask.text("wide");
  const std::string narrow = ask.text("narrow");
  const auto isas = available_isas();
  const bool here =
      std::any_of(isas.begin(), isas.end(), [&](Isa isa) { return wide == to_string(isa); });
  if (!here) return {};
  Goal goal{.what = "every kernel: " + wide + " against " + narrow,
            .unit = "times faster",
            .sense = Goal::Sense::at_least,
            .asked = ask.number("asked"),
            .detail = "not measured: the target winnow_micro is not built"};
  if (!lab.kernels()) return {goal};
  std::vector<Goal> goals;
  for (const auto& [kernel, times] : *lab.kernels()) {
    if (!times.contains(wide) || !times.contains(narrow)) continue;
    goal.what = kernel + ": " + wide + " against " + narrow;
    goal.measured = times.at(narrow) / times.at(wide);
    goal.detail = short_number(times.at(narrow) / 1e3) + " against " +
                  short_number(times.at(wide) / 1e3) + " us";
    goals.push_back(goal);
  }
  return goals;
}

std::vector<Goal> near_limit(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const Measurement& cell = lab.cell(ask.text("scene"), ask.count("objects"));
  const Run* best = cell.fastest(1);
  if (best == nullptr) ask.fail("no partition runs there");
  const FrameLimit limit =
      measure_frame_limit(cell.objects, static_cast<std::size_t>(best->pairs_a_frame()));
  return {{.what = ask.text("scene") + ", " + on_size(cell.objects, 1) +
                   ": fastest partition over bandwidth, sort, permutation and emission",
           .unit = "ratio",
           .asked = ask.number("asked"),
           .measured = best->median_ms() / limit.total(),
           .detail = best->engine + " " + short_number(best->median_ms()) + " ms over " +
                     short_number(limit.total()) + " ms"}};
}

std::vector<Goal> growth_exponent(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string partition = ask.text("partition");
  std::vector<GrowthPoint> points;
  for (const std::size_t objects : ask.get<std::vector<std::size_t>>("sizes")) {
    const Run* run = lab.cell(ask.text("scene"), objects).find(partition, 1);
    if (run == nullptr) ask.fail(partition + " does not run there");
    points.push_back({static_cast<double>(objects), run->median_ms()});
  }
  return {{.what = partition + " on " + ask.text("scene") + ": time grows as objects to the power",
           .unit = "exponent",
           .asked = ask.number("asked"),
           .measured = fitted_exponent(points)}};
}

}  // namespace winnow::bench
