// The class Scene: bodies and collide. Other members are in pair_filter.cpp,
// continuous_collision.cpp, scene_queries.cpp and snapshots.cpp.

#include "pipeline/python/shared_scene.h"

#include "pipeline/python/batch.h"
#include "pipeline/python/bodies.h"
#include "pipeline/python/contact_choices.h"
#include "pipeline/python/drawing.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/snapshots.h"

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {

std::unique_ptr<SceneQueries> SharedScene::take_queries() {
  const std::lock_guard lock(queries_mutex_);
  if (queries_.empty()) return std::make_unique<SceneQueries>(scene);
  std::unique_ptr<SceneQueries> taken = std::move(queries_.back());
  queries_.pop_back();
  return taken;
}

void SharedScene::put_queries(std::unique_ptr<SceneQueries> queries) noexcept {
  const std::lock_guard lock(queries_mutex_);
  try {
    queries_.push_back(std::move(queries));
  } catch (const std::bad_alloc&) {
    // The next query makes a new one.
  }
}

void SharedScene::exchange_predicate(std::shared_ptr<Predicate>& other) {
  predicate_.swap(other);
  scene.set_predicate(predicate_ ? pair_predicate(*predicate_) : PairPredicate{});
}

namespace {

/// Checks an option here, because a scene would fail only when the first body is added.
void expect_length(double length, const char* name) {
  if (length >= 0.0 && length < std::numeric_limits<double>::infinity()) return;
  throw Refusal(Status::invalid_argument, std::string(name) + ": expected a finite value >= 0");
}

}  // namespace

SceneOptions scene_options(double contact_margin, const std::string& tier,
                           const std::vector<std::string>& structures, bool parallel) {
  SceneOptions options;
  options.execution = parallel ? Execution::parallel() : Execution::serial();
  if (structures.size() != kBodyStates) {
    throw Refusal(Status::invalid_argument, "structures: of fixed, dynamic and sleeping bodies");
  }
  for (std::size_t i = 0; i < kBodyStates; ++i) options.structures[i] = structure_of(structures[i]);
  expect_length(contact_margin, "contact_margin");
  options.contact_margin = contact_margin;
  options.tier = chosen(kTiers, tier, "tier");
  return options;
}

namespace {

[[nodiscard]] std::shared_ptr<SharedScene> make_scene(
    const std::shared_ptr<SharedShapes>& shapes, double contact_margin, const std::string& tier,
    double cache_tolerance, bool part_manifolds, bool suppress_ghost_contacts, bool warm_start,
    const std::vector<std::string>& structures, bool parallel, std::size_t build_budget,
    const RecorderPointer& recorder) {
  SceneOptions options = scene_options(contact_margin, tier, structures, parallel);
  expect_length(cache_tolerance, "cache_tolerance");
  options.cache_tolerance = cache_tolerance;
  options.part_manifolds = part_manifolds;
  options.suppress_ghost_contacts = suppress_ghost_contacts;
  options.warm_start = warm_start;
  options.build_budget = build_budget;
  return std::make_shared<SharedScene>(shapes, options, recorder);
}

void reserve(SharedScene& s, const SceneCapacity& room, HeldContacts* contacts, bool touch) {
  const Pages pages = touch ? Pages::prefaulted : Pages::untouched;
  std::unique_lock<std::mutex> filling;
  Contacts* out = nullptr;
  if (contacts != nullptr) {
    filling = contacts->hold();
    out = &contacts->to_fill("contacts");
  }
  change_scene_or_throw(s, "reserve", [&] {
    const Status status = s.scene.reserve(room, pages);
    if (status != Status::ok || out == nullptr) return status;
    return s.scene.reserve_contacts(*out, room, pages);
  });
}

// --- bodies ------------------------------------------------------------------------------------

[[nodiscard]] py::array add_bodies(SharedScene& s, py::handle shape_array, py::handle poses,
                                   py::handle states, py::handle layers, py::handle mask,
                                   py::handle environment, py::handle data, py::handle contact,
                                   py::handle rest, py::handle scene_layer) {
  PoseInput pose(poses);
  ShapeInput shape(*s.shapes, shape_array);
  EachInteger state = body_states(states);
  FilterInput filter(layers, mask, environment);
  Numbers contact_offset(contact, "contact", {}, Valid::length);
  Numbers rest_offset(rest, "rest", {}, Valid::finite);
  EachInteger layer(scene_layer, "layer", kSceneLayers - 1);
  const std::size_t count = agree({&pose, &shape});
  filter.expect(count);
  expect_all(count, {&state, &contact_offset, &rest_offset, &layer});
  const std::vector<ClientData> values = data_of(data, count);
  std::vector<BodyDefinition> bodies(count);
  for (std::size_t i = 0; i < count; ++i) {
    bodies[i] = {shape[i],
                 pose[i],
                 static_cast<BodyState>(state[i]),
                 filter[i],
                 values.empty() ? 0 : values[i],
                 {contact_offset.at(i), rest_offset.at(i)},
                 static_cast<std::uint16_t>(layer[i])};
  }
  const std::vector<ShapeId> used = shapes_of(bodies);
  auto keys = fresh<std::uint64_t>(count);
  const std::span<Key> out(keys_in(keys), count);
  change_scene_or_throw(s, "add", [&] {
    const Status status = s.scene.add(bodies, out);
    if (status == Status::ok) s.held.use(used, 1);
    return status;
  });
  return keys;
}

void remove_bodies(SharedScene& s, py::handle key_array) {
  const KeyInput keys(s, key_array);
  change_scene_or_throw(s, "remove", [&] {
    std::vector<BodyDefinition> bodies;
    Status status = bodies_of(s.scene, keys.keys(), bodies);
    if (status == Status::ok) status = s.scene.remove(keys.keys());
    if (status == Status::ok) s.held.use(shapes_of(bodies), -1);
    return status;
  });
}

void clear(SharedScene& s) {
  changing_scene(s, [&] {
    s.scene.clear();
    s.held.clear();
  });
}

void move_bodies(SharedScene& s, py::handle key_array, py::handle poses) {
  const KeyInput keys(s, key_array);
  PoseInput pose(poses);
  pose.expect(keys.count());
  std::vector<Pose> room;
  change_scene_or_throw(s, "move", [&] { return s.scene.move(keys.keys(), pose.view(room)); });
}

void set_body_state(SharedScene& s, py::handle key_array, const std::string& name) {
  const KeyInput keys(s, key_array);
  const BodyState state = chosen(kBodyStateNames, name, "state");
  change_scene_or_throw(s, "set_body_state",
                        [&] { return s.scene.set_body_state(keys.keys(), state); });
}

void set_shape(SharedScene& s, py::handle key_array, py::handle shape_array) {
  const KeyInput keys(s, key_array);
  ShapeInput shape(*s.shapes, shape_array);
  shape.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  const std::span<const ShapeId> after = shape.list();
  change_scene_or_throw(s, "set_shape", [&] {
    std::vector<BodyDefinition> before;
    Status status = bodies_of(s.scene, list, before);
    if (status == Status::ok && has_twice(list)) status = Status::invalid_key;
    if (status != Status::ok) return status;
    status = set_all(
        list.size(), [&](std::size_t i) { return s.scene.set_shape(list[i], after[i]); },
        [&](std::size_t i) { return s.scene.set_shape(list[i], before[i].shape); });
    if (status != Status::ok) return status;
    s.held.use(after, 1);
    s.held.use(shapes_of(before), -1);
    return Status::ok;
  });
}

// --- properties of bodies ----------------------------------------------------------------------

[[nodiscard]] py::dict body_columns(const SharedScene& s, py::handle key_array) {
  const KeyInput keys(s, key_array);
  std::vector<BodyDefinition> bodies;
  read_or_throw(s.mutex, "bodies", [&] { return bodies_of(s.scene, keys.keys(), bodies); });
  const auto columns = columns_of(std::move(bodies));
  using Body = BodyDefinition;
  static_assert(offsetof(Pose, position) == 0 && sizeof(Pose) == 7 * sizeof(double));
  py::dict result;
  result["shape"] = columns.of(&Body::shape);
  result["pose"] = columns.of(&Body::pose);
  result["state"] = columns.of(&Body::state);
  constexpr std::size_t filter = offsetof(Body, filter);
  result["layers"] = columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, layers));
  result["mask"] = columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, mask));
  result["environment"] =
      columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, environment));
  result["data"] = columns.of(&Body::data);
  constexpr std::size_t offsets = offsetof(Body, offsets);
  result["contact"] = columns.column<double>(offsets + offsetof(ContactOffsets, contact));
  result["rest"] = columns.column<double>(offsets + offsetof(ContactOffsets, rest));
  result["layer"] = columns.of(&Body::layer);
  return result;
}

