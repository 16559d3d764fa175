// Kernels of spheres, capsules and half-spaces compared with closed forms and searches in long
// double, and with themselves: on every ISA, with swapped bodies, at other positions of a batch.

#include <gtest/gtest.h>
#include <winnow/simd/isa.h>
#include "pipeline/kernels/kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/pipeline/pair_scenes.h"
#include "tests/pipeline/round_reference.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMargin = 0.05;

struct Kind {
  ShapeKind a;
  ShapeKind b;
};
using enum ShapeKind;
constexpr Kind kKinds[] = {{sphere, sphere},    {sphere, capsule},     {capsule, capsule},
                           {sphere, box},       {capsule, box},        {sphere, triangle},
                           {capsule, triangle}, {sphere, half_space},  {capsule, half_space},
                           {box, half_space},   {triangle, half_space}};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << to_string(kind.a) << "_" << to_string(kind.b);
}

/// Answers of a range of pairs in columns.
class Answers {
 public:
  Answers(const PairScene& scene, Kind kind, const BodyPair* pairs, std::size_t size, int level)
      : count(static_cast<std::uint32_t>(size)) {
    overlap.resize(count, 2);
    for (auto& c : column) c.resize(count, -77.0);
    first.resize(count);
    contacts.resize(count);
    uncertified.resize(count);
    for (auto& c : points) c.resize(kManifoldPoints * count + 16);
    feature.resize(kManifoldPoints * count + 16);
    NarrowJob job{};
    job.pairs = pairs;
    job.count = count;
    job.shapes = scene.shapes.data();
    job.poses = scene.poses.data();
    job.tables = &scene.pool.tables();
    job.margin = kMargin;
    job.overlap = overlap.data();
    job.distance = column[0].data();
    job.error_bound = column[1].data();
    for (int k = 0; k < 3; ++k) {
      job.normal[k] = column[2 + k].data();
      job.point[k] = column[5 + k].data();
      job.contacts.position[k] = points[k].data();
    }
    job.contact_first = first.data();
    job.contact_count = contacts.data();
    job.contacts.depth = points[3].data();
    job.contacts.feature = feature.data();
    job.uncertified = uncertified.data();
    const NarrowKernels* kernels = narrow_kernels(kind.a, kind.b);
    uncertified.resize(kernels->of_level[level](job));
    certified.assign(count, 1);
    for (const std::uint32_t i : uncertified) certified[i] = 0;
    contact_total = job.contacts.size;
  }
  Answers(const PairScene& scene, Kind kind, int level)
      : Answers(scene, kind, scene.pairs.data(), scene.pairs.size(), level) {}

  [[nodiscard]] LongVector vector(int from, std::size_t i) const {
    const auto at = [&](int k) { return column[static_cast<std::size_t>(from + k)][i]; };
    return {at(0), at(1), at(2)};
  }
  [[nodiscard]] LongVector normal(std::size_t i) const { return vector(2, i); }
  [[nodiscard]] LongVector point(std::size_t i) const { return vector(5, i); }

  std::uint32_t count;
  std::vector<std::uint8_t> overlap;
  /// Distance, error bound, normal (3), point (3).
  std::vector<double> column[8];
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> contacts;
  std::vector<std::uint32_t> uncertified;
  std::vector<std::uint8_t> certified;
  std::vector<float> points[4];
  std::vector<std::uint64_t> feature;
  std::uint32_t contact_total = 0;
};

/// Returns pairs ordered by kinds, as the dispatcher passes them.
PairScene scene_of(Kind kind, PairStyle style, std::size_t count, std::uint64_t seed) {
  PairScene scene;
  Random random(seed);
  add_pairs(scene, kind.a, kind.b, style, count, random);
  for (BodyPair& pair : scene.pairs) {
    if (scene.shapes[pair.a].kind() != kind.a) std::swap(pair.a, pair.b);
  }
  return scene;
}

struct ReferencePair {
  ReferencePair(const PairScene& scene, BodyPair pair) {
    const Pose& pose = scene.poses[pair.a];
    a = make_reference(scene.pool.tables(), scene.shapes[pair.a], pose, pose.position.data());
    b = make_reference(scene.pool.tables(), scene.shapes[pair.b], scene.poses[pair.b],
                       pose.position.data());
    distance = reference_distance(a, b);
    scale = reference_scale(a, b);
  }
  ReferenceShape a;
  ReferenceShape b;
  long double distance;
  long double scale;
};

