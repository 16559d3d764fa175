// Impacts of vertices with faces and of edges with edges: no impact is missed, and no time is late.

#include <winnow/pipeline/impacts.h>
#include "tests/pipeline/feature_oracle.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace winnow::test {
namespace {

constexpr double kFeatureInfinity = std::numeric_limits<double>::infinity();
constexpr FeaturePair kFeaturePairs[] = {FeaturePair::vertex_face, FeaturePair::edge_edge};

struct FeatureStep {
  std::array<Vec3d, 4> start;
  std::array<Vec3d, 4> end;
};

Vec3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Vec3d random_lattice(Random& random, int size) {
  const auto number = [&] {
    return static_cast<double>(random.below(static_cast<std::size_t>(2 * size + 1))) - size;
  };
  return {number(), number(), number()};
}

/// Random points, moved by up to `motion`. Some sets are far away, some are planar, and some points
/// coincide.
FeatureStep random_step(Random& random, double motion) {
  FeatureStep step;
  const Vec3d offset = random.chance(0.2) ? random_vector(random, 1e9) : Vec3d();
  const bool flat = random.chance(0.1);
  for (std::size_t k = 0; k < 4; ++k) {
    step.start[k] = offset + random_vector(random, 1.0);
    step.end[k] = step.start[k] + random_vector(random, motion);
    if (flat) step.start[k].z() = step.end[k].z() = offset.z();
  }
  if (random.chance(0.1)) step.start[3] = step.start[2];
  if (random.chance(0.1)) step.end[3] = step.end[2];
  return step;
}

/// Returns a step whose features touch exactly at its middle: at a corner, on a border or inside,
/// and sometimes degenerate.
FeatureStep touching_step(FeaturePair kind, Random& random) {
  const auto part = [&](int most) {
    return static_cast<double>(random.below(static_cast<std::size_t>(most) + 1));
  };
  std::array<Vec3d, 4> middle;
  const Vec3d a = random_lattice(random, 3);
  const Vec3d b = random_lattice(random, 3);
  const Vec3d at = random_lattice(random, 6);
  if (kind == FeaturePair::vertex_face) {
    const double i = part(4);
    const double k = part(4 - static_cast<int>(i));
    middle = {at + i * a + k * b, at, at + 4.0 * a, at + 4.0 * b};
  } else {
    middle = {at - part(3) * a, at + part(3) * a, at - part(3) * b, at + part(3) * b};
  }
  FeatureStep step;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d velocity = random_lattice(random, 8);
    step.start[k] = middle[k] - velocity;
    step.end[k] = middle[k] + velocity;
  }
  return step;
}

FeatureImpact impact_of(FeaturePair kind, const FeatureStep& step,
                        const FeatureImpactOptions& options = {}) {
  FeatureImpact impact = expect_ok(feature_impact(kind, step.start, step.end, options));
  EXPECT_EQ(impact.hit, impact.time <= 1.0);
  return impact;
}

TEST(FeatureImpacts, impacts_match_exact_arithmetic) {
  Random random(11);
  std::size_t unsettled = 0;
  std::size_t hits = 0;
  std::size_t false_hits = 0;
  const std::size_t count = scaled(1200);
  for (std::size_t i = 0; i < count; ++i) {
    for (const FeaturePair kind : kFeaturePairs) {
      const FeatureStep step = random_step(random, random.log_uniform(0.1, 4.0));
      const ExactImpact truth = exact_impact(kind, step.start, step.end);
      const FeatureImpact impact = impact_of(kind, step);
      if (truth.touch) {
        EXPECT_TRUE(impact.hit) << i;
        EXPECT_LE(impact.time, truth.to) << i;
        EXPECT_GE(impact.time, truth.from - 1e-9) << i;
        ++hits;
      }
      if (truth.apart && impact.hit) ++false_hits;
      if (!truth.touch && !truth.apart) ++unsettled;
    }
  }
  EXPECT_GT(hits, count / 20);
  EXPECT_EQ(false_hits, 0U);
  EXPECT_LT(unsettled, 2 * count / 10);
}

TEST(FeatureImpacts, exact_touches_are_never_missed) {
  Random random(12);
  for (std::size_t i = 0; i < scaled(20000); ++i) {
    for (const FeaturePair kind : kFeaturePairs) {
      const FeatureStep step = touching_step(kind, random);
      const FeatureImpact impact = impact_of(kind, step);
      EXPECT_TRUE(impact.hit) << i;
      EXPECT_LE(impact.time, 0.5) << i;
      const FeatureImpact few =
          impact_of(kind, step, {.max_intervals = 1 + static_cast<std::uint32_t>(i % 8)});
      EXPECT_LE(few.time, impact.time) << i;
    }
  }
}

