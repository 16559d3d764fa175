// Queries of a partition, in batches: rays, swept volumes, regions and nearest objects.

#include "pipeline/python/batch.h"
#include "pipeline/python/filters.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/volumes.h"

#include <winnow/core/rays.h>
#include <winnow/core/regions.h>

#include <cstring>
#include <limits>
#include <utility>

namespace winnow::python {
namespace {

enum class Find { closest, any, all };
constexpr Choices<Find, 3> kFinds{
    {{"closest", Find::closest}, {"any", Find::any}, {"all", Find::all}}};

/// At most one hit for each query, as columns.
struct HitTable : EmptyIfZero {
  py::array key;
  py::array data;
  py::array t;
};
/// All hits of each query, concatenated.
struct HitTables : EmptyIfZero {
  py::array first;
  py::array key;
  py::array data;
  py::array t;
};
struct OverlapTables : EmptyIfZero {
  py::array first;
  py::array crossing;
  py::array ids;
};

/// A HitTable with columns that are not written yet. Usable without the GIL.
class FreshHits {
 public:
  template <typename... Shape>
  explicit FreshHits(Shape... shape)
      : key_(fresh<std::uint64_t>(shape...)),
        data_(fresh<std::uint64_t>(shape...)),
        t_(fresh<float>(shape...)),
        columns_{keys_in(key_), data_.mutable_data(), t_.mutable_data()} {}

  [[nodiscard]] const HitColumns& columns() const noexcept { return columns_; }
  void put(std::size_t i, const Hit& hit) const noexcept {
    columns_.key[i] = hit.key;
    columns_.data[i] = hit.data;
    columns_.t[i] = hit.t;
  }
  [[nodiscard]] HitTable table() && {
    return {{}, std::move(key_), std::move(data_), std::move(t_)};
  }

 private:
  py::array_t<std::uint64_t> key_;
  py::array_t<std::uint64_t> data_;
  py::array_t<float> t_;
  HitColumns columns_;
};

[[nodiscard]] HitTables shown_hits(const std::shared_ptr<const void>& owner,
                                   std::span<const Hit> hits, std::vector<std::uint64_t>&& first) {
  const Hit* const begin = hits.data();
  const auto* const key = reinterpret_cast<const std::uint64_t*>(begin);
  const auto* const data = reinterpret_cast<const std::uint64_t*>(
      reinterpret_cast<const std::byte*>(begin) + offsetof(Hit, data));
  const auto* const t =
      reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(begin) + offsetof(Hit, t));
  return {{},
          given(std::move(first)),
          shown(owner, key, hits.size(), sizeof(Hit)),
          shown(owner, data, hits.size(), sizeof(Hit)),
          shown(owner, t, hits.size(), sizeof(Hit))};
}

/// Directions and ranges of t of swept volumes.
struct CastBatch {
  CastBatch(py::handle directions, py::handle least, py::handle most)
      : direction(directions, "directions", {3}),
        min_t(least, "min_t", {}, true),
        max_t(most, "max_t", {}, true) {
    min_t.expect(direction.count());
    max_t.expect(direction.count());
  }
  Numbers direction;
  Numbers min_t;
  Numbers max_t;

  [[nodiscard]] std::size_t count() const { return direction.count(); }
  template <typename Moving>
  [[nodiscard]] Cast cast(Moving moving, std::size_t i) const {
    moving.direction = point_at(direction, i);
    moving.min_t = static_cast<float>(min_t.at(i));
    moving.max_t = static_cast<float>(max_t.at(i));
    return moving;
  }
};

/// Runs `count` casts; cast_at(i) makes the i-th.
template <typename CastAt>
[[nodiscard]] py::object cast_many(const SharedPartition& p, std::size_t count, Find find,
                                   const Filter& filter, const char* call, CastAt&& cast_at) {
  if (find == Find::all) {
    auto lists = std::make_shared<Lists<Hit>>(count);
    const Outcome outcome = reading(p.mutex, [&] {
      std::vector<HitBuffer> buffers(tasks_for(count));
      const Outcome done = answer_all(p.execution, count, [&](std::size_t task, std::size_t i) {
        const Status status = p.partition.all(cast_at(i), buffers[task], filter);
        if (status == Status::ok) lists->put(task, i, buffers[task].begin(), buffers[task].end());
        return status;
      });
      if (done.status == Status::ok) lists->join();
      return done;
    });
    accept(outcome.status, outcome.text(call));
    return py::cast(shown_hits(lists, lists->entries, std::vector(lists->first)));
  }
  FreshHits found(count);
  const Outcome outcome = reading(p.mutex, [&] {
    return answer_all(p.execution, count, [&](std::size_t, std::size_t i) {
      Hit hit;
      const Status status = find == Find::any ? p.partition.any(cast_at(i), filter).get(hit)
                                              : p.partition.closest(cast_at(i), filter).get(hit);
      found.put(i, hit);
      return status;
    });
  });
  accept(outcome.status, outcome.text(call));
  return py::cast(std::move(found).table());
}

// --- rays --------------------------------------------------------------------------------------

/// Rays, read in place if all columns are of float and have one stride, else copied.
class RayInput {
 public:
  RayInput(py::handle origins, py::handle directions, py::handle least, py::handle most)
      : origin_(origins, "origins", {3}), casts_(directions, least, most) {
    origin_.expect(casts_.count());
  }
  [[nodiscard]] std::size_t count() const { return casts_.count(); }

