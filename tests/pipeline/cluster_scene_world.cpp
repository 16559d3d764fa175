// Keeps a table of the bodies of a ClusterScene, builds one Scene from it for each frame, and
// compares contacts and events. Used by the cluster tests.

#include "tests/pipeline/cluster_scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <memory>

#include "pipeline/shapes/pair_order.h"
#include "tests/support/answers.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

Pose random_pose(double size, Random& random) {
  Pose pose = Pose::at(random.uniform(0, size), random.uniform(0, size), random.uniform(0, size));
  for (double& q : pose.orientation) q = random.uniform(-1, 1);
  return pose;
}

}  // namespace

WorldShapes::WorldShapes() {
  ShapeId id;
  const auto keep = [&](Status status, std::vector<ShapeId>& ids) {
    EXPECT_EQ(status, Status::ok);
    ids.push_back(id);
  };
  for (const double radius : {0.5, 0.7}) keep(shapes.add(SphereShape{radius}).get(id), movable);
  keep(shapes.add(CapsuleShape{0.3, 0.5}).get(id), movable);
  keep(shapes.add(BoxShape{{0.5, 0.4, 0.6}}).get(id), movable);
  keep(shapes.add(BoxShape{{0.9, 0.2, 0.3}}).get(id), movable);
  keep(shapes.add(CylinderShape{0.4, 0.5}).get(id), movable);
  const std::vector<Vec3d> points{{0.5, 0, 0},  {-0.5, 0, 0}, {0, 0.6, 0},
                                  {0, -0.6, 0}, {0, 0, 0.7},  {0.3, 0.3, -0.5}};
  keep(shapes.add_hull(PointView(points), 0.0).get(id), movable);
  const CompoundChild cross[] = {{movable[3], Pose::at(0.4, 0, 0)},
                                 {movable[0], Pose::at(-0.4, 0, 0)}};
  keep(composites.add_compound(cross).get(id), movable);
  keep(shapes.add(HalfSpaceShape{}).get(id), ground);
  const MeshData hills = terrain(8);
  keep(composites.add_mesh(hills.points(), hills.indices()).get(id), ground);
  std::vector<float> heights;
  for (int i = 0; i < 64; ++i) heights.push_back(static_cast<float>(i % 5) * 0.2F);
  keep(composites.add_height_field({heights, 8, 8}).get(id), ground);
  const CompoundChild fence[] = {{movable[4], Pose::at(0, 0, 1)}, {movable[2], Pose::at(2, 0, 1)}};
  keep(composites.add_compound(fence).get(id), ground);
}

std::vector<FlatContact> flattened(const Contacts& contacts) {
  std::vector<FlatContact> flat(contacts.size());
  for (const ContactRun& run : contacts.runs()) {
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
      flat[i].code = KindPairs::index(run.kind_a, run.kind_b);
    }
  }
  for (std::size_t i = 0; i < flat.size(); ++i) {
    flat[i].a = contacts.data_a()[i];
    flat[i].b = contacts.data_b()[i];
    flat[i].persisted = contacts.event()[i] == ContactEvent::persisted;
    auto& bits = flat[i].bits;
    if (contacts.level() == ContactLevel::pairs) continue;
    for (std::uint32_t m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1];
         ++m) {
      bits.insert(bits.end(), {contacts.part_a()[m], contacts.part_b()[m]});
      const auto add = [&](std::span<const double> column) {
        if (!column.empty()) bits.push_back(std::bit_cast<std::uint64_t>(column[m]));
      };
      add(contacts.distance());
      add(contacts.error_bound());
      for (int axis = 0; axis < 3; ++axis) add(contacts.normal(axis));
      for (int axis = 0; axis < 3; ++axis) add(contacts.point(axis));
      if (contacts.level() != ContactLevel::manifold) continue;
      for (std::uint32_t p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        const ContactPoint point = contacts.contact(p);
        for (const float x : point.position) bits.push_back(std::bit_cast<std::uint32_t>(x));
        bits.insert(bits.end(), {std::bit_cast<std::uint32_t>(point.depth), point.feature});
      }
    }
  }
  return flat;
}

ClusterSceneWorld::ClusterSceneWorld(const WorldShapes& shapes, std::uint32_t ranks,
                                     const ClusterSceneOptions& options)
    : shapes_(shapes), options_(options) {
  options_.scene.composites = &shapes.composites;
  transport_ = std::make_unique<LoopbackTransport>(ranks);
  cluster_ = std::make_unique<ClusterScene>(*transport_, shapes_.shapes, options_);
}

