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

/// A state by name for all bodies, or numbers as in FIXED, DYNAMIC, SLEEPING.
class BodyStateInput {
 public:
  explicit BodyStateInput(py::handle object)
      : numbers_(py::isinstance<py::str>(object)
                     ? EachInteger(py::int_(static_cast<int>(chosen(
                                       kBodyStateNames, py::cast<std::string>(object), "state"))),
                                   "state", kBodyStates - 1)
                     : EachInteger(object, "state", kBodyStates - 1)) {}
  void expect(std::size_t count) { numbers_.expect(count); }
  [[nodiscard]] BodyState operator[](std::size_t i) const noexcept {
    return static_cast<BodyState>(numbers_[i]);
  }

 private:
  EachInteger numbers_;
};

/// Contact and rest offsets of bodies as two columns.
class OffsetInput {
 public:
  OffsetInput(py::handle contact, py::handle rest)
      : contact_(contact, "contact", {}, Valid::length), rest_(rest, "rest", {}, Valid::finite) {}
  void expect(std::size_t count) {
    for (Numbers* each : {&contact_, &rest_}) each->expect(count);
  }
  [[nodiscard]] ContactOffsets operator[](std::size_t i) const noexcept {
    return {contact_.at(i), rest_.at(i)};
  }

 private:
  Numbers contact_;
  Numbers rest_;
};

/// Layers of a scene.
class LayerInput {
 public:
  LayerInput(py::handle object, const char* name, std::uint64_t most = kSceneLayers - 1)
      : numbers_(object, name, most) {}
  void expect(std::size_t count) { numbers_.expect(count); }
  [[nodiscard]] std::uint16_t operator[](std::size_t i) const noexcept {
    return static_cast<std::uint16_t>(numbers_[i]);
  }

 private:
  EachInteger numbers_;
};

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
