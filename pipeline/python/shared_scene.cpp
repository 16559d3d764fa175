// The class Scene: bodies and collide. Other members are in pair_filter.cpp,
// continuous_collision.cpp, scene_queries.cpp and snapshots.cpp.

#include "pipeline/python/shared_scene.h"

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
    double cache_tolerance, bool contact_reduction, bool suppress_ghost_contacts, bool warm_start,
    const std::vector<std::string>& structures, bool parallel, std::size_t build_budget,
    const RecorderPointer& recorder) {
  SceneOptions options = scene_options(contact_margin, tier, structures, parallel);
  expect_length(cache_tolerance, "cache_tolerance");
  options.cache_tolerance = cache_tolerance;
  options.contact_reduction = contact_reduction;
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
  accept(changing_scene(s,
                        [&] {
                          const Status status = s.scene.reserve(room, pages);
                          if (status != Status::ok || out == nullptr) return status;
                          return s.scene.reserve_contacts(*out, room, pages);
                        }),
         "reserve");
}

// --- bodies ------------------------------------------------------------------------------------

[[nodiscard]] py::array add_bodies(SharedScene& s, py::handle shape_array, py::handle poses,
                                   py::handle states, py::handle layers, py::handle mask,
                                   py::handle environment, py::handle data, py::handle contact,
                                   py::handle rest, py::handle scene_layer) {
  const PoseInput pose(poses);
  const ShapeInput shape(shape_array);
  const BodyStateInput state(states);
  const FilterInput filter(layers, mask, environment);
  OffsetInput offsets(contact, rest);
  const LayerInput layer(scene_layer, "layer");
  const std::size_t count = pose.count();
  shape.expect(count);
  state.expect(count);
  filter.expect(count);
  offsets.expect(count);
  layer.expect(count);
  const std::vector<ClientData> values = data_of(data, count);
  std::vector<BodyDefinition> bodies(count);
  for (std::size_t i = 0; i < count; ++i) {
    bodies[i] = {shape[i],   pose[i], state[i], filter[i], values.empty() ? 0 : values[i],
                 offsets[i], layer[i]};
  }
  const std::vector<ShapeId> used = shapes_of(bodies);
  auto keys = fresh<std::uint64_t>(count);
  const std::span<Key> out(keys_in(keys), count);
  accept(changing_scene(s,
                        [&] {
                          const Status status = s.scene.add(bodies, out);
                          if (status == Status::ok) s.held.use(used, 1);
                          return status;
                        }),
         "add");
  return keys;
}

void remove_bodies(SharedScene& s, py::handle key_array) {
  const KeyInput keys(key_array);
  accept(changing_scene(s,
                        [&] {
                          std::vector<BodyDefinition> bodies;
                          Status status = bodies_of(s.scene, keys.keys(), bodies);
                          if (status == Status::ok) status = s.scene.remove(keys.keys());
                          if (status == Status::ok) s.held.use(shapes_of(bodies), -1);
                          return status;
                        }),
         "remove");
}

void clear(SharedScene& s) {
  changing_scene(s, [&] {
    s.scene.clear();
    s.held.clear();
  });
}

void move_bodies(SharedScene& s, py::handle key_array, py::handle poses) {
  const KeyInput keys(key_array);
  const PoseInput pose(poses);
  std::vector<Pose> room;
  accept(changing_scene(s, [&] { return s.scene.move(keys.keys(), pose.view(room)); }), "move");
}

void set_body_state(SharedScene& s, py::handle key_array, const std::string& name) {
  const KeyInput keys(key_array);
  const BodyState state = chosen(kBodyStateNames, name, "state");
  accept(changing_scene(s, [&] { return s.scene.set_body_state(keys.keys(), state); }),
         "set_body_state");
}

void set_shape(SharedScene& s, py::handle key_array, py::handle shape_array) {
  const KeyInput keys(key_array);
  const ShapeInput shape(shape_array);
  shape.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  std::vector<ShapeId> after(list.size());
  for (std::size_t i = 0; i < after.size(); ++i) after[i] = shape[i];
  accept(changing_scene(
             s,
             [&] {
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
             }),
         "set_shape");
}

// --- properties of bodies ----------------------------------------------------------------------

[[nodiscard]] py::array contains(const SharedScene& s, py::handle key_array) {
  const KeyInput keys(key_array);
  auto result = fresh<bool>(keys.count());
  bool* const to = result.mutable_data();
  reading(s.mutex, [&] {
    for (std::size_t i = 0; i < keys.count(); ++i) to[i] = s.scene.contains(keys.keys()[i]);
  });
  return result;
}

