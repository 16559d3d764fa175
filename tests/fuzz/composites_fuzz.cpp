// Meshes and height fields of hostile numbers: bad ones are refused and change nothing, and rays,
// overlaps and distances of good ones equal the results of their single triangles.

#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Surface {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] bool is_good() const {
    return corners.size() >= 3 &&
           std::all_of(vertices.begin(), vertices.end(), [](auto& v) { return v.all_finite(); }) &&
           std::all_of(corners.begin(), corners.begin() + whole(),
                       [&](std::uint32_t c) { return c < vertices.size(); });
  }
  [[nodiscard]] std::vector<TriangleShape> triangles() const {
    std::vector<TriangleShape> all(corners.size() / 3);
    for (std::size_t i = 0; i < 3 * all.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        all[i / 3].vertex[i % 3][k] = static_cast<double>(vertices[corners[i]][k]);
      }
    }
    return all;
  }

 private:
  [[nodiscard]] std::ptrdiff_t whole() const {
    return static_cast<std::ptrdiff_t>(corners.size() / 3 * 3);
  }
};

Surface some_surface(Bytes& bytes) {
  Surface surface;
  surface.vertices.resize(1 + bytes.below(40));
  const bool hostile = bytes.chance(8);
  for (Vec3f& vertex : surface.vertices) {
    for (int k = 0; k < 3; ++k) {
      vertex[k] = hostile ? bytes.wild() : 0.25F * static_cast<float>(bytes.grid_value());
    }
  }
  surface.corners.resize(bytes.below(200));
  const std::size_t numbers = surface.vertices.size() + (bytes.chance(16) ? 1U : 0U);
  for (std::uint32_t& corner : surface.corners) {
    corner = static_cast<std::uint32_t>(bytes.below(numbers));
  }
  return surface;
}

/// One composite shape in a scene, as a whole and as single triangles.
class Exhibit {
 public:
  explicit Exhibit(Bytes& bytes) : composites_(shapes_, &memory_) {
    take(bytes, true);
    check_memory();
  }

  void change(Bytes& bytes);
  void query(Bytes& bytes);
  void check_memory() const {
    WINNOW_REQUIRE(composites_.footprint().total().reserved == memory_.outstanding());
  }

 private:
  void take(Bytes& bytes, bool first);
  void take_mesh(Bytes& bytes);
  void refit(Bytes& bytes);
  void take_field(Bytes& bytes);
  void update_field(Bytes& bytes);
  void read_field();
  void query_ray(Bytes& bytes, SceneQueries& queries, const Pose& pose);
  void query_shape(Bytes& bytes, SceneQueries& queries, Key body, const Pose& pose);

  CountingMemory memory_;
  ShapePool shapes_;
  CompositePool composites_;
  ShapeId id_;
  Surface surface_;
  std::vector<float> heights_;
  std::vector<TriangleShape> triangles_;
};

void Exhibit::take(Bytes& bytes, bool first) {
  if (!first && id_ != ShapeId{}) {
    WINNOW_REQUIRE(composites_.remove(id_) == Status::ok && !composites_.contains(id_));
    WINNOW_REQUIRE(composites_.remove(id_) == Status::invalid_key);
    id_ = {};
    triangles_.clear();
  }
  if (bytes.chance(3)) return take_field(bytes);
  take_mesh(bytes);
}

void Exhibit::take_mesh(Bytes& bytes) {
  surface_ = some_surface(bytes);
  const MeshOptions options{bytes.chance(16) ? bytes.any<double>() : 0.02};
  const Status status = composites_
                            .add_mesh(std::span(std::as_const(surface_.vertices)),
                                      std::span(std::as_const(surface_.corners)), options)
                            .get(id_);
  const bool good_angle = options.active_edge_angle >= 0.0 && options.active_edge_angle <= 3.14;
  if (status != Status::ok) {
    WINNOW_REQUIRE(!surface_.is_good() || !good_angle);
    WINNOW_REQUIRE(id_ == ShapeId{} && composites_.size(CompositeKind::mesh) == 0);
    return;
  }
  WINNOW_REQUIRE(surface_.is_good() &&
                 composites_.mesh(id_)->triangles() == surface_.corners.size() / 3);
  triangles_ = surface_.triangles();
}

