// Checks the contacts of a granular flow by brute force: collides all pairs with the narrow phase
// and compares the sorted lists. FlowRun::step calls check_contacts().

#include "bench/simulation/flow_run.h"

#include <winnow/pipeline/narrow_phase.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace winnow::bench {
namespace {

/// Largest number of pairs that are tested.
constexpr double kMaxRowPairs = 4e6;

/// Two rows, the smaller first. Rows from objects() on are the mesh's triangles.
struct RowPair {
  std::size_t a;
  std::size_t b;

  friend auto operator<=>(const RowPair&, const RowPair&) = default;
};
using RowPairs = std::vector<RowPair>;

class Check {
 public:
  Check(const GranularFlow& flow, const Contacts& contacts)
      : flow_(flow), contacts_(contacts), objects_(flow.objects()) {
    const auto objects = static_cast<double>(objects_);
    const double pairs = objects * (objects + static_cast<double>(flow.mesh().size()));
    stride_ = static_cast<std::size_t>(std::ceil(std::max(1.0, pairs / kMaxRowPairs)));
  }

  [[nodiscard]] FlowFaults run() const {
    RowPairs found = reported();
    FlowFaults faults;
    const std::size_t all = found.size();
    found.erase(std::unique(found.begin(), found.end()), found.end());
    faults.doubled = all - found.size();
    const RowPairs expected = touching();
    faults.compared = expected.size();
    RowPairs differ;
    std::set_difference(expected.begin(), expected.end(), found.begin(), found.end(),
                        std::back_inserter(differ));
    faults.lost = differ.size();
    differ.clear();
    std::set_difference(found.begin(), found.end(), expected.begin(), expected.end(),
                        std::back_inserter(differ));
    faults.invented = differ.size();
    return faults;
  }

 private:
  [[nodiscard]] bool is_looked_at(std::size_t row) const { return row % stride_ == 0; }

  [[nodiscard]] RowPairs reported() const {
    const Contacts& contacts = contacts_;
    RowPairs found;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const std::size_t a = std::min(contacts.data_a()[i], contacts.data_b()[i]);
      const std::size_t b = std::max(contacts.data_a()[i], contacts.data_b()[i]);
      if (!is_looked_at(a) && (b == objects_ || !is_looked_at(b))) continue;
      found.push_back({a, b});
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Returns the pairs of each body to look at with all other bodies and all triangles.
  [[nodiscard]] std::vector<BodyPair> pairs_to_test() const {
    std::vector<BodyPair> pairs;
    for (std::size_t i = 0; i < objects_; i += stride_) {
      for (std::size_t j = 0; j < objects_ + flow_.mesh().size(); ++j) {
        if (j == i || (j < i && is_looked_at(j))) continue;
        pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
      }
    }
    return pairs;
  }

  [[nodiscard]] std::vector<TriangleShape> triangles() const {
    const Triangles& mesh = flow_.mesh();
    std::vector<TriangleShape> shapes(mesh.size());
    for (std::size_t t = 0; t < shapes.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3d& v = mesh.vertices[mesh.corners[3 * t + k]];
        for (int axis = 0; axis < 3; ++axis) shapes[t].vertex[k][axis] = v[axis];
      }
    }
    return shapes;
  }

  [[nodiscard]] RowPairs touching() const {
    const std::vector<TriangleShape> triangle = triangles();
    const std::vector<BodyPair> pairs = pairs_to_test();

    ShapeTables tables = flow_.shapes().tables();
    tables.triangles = triangle.data();
    tables.count[static_cast<std::size_t>(ShapeKind::triangle)] =
        static_cast<std::uint32_t>(triangle.size());
    std::vector<ShapeId> shapes;
    for (std::size_t i = 0; i < objects_; ++i) shapes.push_back(flow_.shape(i));
    for (std::size_t t = 0; t < triangle.size(); ++t) {
      shapes.push_back(ShapeId::of(ShapeKind::triangle, static_cast<std::uint32_t>(t)));
    }
    std::vector<Pose> poses(flow_.contact_poses().begin(), flow_.contact_poses().end());
    poses.resize(objects_);
    poses.resize(shapes.size());  // the mesh has the identity pose
    NarrowPhase narrow;
    NarrowResult result;
    RowPairs touching;
    if (narrow.collide(tables, {shapes, poses}, pairs, {.level = ContactLevel::boolean}, result) !=
        Status::ok) {
      return touching;
    }
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (!result.overlaps(i)) continue;
      const BodyPair& pair = pairs[result.pair_of(i)];
      // All triangles are one body: a contact of the mesh may stand for several of them.
      const std::size_t a = std::min<std::size_t>(pair.a, objects_);
      const std::size_t b = std::min<std::size_t>(pair.b, objects_);
      touching.push_back({std::min(a, b), std::max(a, b)});
    }
    std::sort(touching.begin(), touching.end());
    touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
    return touching;
  }

  const GranularFlow& flow_;
  const Contacts& contacts_;
  std::size_t objects_;
  std::size_t stride_ = 1;
};

}  // namespace

FlowFaults check_contacts(const GranularFlow& flow, const Contacts& contacts) {
  return Check(flow, contacts).run();
}

}  // namespace winnow::bench
