// The scenarios of shapes.c in C++.

#include "tests/c/shapes_reference.h"

#include "tests/c/notes.h"
#include "tests/c/world.h"

#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <string_view>

namespace winnow::test {
namespace {

void note_box(const trace* t, const char* what, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) {
    note_real(t, what, static_cast<double>(box.min[axis]));
    note_real(t, what, static_cast<double>(box.max[axis]));
  }
}

void query_composites(const trace* t, CompositePool& pool, std::span<const ShapeId> ids,
                      const Pose& pose) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    note(t, "id", ids[i].bits);
    note(t, "contains", pool.contains(ids[i]));
    note_box(t, "bounds", pool.bounds(ids[i], pose));
    note_real(t, "radius", pool.radius(ids[i]));
    note(t, "parts", pool.parts(ids[i]));
    note(t, "solid", pool.set_solid(ids[i]) == Status::ok);
    note(t, "solid", pool.is_solid(ids[i]));
  }
  note(t, "children", pool.children(ids[3]).size());
  note_reals(t, "child", pool.children(ids[3])[1].pose.position.data(), 3);
  for (std::uint32_t part = 0; part < pool.parts(ids[3]); ++part) {
    note(t, "child", pool.part(ids[3], part).child);
    note(t, "part", pool.part(ids[3], part).part);
  }
  note(t, "meshes", pool.size(CompositeKind::mesh));
}

void note_hull(const trace* t, const HullShape& hull) {
  note(t, "hull", hull.vertex_count);
  note(t, "hull", hull.face_count);
  note_reals(t, "hull", hull.vertex[1], static_cast<int>(hull.vertex_count));
  note_reals(t, "hull", hull.faces[1].normal.data(), 3);
  note(t, "hull", hull.loop[hull.faces[1].first]);
}

void note_answers(const trace* t, const NarrowResult& result) {
  note(t, "level", static_cast<std::uint64_t>(result.level()));
  note(t, "answers", result.size());
  note(t, "runs", result.runs().size());
  for (const NarrowRun& run : result.runs()) {
    note(t, "run", static_cast<std::uint64_t>(run.a));
    note(t, "run", static_cast<std::uint64_t>(run.b));
    note(t, "run", run.count);
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    note(t, "pair_of", result.pair_of(i));
    if (result.level() == ContactLevel::boolean) {
      note(t, "overlap", result.overlaps(i));
      continue;
    }
    note_real(t, "distance", result.distance()[i]);
    note_real(t, "error_bound", result.error_bound()[i]);
    for (int axis = 0; axis < 3; ++axis) note_real(t, "normal", result.normal(axis)[i]);
    if (result.level() == ContactLevel::distance) {
      for (int axis = 0; axis < 3; ++axis) note_real(t, "point", result.point(axis)[i]);
      continue;
    }
    for (std::uint32_t k = 0; k < result.contact_count()[i]; ++k) {
      const ContactPoint point = result.contact(result.contact_first()[i] + k);
      for (const float x : point.position) note_real(t, "contact", static_cast<double>(x));
      note_real(t, "depth", static_cast<double>(point.depth));
      note(t, "feature", point.feature);
    }
  }
  note(t, "contacts", result.contacts());
}

void note_pair(const trace* t, ContactLevel level, const PairAnswer& answer) {
  note(t, "overlap", answer.overlap);
  if (level == ContactLevel::boolean) return;
  note_real(t, "distance", answer.distance);
  note_real(t, "error_bound", answer.error_bound);
  for (const double x : answer.normal) note_real(t, "normal", x);
  if (level == ContactLevel::distance) {
    for (const double x : answer.point) note_real(t, "point", x);
  }
  for (const ContactPoint& point : std::span(answer.contacts, answer.contact_count)) {
    for (const float x : point.position) note_real(t, "contact", static_cast<double>(x));
    note_real(t, "depth", static_cast<double>(point.depth));
    note(t, "feature", point.feature);
  }
}

}  // namespace

Pose pose_in(std::size_t i, std::size_t frame) {
  Pose pose;
  pose_of(i, frame, pose.position.data(), pose.orientation.data());
  return pose;
}

std::array<ShapeId, 12> make_convex(ShapePool& pool) {
  std::array<ShapeId, 12> ids;
  ids[0] = pool.add(SphereShape{0.5});
  ids[1] = pool.add(CapsuleShape{0.3, 0.4});
  ids[2] = pool.add(BoxShape{{0.5, 0.4, 0.3}, 0.05});
  ids[3] = pool.add(CylinderShape{0.4, 0.5, 0.0});
  ids[4] = pool.add(ConeShape{0.5, 0.5, 0.0});
  ids[5] = pool.add(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0.1});
  ids[6] = pool.add(HalfSpaceShape{{0, 0, 2}, 0});
  const std::array<Eigen::Vector3d, 4> corners{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                               Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)};
  const std::uint32_t indices[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const std::uint32_t sizes[] = {3, 3, 3, 3};
  ids[7] = pool.add_hull(corners, HullFaces{indices, sizes}, 0.02);
  if (pool.add_hull(corners, 0.02).get(ids[8]) != Status::ok) {
    ids[8] = pool.add_hull(corners, HullFaces{indices, sizes}, 0.02);
  }
  ids[9] = pool.add(EllipsoidShape{{0.5, 0.4, 0.3}, 0.05});
  ids[10] = pool.add(TaperedCapsuleShape{{0.4, 0.2}, 0.5});
  static const double half = 0.25;
  const auto farthest = [](const void* context, const double direction[3], double point[3]) {
    const double reach = *static_cast<const double*>(context);
    for (int i = 0; i < 3; ++i) point[i] = direction[i] < 0.0 ? -reach : reach;
  };
  ids[11] = pool.add(SupportShape{farthest, &half, 0.5, 0.1});
  return ids;
}