TEST(FeatureImpacts, impacts_start_at_requested_separation) {
  Random random(13);
  for (std::size_t i = 0; i < scaled(2000); ++i) {
    for (const FeaturePair kind : kFeaturePairs) {
      const FeatureStep step = random_step(random, 1.0);
      const double separation = random.log_uniform(1e-6, 0.3);
      const FeatureImpact impact = impact_of(kind, step, {.min_separation = separation});
      const double until = impact.hit ? impact.time : 1.0;
      // Features that start nearer than the separation have an impact at time 0.
      for (double part = 0.0; until > 0.0 && part < 1.0; part += 0x1p-6) {
        EXPECT_GT(feature_distance(kind, step.start, step.end, part * until), separation * 0.999999)
            << i;
      }
      if (impact.hit) {
        const double reached = feature_distance(kind, step.start, step.end, impact.time);
        EXPECT_LT(reached, separation + 1e-6) << i;
      }
      EXPECT_LE(impact.time, impact_of(kind, step).time) << i;
    }
  }
}

/// Returns a step in which a vertex crosses the plane of a face beside the face, or an edge passes
/// another edge, at the distance `gap`.
FeatureStep passing_step(FeaturePair kind, Random& random, double gap) {
  FeatureStep step;
  if (kind == FeaturePair::vertex_face) {
    step.start = {Vec3d(random.uniform(0.1, 0.9), -gap, random.uniform(0.2, 1.0)), Vec3d(),
                  Vec3d(1.0, 0.0, 0.0), Vec3d(0.0, 1.0, 0.0)};
    step.end = step.start;
    step.end[0].z() = -random.uniform(0.2, 1.0);
  } else {
    step.start = {Vec3d(), Vec3d(1.0, 0.0, 0.0), Vec3d(-gap, -random.uniform(0.1, 1.0), 1.0),
                  Vec3d(-gap, random.uniform(0.1, 1.0), 1.0)};
    step.end = step.start;
    step.end[2].z() = step.end[3].z() = -random.uniform(0.2, 1.0);
  }
  // Rotate the step so that no axis separates the features.
  Vec3d axis = random_vector(random, 1.0);
  axis /= axis.norm();
  const double w = random.uniform(0.2, 0.9);
  const Vec3d u = axis * std::sqrt(1.0 - w * w);
  for (auto* points : {&step.start, &step.end}) {
    for (Vec3d& v : *points) v += 2.0 * (w * u.cross(v) + u.cross(u.cross(v)));
  }
  return step;
}

TEST(FeatureImpacts, passing_features_have_no_impact) {
  Random random(14);
  for (std::size_t i = 0; i < scaled(5000); ++i) {
    for (const FeaturePair kind : kFeaturePairs) {
      const double gap = random.log_uniform(1e-11, 1e-3);
      EXPECT_FALSE(impact_of(kind, passing_step(kind, random, gap)).hit) << gap;
    }
  }
}

TEST(FeatureImpacts, touching_start_hits_at_time_zero) {
  const FeatureStep face{{Vec3d(0.25, 0.25, 0.0), Vec3d(), Vec3d(1, 0, 0), Vec3d(0, 1, 0)},
                         {Vec3d(0.25, 0.25, 1.0), Vec3d(), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}};
  EXPECT_EQ(impact_of(FeaturePair::vertex_face, face).time, 0.0);
  const FeatureStep rest{face.start, face.start};
  EXPECT_EQ(impact_of(FeaturePair::vertex_face, rest).time, 0.0);
  const FeatureStep point{};
  for (const FeaturePair kind : kFeaturePairs) EXPECT_EQ(impact_of(kind, point).time, 0.0);
  const FeatureStep lines{{Vec3d(), Vec3d(2, 0, 0), Vec3d(1, 0, 0), Vec3d(3, 0, 0)},
                          {Vec3d(), Vec3d(2, 0, 0), Vec3d(5, 0, 0), Vec3d(7, 0, 0)}};
  EXPECT_EQ(impact_of(FeaturePair::edge_edge, lines).time, 0.0);
}