class RoundKernels : public testing::TestWithParam<Kind> {
 protected:
  /// Calls body(scene, style) with a scene of every style.
  template <typename Body>
  void for_styles(std::size_t count, Body&& body) {
    for (const PairStyle style : kPairStyles) {
      SCOPED_TRACE(to_string(style));
      const PairScene scene = scene_of(GetParam(), style, scaled(count), 7);
      body(scene, style);
      if (HasFatalFailure()) return;
    }
  }
  template <typename Body>
  static void for_isas(Body&& body) {
    for (const Isa isa : available_isas()) {
      SCOPED_TRACE(to_string(isa));
      const IsaScope scope(isa);
      body();
    }
  }
};

TEST_P(RoundKernels, certified_signs_match_reference) {
  for_styles(1500, [&](const PairScene& scene, PairStyle style) {
    const Answers answers(scene, GetParam(), 0);
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      if (answers.certified[i] == 0) {
        ++unknown;
        continue;
      }
      const ReferencePair reference(scene, scene.pairs[i]);
      ASSERT_EQ(answers.overlap[i] != 0, reference.distance <= 0) << i << " " << reference.distance;
    }
    if (style == PairStyle::ordinary) {
      EXPECT_LE(unknown, scene.pairs.size() / 500);
    }
  });
}

TEST_P(RoundKernels, distances_stay_within_error_bounds) {
  for_styles(1500, [&](const PairScene& scene, PairStyle style) {
    const Answers answers(scene, GetParam(), 1);
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      if (answers.certified[i] == 0) {
        ++unknown;
        continue;
      }
      const ReferencePair reference(scene, scene.pairs[i]);
      const long double d = answers.column[0][i];
      const double bound = answers.column[1][i];
      ASSERT_LE(std::abs(d - reference.distance), bound) << i << " " << d;
      ASSERT_EQ(d <= 0, reference.distance <= 0) << i;
      ASSERT_LE(bound, 1e-12L * (reference.scale + std::abs(d))) << i;
    }
    if (style == PairStyle::ordinary) {
      EXPECT_LE(unknown, scene.pairs.size() / 500);
    }
  });
}

TEST_P(RoundKernels, normals_separate_and_points_lie_on_shapes) {
  for_styles(1000, [&](const PairScene& scene, PairStyle) {
    const Answers answers(scene, GetParam(), 1);
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      if (answers.certified[i] == 0) continue;
      const ReferencePair reference(scene, scene.pairs[i]);
      const LongVector n = answers.normal(i);
      const long double close = 1e-5L * (reference.scale + std::abs(reference.distance));
      ASSERT_NEAR(static_cast<double>(n.norm()), 1.0, 1e-14) << i;
      ASSERT_LE(reference_overlap_along(reference.a, reference.b, n), -reference.distance + close)
          << i;
      const LongVector on_a = answers.point(i);
      const LongVector on_b = on_a + n * static_cast<long double>(answers.column[0][i]);
      ASSERT_LE(reference_distance(reference.a, on_a), close) << i;
      ASSERT_LE(reference_distance(reference.b, on_b), close) << i;
    }
  });
}

TEST_P(RoundKernels, contacts_lie_between_surfaces_and_include_deepest) {
  const PairScene scene = scene_of(GetParam(), PairStyle::ordinary, scaled(2000), 3);
  const Answers answers(scene, GetParam(), 2);
  std::uint32_t total = 0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    ASSERT_EQ(answers.first[i], total) << i;
    total += answers.contacts[i];
    if (answers.certified[i] == 0) {
      ASSERT_EQ(answers.contacts[i], 0U) << i;
      continue;
    }
    const ReferencePair reference(scene, scene.pairs[i]);
    const long double close = 2e-6L * reference.scale;
    const double d = answers.column[0][i];
    ASSERT_EQ(answers.contacts[i] > 0, d <= kMargin) << i << " " << d;
    float deepest = -std::numeric_limits<float>::infinity();
    for (std::uint32_t k = answers.first[i]; k < total; ++k) {
      const float depth = answers.points[3][k];
      deepest = std::max(deepest, depth);
      ASSERT_GE(depth, -kMargin - close) << i;
      const LongVector p(answers.points[0][k], answers.points[1][k], answers.points[2][k]);
      // Both points of two nearly parallel capsules get the depth of the closest point.
      const long double aside = answers.contacts[i] > 1 ? 1e-3L * reference.scale : 0.0L;
      const long double half = std::abs(depth) * 0.5L + close + aside;
      ASSERT_LE(reference_distance(reference.a, p), half) << i;
      ASSERT_LE(reference_distance(reference.b, p), half) << i;
      for (std::uint32_t j = answers.first[i]; j < k; ++j) {
        ASSERT_NE(answers.feature[j], answers.feature[k]) << i;
      }
    }
    if (d <= kMargin) {
      ASSERT_NEAR(deepest, -d, static_cast<double>(close)) << i;
    }
  }
  EXPECT_EQ(answers.contact_total, total);
}

