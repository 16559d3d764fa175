// Properties of the answers for all kinds of shapes that can be checked without the oracle.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/pipeline/reproduction.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr NarrowTier kTiers[] = {NarrowTier::robust, NarrowTier::reference};

NarrowOptions distances(NarrowTier tier) {
  return {.level = ContactLevel::distance, .tier = tier};
}

/// Pairs of all kinds.
PairScene mixed_scene(PairStyle style, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  PairScene scene;
  for (const ShapeKind a : all_kinds()) {
    for (const ShapeKind b : all_kinds()) {
      if (a == ShapeKind::half_space && b == ShapeKind::half_space) continue;
      add_pairs(scene, a, b, style, count, random);
    }
  }
  return scene;
}

Eigen::Vector3d between(const PairScene& scene, BodyPair pair) {
  return as_eigen(scene.poses[pair.b].position) - as_eigen(scene.poses[pair.a].position);
}

bool is_curved(const PairScene& scene, BodyPair pair) {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    const ShapeKind kind = scene.shapes[body].kind();
    if (kind == ShapeKind::cylinder || kind == ShapeKind::cone) return true;
  }
  return false;
}

class Properties : public testing::TestWithParam<PairStyle> {
 protected:
  /// Reports only the first few faults.
  void complain(const char* what, BodyPair pair, double is, double should_be) {
    if (++complaints_ > 3) return;
    ADD_FAILURE() << what << ": " << is << " instead of " << should_be << '\n'
                  << reproduction(scene_, pair);
  }
  void TearDown() override { EXPECT_EQ(complaints_, 0); }

  PairScene scene_ = mixed_scene(GetParam(), scaled(12), 3);

 private:
  int complaints_ = 0;
};

TEST_P(Properties, swapped_bodies_give_mirrored_answers) {
  PairScene back = mixed_scene(GetParam(), scaled(12), 3);
  for (BodyPair& pair : back.pairs) std::swap(pair.a, pair.b);
  for (const NarrowTier tier : kTiers) {
    const auto there = compute_results(scene_, distances(tier));
    const auto again = compute_results(back, distances(tier));
    for (std::size_t i = 0; i < there.size(); ++i) {
      const PairResults& p = there[i];
      const PairResults& q = again[i];
      // Coincident centres have no canonical order, and the search on rims depends on the order.
      const bool exactly =
          !is_curved(scene_, scene_.pairs[i]) && between(scene_, scene_.pairs[i]).norm() > 0.0;
      const double allowed = exactly ? 0.0 : p.error_bound + q.error_bound;
      if (p.overlap != q.overlap || !(std::abs(p.distance - q.distance) <= allowed)) {
        complain("swapped distance", scene_.pairs[i], q.distance, p.distance);
      }
      // If several normals are equally good, the frame of a decides.
      if (GetParam() == PairStyle::ordinary &&
          (p.normal + q.normal).norm() > (exactly ? 0.0 : 1e-5)) {
        complain("swapped normal", scene_.pairs[i], (p.normal + q.normal).norm(), 0.0);
      }
    }
  }
}

TEST_P(Properties, common_translation_changes_nothing) {
  PairScene near = mixed_scene(GetParam(), scaled(12), 3);
  // Positions on a grid on which all sums are exact.
  for (Pose& pose : near.poses) {
    for (double& x : pose.position) x = std::abs(x) < 1e3 ? std::round(x * 0x1p10) * 0x1p-10 : 0.0;
  }
  for (const NarrowTier tier : kTiers) {
    const auto here = compute_results(near, distances(tier));
    for (const double offset : {1e4, 1e6, 1e9}) {
      PairScene far = mixed_scene(GetParam(), scaled(12), 3);
      far.poses = near.poses;
      for (Pose& pose : far.poses) {
        pose.position[0] += offset;
        pose.position[1] -= 2 * offset;
        pose.position[2] += 3 * offset;
      }
      const auto there = compute_results(far, distances(tier));
      for (std::size_t i = 0; i < here.size(); ++i) {
        if (!same(here[i], there[i])) {
          complain("moved far", near.pairs[i], there[i].distance, here[i].distance);
        }
      }
    }
  }
}

TEST_P(Properties, common_rotation_keeps_distance_within_error_bound) {
  PairScene turned = mixed_scene(GetParam(), scaled(12), 3);
  Random random(9);
  for (const BodyPair pair : turned.pairs) {
    Eigen::Quaterniond turn(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                            random.uniform(-1, 1));
    turn.normalize();
    for (const std::uint32_t body : {pair.a, pair.b}) {
      Pose& pose = turned.poses[body];
      const Quaternion& q = pose.orientation;
      const Eigen::Quaterniond orientation =
          turn * Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
      pose.orientation = orientation;
      pose.position = Eigen::Vector3d(turn * as_eigen(pose.position));
    }
  }
  for (const NarrowTier tier : kTiers) {
    const auto before = compute_results(scene_, distances(tier));
    const auto after = compute_results(turned, distances(tier));
    for (std::size_t i = 0; i < before.size(); ++i) {
      // The rotation also rounds positions and orientations.
      const BodyPair pair = scene_.pairs[i];
      const double reach = between(scene_, pair).norm() + std::abs(before[i].distance) +
                           as_eigen(scene_.poses[pair.a].position).norm() + extent(scene_, pair);
      const double bound = before[i].error_bound + after[i].error_bound + 1e-14 * reach;
      if (!(std::abs(before[i].distance - after[i].distance) <= bound)) {
        complain("turned", pair, after[i].distance, before[i].distance);
      }
    }
  }
}