  [[nodiscard]] RayBatch view(std::vector<Ray>& room) const {
    const Numbers& direction = casts_.direction;
    const bool plain = casts_.min_t.is_one() && casts_.max_t.is_one() &&
                       casts_.min_t.at(0) == 0.0 &&
                       casts_.max_t.at(0) == std::numeric_limits<double>::infinity();
    if (plain && origin_.is_single() && direction.is_single() &&
        origin_.stride() == direction.stride()) {
      return {{origin_.column<float>(0), origin_.column<float>(1), origin_.column<float>(2)},
              {direction.column<float>(0), direction.column<float>(1), direction.column<float>(2)},
              count(),
              nullptr,
              nullptr,
              static_cast<std::size_t>(origin_.stride())};
    }
    room.resize(count());
    for (std::size_t i = 0; i < room.size(); ++i) {
      room[i] = {point_at(origin_, i), point_at(direction, i),
                 static_cast<float>(casts_.min_t.at(i)), static_cast<float>(casts_.max_t.at(i))};
    }
    return RayBatch(std::span<const Ray>(room));
  }

 private:
  Numbers origin_;
  CastBatch casts_;
};

[[nodiscard]] py::object cast_rays(const SharedPartition& p, py::handle origins,
                                   py::handle directions, const std::string& find_name,
                                   py::handle min_t, py::handle max_t, const Filter& filter) {
  const Find find = chosen(kFinds, find_name, "find");
  const RayInput rays(origins, directions, min_t, max_t);
  std::vector<Ray> room;
  if (find == Find::all) {
    const std::shared_ptr<HitBuffer> hits = p.hit_pool->take();
    std::vector<std::uint64_t> first(rays.count() + 1);
    accept(reading(p.mutex, [&] { return p.partition.all(rays.view(room), *hits, filter); }),
           "cast_rays");
    for (std::size_t i = 0; i < rays.count(); ++i) {
      first[i + 1] = first[i] + hits->of(i).size();
    }
    return py::cast(shown_hits(hits, hits->hits(), std::move(first)));
  }
  FreshHits found(rays.count());
  accept(reading(p.mutex,
                 [&] {
                   const RayBatch batch = rays.view(room);
                   return find == Find::any ? p.partition.any(batch, found.columns(), filter)
                                            : p.partition.closest(batch, found.columns(), filter);
                 }),
         "cast_rays");
  return py::cast(std::move(found).table());
}

// --- swept volumes -----------------------------------------------------------------------------

[[nodiscard]] py::object cast_boxes(const SharedPartition& p, py::handle lower, py::handle upper,
                                    py::handle directions, const std::string& find,
                                    py::handle min_t, py::handle max_t, const Filter& filter) {
  const CastBatch casts(directions, min_t, max_t);
  Numbers low(lower, "lower", {3});
  Numbers high(upper, "upper", {3});
  low.expect(casts.count());
  high.expect(casts.count());
  return cast_many(p, casts.count(), chosen(kFinds, find, "find"), filter, "cast_boxes",
                   [&](std::size_t i) { return casts.cast(BoxCast{box_at(low, high, i)}, i); });
}

[[nodiscard]] py::object cast_spheres(const SharedPartition& p, py::handle centers,
                                      py::handle radii, py::handle directions,
                                      const std::string& find, py::handle min_t, py::handle max_t,
                                      const Filter& filter) {
  const CastBatch casts(directions, min_t, max_t);
  Numbers center(centers, "centers", {3});
  Numbers radius(radii, "radii", {}, true);
  center.expect(casts.count());
  radius.expect(casts.count());
  return cast_many(
      p, casts.count(), chosen(kFinds, find, "find"), filter, "cast_spheres",
      [&](std::size_t i) { return casts.cast(SphereCast{sphere_at(center, radius, i)}, i); });
}

[[nodiscard]] py::object cast_capsules(const SharedPartition& p, py::handle a, py::handle b,
                                       py::handle radii, py::handle directions,
                                       const std::string& find, py::handle min_t, py::handle max_t,
                                       const Filter& filter) {
  const CastBatch casts(directions, min_t, max_t);
  Numbers from(a, "a", {3});
  Numbers to(b, "b", {3});
  Numbers radius(radii, "radii", {}, true);
  for (Numbers* each : {&from, &to, &radius}) each->expect(casts.count());
  return cast_many(
      p, casts.count(), chosen(kFinds, find, "find"), filter, "cast_capsules",
      [&](std::size_t i) { return casts.cast(CapsuleCast{capsule_at(from, to, radius, i)}, i); });
}

// --- regions -----------------------------------------------------------------------------------

/// Runs `count` region queries; region_at(i) makes the i-th.
template <typename RegionAt>
[[nodiscard]] OverlapTables overlap_many(const SharedPartition& p, std::size_t count,
                                         const std::string& order_name, const Filter& filter,
                                         const char* call, RegionAt&& region_at) {
  const Order order = chosen(kOrders, order_name, "order");
  auto lists = std::make_shared<Lists<ObjectId>>(count);
  std::vector<std::uint64_t> crossing(count);
  const Outcome outcome = reading(p.mutex, [&] {
    std::vector<OverlapBuffer> buffers(tasks_for(count));
    const Outcome done = answer_all(p.execution, count, [&](std::size_t task, std::size_t i) {
      OverlapBuffer& found = buffers[task];
      const Status status = p.partition.overlap(region_at(i), found, filter, order);
      if (status != Status::ok) return status;
      lists->put(task, i, found.ids().data(), found.ids().data() + found.size());
      crossing[i] = found.inside().size();
      return status;
    });
    if (done.status == Status::ok) lists->join();
    return done;
  });
  accept(outcome.status, outcome.text(call));
  for (std::size_t i = 0; i < count; ++i) crossing[i] += lists->first[i];
  const ObjectId* const ids = lists->entries.data();
  return {{},
          given(std::vector(lists->first)),
          given(std::move(crossing)),
          shown(std::shared_ptr<const void>(lists), ids, lists->entries.size())};
}

[[nodiscard]] OverlapTables overlap_points(const SharedPartition& p, py::handle points,
                                           const std::string& order, const Filter& filter) {
  const Numbers point(points, "points", {3});
  return overlap_many(p, point.count(), order, filter, "overlap_points", [&](std::size_t i) {
    // A point in double is replaced by the box of its float neighbours.
    return point.is_single() ? Region(point_at(point, i)) : Region(box_at(point, point, i));
  });
}

[[nodiscard]] OverlapTables overlap_spheres(const SharedPartition& p, py::handle centers,
                                            py::handle radii, const std::string& order,
                                            const Filter& filter) {
  const Numbers center(centers, "centers", {3});
  Numbers radius(radii, "radii", {}, true);
  radius.expect(center.count());
  return overlap_many(p, center.count(), order, filter, "overlap_spheres",
                      [&](std::size_t i) { return Region(sphere_at(center, radius, i)); });
}

[[nodiscard]] OverlapTables overlap_capsules(const SharedPartition& p, py::handle a, py::handle b,
                                             py::handle radii, const std::string& order,
                                             const Filter& filter) {
  const Numbers from(a, "a", {3});
  Numbers to(b, "b", {3});
  Numbers radius(radii, "radii", {}, true);
  to.expect(from.count());
  radius.expect(from.count());
  return overlap_many(p, from.count(), order, filter, "overlap_capsules",
                      [&](std::size_t i) { return Region(capsule_at(from, to, radius, i)); });
}

[[nodiscard]] OverlapTables overlap_oriented_boxes(const SharedPartition& p, py::handle centers,
                                                   py::handle halves, py::handle axes,
                                                   const std::string& order, const Filter& filter) {
  const Numbers center(centers, "centers", {3});
  Numbers half(halves, "half", {3}, true);
  Numbers turn(axes, "axes", {3, 3}, true);
  half.expect(center.count());
  turn.expect(center.count());
  return overlap_many(
      p, center.count(), order, filter, "overlap_oriented_boxes", [&](std::size_t i) {
        OrientedBox box{point_at(center, i), {}, Mat3f::identity()};
        // Upper bound on the displacement of corners by the rounding of the axes.
        double reach = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) reach += half.at(i, axis);
        const double off =
            off_point_at(center, i) + (turn.is_single() ? 0.0 : 0x1p-23 * std::abs(reach));
        for (std::size_t row = 0; row < 3; ++row) {
          box.half[row] = grown(half.at(i, row), off);
          for (std::size_t column = 0; column < 3; ++column) {
            box.axes(row, column) = static_cast<float>(turn.at(i, row, column));
          }
        }
        return Region(box);
      });
}

