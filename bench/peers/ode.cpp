// Adapter of ODE's sweep-and-prune space as a broad phase; it registers itself in registry.h.

#include "bench/contenders/engines.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/registry.h"

#include <ode/ode.h>

#include <atomic>
#include <cstdlib>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

std::atomic<std::size_t> allocated_bytes{0};

void* counted_allocate(dsizeint size) {
  allocated_bytes += size;
  return std::malloc(size);
}

void* counted_reallocate(void* memory, dsizeint old_size, dsizeint new_size) {
  allocated_bytes += new_size - old_size;
  return std::realloc(memory, new_size);
}

void counted_free(void* memory, dsizeint size) {
  allocated_bytes -= size;
  std::free(memory);
}

/// Initialises ODE as a whole, and registers the geom class of boxes.
class Library {
 public:
  /// Created at the first call, closed at exit.
  static const Library& get() {
    static const Library library;
    return library;
  }

  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() { dCloseODE(); }

  [[nodiscard]] int box_class() const { return box_class_; }

 private:
  Library() {
    dSetAllocHandler(counted_allocate);
    dSetReallocHandler(counted_reallocate);
    dSetFreeHandler(counted_free);
    dInitODE2(0);
    dGeomClass definition{};
    definition.bytes = sizeof(Aabb);
    definition.collider = [](int) -> dColliderFn* { return nullptr; };
    definition.aabb = give_bounds;
    box_class_ = dCreateGeomClass(&definition);
  }

  static void give_bounds(dGeomID geom, dReal bounds[6]) {
    const Aabb& box = *static_cast<const Aabb*>(dGeomGetClassData(geom));
    for (int axis = 0; axis < 3; ++axis) {
      bounds[2 * axis] = static_cast<dReal>(box.min[axis]);
      bounds[2 * axis + 1] = static_cast<dReal>(box.max[axis]);
    }
  }

  int box_class_ = 0;
};

int sap_order(const std::array<int, 3>& axes) {
  return axes[0] | (axes[1] << 2) | (axes[2] << 4);
}

/// ODE in double: the sweep-and-prune space. ODE's own box geoms compute bounds from centre and
/// half length, with rounding, so a geom class with a box as its data gives exact bounds. ODE's
/// spaces support one thread only.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): sweep and
/// prune, with its axes ordered by how much they prune. The hash space and the quadtree space were
/// slower. Updates of few objects are cheap, but each search covers all objects.
class OdeEngine final : public PairsAdapter {
 public:
  OdeEngine() { Library::get(); }
  ~OdeEngine() override {
    if (space_ != nullptr) dSpaceDestroy(space_);
  }

  [[nodiscard]] std::string name() const override { return "ODE SAP"; }
  [[nodiscard]] bool is_serial() const override { return true; }
  /// ODE sweeps along one axis: a frame with more objects takes over a second.
  [[nodiscard]] std::size_t largest() const override { return 100'000; }

  /// Bytes allocated by ODE, for all ODE engines together.
  [[nodiscard]] std::size_t bytes() const override {
    return allocated_bytes + geoms_.capacity() * sizeof(geoms_[0]);
  }

 private:
  void build(std::span<const Aabb> boxes) override {
    dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
    space_ = dSweepAndPruneSpaceCreate(nullptr, sap_order(axes_by_pruning(boxes)));
    add_geoms(boxes);
    dSpaceClean(space_);
  }

  void update(std::span<const std::uint32_t> changed_rows,
              std::span<const Aabb> all_boxes) override {
    for (const std::uint32_t row : changed_rows) {
      *static_cast<Aabb*>(dGeomGetClassData(geoms_[row])) = all_boxes[row];
      dGeomMoved(geoms_[row]);
    }
    add_geoms(all_boxes);
    dSpaceClean(space_);
  }

  /// Adds geoms for new rows.
  void add_geoms(std::span<const Aabb> boxes) {
    geoms_.reserve(boxes.size());
    for (std::size_t i = geoms_.size(); i < boxes.size(); ++i) {
      const dGeomID geom = dCreateGeom(Library::get().box_class());
      *static_cast<Aabb*>(dGeomGetClassData(geom)) = boxes[i];
      dGeomSetData(geom, pointer_of(i));
      dSpaceAdd(space_, geom);
      geoms_.push_back(geom);
    }
  }

  static void collect(void* self, dGeomID a, dGeomID b) {
    auto& engine = *static_cast<OdeEngine*>(self);
    const std::uint32_t i = row_of(dGeomGetData(a));
    const std::uint32_t j = row_of(dGeomGetData(b));
    if (engine.boxes_[i].overlaps(engine.boxes_[j])) engine.pairs_.push_back(ordered(i, j));
  }

  void find_pairs(std::span<const Aabb> boxes) override {
    boxes_ = boxes;
    pairs_.clear();
    dSpaceCollide(space_, this, collect);
  }

  dSpaceID space_ = nullptr;
  std::vector<dGeomID> geoms_;
  std::span<const Aabb> boxes_;
};

const RegisteredPeer<Engine, OdeEngine> kOdeEngine;

}  // namespace
}  // namespace winnow::bench