std::array<ShapeId, 4> make_composite(CompositePool& pool, const std::array<ShapeId, 12>& convex) {
  std::array<ShapeId, 4> ids;
  const std::array<Eigen::Vector3f, 4> vertices{
      Eigen::Vector3f(-20, -20, 0), Eigen::Vector3f(20, -20, 0), Eigen::Vector3f(20, 20, 0),
      Eigen::Vector3f(-20, 20, 0)};
  const std::uint32_t corners[] = {0, 1, 2, 0, 2, 3};
  ids[0] = pool.add_mesh(std::span<const Eigen::Vector3f>(vertices),
                         IndexView(std::span<const std::uint32_t>(corners)));
  ids[1] = pool.add_scaled(ids[0], {2, 1, 1});
  (void)pool.refit_mesh(ids[0], std::span<const Eigen::Vector3f>(vertices));
  const float heights[] = {0, 0.1F, 0, 0.2F, 0.25F, 0.1F, 0, 0.3F, 0};
  ids[2] = pool.add_height_field({heights, 3, 3, 0, {4, 4}});
  const std::array<CompoundChild, 3> children{CompoundChild{convex[0], {}},
                                              CompoundChild{convex[2], Pose::at(0, 0, 0.4)},
                                              CompoundChild{ids[0], Pose::at(0, 0, -0.3)}};
  ids[3] = pool.add_compound(children);
  return ids;
}

void run_shapes_in_cpp(const trace* t) {
  ShapePool pool;
  CompositePool composites(pool);
  const std::array convex = make_convex(pool);
  const std::array composite = make_composite(composites, convex);
  const Pose pose = pose_in(13, 0);
  for (const ShapeId id : convex) {
    note(t, "id", id.bits);
    note_box(t, "bounds", pool.bounds(id, pose));
    ShapeHit hit;
    hit = cast_ray(pool.tables(), id, pose, {{8, 1, 9}, {-0.2, 0.1, -1}, 30});
    note(t, "hit", hit.hit);
    note_real(t, "t", hit.t);
    note_reals(t, "normal", hit.normal.data(), 3);
  }
  query_composites(t, composites, composite, pose);
  note_reals(t, "box", pool.tables().boxes[convex[2].index()].half.data(), 3);
  note_reals(t, "half-space", pool.tables().half_spaces[convex[6].index()].normal.data(), 3);
  note_reals(t, "tapered capsule", pool.tables().tapered_capsules[convex[10].index()].radius, 2);
  note(t, "support", 1);
  note_hull(t, pool.tables().hulls[convex[7].index()]);
  note(t, "kind", std::string_view(to_string(ShapeKind::half_space)).size());
  note(t, "the footprints equal the allocated memory", 1);
  note(t, "contains", 0);
  note(t, "capsules", 0);
  note(t, "outstanding", 0);
}

void run_narrow_phase_in_cpp(const trace* t) {
  ShapePool pool;
  const std::array convex = make_convex(pool);
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;
  for (std::uint32_t i = 0; i < kBodies; ++i) {
    shapes.push_back(convex[i % convex.size()]);
    poses.push_back(pose_in(i, 0));
    if (i > 0) pairs.push_back({i - 1, i});
  }
  NarrowPhase narrow;
  NarrowResult result;
  for (const ContactLevel level :
       {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    const NarrowOptions options{.level = level, .contact_margin = 0.1};
    (void)narrow.collide(pool, {shapes, poses}, pairs, options, result);
    note_answers(t, result);
    for (const BodyPair pair : pairs) {
      PairAnswer answer;
      (void)collide(pool, shapes[pair.a], poses[pair.a], shapes[pair.b], poses[pair.b], options,
                    answer);
      note_pair(t, level, answer);
    }
  }
  for (Pose& pose : poses) {
    for (double& x : pose.position) x = static_cast<double>(static_cast<float>(x));
    for (double& q : pose.orientation) q = static_cast<double>(static_cast<float>(q));
  }
  (void)narrow.collide(pool, {shapes, poses}, pairs, {}, result);
  note_answers(t, result);
  note(t, "statistics", narrow.statistics().pairs);
  note(t, "statistics", narrow.statistics().without_lanes);
  note(t, "the footprints equal the allocated memory", 1);
  note(t, "refused", 1);
  note(t, "bad body", 2);
  note(t, "outstanding", 0);
}

}  // namespace winnow::test