constexpr std::size_t kFrustumFloats = sizeof(Frustum) / sizeof(float);

[[nodiscard]] OverlapTables overlap_frusta(const SharedPartition& p, py::handle frusta,
                                           const std::string& order, const Filter& filter) {
  const Numbers numbers(frusta, "frusta", {kFrustumFloats});
  return overlap_many(p, numbers.count(), order, filter, "overlap_frusta", [&](std::size_t i) {
    float values[kFrustumFloats];
    for (std::size_t k = 0; k < kFrustumFloats; ++k) {
      values[k] = static_cast<float>(numbers.at(i, k));
    }
    Frustum frustum;
    std::memcpy(static_cast<void*>(&frustum), values, sizeof(Frustum));
    return Region(frustum);
  });
}

[[nodiscard]] OverlapTables overlap_planes(const SharedPartition& p, py::handle planes,
                                           const std::string& order, const Filter& filter) {
  const py::array array = py::array::ensure(planes);
  if (!array || array.ndim() != 3) {
    PyErr_Clear();
    throw Refusal(Status::size_mismatch, "planes: expected shape (n, p, 4)");
  }
  const auto sides = static_cast<std::size_t>(array.shape(1));
  const Numbers numbers(array, "planes", {sides, 4});
  const std::size_t count = numbers.count();
  std::vector<Plane> all(count * sides);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      all[i].normal[k] = static_cast<float>(numbers.at(i / sides, i % sides, k));
    }
    all[i].offset = static_cast<float>(numbers.at(i / sides, i % sides, 3));
  }
  return overlap_many(p, count, order, filter, "overlap_planes", [&](std::size_t i) {
    return Region(std::span<const Plane>(all).subspan(i * sides, sides));
  });
}