void Exhibit::refit(Bytes& bytes) {
  Surface moved = surface_;
  for (Vec3f& vertex : moved.vertices) {
    if (bytes.chance(3)) vertex[0] = bytes.wild();
  }
  if (bytes.chance(8)) moved.vertices.pop_back();
  const Status status = composites_.refit_mesh(id_, std::span(std::as_const(moved.vertices)));
  if (status != Status::ok) {
    WINNOW_REQUIRE(!moved.is_good() || moved.vertices.size() != surface_.vertices.size());
    return;
  }
  surface_ = moved;
  triangles_ = surface_.triangles();
}

void Exhibit::take_field(Bytes& bytes) {
  HeightSamples samples;
  samples.columns = static_cast<std::uint32_t>(bytes.below(20));
  samples.rows = static_cast<std::uint32_t>(bytes.below(20));
  samples.row_stride =
      bytes.chance(4) ? samples.columns + static_cast<std::uint32_t>(bytes.below(3)) : 0;
  if (bytes.chance(16)) samples.spacing[0] = bytes.any<double>();
  if (bytes.chance(4)) samples.spacing[1] = 0.25;
  const std::size_t stride = samples.row_stride == 0 ? samples.columns : samples.row_stride;
  heights_.assign(stride * samples.rows, 0.0F);
  for (float& height : heights_) {
    height = bytes.chance(16) ? bytes.wild() : 0.25F * static_cast<float>(bytes.grid_value());
  }
  if (bytes.chance(8) && !heights_.empty()) heights_.pop_back();
  samples.heights = heights_;
  const Status status = composites_.add_height_field(samples).get(id_);
  if (status != Status::ok) {
    WINNOW_REQUIRE(id_ == ShapeId{} && composites_.size(CompositeKind::height_field) == 0);
    return;
  }
  WINNOW_REQUIRE(samples.columns >= 2 && samples.rows >= 2);
  read_field();
}

void Exhibit::update_field(Bytes& bytes) {
  HeightSamples samples;
  samples.columns = static_cast<std::uint32_t>(bytes.below(6));
  samples.rows = static_cast<std::uint32_t>(bytes.below(6));
  std::vector<float> heights(samples.columns * samples.rows);
  for (float& height : heights) height = bytes.chance(8) ? bytes.wild() : 0.5F;
  samples.heights = heights;
  const auto column = static_cast<std::uint32_t>(bytes.below(20));
  const auto row = static_cast<std::uint32_t>(bytes.below(20));
  const std::vector<TriangleShape> before = triangles_;
  const Status status = composites_.update_height_field(id_, column, row, samples);
  read_field();
  if (status == Status::ok) return;
  WINNOW_REQUIRE(std::equal(before.begin(), before.end(), triangles_.begin(), triangles_.end(),
                            [](const TriangleShape& a, const TriangleShape& b) {
                              return std::memcmp(&a, &b, sizeof a) == 0;
                            }));
}

void Exhibit::read_field() {
  const HeightField& field = *composites_.height_field(id_);
  const Aabb box = field.bounds();
  triangles_.clear();
  for (std::uint32_t i = 0; i < field.triangles(); ++i) {
    TriangleShape triangle;
    if (!field.triangle(i, triangle)) continue;
    for (const auto& corner : triangle.vertex) {
      for (int k = 0; k < 3; ++k) {
        WINNOW_REQUIRE(corner[k] >= static_cast<double>(box.min[k]) &&
                       corner[k] <= static_cast<double>(box.max[k]));
      }
    }
    triangles_.push_back(triangle);
  }
}

void Exhibit::change(Bytes& bytes) {
  if (id_ == ShapeId{} || bytes.chance(3)) return take(bytes, false);
  if (id_.composite_kind() == CompositeKind::mesh) return refit(bytes);
  update_field(bytes);
}

