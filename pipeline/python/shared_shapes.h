#pragma once

#include "pipeline/python/arrays.h"
#include "pipeline/python/callbacks.h"
#include "pipeline/python/described.h"
#include "pipeline/python/init_checks.h"
#include "pipeline/python/inputs.h"
#include "pipeline/python/locks.h"

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/shape_pool.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace winnow::python {

/// Number of uses of each shape, by the bits of its id.
using ShapeUses = std::unordered_map<std::uint32_t, std::uint32_t>;

/// A Python support function, and the store for its exceptions.
class SupportCallback {
 public:
  SupportCallback(py::object function, double radius, Raised& raised)
      : function_(std::move(function), "function"), radius_(radius), raised_(raised) {}
  [[nodiscard]] SupportShape shape(double rounding) const noexcept {
    return {&evaluate, this, radius_, rounding};
  }

 private:
  static void evaluate(const void* context, const double direction[3], double point[3]);

  PythonFunction function_;
  double radius_;
  Raised& raised_;
};
using SupportFunctions = std::unordered_map<std::uint32_t, std::unique_ptr<SupportCallback>>;

/// Convex and composite shapes that several threads and scenes may use. A shape cannot be removed
/// while a compound or a body uses it.
class SharedShapes : public NeedsInit {
 public:
  [[nodiscard]] bool contains(ShapeId id) const noexcept {
    return id.is_composite() ? composites.contains(id) : pool.contains(id);
  }
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept {
    return id.is_composite() ? composites.bounds(id, pose) : pool.bounds(id, pose);
  }

  /// Changes the number of uses of each shape by `change`. Requires the mutex, shared or not.
  void use(std::span<const ShapeId> shapes, int change);
  void use(const ShapeUses& shapes, int change);
  [[nodiscard]] bool is_used(ShapeId id) const;
  /// Loads a snapshot; `invalid_key` while anything except compounds uses shapes. Requires the
  /// mutex.
  [[nodiscard]] Status load(std::span<const std::byte> convex,
                            std::span<const std::byte> composite);
  /// While there are pins, no shape is removed and no snapshot is loaded.
  void pin(int change) noexcept { pins_ += change; }

  mutable std::shared_mutex mutex;
  ShapePool pool;
  CompositePool composites{pool};
  /// Incremented by each change in place; scenes then refresh their bodies.
  std::atomic<std::uint64_t> revision{0};
  /// Support functions of shapes, by the bits of their ids. Changes require the mutex; functions
  /// are destroyed without it.
  SupportFunctions supports;
  /// Exceptions of support functions.
  mutable Raised raised;

 private:
  std::atomic<int> pins_{0};
  mutable std::mutex uses_mutex_;
  ShapeUses uses_;
};

/// Like `reading`, and raises exceptions of support functions.
template <typename Body>
auto reading_shapes(const SharedShapes& shapes, Body&& body) {
  return shapes.raised.during([&] { return reading(shapes.mutex, body); });
}

/// Uses of shapes by the bodies of a scene, or by sensors; the destructor ends them.
class HeldShapes {
 public:
  explicit HeldShapes(std::shared_ptr<SharedShapes> shapes) noexcept : shapes_(std::move(shapes)) {}
  ~HeldShapes() { clear(); }
  HeldShapes(const HeldShapes&) = delete;
  HeldShapes& operator=(const HeldShapes&) = delete;

  /// Changes the number of uses of each shape by `change`. Requires the mutex of the shapes, shared
  /// or not.
  void use(std::span<const ShapeId> ids, int change);
  /// Ends all uses.
  void clear();

 private:
  const std::shared_ptr<SharedShapes> shapes_;
  ShapeUses uses_;
};

using ShapesClass = Class<SharedShapes>;

/// Ids of shapes: an array, read in place if it is of uint32 and contiguous, or one id for all.
class ShapeInput : public Integers<std::uint32_t> {
 public:
  ShapeInput(const SharedShapes& shapes, py::handle object, const char* name = "shapes");
  [[nodiscard]] ShapeId operator[](std::size_t i) const noexcept { return {values()[i]}; }
  [[nodiscard]] std::span<const ShapeId> list() const noexcept {
    return {reinterpret_cast<const ShapeId*>(values().data()), count()};
  }

 private:
  [[nodiscard]] std::string fault(Status status) const override;

  const SharedShapes& shapes_;
};

void add_shapes(py::module_& module);
void add_support(ShapesClass& type);
void add_composites(ShapesClass& type);
void add_narrow(py::module_& module);
void add_scene(py::module_& module);

}  // namespace winnow::python