[[nodiscard]] py::array overlap_boxes(const SharedPartition& p, py::handle lower, py::handle upper,
                                      const std::string& order_name, const Filter& filter) {
  const Order order = chosen(kOrders, order_name, "order");
  const BoxInput boxes(lower, upper);
  const std::shared_ptr<PairBuffer> out = p.pair_pool->take();
  std::vector<Aabb> room;
  accept(
      reading(p.mutex, [&] { return p.partition.overlap(boxes.view(room), *out, filter, order); }),
      "overlap_boxes");
  return shown_pairs(out);
}

// --- frusta ------------------------------------------------------------------------------------

/// Calls make(i) for each of `count` frusta and returns them as rows of numbers.
template <typename Make>
[[nodiscard]] py::array frustum_rows(std::size_t count, Make&& make) {
  auto result = fresh<float>(count, kFrustumFloats);
  float* to = result.mutable_data();
  for (std::size_t i = 0; i < count; ++i, to += kFrustumFloats) {
    const Frustum frustum = make(i);
    if (!frustum.is_valid()) {
      throw Refusal(Status::invalid_argument, "frustum " + std::to_string(i));
    }
    std::memcpy(to, static_cast<const void*>(&frustum), sizeof(Frustum));
  }
  return result;
}

[[nodiscard]] py::array perspective(py::handle eyes, py::handle forwards, py::handle ups,
                                    float vertical_fov, float aspect, float near_t, float far_t) {
  const Numbers eye(eyes, "eye", {3});
  Numbers forward(forwards, "forward", {3}, true);
  Numbers up(ups, "up", {3}, true);
  forward.expect(eye.count());
  up.expect(eye.count());
  return frustum_rows(eye.count(), [&](std::size_t i) {
    return Frustum::perspective(point_at(eye, i), point_at(forward, i), point_at(up, i),
                                vertical_fov, aspect, near_t, far_t);
  });
}

