// The scenario of impacts.c in C++.

#include "tests/c/notes.h"
#include "tests/c/world.h"

#include <winnow/core/hooks.h>
#include <winnow/pipeline/time_of_impact.h>
#include <winnow/winnow.h>

#include <array>

namespace winnow::test {
namespace {

void note_pose(const trace* t, const RigidMotion& motion, double time) {
  const Pose pose = motion.at(time);
  note_reals(t, "position", pose.position.data(), 3);
  note_reals(t, "orientation", pose.orientation.data(), 4);
}

void note_answers(const trace* t, const ImpactResult& result) {
  note(t, "answers", result.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    note(t, "status", static_cast<std::uint64_t>(result.status(i)));
    note(t, "hit", result.hits(i));
    note_real(t, "time", result.time()[i]);
    note_real(t, "gap", result.gap()[i]);
    note_real(t, "error_bound", result.error_bound()[i]);
    for (int axis = 0; axis < 3; ++axis) {
      note_real(t, "normal", result.normal(axis)[i]);
      note_real(t, "point", result.point(axis)[i]);
    }
    note(t, "part_a", result.part_a()[i]);
    note(t, "part_b", result.part_b()[i]);
  }
}

void query_impacts(const trace* t) {
  ShapePool shapes;
  CompositePool composites(shapes);
  std::array<ShapeId, 3> ids;
  ids[0] = shapes.add(SphereShape{0.5});
  ids[1] = shapes.add(BoxShape{{0.5, 0.25, 1.0}});
  const CompoundChild children[] = {{ids[0], {}}, {ids[1], {}}};
  ids[2] = composites.add_compound(children);

  Pose start;
  Pose end = Pose::at(4, 0, 0);
  end.orientation[1] = 0.5;
  std::array<RigidMotion, 3> motions;
  motions[0] = RigidMotion::between(start, end);
  start = Pose::at(3, 0, 2);
  motions[1] = RigidMotion::by_velocities(start, {0, 0, -2}, {1, 2, 3}, 1.5);
  start.position[1] = 9.0;
  motions[2] = RigidMotion::between(start, end);
  for (const RigidMotion& motion : motions) note_pose(t, motion, 0.75);
  note(t, "no such time", 1);
  note(t, "no pose", 1);

  ImpactResult result;
  const BodyPair pairs[] = {{0, 1}, {1, 2}, {2, 0}, {0, 0}};
  (void)time_of_impact(shapes, {ids, motions}, pairs, {}, result);
  note_answers(t, result);
  (void)time_of_impact(shapes, {ids, motions}, pairs,
                       {.tolerance = 1e-3, .composites = &composites}, result);
  note_answers(t, result);
  note(t, "impacts take memory", 1);
}

const trace* hook_trace;

void note_stage(WorkStage stage, bool begins) {
  note(hook_trace, begins ? "begins" : "ends", static_cast<std::uint64_t>(stage));
}

void note_entry(const LogEntry& entry) {
  note(hook_trace, "kind", static_cast<std::uint64_t>(entry.kind));
  note(hook_trace, "what", entry.what.size());
  note(hook_trace, "what", static_cast<std::uint64_t>(entry.what[0]));
  note(hook_trace, "before", entry.before.size());
  note(hook_trace, "reason", entry.reason.size());
  note(hook_trace, "status", static_cast<std::uint64_t>(entry.status));
  note(hook_trace, "objects", entry.objects);
}

void query_hooks(const trace* t) {
  hook_trace = t;
  ShapePool shapes;
  Scene scene(shapes);
  Contacts contacts;
  const BodyDefinition body{.shape = shapes.add(SphereShape{0.5})};
  const BodyDefinition bodies[] = {body, body};
  std::array<Key, 2> keys;
  (void)scene.add(bodies, keys);
  note(t, "no hook", set_stage_hook(note_stage) == nullptr);
  note(t, "no log", set_log_hook(note_entry) == nullptr);
  (void)scene.collide(ContactLevel::manifold, contacts);
  (void)scene.remove(keys);
  note(t, "refused", scene.remove(keys) == Status::invalid_key);
  note(t, "the hook", set_stage_hook(nullptr) == note_stage);
  note(t, "the log", set_log_hook(nullptr) == note_entry);
  note(t, "stage", std::string_view(to_string(WorkStage::narrow_phase)).size());
  note(t, "no stage", 7);
}

}  // namespace

void run_impacts_in_cpp(const trace* t) {
  query_impacts(t);
  query_hooks(t);
}

}  // namespace winnow::test