void ClusterSceneWorld::add_ground() {
  std::vector<BodyName> names;
  std::vector<BodyDefinition> bodies;
  for (const ShapeId shape : shapes_.ground) {
    // Names include 0 and the greatest value.
    const BodyName name = (next_++ - 1) * 0x5555555555555555ULL;
    BodyDefinition body{.shape = shape, .pose = Pose::at(0, 0, 0.5), .state = BodyState::fixed};
    body.data = name;
    ground_[name] = body;
    names.push_back(name);
    bodies.push_back(body);
    fresh_.insert(name);
  }
  ASSERT_EQ(cluster_->replicate({names, bodies}), Status::ok);
}

void ClusterSceneWorld::move_ground(Random& random) {
  std::vector<BodyName> names;
  std::vector<Pose> poses;
  for (auto& [name, body] : ground_) {
    if (!body.shape.is_composite()) continue;
    body.pose.position[2] += random.uniform(-0.2, 0.2);
    names.push_back(name);
    poses.push_back(body.pose);
  }
  ASSERT_EQ(cluster_->move_replicated(names, poses), Status::ok);
}

BodyDefinition ClusterSceneWorld::make_body(const Pose& pose, Random& random) const {
  BodyDefinition body{.shape = shapes_.movable[random.below(shapes_.movable.size())], .pose = pose};
  if (random.chance(0.1)) body.state = BodyState::fixed;
  if (random.chance(0.2)) body.filter = {.layers = 2, .mask = 1};
  return body;
}

void ClusterSceneWorld::add(std::size_t count, double size, Random& random) {
  std::vector<BodyDefinition> bodies;
  for (; count > 0; --count) bodies.push_back(make_body(random_pose(size, random), random));
  add_bodies(bodies, random);
}

void ClusterSceneWorld::add_at(const Pose& pose, Random& random) {
  add_bodies({make_body(pose, random)}, random);
}

void ClusterSceneWorld::add_bodies(const std::vector<BodyDefinition>& bodies, Random& random) {
  const std::uint32_t ranks = cluster_->ranks();
  std::vector<std::vector<BodyName>> names(ranks);
  std::vector<std::vector<BodyDefinition>> of_rank(ranks);
  for (BodyDefinition body : bodies) {
    const BodyName name = next_++ * 0x9E3779B97F4A7C15ULL;
    const std::uint32_t rank = static_cast<std::uint32_t>(random.below(ranks));
    body.data = name;
    names[rank].push_back(name);
    of_rank[rank].push_back(body);
    bodies_[name] = body;
    owners_[name] = rank;
    fresh_.insert(name);
  }
  std::vector<ClusterSceneBatch> batches(ranks);
  for (std::uint32_t r = 0; r < ranks; ++r) batches[r] = {names[r], of_rank[r]};
  std::vector<Status> answers(ranks, Status::unsupported);
  ASSERT_EQ(cluster_->add(batches, answers), Status::ok);
  EXPECT_EQ(std::count(answers.begin(), answers.end(), Status::ok), ranks);
}

void ClusterSceneWorld::move(double share, double step, Random& random) {
  std::map<std::uint32_t, std::pair<std::vector<BodyName>, std::vector<Pose>>> moves;
  for (auto& [name, body] : bodies_) {
    if (!random.chance(share)) continue;
    for (double& x : body.pose.position) x += random.uniform(-step, step);
    body.pose.orientation[1] += 0.01;
    auto& [names, poses] = moves[rank_of(name)];
    names.push_back(name);
    poses.push_back(body.pose);
  }
  for (const auto& [rank, bodies] : moves) {
    ASSERT_EQ(cluster_->move(rank, bodies.first, bodies.second), Status::ok);
  }
}

void ClusterSceneWorld::remove(std::size_t count, Random& random) {
  for (; count > 0 && !bodies_.empty(); --count) {
    auto one = bodies_.begin();
    std::advance(one, random.below(bodies_.size()));
    const BodyName name = one->first;
    ASSERT_EQ(cluster_->remove(rank_of(name), std::span(&name, 1)), Status::ok);
    bodies_.erase(one);
    owners_.erase(name);
    fresh_.erase(name);
  }
}

/// Updates the rank of each body from the arrivals that the ranks report.
void ClusterSceneWorld::follow() {
  std::size_t bodies = 0;
  for (std::uint32_t rank = 0; rank < cluster_->ranks(); ++rank) {
    bodies += cluster_->size(rank);
    for (const ClusterBody& body : cluster_->arrived(rank)) owners_[body.name] = rank;
  }
  ASSERT_EQ(bodies, bodies_.size());
  ASSERT_EQ(owners_.size(), bodies_.size());
  for (const auto& [name, rank] : owners_) {
    BodyDefinition body = expect_ok(cluster_->body(rank, name));
    ASSERT_EQ(body.data, name);
    ASSERT_EQ(body.filter, bodies_.at(name).filter);
  }
}