constexpr Choices<Frustum::NearDepth, 2> kNearDepths{
    {{"zero", Frustum::NearDepth::zero}, {"minus_one", Frustum::NearDepth::minus_one}}};

[[nodiscard]] py::array frusta_of(py::handle matrices, const std::string& near_depth) {
  const Numbers numbers(matrices, "clip_from_world", {4, 4});
  const Frustum::NearDepth depth = chosen(kNearDepths, near_depth, "near_depth");
  return frustum_rows(numbers.count(), [&](std::size_t i) {
    Mat4d matrix;
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        matrix(row, column) = numbers.at(i, row, column);
      }
    }
    return Frustum::from_matrix(matrix, depth);
  });
}

// --- nearest -----------------------------------------------------------------------------------

[[nodiscard]] HitTable nearest(const SharedPartition& p, py::handle lower, std::size_t count,
                               py::handle upper, py::handle radii, const Filter& filter) {
  const Numbers low(lower, "lower", {3});
  Numbers high(upper.is_none() ? lower : upper, "upper", {3});
  Numbers radius(radii, "radius", {}, true);
  high.expect(low.count());
  radius.expect(low.count());
  const std::size_t queries = low.count();
  if (count != 0 && queries > (std::size_t{1} << 40U) / count) {
    throw Refusal(Status::out_of_memory, "nearest");
  }
  FreshHits found(queries, count);
  const Outcome outcome = reading(p.mutex, [&] {
    std::vector<HitBuffer> buffers(tasks_for(queries));
    return answer_all(p.execution, queries, [&](std::size_t task, std::size_t i) {
      HitBuffer& hits = buffers[task];
      const Status status = p.partition.nearest(box_at(low, high, i), count,
                                                static_cast<float>(radius.at(i)), hits, filter);
      if (status != Status::ok) return status;
      for (std::size_t k = 0; k < count; ++k) {
        found.put(i * count + k, k < hits.size() ? hits[k] : Hit{});
      }
      return status;
    });
  });
  accept(outcome.status, outcome.text("nearest"));
  return std::move(found).table();
}

constexpr float kForever = std::numeric_limits<float>::infinity();

void add_casts(PartitionClass& partition) {
  using py::arg;
  partition
      .def("cast_rays", filtered(&cast_rays), arg("origins"), arg("directions"),
           arg("find") = "closest", py::kw_only(), arg("min_t") = 0.0F, arg("max_t") = kForever,
           arg("filter") = PythonFilter{},
           "Finds the objects whose boxes the rays origins + t * directions, (n, 3) each, min_t <= "
           "t <= max_t, (n,) or one for all, hit. `find`: 'closest' or 'any', returning Hits, or "
           "'all', returning HitLists sorted by t. Floats with one stride are read in place.")
      .def("cast_boxes", filtered(&cast_boxes), arg("lower"), arg("upper"), arg("directions"),
           arg("find") = "closest", py::kw_only(), arg("min_t") = 0.0F, arg("max_t") = kForever,
           arg("filter") = PythonFilter{},
           "As cast_rays, for boxes (n, 3), (n, 3) that move by t * directions (n, 3).")
      .def("cast_spheres", filtered(&cast_spheres), arg("centers"), arg("radii"), arg("directions"),
           arg("find") = "closest", py::kw_only(), arg("min_t") = 0.0F, arg("max_t") = kForever,
           arg("filter") = PythonFilter{},
           "As cast_rays, for spheres: centres (n, 3), radii (n,) or one for all.")
      .def("cast_capsules", filtered(&cast_capsules), arg("a"), arg("b"), arg("radii"),
           arg("directions"), arg("find") = "closest", py::kw_only(), arg("min_t") = 0.0F,
           arg("max_t") = kForever, arg("filter") = PythonFilter{},
           "As cast_rays, for capsules: ends a and b (n, 3), radii (n,) or one for all.");
}