/// Appends `size` bytes of `data`.
void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}
std::string bytes_of(const Answers& answers, std::size_t i, int level) {
  std::string bytes;
  append(bytes, &answers.certified[i], 1);
  if (answers.certified[i] == 0) return bytes;
  if (level == 0) append(bytes, &answers.overlap[i], 1);
  if (level == 0) return bytes;
  for (int c = 0; c < (level == 1 ? 8 : 5); ++c) append(bytes, &answers.column[c][i], 8);
  if (level == 1) return bytes;
  for (std::uint32_t k = 0; k < answers.contacts[i]; ++k) {
    for (const auto& p : answers.points) append(bytes, &p[answers.first[i] + k], 4);
    append(bytes, &answers.feature[answers.first[i] + k], 8);
  }
  return bytes;
}

TEST_P(RoundKernels, answers_match_on_every_isa) {
  for_styles(250, [&](const PairScene& scene, PairStyle) {
    for (int level = 0; level < 3; ++level) {
      std::vector<std::string> expected;
      for_isas([&] {
        const Answers answers(scene, GetParam(), level);
        for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
          const std::string bytes = bytes_of(answers, i, level);
          if (expected.size() <= i) expected.push_back(bytes);
          ASSERT_EQ(bytes, expected[i]) << i << " level " << level;
        }
      });
    }
  });
}

TEST_P(RoundKernels, batch_position_does_not_change_answers) {
  const PairScene scene = scene_of(GetParam(), PairStyle::lattice, 45, 5);
  for_isas([&] {
    for (int level = 0; level < 3; ++level) {
      const Answers all(scene, GetParam(), level);
      for (const std::size_t from : {1U, 7U, 30U}) {
        for (const std::size_t count : {1U, 2U, 9U, 15U}) {
          const Answers part(scene, GetParam(), &scene.pairs[from], count, level);
          for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(bytes_of(part, i, level), bytes_of(all, from + i, level)) << from << " " << i;
          }
        }
      }
    }
  });
}

TEST_P(RoundKernels, swapped_bodies_give_mirrored_answers) {
  if (GetParam().a != GetParam().b) return;
  for_styles(1000, [&](const PairScene& scene, PairStyle) {
    std::vector<BodyPair> turned = scene.pairs;
    for (BodyPair& pair : turned) std::swap(pair.a, pair.b);
    const Answers ab(scene, GetParam(), 1);
    const Answers ba(scene, GetParam(), turned.data(), turned.size(), 1);
    for (std::size_t i = 0; i < turned.size(); ++i) {
      ASSERT_EQ(ab.certified[i], ba.certified[i]) << i;
      if (ab.certified[i] == 0) continue;
      ASSERT_EQ(ab.column[0][i], ba.column[0][i]) << i;
      ASSERT_EQ(ab.column[1][i], ba.column[1][i]) << i;
      ASSERT_EQ(ab.normal(i), -ba.normal(i)) << i;
    }
  });
}

TEST_P(RoundKernels, bad_poses_are_not_certified) {
  const auto expect_uncertified = [&](const PairScene& scene, const std::string& what) {
    for_isas([&] {
      for (int level = 0; level < 3; ++level) {
        const Answers answers(scene, GetParam(), level);
        for (std::size_t i = 0; i < scene.pairs.size(); i += 3) {
          ASSERT_EQ(answers.certified[i], 0) << what << " level " << level;
        }
      }
    });
  };
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int side = 0; side < 2; ++side) {
      const bool turns = (side == 0 ? GetParam().a : GetParam().b) != sphere;
      for (int k = 0; k < (turns ? 7 : 3); ++k) {
        PairScene copy = scene_of(GetParam(), PairStyle::ordinary, 40, 9);
        for (std::size_t i = 0; i < copy.pairs.size(); i += 3) {
          Pose& pose = copy.poses[side == 0 ? copy.pairs[i].a : copy.pairs[i].b];
          (k < 3 ? pose.position[k] : pose.orientation[k - 3]) = bad;
        }
        expect_uncertified(copy, std::to_string(bad) + " " + std::to_string(k));
      }
      if (!turns) continue;
      PairScene zero = scene_of(GetParam(), PairStyle::ordinary, 40, 9);
      for (std::size_t i = 0; i < zero.pairs.size(); i += 3) {
        Pose& pose = zero.poses[side == 0 ? zero.pairs[i].a : zero.pairs[i].b];
        for (double& q : pose.orientation) q = 0.0;
      }
      expect_uncertified(zero, "zero quaternion");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, RoundKernels, testing::ValuesIn(kKinds),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
