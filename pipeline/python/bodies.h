#pragma once

// Arguments and helpers for calls on many bodies of a scene, or sensors, at once.

#include "pipeline/python/locks.h"
#include "pipeline/python/refusal.h"
#include "pipeline/python/shared_scene.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {

/// Runs body() with exclusive access to the scene and shared access to the shapes.
template <typename Body>
auto changing_scene(SharedScene& s, Body&& body) {
  return changing(s.mutex, [&] {
    const std::shared_lock lock(s.shapes->mutex);
    s.is_stale = true;
    return body();
  });
}

/// As changing_scene; throws unless the status is ok. `call` is for messages.
template <typename Body>
void change_scene_or_throw(SharedScene& s, const char* call, Body&& body) {
  accept(changing_scene(s, std::forward<Body>(body)), call);
}

/// States: a name for all bodies, or numbers as in FIXED, DYNAMIC, SLEEPING.
[[nodiscard]] inline EachInteger body_states(py::handle object) {
  if (!py::isinstance<py::str>(object)) return {object, "state", kBodyStates - 1};
  const BodyState state = chosen(kBodyStateNames, py::cast<std::string>(object), "state");
  return {py::int_(static_cast<int>(state)), "state", kBodyStates - 1};
}

/// Calls get(key, one) for each key, in order; returns the first status that is not ok.
template <typename Definition, typename Get>
[[nodiscard]] Status definitions_of(std::span<const Key> keys, std::vector<Definition>& all,
                                    Get&& get) {
  all.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Status status = get(keys[i], all[i]);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

[[nodiscard]] inline Status bodies_of(const Scene& scene, std::span<const Key> keys,
                                      std::vector<BodyDefinition>& bodies) {
  return definitions_of(keys, bodies,
                        [&](Key key, BodyDefinition& body) { return scene.body(key).get(body); });
}

/// Shapes of bodies or of sensors.
template <typename Definition>
[[nodiscard]] std::vector<ShapeId> shapes_of(const std::vector<Definition>& all) {
  std::vector<ShapeId> ids(all.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = all[i].shape;
  return ids;
}

/// Calls set(i) for each body; if one call fails, calls undo(i) for the bodies before it.
template <typename Set, typename Undo>
[[nodiscard]] Status set_all(std::size_t count, Set&& set, Undo&& undo) {
  for (std::size_t i = 0; i < count; ++i) {
    const Status status = set(i);
    if (status == Status::ok) continue;
    while (i > 0) static_cast<void>(undo(--i));
    return status;
  }
  return Status::ok;
}

[[nodiscard]] inline bool has_twice(std::span<const Key> keys) {
  std::vector<ObjectId> ids(keys.size());
  std::transform(keys.begin(), keys.end(), ids.begin(), [](Key key) { return key.id; });
  std::sort(ids.begin(), ids.end());
  return std::adjacent_find(ids.begin(), ids.end()) != ids.end();
}

}  // namespace winnow::python
