// Checks the contacts of a granular flow by brute force: collides all pairs with the narrow phase
// and compares the sorted lists. FlowRun::step calls check_contacts().

#include "bench/simulation/flow_check.h"

#include <winnow/pipeline/narrow_phase.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace winnow::bench {
namespace {

/// Largest number of pairs of bodies that are tested.
constexpr double kMaxRowPairs = 1e8;

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
      if (b < objects_) {
        found.push_back({a, b});
        continue;
      }
      const auto first = contacts.manifold_first();
      for (std::uint32_t m = first[i]; m < first[i + 1]; ++m) {
        found.push_back({a, objects_ + contacts.part_b()[m]});
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  [[nodiscard]] double radius_of(ShapeId id) const {
    const ShapeTables& tables = flow_.shapes().tables();
    if (id.kind() == ShapeKind::sphere) return tables.spheres[id.index()].radius;
    const double* half = tables.boxes[id.index()].half;
    return std::hypot(half[0], half[1], half[2]);
  }

  /// Adds the pairs of bodies whose bounding spheres overlap.
  void add_bodies(std::vector<BodyPair>& pairs) const {
    std::vector<double> radius;
    for (std::size_t i = 0; i < objects_; ++i) {
      radius.push_back(radius_of(flow_.shape(i)) * (1.0 + 1e-12));
    }
    for (std::size_t i = 0; i < objects_; i += stride_) {
      const double* p = flow_.contact_poses()[i].position;
      for (std::size_t j = 0; j < objects_; ++j) {
        if (j == i || (j < i && is_looked_at(j))) continue;
        const double* q = flow_.contact_poses()[j].position;
        const double reach = radius[i] + radius[j];
        double gap = 0.0;
        for (int axis = 0; axis < 3; ++axis) gap += (p[axis] - q[axis]) * (p[axis] - q[axis]);
        if (gap > reach * reach) continue;
        pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
      }
    }
  }

  /// Adds the pairs of a body and a triangle for which the box around the body's bounding sphere
  /// overlaps the triangle's box.
  void add_triangles(const std::vector<TriangleShape>& triangles,
                     std::vector<BodyPair>& pairs) const {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      double low[3];
      double high[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& v = triangles[t].vertex;
        low[axis] = std::min({v[0][axis], v[1][axis], v[2][axis]});
        high[axis] = std::max({v[0][axis], v[1][axis], v[2][axis]});
      }
      for (std::size_t i = 0; i < objects_; i += stride_) {
        const double* p = flow_.contact_poses()[i].position;
        const double reach = radius_of(flow_.shape(i)) * (1.0 + 1e-12);
        bool overlaps = true;
        for (int axis = 0; axis < 3; ++axis) {
          overlaps = overlaps && p[axis] >= low[axis] - reach && p[axis] <= high[axis] + reach;
        }
        if (!overlaps) continue;
        pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(objects_ + t)});
      }
    }
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
    std::vector<BodyPair> pairs;
    add_bodies(pairs);
    add_triangles(triangle, pairs);

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
      touching.push_back({std::min(pair.a, pair.b), std::max(pair.a, pair.b)});
    }
    std::sort(touching.begin(), touching.end());
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
