// The collision checker of a robot planner: many configurations of an arm are tested against the
// cell that it works in. A sampling planner tests thousands at a time: they go into one scene, each
// in its own environment, and are answered together. Compared with FCL's
// DynamicAABBTreeCollisionManager, if it is installed.

#include <winnow/winnow.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#if WINNOW_BESIDE_FCL
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision.h>
#endif

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

constexpr std::size_t kLinks = 7;
constexpr double kLinkRadius = 0.06;
constexpr double kLinkHalf = 0.12;
using Configuration = std::array<double, kLinks>;
using Links = std::array<Eigen::Isometry3d, kLinks>;

/// Returns the poses of the links: capsules along z, with joints about x and z in turn.
Links links_of(const Configuration& joints) {
  Links links;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < kLinks; ++i) {
    base.rotate(Eigen::AngleAxisd(joints[i], i % 2 == 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                                        : Eigen::Vector3d::UnitX()));
    base.translate(Eigen::Vector3d(0, 0, kLinkHalf));
    links[i] = base;
    base.translate(Eigen::Vector3d(0, 0, kLinkHalf));
  }
  return links;
}

/// A box of the cell around the arm.
struct Box {
  Eigen::Vector3d half;
  Eigen::Isometry3d pose;
};
std::vector<Box> make_cell(std::size_t boxes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-2.0, 2.0);
  std::uniform_real_distribution<double> half(0.02, 0.12);
  std::uniform_real_distribution<double> angle(-3.0, 3.0);
  std::vector<Box> cell;
  while (cell.size() < boxes) {
    const Eigen::Vector3d at(place(random), place(random), place(random));
    if (at.norm() < 0.8) continue;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(at).rotate(Eigen::AngleAxisd(angle(random), at.normalized()));
    cell.push_back({{half(random), half(random), half(random)}, pose});
  }
  return cell;
}

winnow::Pose pose_of(const Eigen::Isometry3d& where) {
  const Eigen::Vector3d p = where.translation();
  const Eigen::Quaterniond q(where.linear());
  return {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

class WinnowChecker {
 public:
  WinnowChecker(std::span<const Box> cell, std::size_t batch)
      : scene_(shapes_, {.execution = winnow::Execution::serial()}), poses_(batch * kLinks) {
    for (const Box& box : cell) {
      const winnow::Key obstacle = scene_.add(
          {.shape = shapes_.add(winnow::BoxShape{{box.half.x(), box.half.y(), box.half.z()}}),
           .pose = pose_of(box.pose),
           .state = winnow::BodyState::fixed,
           .filter = {.layers = kCell, .environment = winnow::kAllEnvironments}});
      check(bool{obstacle}, "a box is added");
    }
    const winnow::ShapeId link = shapes_.add(winnow::CapsuleShape{kLinkRadius, kLinkHalf});
    for (std::uint32_t i = 0; i < batch * kLinks; ++i) {
      const std::uint32_t configuration = i / kLinks;
      links_.push_back(
          scene_.add({.shape = link,
                      .filter = {.layers = kArm, .mask = kCell, .environment = configuration},
                      .data = configuration}));
      check(bool{links_.back()}, "a link is added");
    }
  }

  void check_all(std::span<const Configuration> batch, std::vector<char>& collides) {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Links links = links_of(batch[i]);
      for (std::size_t k = 0; k < kLinks; ++k) poses_[i * kLinks + k] = pose_of(links[k]);
    }
    check(scene_.move(links_, poses_) == winnow::Status::ok, "links move");
    check(scene_.collide(winnow::ContactLevel::boolean, contacts_) == winnow::Status::ok,
          "contacts are found");
    collides.assign(batch.size(), 0);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const bool first = is_link(contacts_.a()[i]);
      collides[first ? contacts_.data_a()[i] : contacts_.data_b()[i]] = 1;
    }
  }

 private:
  static constexpr std::uint32_t kCell = 1;
  static constexpr std::uint32_t kArm = 2;

  // Boxes were added first.
  [[nodiscard]] bool is_link(winnow::Key key) const { return key.id >= links_.front().id; }

  winnow::ShapePool shapes_;
  winnow::Scene scene_;
  winnow::Contacts contacts_;
  std::vector<winnow::Key> links_;
  std::vector<winnow::Pose> poses_;
};

#if WINNOW_BESIDE_FCL
class FclChecker {
 public:
  explicit FclChecker(std::span<const Box> cell) {
    for (const Box& box : cell) {
      const auto shape = std::make_shared<fcl::Boxd>(2.0 * box.half);
      boxes_.push_back(std::make_unique<fcl::CollisionObjectd>(shape, box.pose));
      manager_.registerObject(boxes_.back().get());
    }
    manager_.setup();
    const auto link = std::make_shared<fcl::Capsuled>(kLinkRadius, 2.0 * kLinkHalf);
    for (std::size_t i = 0; i < kLinks; ++i) {
      links_.push_back(std::make_unique<fcl::CollisionObjectd>(link));
    }
  }

  void check_all(std::span<const Configuration> batch, std::vector<char>& collides) {
    collides.assign(batch.size(), 0);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Links links = links_of(batch[i]);
      bool found = false;
      // A planner that tests one configuration at a time stops at the first link that collides.
      for (std::size_t k = 0; k < kLinks && !found; ++k) {
        links_[k]->setTransform(links[k]);
        links_[k]->computeAABB();
        manager_.collide(links_[k].get(), &found,
                         [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
                           fcl::CollisionResultd result;
                           *static_cast<bool*>(data) =
                               fcl::collide(a, b, fcl::CollisionRequestd(), result) != 0;
                           return *static_cast<bool*>(data);
                         });
      }
      collides[i] = found ? 1 : 0;
    }
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> boxes_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> links_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};
#endif

/// Baseline without a library: each link against each box.
std::size_t count_near(std::span<const Box> cell, const Configuration& joints) {
  std::size_t near = 0;
  for (const Eigen::Isometry3d& link : links_of(joints)) {
    for (const Box& box : cell) {
      const double apart = (link.translation() - box.pose.translation()).norm();
      near += apart <= kLinkHalf + kLinkRadius + box.half.norm() ? 1 : 0;
    }
  }
  return near;
}

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  const std::vector<Box> cell = make_cell(race.size(60, 300));
  std::vector<Configuration> batch(race.size(64, 1'000));
  WinnowChecker winnow_checker(cell, batch.size());
  std::vector<char> collides;
  std::size_t colliding = 0;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-2.0, 2.0);
#if WINNOW_BESIDE_FCL
  FclChecker fcl_checker(cell);
  std::vector<char> of_fcl;
#endif
  for (std::size_t frame = 0; frame < race.size(3, 20); ++frame) {
    for (Configuration& one : batch) {
      for (double& joint : one) joint = angle(random);
    }
    race.time("winnow", [&] { winnow_checker.check_all(batch, collides); });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      colliding += collides[i] != 0 ? 1 : 0;
      check(collides[i] == 0 || count_near(cell, batch[i]) != 0, "what collides is near");
    }
#if WINNOW_BESIDE_FCL
    race.time("FCL, DynamicAABBTree", [&] { fcl_checker.check_all(batch, of_fcl); });
    std::size_t others = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) others += collides[i] != of_fcl[i] ? 1 : 0;
    check(others <= batch.size() / 500, "FCL agrees except for touching pairs");
#endif
  }
  check(colliding != 0, "some configurations collide");
  return race.finish("robot planner: " + std::to_string(batch.size()) + " configurations of " +
                     std::to_string(kLinks) + " links among " + std::to_string(cell.size()) +
                     " boxes, one thread each");
}