void Exhibit::query_ray(Bytes& bytes, SceneQueries& queries, const Pose& pose) {
  ShapeRay ray;
  for (double& x : ray.origin) x = 0.25 * bytes.grid_value();
  for (double& x : ray.direction) x = 0.25 * bytes.grid_value();
  ray.direction[2] += ray.direction[0] == 0.0 && ray.direction[1] == 0.0 ? 100.0 : 0.0;
  ray.max_t = kInfinity;
  SceneHit hit;
  WINNOW_REQUIRE(queries.closest(ray).get(hit) == Status::ok);
  double first = kInfinity;
  for (const TriangleShape& triangle : triangles_) {
    ShapeTables tables = shapes_.tables();
    tables.triangles = &triangle;
    tables.count[static_cast<std::size_t>(ShapeKind::triangle)] = 1;
    ShapeHit one;
    WINNOW_REQUIRE(cast_ray(tables, ShapeId::of(ShapeKind::triangle, 0), pose, ray).get(one) ==
                   Status::ok);
    if (one.hit) first = std::min(first, one.t);
  }
  if (!hit) {
    WINNOW_REQUIRE(first == kInfinity);
    return;
  }
  WINNOW_REQUIRE(std::abs(hit.t - first) <= 1e-9 * (1.0 + first));
}

void Exhibit::query_shape(Bytes& bytes, SceneQueries& queries, Key body, const Pose& pose) {
  ShapeId box;
  WINNOW_REQUIRE(
      shapes_.add(BoxShape{{bytes.extent(), bytes.extent(), bytes.extent()}, 0.0}).get(box) ==
      Status::ok);
  const Pose at = bytes.pose();
  ShapeTables tables = shapes_.tables();
  tables.triangles = triangles_.data();
  tables.count[static_cast<std::size_t>(ShapeKind::triangle)] =
      static_cast<std::uint32_t>(triangles_.size());
  std::vector<ShapeId> ids{box};
  std::vector<BodyPair> pairs;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    ids.push_back(ShapeId::of(ShapeKind::triangle, i));
    pairs.push_back({0, i + 1});
  }
  std::vector<Pose> poses(ids.size(), pose);
  poses[0] = at;
  NarrowPhase narrow;
  NarrowResult result;
  WINNOW_REQUIRE(narrow.collide(tables, {ids, poses}, pairs, {.level = ContactLevel::distance},
                                result) == Status::ok);
  const auto truth = std::any_of(result.distance().begin(), result.distance().end(),
                                 [](double distance) { return distance <= 0.0; });
  std::span<const SceneOverlap> found;
  WINNOW_REQUIRE(queries.overlap(box, at).get(found) == Status::ok);
  WINNOW_REQUIRE(truth == !found.empty() && (found.empty() || found[0].key == body));
  WINNOW_REQUIRE(shapes_.remove(box) == Status::ok);
}

void Exhibit::query(Bytes& bytes) {
  if (id_ == ShapeId{}) return;
  // Results are compared to the last digits only if the sizes are similar.
  const Aabb box = composites_.bounds(id_, Pose{});
  if (!(as_eigen(box.min).minCoeff() > -1e6F && as_eigen(box.max).maxCoeff() < 1e6F)) return;
  Scene scene(shapes_, {.composites = &composites_});
  const Pose pose = bytes.pose();
  Key body;
  WINNOW_REQUIRE(scene.add({.shape = id_, .pose = pose}).get(body) == Status::ok);
  WINNOW_REQUIRE(scene.refresh() == Status::ok);
  SceneQueries queries(scene);
  query_ray(bytes, queries, pose);
  query_shape(bytes, queries, body, pose);
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  Exhibit exhibit(bytes);
  for (int steps = 0; !bytes.empty() && steps < 40; ++steps) {
    if (bytes.chance(3)) {
      exhibit.change(bytes);
    } else {
      exhibit.query(bytes);
    }
    exhibit.check_memory();
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(150, 1200);
}

}  // namespace winnow::test