[[nodiscard]] py::array keys_of(const SharedScene& s, py::handle id_array) {
  const Integers<std::uint32_t> ids(id_array, "ids");
  auto result = fresh<std::uint64_t>(ids.count());
  Key* const to = keys_in(result);
  reading(s.mutex, [&] {
    for (std::size_t i = 0; i < ids.count(); ++i) to[i] = s.scene.key_of(ids[i]);
  });
  return result;
}

[[nodiscard]] py::dict body_columns(const SharedScene& s, py::handle key_array) {
  const KeyInput keys(key_array);
  std::vector<BodyDefinition> bodies;
  accept(reading(s.mutex, [&] { return bodies_of(s.scene, keys.keys(), bodies); }), "bodies");
  const auto columns = columns_of(std::move(bodies));
  using Body = BodyDefinition;
  static_assert(offsetof(Pose, position) == 0 && sizeof(Pose) == 7 * sizeof(double));
  py::dict result;
  result["shape"] = columns.column<std::uint32_t>(offsetof(Body, shape));
  result["pose"] = columns.rows<double>(offsetof(Body, pose), 7);
  result["state"] = columns.column<std::uint8_t>(offsetof(Body, state));
  constexpr std::size_t filter = offsetof(Body, filter);
  result["layers"] = columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, layers));
  result["mask"] = columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, mask));
  result["environment"] =
      columns.column<std::uint32_t>(filter + offsetof(ObjectFilter, environment));
  result["data"] = columns.column<std::uint64_t>(offsetof(Body, data));
  constexpr std::size_t offsets = offsetof(Body, offsets);
  result["contact"] = columns.column<double>(offsets + offsetof(ContactOffsets, contact));
  result["rest"] = columns.column<double>(offsets + offsetof(ContactOffsets, rest));
  result["layer"] = columns.column<std::uint16_t>(offsetof(Body, layer));
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
  py::dict result;
  result["boxes_updated"] = stats.boxes_updated;
  result["body_pairs"] = stats.body_pairs;
  result["rejected_by_spheres"] = stats.rejected_by_spheres;
  result["cached_pairs"] = stats.cached_pairs;
  result["primitive_pairs"] = stats.primitive_pairs;
  result["convex"] = narrow_statistics(stats.convex);
  result["parts"] = narrow_statistics(stats.parts);
  return result;
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

[[nodiscard]] Drawing draw(const SharedScene& s, bool objects, bool structure, bool labels,
                           int max_depth) {
  Drawing drawing;
  accept(reading(s.mutex,
                 [&] {
                   return s.scene.debug_draw(drawing, {objects, structure, labels, max_depth});
                 }),
         "debug_draw");
  return drawing;
}

void add_bodies_to(SceneClass& scene) {
  using py::arg;
  constexpr std::uint32_t every = ~0U;
  scene
      .def(py::init(&make_scene), arg("shapes").none(false), py::kw_only(),
           arg("contact_margin") = 0.0, arg("tier") = "robust", arg("cache_tolerance") = 0.0,
           arg("contact_reduction") = false, arg("suppress_ghost_contacts") = false,
           arg("warm_start") = false,
           arg("structures") = std::vector<std::string>(kBodyStates, "LinearBvh"),
           arg("parallel") = true, arg("build_budget") = 0, arg("recorder") = py::none(),
           "An empty scene. Pairs at most `contact_margin` apart are contacts too; a pair that has "
           "moved "
           "less than `cache_tolerance` keeps its contacts; both are lengths. `tier` as in "
           "NarrowPhase. "
           "`contact_reduction`: one manifold for each contact region of composite shapes, instead "
           "of one for each pair of parts; `suppress_ghost_contacts`: suppresses ghost contacts at "
           "the "
           "seams between flush fixed bodies; `warm_start`: contacts include their indices in the "
           "last frame. `structures` of fixed, dynamic and sleeping bodies; `build_budget`: rows "
           "of planned work per refresh, 0 for as many as are needed in time. `recorder`: records "
           "all calls.")
      .def("add", &add_bodies, arg("shapes"), arg("poses"), arg("state") = "dynamic",
           arg("layers") = 1, arg("mask") = every, arg("environment") = 0, arg("data") = py::none(),
           py::kw_only(), arg("contact") = 0.0, arg("rest") = 0.0, arg("layer") = 0,
           "Adds n bodies and returns their keys, (n,) uint64: shapes (n,), or one for all, at "
           "poses (n, 7) of x, y, z and a quaternion w, x, y, z, (n, 3), or a tuple of both. "
           "`state`: 'fixed', 'dynamic' or 'sleeping', or (n,) of FIXED, DYNAMIC, SLEEPING. "
           "Filters (n,) or one for all, as in Partition.set_filter. `data`: (n,) uint64. "
           "`contact` and `rest` as in `set_offsets`, `layer` as in `set_layer`.")
      .def("remove", &remove_bodies, arg("keys"), "Removes the bodies of `keys` (n,), all or none.")
      .def("clear", &clear, "Removes every body.")
      .def("move", &move_bodies, arg("keys"), arg("poses"),
           "Sets new poses of the bodies of `keys` (n,), as in `add`. Positions in double, and "
           "orientations in float or double, of any strides are read in place.")
      .def("set_body_state", &set_body_state, arg("keys"), arg("state"),
           "Moves bodies to the set of 'fixed', 'dynamic' or 'sleeping' ones.")
      .def("set_shape", &set_shape, arg("keys"), arg("shapes"),
           "Sets new shapes, (n,) or one for all, of the bodies of `keys` (n,).")
      .def("__len__",
           [](const SharedScene& s) { return reading(s.mutex, [&] { return s.scene.size(); }); })
      .def(
          "size",
          [](const SharedScene& s, const std::string& name) {
            const BodyState state = chosen(kBodyStateNames, name, "state");
            return reading(s.mutex, [&] { return s.scene.size(state); });
          },
          arg("state"), "Number of 'fixed', 'dynamic' or 'sleeping' bodies.")
      .def("contains", &contains, arg("keys"), "True for `keys` (n,) of live bodies: (n,) bool.")
      .def("keys_of", &keys_of, arg("ids"),
           "Keys (n,) uint64 of bodies by id (n,); NULL_KEY for bodies that do not exist.")
      .def("bodies", &body_columns, arg("keys"),
           "The current definitions of the bodies of `keys` (n,): columns shape, pose (n, 7), "
           "state, layers, mask, environment, data, contact, rest, layer.");
}

}  // namespace