void add_regions(PartitionClass& partition) {
  using py::arg;
  partition
      .def("overlap_boxes", filtered(&overlap_boxes), arg("lower"), arg("upper"), py::kw_only(),
           arg("order") = "fast", arg("filter") = PythonFilter{},
           "All overlapping pairs (number of the box, id of the object): (m, 2) uint32. Boxes (n, "
           "3), (n, 3) as in `insert`.")
      .def("overlap_points", filtered(&overlap_points), arg("points"), py::kw_only(),
           arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes contain the points (n, 3), as Overlaps.")
      .def("overlap_spheres", filtered(&overlap_spheres), arg("centers"), arg("radii"),
           py::kw_only(), arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes overlap the spheres: centres (n, 3), radii (n,) or one for all.")
      .def("overlap_capsules", filtered(&overlap_capsules), arg("a"), arg("b"), arg("radii"),
           py::kw_only(), arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes overlap the capsules: ends (n, 3), radii (n,) or one for all.")
      .def("overlap_oriented_boxes", filtered(&overlap_oriented_boxes), arg("centers"), arg("half"),
           arg("axes"), py::kw_only(), arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes overlap oriented boxes: centres (n, 3), half extents (n, 3) or "
           "(3,), axes as columns of (n, 3, 3) or (3, 3).")
      .def("overlap_frusta", filtered(&overlap_frusta), arg("frusta"), py::kw_only(),
           arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes overlap frusta of cameras: (n, 30), as returned by `perspective` "
           "and `frusta_of`.")
      .def("overlap_planes", filtered(&overlap_planes), arg("planes"), py::kw_only(),
           arg("order") = "fast", arg("filter") = PythonFilter{},
           "Objects whose boxes are not entirely outside of one of p planes: (n, p, 4), an inward "
           "normal and an offset each, normal . x + offset >= 0 inside.")
      .def("nearest", filtered(&nearest), arg("lower"), arg("count") = 1, py::kw_only(),
           arg("upper") = py::none(), arg("radius") = kForever, arg("filter") = PythonFilter{},
           "The `count` objects whose boxes are nearest to each point `lower` (n, 3), or to each "
           "box up to `upper` (n, 3), within `radius`, (n,) or one for all. Hits of shape (n, "
           "count), sorted by distance, which is t; NULL_KEY and infinity if there are fewer.");
}

}  // namespace

void add_queries(py::module_& module, PartitionClass& partition) {
  using py::arg;
  py::class_<HitTable>(module, "Hits",
                       "One hit for each query; NULL_KEY, 0 and infinity if there is none.")
      .def_readonly("key", &HitTable::key, "Keys, uint64.")
      .def_readonly("data", &HitTable::data, "Client data, uint64.")
      .def_readonly("t", &HitTable::t,
                    "The t at which the cast first touches the object's box, in units of its "
                    "direction, or the distance: float32.");
  py::class_<HitTables>(module, "HitLists",
                        "Hits of each query: the hits of query i are first[i] to first[i + 1].")
      .def_readonly("first", &HitTables::first, "(n + 1,) uint64.")
      .def_readonly("key", &HitTables::key, "Keys, (m,) uint64.")
      .def_readonly("data", &HitTables::data, "Client data, (m,) uint64.")
      .def_readonly("t", &HitTables::t, "As of Hits, (m,) float32.");
  py::class_<OverlapTables>(
      module, "Overlaps",
      "Objects that overlap each region: ids[first[i]:crossing[i]] are entirely inside region i, "
      "ids[crossing[i]:first[i + 1]] cross its boundary.")
      .def_readonly("first", &OverlapTables::first, "(n + 1,) uint64.")
      .def_readonly("crossing", &OverlapTables::crossing, "(n,) uint64.")
      .def_readonly("ids", &OverlapTables::ids, "Ids of objects, (m,) uint32.");
  add_casts(partition);
  add_regions(partition);
  module.def(
      "perspective", &perspective, arg("eye"), arg("forward"), arg("up"), arg("vertical_fov"),
      arg("aspect"), arg("near"), arg("far"),
      "Frusta of cameras at eye (n, 3) with view direction `forward` and approximate up direction "
      "`up`, (n, 3) or (3,) each; vertical field of view in radians, in (0, pi); distances of the "
      "near and far plane. (n, 30) float32: six inward planes, then a box.");
  module.def("frusta_of", &frusta_of, arg("clip_from_world"), arg("near_depth") = "zero",
             "Frusta of matrices (n, 4, 4) that transform column vectors from world to clip space, "
             "with the near plane at depth 'zero' or 'minus_one'. (n, 30) float32.");
}

}  // namespace winnow::python