TEST_P(Properties, moving_b_along_normal_adds_to_distance) {
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    const auto before = compute_results(scene_, distances(tier));
    for (const double step : {0.25, 1.0}) {
      PairScene moved = mixed_scene(GetParam(), scaled(12), 3);
      std::vector<double> shift(before.size());
      for (std::size_t i = 0; i < before.size(); ++i) {
        // A full step just separates overlapping shapes, or doubles the distance.
        shift[i] = step * std::abs(before[i].distance);
        Vec3d& position = moved.poses[moved.pairs[i].b].position;
        for (int axis = 0; axis < 3; ++axis) position[axis] += shift[i] * before[i].normal[axis];
      }
      const auto after = compute_results(moved, distances(tier));
      for (std::size_t i = 0; i < before.size(); ++i) {
        const BodyPair pair = scene_.pairs[i];
        const double position = as_eigen(moved.poses[pair.b].position).norm();
        const double rounding = 1e-14 * (position + shift[i] + extent(scene_, pair));
        const double bound = before[i].error_bound + after[i].error_bound + rounding;
        const double expected = before[i].distance + shift[i];
        // If the normal is off by 0.01 degrees, the distance grows by less: 1.6e-8 of the step is
        // missing.
        const double missed = is_curved(scene_, pair) ? 1.6e-8 * shift[i] : 0.0;
        if (!(after[i].distance <= expected + bound) ||
            !(after[i].distance >= expected - bound - missed)) {
          complain("moved along the normal", pair, after[i].distance, expected);
        }
      }
    }
  }
}

TEST_P(Properties, witness_points_lie_on_shapes) {
  for (const NarrowTier tier : kTiers) {
    const auto answers = compute_results(scene_, distances(tier));
    PairScene points = mixed_scene(GetParam(), scaled(12), 3);
    ShapeId point = expect_ok(points.pool.add(SphereShape{0.0}));
    points.pairs.clear();
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const BodyPair pair = scene_.pairs[i];
      for (const bool on_b : {false, true}) {
        // Relative to body a, so that its position costs no precision.
        const Eigen::Vector3d p =
            answers[i].point + (on_b ? answers[i].distance : 0.0) * answers[i].normal;
        const Eigen::Vector3d c = on_b ? between(scene_, pair) : Eigen::Vector3d(0, 0, 0);
        const auto first = static_cast<std::uint32_t>(points.shapes.size());
        points.shapes.insert(points.shapes.end(), {scene_.shapes[on_b ? pair.b : pair.a], point});
        Pose pose = scene_.poses[on_b ? pair.b : pair.a];
        for (int axis = 0; axis < 3; ++axis) pose.position[axis] = c[axis];
        points.poses.insert(points.poses.end(), {pose, Pose::at(p.x(), p.y(), p.z())});
        points.pairs.push_back({first, first + 1});
      }
    }
    const auto found = compute_results(points, distances(NarrowTier::reference));
    for (std::size_t i = 0; i < found.size(); ++i) {
      const BodyPair pair = scene_.pairs[i / 2];
      const double size = extent(scene_, pair) + between(scene_, pair).norm();
      const double doubt = answers[i / 2].error_bound;
      const double bounds = 2 * doubt + found[i].error_bound;
      const double share = is_curved(scene_, pair) ? 4e-7 : 1e-9;
      const double allowed = share * size + bounds;
      if (!(std::abs(found[i].distance) <= allowed)) {
        complain("point off its shape", pair, found[i].distance, 0.0);
      }
    }
  }
}

