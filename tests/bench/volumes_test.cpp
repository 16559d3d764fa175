// The figures of `winnow dev volumes` are consistent.

#include <winnow/core/eigen.h>
#include "bench/measure/volume_race.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

std::map<std::string, VolumeRow> rows_by_name(Solids solids, const std::string& partition) {
  std::map<std::string, VolumeRow> rows;
  for (VolumeRow& row :
       race_volumes(std::move(solids), {.partition = partition, .frames = 2, .step = 0.02})) {
    rows.emplace(row.volume, row);
  }
  return rows;
}

TEST(VolumeRace, tighter_volumes_report_fewer_pairs_and_miss_none) {
  for (const std::string partition : {"LinearBvh", "SweepAndPrune", "FlatGrid"}) {
    for (const bool rods : {false, true}) {
      const auto rows =
          rows_by_name(rods ? Solids::rods(400, 1) : Solids::rotated(400, 1), partition);
      ASSERT_EQ(rows.size(), 9U);
      const std::size_t overlapping = rows.at("AABB").overlapping;
      EXPECT_GT(overlapping, 50U);
      for (const auto& [name, row] : rows) {
        EXPECT_EQ(row.missed, 0U) << name;
        EXPECT_EQ(row.overlapping, overlapping) << name;
        EXPECT_EQ(row.fingerprint, rows.at("AABB").fingerprint) << name;
        EXPECT_GE(row.false_positives(), 0.0) << name;
        EXPECT_LE(row.false_positives(), 1.0) << name;
        EXPECT_GT(row.bytes_per_object, 0.0) << name;
      }
      const auto reported = [&](const char* name) { return rows.at(name).reported; };
      EXPECT_LE(reported("26-DOP"), reported("18-DOP"));
      EXPECT_LE(reported("26-DOP"), reported("14-DOP"));
      EXPECT_LT(reported("18-DOP"), reported("AABB"));
      EXPECT_LT(reported("14-DOP"), reported("AABB"));
      EXPECT_LT(reported("AABB"), reported("AABB + 5 %"));
      EXPECT_LT(reported("AABB + 5 %"), reported("AABB + 50 %"));
    }
  }
}

TEST(VolumeRace, margins_begin_at_different_times) {
  constexpr float kShare = 0.2F;
  const Solids solids = Solids::rods(200, 1);
  const std::vector<OrientedBox> then = solids.boxes_at_last_refit(kShare);
  double sum = 0.0;
  for (std::size_t i = 0; i < then.size(); ++i) {
    const OrientedBox& now = solids.boxes()[i];
    const Aabb bounds = now.bounds();
    const float margin = kShare * (as_eigen(bounds.max) - as_eigen(bounds.min)).maxCoeff();
    const float way = (as_eigen(then[i].center) - as_eigen(now.center)).cwiseAbs().maxCoeff();
    EXPECT_LE(way, 1.001F * margin) << i;
    sum += static_cast<double>(way / margin);
  }
  EXPECT_NEAR(sum / static_cast<double>(then.size()), 0.5, 0.1);
}

TEST(VolumeRace, race_follows_the_frames_of_a_recording) {
  const auto box = [](float x, float edge) {
    return Aabb{{x, 0.0F, 0.0F}, {x + edge, edge, edge}};
  };
  const float kInfinite = std::numeric_limits<float>::infinity();
  const Aabb ground{{-kInfinite, -kInfinite, -1.0F}, {kInfinite, kInfinite, -0.5F}};
  // The second box moves to the first box, then grows until it touches the third box as well.
  const std::vector<std::vector<Aabb>> frames{{ground, box(0, 1), box(1.5F, 1), box(3, 1)},
                                              {ground, box(0, 1), box(0.9F, 1), box(3, 1)},
                                              {ground, box(0, 1), box(0.9F, 2.5F), box(3, 1)}};
  const auto rows =
      race_volumes(Solids::of_boxes(frames.front()), {.frames = 2, .recorded = frames});
  EXPECT_EQ(rows.front().reported, 1U + 2U);
  EXPECT_EQ(rows.front().overlapping, 1U + 2U);
  for (const VolumeRow& row : rows) EXPECT_EQ(row.missed, 0U) << row.volume;
}

TEST(VolumeRace, unknown_partition_is_refused) {
  EXPECT_THROW((void)race_volumes(Solids::rotated(4, 1), {.partition = "NoPartition"}),
               std::runtime_error);
}

}  // namespace
}  // namespace winnow::bench