void add_scene(py::module_& module) {
  using py::arg;
  module.attr("FIXED") = static_cast<int>(BodyState::fixed);
  module.attr("DYNAMIC") = static_cast<int>(BodyState::dynamic);
  module.attr("SLEEPING") = static_cast<int>(BodyState::sleeping);
  add_contacts(module);
  SceneClass scene(module, "Scene",
                   "Bodies with shapes and poses, and their contacts. Any number of threads may "
                   "call it; a call that raises changes nothing.");
  add_bodies_to(scene);
  scene
      .def("collide", &collide, arg("contacts"), arg("level") = "manifold",
           "Fills `contacts` with all contacts. `level`: 'pairs', 'boolean', 'distance' or "
           "'manifold'.")
      .def(
          "refresh",
          [](SharedScene& s) { accept(s.working([&] { return s.scene.refresh(); }), "refresh"); },
          "Brings boxes and partitions up to date now rather than in the next query.")
      .def("set_predicate", &set_predicate, arg("predicate"),
           "Sets `predicate(first, second)`, which decides for each pair of bodies, by id, that "
           "their filters allow; None accepts all. Calls come from any working thread, one at a "
           "time, because each needs the GIL: some microseconds a pair. Layers "
           "(`set_layers_collide`) "
           "and `set_ignored` have no such cost. It must return the same result each time, because "
           "it is not called in each frame: set it again to have all pairs tested again. It must "
           "not call winnow (unsupported). `collide` and `find_impacts` raise its exceptions; "
           "contacts "
           "that they were to fill are cleared. Set None to release it: needed if it refers to the "
           "scene.")
      .def_property_readonly("predicate", &predicate_of, "The current predicate.")
      .def_property_readonly(
          "origin",
          [](const SharedScene& s) {
            const Vec3d o = reading(s.mutex, [&] { return s.scene.origin(); });
            return py::make_tuple(o.x(), o.y(), o.z());
          },
          "The point that boxes are measured from.")
      .def("statistics", &statistics_dict, "Counters of the last `collide`.")
      .def("footprint", &scene_footprint, "Bytes (used, reserved) by part.")
      .def("debug_draw", &draw, py::kw_only(), arg("objects") = true, arg("structure") = true,
           arg("labels") = false, arg("max_depth") = 64, "As Partition.debug_draw, of all sets.");
  scene.def(
      "reserve",
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
      },
      py::kw_only(), arg("fixed") = 0, arg("dynamic") = 0, arg("sleeping") = 0, arg("pairs") = 0,
      arg("touching") = 0, arg("manifolds") = 0, arg("points") = 0, arg("level") = "manifold",
      arg("contacts") = py::none(), arg("touch") = false,
      "Reserves the memory for a first `collide` with these numbers of bodies of convex shapes, of "
      "pairs whose boxes overlap, and of touching pairs; `contacts` reserves for these, their "
      "manifolds and points. `touch` writes to each page.");
  add_pair_filter(module, scene);
  add_continuous_collision(module, scene);
  add_scene_queries(module, scene);
  add_scene_snapshots(scene);
  add_sensors(module);
}

}  // namespace winnow::python
