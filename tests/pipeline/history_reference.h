#pragma once

// Reference implementation of Contacts::previous_pair and previous_point. Used by
// warm_start_test.cpp and the contacts fuzzer.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/winnow.h>
#include <Eigen/Geometry>
#include "tests/support/answers.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace winnow::test {

/// Stores the whole last frame and searches all of it for each point, by the definition of
/// Contacts::previous_point. Accepts either of two old points that are equally near up to rounding.
class HistoryReference {
 public:
  /// `radius_of(a, b)` returns the radius of the smaller of two bodies.
  template <typename RadiusOf>
  void compare(const Scene& scene, const Contacts& contacts, bool reduced, RadiusOf&& radius_of) {
    ASSERT_EQ(contacts.previous_pair().size(), contacts.size());
    ASSERT_EQ(contacts.previous_point().size(), contacts.points());
    std::map<PairName, KeptPair> now;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
      const Key a = contacts.a()[i];
      const Key b = contacts.b()[i];
      KeptPair kept = keep(scene, contacts, i);
      const auto before = kept_.find(name_of(scene, a, b));
      ASSERT_EQ(contacts.previous_pair()[i],
                before == kept_.end() ? kNoContact : before->second.index);
      if (before == kept_.end()) {
        for (const KeptPoint& point : kept.points) {
          ASSERT_EQ(contacts.previous_point()[point.index], kNoContact);
        }
      } else {
        ++persisted;
        const double reach = 0.02 * radius_of(a, b);
        ASSERT_NO_FATAL_FAILURE(
            compare_points(contacts, kept.points, before->second.points, reduced, reach));
      }
      now[name_of(scene, a, b)] = std::move(kept);
    }
    kept_ = std::move(now);
  }
  void forget() { kept_.clear(); }

  std::size_t persisted = 0;
  std::size_t by_feature = 0;
  std::size_t by_place = 0;

 private:
  /// Keys and kinds of shapes of a pair: a pair with other kinds is a different pair.
  using PairName = std::array<std::uint32_t, 6>;

  struct KeptPoint {
    std::uint32_t index;
    std::uint32_t part[2];
    std::uint64_t feature;
    /// Position in the frames of both bodies.
    Eigen::Vector3d local[2];
    bool taken;
  };

  struct KeptPair {
    std::uint32_t index;
    std::vector<KeptPoint> points;
  };

  /// Tolerance for rounding.
  static constexpr double kSlack = 1e-9;

  [[nodiscard]] static Eigen::Vector3d in_frame_of(const Pose& pose, const Eigen::Vector3d& world) {
    const Eigen::Quaterniond q(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                               pose.orientation[3]);
    return q.normalized().inverse() * (world - as_eigen(pose.position));
  }

  [[nodiscard]] static PairName name_of(const Scene& scene, Key a, Key b) {
    BodyDefinition body[2];
    body[0] = expect_ok(scene.body(a));
    body[1] = expect_ok(scene.body(b));
    return {a.id, a.stamp, b.id, b.stamp, body[0].shape.kind_index(), body[1].shape.kind_index()};
  }

  [[nodiscard]] static KeptPair keep(const Scene& scene, const Contacts& contacts,
                                     std::uint32_t i) {
    BodyDefinition body[2];
    body[0] = expect_ok(scene.body(contacts.a()[i]));
    body[1] = expect_ok(scene.body(contacts.b()[i]));
    KeptPair kept{i, {}};
    if (contacts.point_first().empty()) return kept;
    for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
      for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        const ContactPoint point = contacts.contact(p);
        Eigen::Vector3d from_a;
        Eigen::Vector3d from_b;
        for (int k = 0; k < 3; ++k) {
          from_a[k] = static_cast<double>(point.position[k]);
          from_b[k] = from_a[k] + (body[0].pose.position[k] - body[1].pose.position[k]);
        }
        Pose turn[2];
        for (int side = 0; side < 2; ++side) {
          turn[side].orientation = body[side].pose.orientation;
        }
        kept.points.push_back({p,
                               {contacts.part_a()[m], contacts.part_b()[m]},
                               point.feature,
                               {in_frame_of(turn[0], from_a), in_frame_of(turn[1], from_b)},
                               false});
      }
    }
    return kept;
  }

  [[nodiscard]] static double apart(const KeptPoint& now, const KeptPoint& old) {
    return std::min((now.local[0] - old.local[0]).norm(), (now.local[1] - old.local[1]).norm());
  }

  void compare_points(const Contacts& contacts, const std::vector<KeptPoint>& points,
                      std::vector<KeptPoint>& before, bool reduced, double reach) {
    std::vector<bool> found(points.size(), false);
    const auto compare_features = [&](bool any_part) {
      for (std::size_t k = 0; k < points.size(); ++k) {
        if (found[k]) continue;
        const auto old = std::find_if(before.begin(), before.end(), [&](const KeptPoint& one) {
          return !one.taken && one.feature == points[k].feature &&
                 (any_part || std::equal(one.part, one.part + 2, points[k].part));
        });
        if (old == before.end()) continue;
        EXPECT_EQ(contacts.previous_point()[points[k].index], old->index);
        found[k] = old->taken = true;
        ++by_feature;
      }
    };
    compare_features(false);
    if (reduced) compare_features(true);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (found[k]) continue;
      ASSERT_NO_FATAL_FAILURE(compare_place(contacts, points[k], before, reach));
    }
  }

  /// Checks that the scene chose the nearest remaining old point, or none if it is out of reach.
  void compare_place(const Contacts& contacts, const KeptPoint& point,
                     std::vector<KeptPoint>& before, double reach) {
    double least = std::numeric_limits<double>::infinity();
    KeptPoint* given = nullptr;
    const std::uint32_t index = contacts.previous_point()[point.index];
    for (KeptPoint& old : before) {
      if (old.taken) continue;
      least = std::min(least, apart(point, old));
      if (old.index == index) given = &old;
    }
    if (index == kNoContact) {
      EXPECT_GE(least, reach * (1.0 - kSlack));
      return;
    }
    ASSERT_NE(given, nullptr);
    EXPECT_LE(apart(point, *given), reach * (1.0 + kSlack));
    EXPECT_LE(apart(point, *given), least + kSlack);
    given->taken = true;
    ++by_place;
  }

  std::map<PairName, KeptPair> kept_;
};

}  // namespace winnow::test