std::vector<FlatContact> ClusterSceneWorld::found() const {
  std::vector<FlatContact> all;
  for (std::uint32_t rank = 0; rank < cluster_->ranks(); ++rank) {
    const std::vector<FlatContact> of_rank = flattened(cluster_->contacts(rank));
    EXPECT_TRUE(std::ranges::is_sorted(of_rank, {}, &FlatContact::order));
    all.insert(all.end(), of_rank.begin(), of_rank.end());
  }
  std::ranges::sort(all, {}, &FlatContact::order);
  return all;
}

std::unique_ptr<Scene> ClusterSceneWorld::one_scene() const {
  std::map<BodyName, BodyDefinition> all = bodies_;
  all.insert(ground_.begin(), ground_.end());
  auto scene = std::make_unique<Scene>(shapes_.shapes, options_.scene);
  for (const auto& [name, body] : all) {
    expect_ok(scene->add(body));
  }
  return scene;
}

std::vector<FlatContact> ClusterSceneWorld::expected(ContactLevel level) const {
  Contacts contacts;
  EXPECT_EQ(one_scene()->collide(level, contacts), Status::ok);
  std::vector<FlatContact> flat = flattened(contacts);
  for (FlatContact& one : flat) {
    one.persisted =
        touched_.contains(one.order()) && !fresh_.contains(one.a) && !fresh_.contains(one.b);
  }
  return flat;
}

/// Each pair that touched before and does not persist must be reported as ended by exactly one
/// rank.
void ClusterSceneWorld::check_events(const std::vector<FlatContact>& found) {
  std::set<PairOrder> still;
  std::set<std::pair<BodyName, BodyName>> expected;
  std::multiset<std::pair<BodyName, BodyName>> reported;
  for (const FlatContact& one : found) {
    if (one.persisted) still.insert(one.order());
  }
  for (const PairOrder& pair : touched_) {
    if (!still.contains(pair)) expected.emplace(std::get<1>(pair), std::get<2>(pair));
  }
  for (std::uint32_t rank = 0; rank < cluster_->ranks(); ++rank) {
    for (const EndedContact& one : cluster_->contacts(rank).ended()) {
      reported.emplace(one.data_a, one.data_b);
    }
  }
  EXPECT_TRUE(std::ranges::equal(reported, expected));
  touched_.clear();
  for (const FlatContact& one : found) touched_.insert(one.order());
  fresh_.clear();
}

void ClusterSceneWorld::check(ContactLevel level) {
  ASSERT_EQ(cluster_->collide(level), Status::ok);
  follow();
  const std::vector<FlatContact> all = found();
  const std::vector<FlatContact> one_scene = expected(level);
  ASSERT_EQ(all.size(), one_scene.size()) << cluster_->ranks() << " ranks";
  EXPECT_TRUE(all == one_scene) << cluster_->ranks() << " ranks";
  EXPECT_EQ(cluster_->statistics().pairs, all.size());
  EXPECT_EQ(cluster_->statistics().bodies, bodies_.size());
  check_events(all);
}

std::vector<std::vector<std::byte>> ClusterSceneWorld::saved() const {
  std::vector<std::vector<std::byte>> kept(cluster_->ranks());
  for (std::uint32_t rank = 0; rank < cluster_->ranks(); ++rank) {
    EXPECT_EQ(cluster_->save(rank, kept[rank]), Status::ok);
  }
  return kept;
}

void ClusterSceneWorld::restart(std::uint32_t ranks) {
  const std::vector<std::vector<std::byte>> kept = saved();
  cluster_.reset();
  transport_ = std::make_unique<LoopbackTransport>(ranks);
  cluster_ = std::make_unique<ClusterScene>(*transport_, shapes_.shapes, options_);
  std::vector<BodyName> names;
  std::vector<BodyDefinition> ground;
  for (const auto& [name, body] : ground_) {
    names.push_back(name);
    ground.push_back(body);
  }
  ASSERT_EQ(cluster_->replicate({names, ground}), Status::ok);
  std::vector<std::vector<std::byte>> given(ranks);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    auto& to = given[i % ranks];
    to.insert(to.end(), kept[i].begin(), kept[i].end());
  }
  std::vector<std::span<const std::byte>> spans(given.begin(), given.end());
  std::vector<Status> answers(ranks, Status::unsupported);
  ASSERT_EQ(cluster_->restore(spans, answers), Status::ok);
  EXPECT_EQ(std::count(answers.begin(), answers.end(), Status::ok), ranks);
  for (std::uint32_t rank = 0; rank < ranks; ++rank) {
    std::vector<ClusterBody> bodies(cluster_->size(rank));
    ASSERT_EQ(cluster_->bodies(rank, bodies), Status::ok);
    for (const ClusterBody& body : bodies) owners_[body.name] = rank;
  }
}

}  // namespace winnow::test