void collide(SharedScene& s, HeldContacts& contacts, const std::string& level_name) {
  const ContactLevel level = chosen(kLevels, level_name, "level");
  const std::unique_lock<std::mutex> filling = contacts.hold();
  Contacts& out = contacts.to_fill("contacts");
  try {
    accept(s.working([&] { return s.scene.collide(level, out); }), "collide");
  } catch (const py::error_already_set&) {
    out.clear();
    throw;
  }
}

void set_predicate(SharedScene& s, const py::object& function) {
  std::shared_ptr<Predicate> other;
  if (!function.is_none()) other = std::make_shared<Predicate>(function, "predicate");
  changing_scene(s, [&] { s.exchange_predicate(other); });
}

[[nodiscard]] py::object predicate_of(const SharedScene& s) {
  const std::shared_ptr<Predicate> predicate = reading(s.mutex, [&] { return s.predicate(); });
  return predicate ? predicate->object() : py::none();
}

[[nodiscard]] py::dict statistics_dict(const SharedScene& s) {
  const SceneStatistics stats = reading(s.mutex, [&] { return s.scene.statistics(); });
  return py::dict(py::arg("boxes_updated") = stats.boxes_updated,
                  py::arg("body_pairs") = stats.body_pairs,
                  py::arg("rejected_by_spheres") = stats.rejected_by_spheres,
                  py::arg("cached_pairs") = stats.cached_pairs,
                  py::arg("primitive_pairs") = stats.primitive_pairs,
                  py::arg("convex") = narrow_statistics(stats.convex),
                  py::arg("parts") = narrow_statistics(stats.parts));
}