TEST(FeatureImpacts, scaled_steps_keep_impacts) {
  Random random(15);
  for (std::size_t i = 0; i < scaled(500); ++i) {
    for (const FeaturePair kind : kFeaturePairs) {
      const FeatureStep step = touching_step(kind, random);
      for (const double size : {0x1p-1060, 0x1p-400, 0x1p400, 0x1p1010}) {
        FeatureStep other = step;
        for (auto* points : {&other.start, &other.end}) {
          for (Vec3d& v : *points) v *= size;
        }
        EXPECT_LE(impact_of(kind, other).time, 0.5) << size;
      }
    }
  }
}

TEST(FeatureImpacts, bad_input_is_refused) {
  const double large = std::numeric_limits<double>::max();
  for (const FeaturePair kind : kFeaturePairs) {
    FeatureStep step;
    for (const double bad : {kFeatureInfinity, -kFeatureInfinity, std::nan("")}) {
      for (std::size_t c = 0; c < 24; ++c) {
        FeatureStep one = step;
        (c < 12 ? one.start : one.end)[c % 12 / 3][c % 3] = bad;
        expect_error(feature_impact(kind, one.start, one.end), Status::invalid_bounds);
      }
    }
    step.start[0].x() = large;
    step.start[2].x() = -large;
    expect_error(feature_impact(kind, step.start, step.end), Status::invalid_bounds);
    step = {};
    for (const FeatureImpactOptions& bad :
         {FeatureImpactOptions{.min_separation = -1.0},
          FeatureImpactOptions{.min_separation = kFeatureInfinity},
          FeatureImpactOptions{.tolerance = 0.0}, FeatureImpactOptions{.tolerance = std::nan("")},
          FeatureImpactOptions{.max_intervals = 0}}) {
      expect_error(feature_impact(kind, step.start, step.end, bad), Status::invalid_argument);
    }
  }
}

/// Steps of all kinds in columns, some with bad numbers.
struct FeatureTable {
  std::vector<FeatureStep> step;
  std::vector<double> column[24];

  FeatureTable(FeaturePair kind, std::size_t count) {
    Random random(16);
    for (std::size_t i = 0; i < count; ++i) {
      step.push_back(i % 3 == 0 ? touching_step(kind, random) : random_step(random, 0.5));
      if (i % 50 == 7) step.back().end[i % 4].y() = i % 100 < 50 ? kFeatureInfinity : std::nan("");
      if (i % 50 == 9) step.back().start[i % 4].y() = 1e200;
    }
    for (std::size_t c = 0; c < 24; ++c) {
      for (const FeatureStep& s : step)
        column[c].push_back((c < 12 ? s.start : s.end)[c % 12 / 3][c % 3]);
    }
  }
  [[nodiscard]] FeatureColumns view() const {
    FeatureColumns view;
    view.count = step.size();
    for (std::size_t c = 0; c < 24; ++c)
      (c < 12 ? view.start : view.end)[c % 12 / 3][c % 3] = column[c].data();
    return view;
  }
};

TEST(FeatureImpacts, columns_match_on_every_isa) {
  for (const FeaturePair kind : kFeaturePairs) {
    const FeatureTable table(kind, scaled(3000) + 5);
    for (const double separation : {0.0, 1e-3}) {
      const FeatureImpactOptions options{.min_separation = separation};
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        std::vector<double> times(table.step.size());
        ASSERT_EQ(feature_impacts(kind, table.view(), times, options), Status::ok);
        for (std::size_t i = 0; i < times.size(); ++i) {
          FeatureImpact one;
          const Status status =
              feature_impact(kind, table.step[i].start, table.step[i].end, options).get(one);
          if (status != Status::ok) {
            EXPECT_TRUE(std::isnan(times[i])) << i;
          } else {
            EXPECT_EQ(std::bit_cast<std::uint64_t>(times[i]),
                      std::bit_cast<std::uint64_t>(one.time))
                << i;
          }
        }
      }
    }
  }
}

TEST(FeatureImpacts, mismatched_columns_are_refused) {
  const FeatureTable table(FeaturePair::edge_edge, 9);
  std::vector<double> times(8);
  EXPECT_EQ(feature_impacts(FeaturePair::edge_edge, table.view(), times), Status::size_mismatch);
  times.resize(9);
  FeatureColumns missing = table.view();
  missing.end[2][1] = nullptr;
  EXPECT_EQ(feature_impacts(FeaturePair::edge_edge, missing, times), Status::invalid_argument);
  EXPECT_EQ(feature_impacts(FeaturePair::edge_edge, {}, {}), Status::ok);
}

}  // namespace
}  // namespace winnow::test
