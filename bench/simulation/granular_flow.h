#pragma once

#include <winnow/core/volumes.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/scenes/meshes.h"
#include "bench/simulation/flow_bodies.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

enum class FlowShape : std::uint8_t { spheres, boxes, mixed };

struct FlowOptions {
  std::size_t objects = 10'000;
  FlowShape shape = FlowShape::mixed;
  std::uint64_t seed = 1;
  double step = 1e-3;
  double gravity = 10.0;
  /// Largest speed along each axis at the start; directions are random.
  double stir = 2.0;
  SoftContacts law{};
  Execution execution = Execution::parallel();
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
};

/// Times of the phases of one step in milliseconds.
struct FlowTimes {
  double move = 0.0;    ///< Scene::move
  double broad = 0.0;   ///< boxes, partitions, pairs of bodies
  double mid = 0.0;     ///< pairs with triangles
  double narrow = 0.0;  ///< contacts; all phases together if the step was not profiled
  double solver = 0.0;  ///< forces and motion
  bool profiled = false;

  [[nodiscard]] double total() const noexcept { return move + broad + mid + narrow + solver; }
};

/// Figures of one step of a flow; energies and contacts are those at its start.
struct FlowSample {
  double time = 0.0;  ///< at the end of the step
  FlowEnergy energy{};
  double fed = 0.0;  ///< energy added so far by putting bodies back
  double deepest = 0.0;
  std::size_t contacts = 0;  ///< pairs of bodies
  std::size_t points = 0;
  FlowTimes times{};

  /// Returns the energy without the energy added by putting bodies back. Gravity conserves it, and
  /// contacts can only reduce it.
  [[nodiscard]] double balance() const noexcept { return energy.total() - fed; }
};

/// Granular flow, written as a simulation that embeds winnow: spheres and boxes of about unit size
/// fall into a funnel, and bodies that left it are put back above it at rest. Contacts are soft and
/// steps semi-implicit. The bits of every body are the same on any number of threads and any
/// instruction set.
class GranularFlow {
 public:
  /// Throws std::runtime_error if winnow rejects the mesh.
  explicit GranularFlow(const FlowOptions& options);

  /// Makes one step. A profiled step finds the pairs in a separate call, so that phases can be
  /// timed.
  void step(bool profiled = false);

  [[nodiscard]] std::size_t objects() const noexcept { return objects_; }
  [[nodiscard]] std::size_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::size_t returned() const noexcept { return returned_; }
  [[nodiscard]] const FlowSample& last() const noexcept { return last_; }
  /// Returns the contacts, valid until the next step. Client data are rows; row objects() is the
  /// mesh.
  [[nodiscard]] const Contacts& contacts() const noexcept { return contacts_; }
  /// Returns the poses for which the contacts were found.
  [[nodiscard]] const std::pmr::vector<Pose>& contact_poses() const noexcept { return then_; }
  /// Makes `contact_poses` available from the next step on, which costs time.
  void keep_contact_poses() noexcept { keeps_poses_ = true; }

  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] ShapeId shape(std::size_t i) const noexcept { return shape_of_[i]; }
  [[nodiscard]] Pose pose(std::size_t i) const noexcept {
    return poses_of(bodies_, objects_ + 1)[i];
  }
  [[nodiscard]] const Triangles& mesh() const noexcept { return mesh_; }
  [[nodiscard]] Aabb box(std::size_t i) const noexcept {
    return shapes_.bounds(shape_of_[i], pose(i));
  }

  /// Returns a hash of the bits of positions, velocities and orientations.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;

 private:
  struct Spot {
    double x;
    double y;
    std::size_t last;  ///< the last body that was put there
  };

  void make_obstacle();
  void make_shapes();
  void make_spots();
  void fill();
  void add_to_scene();
  void find_contacts(bool profiled);
  void put_back(std::size_t i);
  [[nodiscard]] double energy_of(std::size_t i) const noexcept;

  FlowOptions options_;
  std::size_t objects_;
  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  Contacts contacts_;
  Contacts found_pairs_;
  Triangles mesh_;
  ShapeId mesh_shape_;
  FunnelSize funnel_;
  double spacing_ = 0.0;
  double floor_ = 0.0;
  double refill_ = 0.0;  ///< height at which bodies are put back

  FlowBodies bodies_;
  std::pmr::vector<ShapeId> shape_of_;
  std::pmr::vector<Key> keys_;
  std::pmr::vector<Spot> spots_;
  std::pmr::vector<std::size_t> spot_of_;
  std::size_t next_spot_ = 0;
  std::pmr::vector<PairForce> pair_forces_;
  std::pmr::vector<FlowEnergy> energy_parts_;
  std::pmr::vector<Pose> then_;
  bool keeps_poses_ = false;

  std::size_t steps_ = 0;
  std::size_t returned_ = 0;
  double fed_ = 0.0;
  FlowSample last_;
};

}  // namespace winnow::bench