[[nodiscard]] py::dict scene_footprint(const SharedScene& s) {
  const SceneFootprint f = reading(s.mutex, [&] { return s.scene.footprint(); });
  py::dict result;
  const auto add = [&](const char* name, const Bytes& bytes) {
    result[name] = py::make_tuple(bytes.used, bytes.reserved);
  };
  add("bodies", f.bodies);
  for (std::size_t i = 0; i < kBodyStates; ++i) {
    add(std::string(kBodyStateNames[i].first).c_str(), f.partitions[i]);
  }
  add("pairs", f.pairs);
  add("mid_phase", f.mid_phase);
  add("narrow_phase", f.narrow_phase);
  add("total", f.total());
  return result;
}

[[nodiscard]] py::object draw(const SharedScene& s, bool objects, bool structure, bool labels,
                              int max_depth) {
  Drawing drawing;
  read_or_throw(s.mutex, "debug_draw", [&] {
    return s.scene.debug_draw(drawing, {objects, structure, labels, max_depth});
  });
  return drawing.shown();
}

}  // namespace

void add_scene(py::module_& module) {
  module.attr("FIXED") = static_cast<int>(BodyState::fixed);
  module.attr("DYNAMIC") = static_cast<int>(BodyState::dynamic);
  module.attr("SLEEPING") = static_cast<int>(BodyState::sleeping);
  add_contacts(module);
  SceneClass scene(module, "Scene");
  scene.def(py::init(&make_scene))
      .property("shapes", [](const SharedScene& s) { return s.shapes; })
      .def("add", &add_bodies)
      .def("remove", &remove_bodies)
      .def("clear", &clear)
      .def("move", &move_bodies)
      .def("set_body_state", &set_body_state)
      .def("set_shape", &set_shape)
      .def("__len__",
           [](const SharedScene& s) { return reading(s.mutex, [&] { return s.scene.size(); }); })
      .def("size",
           [](const SharedScene& s, const std::string& name) {
             const BodyState state = chosen(kBodyStateNames, name, "state");
             return reading(s.mutex, [&] { return s.scene.size(state); });
           })
      .def("contains",
           [](const SharedScene& s, py::handle key_array) {
             const KeyInput keys(s, key_array);
             return each_answer<bool>(s.mutex, keys.count(), [&](std::size_t i) {
               return s.scene.contains(keys.keys()[i]);
             });
           })
      .def("keys_of",
           [](const SharedScene& s, py::handle id_array) {
             const Integers<std::uint32_t> ids(id_array, "ids");
             return each_key(s.mutex, ids.count(),
                             [&](std::size_t i) { return s.scene.key_of(ids[i]); });
           })
      .def("bodies", &body_columns)
      .def("collide", &collide)
      .def("refresh",
           [](SharedScene& s) { accept(s.working([&] { return s.scene.refresh(); }), "refresh"); })
      .def("set_predicate", &set_predicate)
      .property("predicate", &predicate_of)
      .property("origin",
                [](const SharedScene& s) {
                  const Vec3d o = reading(s.mutex, [&] { return s.scene.origin(); });
                  return py::make_tuple(o.x(), o.y(), o.z());
                })
      .def("statistics", &statistics_dict)
      .def("footprint", &scene_footprint)
      .def("debug_draw", &draw)
      .def("reserve",
           [](SharedScene& s, std::size_t fixed, std::size_t dynamic, std::size_t sleeping,
              std::size_t pairs, std::size_t touching, std::size_t manifolds, std::size_t points,
              const std::string& level, HeldContacts* contacts, bool touch) {
             reserve(s,
                     {{fixed, dynamic, sleeping},
                      pairs,
                      chosen(kLevels, level, "level"),
                      touching,
                      manifolds,
                      points},
                     contacts, touch);
           });
  add_pair_filter(module, scene);
  add_continuous_collision(module, scene);
  add_scene_queries(scene);
  add_scene_snapshots(scene);
  add_sensors(module);
}

}  // namespace winnow::python