/// Multiplies all shapes and positions exactly by 2^exponent. Leaves out hulls, since the pool
/// might choose other vertices.
PairScene scaled_scene(PairStyle style, int exponent) {
  Random random(11);
  PairScene scene;
  PairScene result;
  for (const ShapeKind a : all_kinds()) {
    for (const ShapeKind b : all_kinds()) {
      if (a == ShapeKind::hull || b == ShapeKind::hull) continue;
      if (a == ShapeKind::half_space && b == ShapeKind::half_space) continue;
      add_pairs(scene, a, b, style, scaled(30), random);
    }
  }
  const auto times = [exponent](double& x) { x = std::ldexp(x, exponent); };
  const auto add = [&](auto shape, auto... members) {
    (times(shape.*members), ...);
    result.shapes.emplace_back() = expect_ok(result.pool.add(shape));
  };
  const ShapeTables tables = scene.pool.tables();
  for (const ShapeId id : scene.shapes) {
    const std::uint32_t i = id.index();
    if (id.kind() == ShapeKind::sphere) add(tables.spheres[i], &SphereShape::radius);
    if (id.kind() == ShapeKind::capsule) {
      add(tables.capsules[i], &CapsuleShape::radius, &CapsuleShape::half_length);
    }
    if (id.kind() == ShapeKind::box) {
      BoxShape box = tables.boxes[i];
      std::ranges::for_each(box.half, times);
      add(box, &BoxShape::rounding);
    }
    if (id.kind() == ShapeKind::cylinder) {
      add(tables.cylinders[i], &CylinderShape::radius, &CylinderShape::half_length,
          &CylinderShape::rounding);
    }
    if (id.kind() == ShapeKind::cone) {
      add(tables.cones[i], &ConeShape::radius, &ConeShape::half_length, &ConeShape::rounding);
    }
    if (id.kind() == ShapeKind::triangle) {
      TriangleShape triangle = tables.triangles[i];
      for (auto& vertex : triangle.vertex) std::ranges::for_each(vertex, times);
      add(triangle, &TriangleShape::rounding);
    }
    if (id.kind() == ShapeKind::half_space) add(tables.half_spaces[i], &HalfSpaceShape::offset);
  }
  result.poses = scene.poses;
  for (Pose& pose : result.poses) std::ranges::for_each(pose.position, times);
  result.pairs = scene.pairs;
  return result;
}

// Products of lengths overflow or underflow long before the lengths do.
TEST(Sizes, powers_of_two_keep_verdict_and_distance) {
  for (const PairStyle style : {PairStyle::ordinary, PairStyle::degenerate}) {
    const PairScene plain = scaled_scene(style, 0);
    for (const ContactLevel level :
         {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
      const NarrowOptions options{.level = level};
      const auto truth = compute_results(plain, options);
      for (const int exponent : {-300, -166, -140, -125, -106, -60, -36, 36, 93, 121, 133, 300}) {
        const PairScene scene = scaled_scene(style, exponent);
        const auto answers = compute_results(scene, options);
        int complaints = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
          const PairResults& p = truth[i];
          const PairResults& q = answers[i];
          const double apart = std::abs(std::ldexp(q.distance, -exponent) - p.distance);
          const bool near = apart <= 1.001 * (std::ldexp(q.error_bound, -exponent) + p.error_bound);
          if (q.overlap == p.overlap && (level != ContactLevel::distance || near)) continue;
          if (++complaints > 3) break;
          ADD_FAILURE() << to_string(style) << ", times 2^" << exponent << ": " << q.distance
                        << " +- " << q.error_bound << " instead of " << p.distance << " +- "
                        << p.error_bound << '\n'
                        << reproduction(scene, scene.pairs[i]);
        }
      }
    }
  }
}

/// Returns upright boxes and points with numbers from 10^-digits to 10^digits.
PairScene boxes_of_any_sizes(int digits, Random& random) {
  const auto any = [&] {
    const double size = std::pow(10.0, random.uniform(-digits, digits));
    return random.chance(0.15) ? 0.0 : random.chance(0.5) ? size : -size;
  };
  PairScene scene;
  for (std::uint32_t i = 0; i < 2 * scaled(2000); ++i) {
    BoxShape box;
    for (double& half : box.half) half = std::abs(any());
    if (i % 3 == 0) box.half = Vec3d::constant(box.half[0]);
    scene.shapes.emplace_back() = expect_ok(scene.pool.add(box));
    scene.poses.push_back(Pose::at(any(), any(), any()));
    if (i % 2 == 1) scene.pairs.push_back({i - 1, i});
  }
  return scene;
}

// The gaps along the axes decide about upright boxes. These sums lose less than a millionth of the
// sizes.
TEST(Sizes, upright_boxes_of_any_range_are_decided) {
  for (const int digits : {3, 12, 38, 100, 150}) {
    Random random(static_cast<std::uint64_t>(digits));
    const PairScene scene = boxes_of_any_sizes(digits, random);
    const BoxShape* const boxes = scene.pool.tables().boxes;
    for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
      for (const ContactLevel level : {ContactLevel::boolean, ContactLevel::distance}) {
        const auto answers = compute_results(scene, {.level = level, .tier = tier});
        std::size_t clear = 0;
        for (std::size_t i = 0; i < answers.size(); ++i) {
          const BodyPair pair = scene.pairs[i];
          bool sure = true;
          bool apart = false;
          for (int k = 0; k < 3; ++k) {
            const double way =
                std::abs(scene.poses[pair.b].position[k] - scene.poses[pair.a].position[k]);
            const double reach = boxes[scene.shapes[pair.a].index()].half[k] +
                                 boxes[scene.shapes[pair.b].index()].half[k];
            sure = sure && std::abs(way - reach) >= 1e-6 * (way + reach);
            apart = apart || way > reach;
          }
          if (!sure) continue;
          ++clear;
          EXPECT_EQ(answers[i].overlap, !apart) << digits << '\n' << reproduction(scene, pair);
          if (HasFailure()) return;
        }
        EXPECT_GT(clear, answers.size() / 2);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, Properties, testing::ValuesIn(kPairStyles),
                         [](const testing::TestParamInfo<PairStyle>& style) {
                           return std::string(to_string(style.param));
                         });

}  // namespace
}  // namespace winnow::test
