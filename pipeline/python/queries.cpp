// Queries of a partition, in batches: rays, swept volumes, regions and nearest objects.

#include "pipeline/python/batch.h"
#include "pipeline/python/entry_columns.h"
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

/// A table `Hits` whose columns are not written yet. Usable without the GIL.
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
  [[nodiscard]] py::object shown() const { return table("Hits", key_, data_, t_); }

 private:
  py::array_t<std::uint64_t> key_;
  py::array_t<std::uint64_t> data_;
  py::array_t<float> t_;
  HitColumns columns_;
};

[[nodiscard]] py::object shown_hits(const std::shared_ptr<const void>& owner,
                                    std::span<const Hit> hits, std::vector<std::uint64_t>&& first) {
  const EntryColumns<Hit> columns(owner, hits);
  return columns.table("HitLists", &Hit::key, &Hit::data, &Hit::t, given(std::move(first)));
}

/// Directions and ranges of t of swept volumes.
struct CastBatch {
  /// `volumes` are the arguments that state the volumes.
  CastBatch(std::initializer_list<Input*> volumes, py::handle directions, py::handle least,
            py::handle most)
      : direction(directions, "directions", {3}, Valid::direction),
        min_t(least, "min_t", {}),
        max_t(most, "max_t", {}) {
    std::vector<Input*> all(volumes);
    all.insert(all.end(), {&direction, &min_t, &max_t});
    count = agree(all);
  }
  Numbers direction;
  Numbers min_t;
  Numbers max_t;
  std::size_t count;

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
    read_or_throw(p.mutex, call, [&] {
      std::vector<HitBuffer> buffers(tasks_for(count));
      const Outcome done = answer_all(p.execution, count, [&](std::size_t task, std::size_t i) {
        const Status status = p.partition.all(cast_at(i), buffers[task], filter);
        if (status == Status::ok) lists->put(task, i, buffers[task].begin(), buffers[task].end());
        return status;
      });
      if (done.status == Status::ok) lists->join();
      return done;
    });
    return shown_hits(lists, lists->entries, std::vector(lists->first));
  }
  FreshHits found(count);
  read_or_throw(p.mutex, call, [&] {
    return answer_all(p.execution, count, [&](std::size_t, std::size_t i) {
      Hit hit;
      const Status status = find == Find::any ? p.partition.any(cast_at(i), filter).get(hit)
                                              : p.partition.closest(cast_at(i), filter).get(hit);
      found.put(i, hit);
      return status;
    });
  });
  return found.shown();
}

// --- rays --------------------------------------------------------------------------------------

/// Rays, read in place if all columns are of float and have one stride, else copied.
class RayInput {
 public:
  RayInput(py::handle origins, py::handle directions, py::handle least, py::handle most)
      : origin_(origins, "origins", {3}, Valid::finite),
        casts_({&origin_}, directions, least, most) {}
  [[nodiscard]] std::size_t count() const { return casts_.count; }

  [[nodiscard]] RayBatch view(std::vector<Ray>& room) const {
    const Numbers& direction = casts_.direction;
    const bool plain = casts_.min_t.is_one() && casts_.max_t.is_one() &&
                       casts_.min_t.at(0) == 0.0 &&
                       casts_.max_t.at(0) == std::numeric_limits<double>::infinity();
    if (plain && !origin_.is_one() && origin_.is_single() && direction.is_single() &&
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
    read_or_throw(p.mutex, "cast_rays",
                  [&] { return p.partition.all(rays.view(room), *hits, filter); });
    for (std::size_t i = 0; i < rays.count(); ++i) {
      first[i + 1] = first[i] + hits->of(i).size();
    }
    return shown_hits(hits, hits->hits(), std::move(first));
  }
  FreshHits found(rays.count());
  read_or_throw(p.mutex, "cast_rays", [&] {
    const RayBatch batch = rays.view(room);
    return find == Find::any ? p.partition.any(batch, found.columns(), filter)
                             : p.partition.closest(batch, found.columns(), filter);
  });
  return found.shown();
}

// --- swept volumes -----------------------------------------------------------------------------

[[nodiscard]] py::object cast_boxes(const SharedPartition& p, py::handle lower, py::handle upper,
                                    py::handle directions, const std::string& find,
                                    py::handle min_t, py::handle max_t, const Filter& filter) {
  BoxInput boxes(lower, upper);
  const CastBatch casts({&boxes}, directions, min_t, max_t);
  return cast_many(p, casts.count, chosen(kFinds, find, "find"), filter, "cast_boxes",
                   [&](std::size_t i) { return casts.cast(BoxCast{boxes[i]}, i); });
}

[[nodiscard]] py::object cast_spheres(const SharedPartition& p, py::handle centers,
                                      py::handle radii, py::handle directions,
                                      const std::string& find, py::handle min_t, py::handle max_t,
                                      const Filter& filter) {
  SphereInput spheres(centers, radii);
  const CastBatch casts({&spheres}, directions, min_t, max_t);
  return cast_many(p, casts.count, chosen(kFinds, find, "find"), filter, "cast_spheres",
                   [&](std::size_t i) { return casts.cast(SphereCast{spheres[i]}, i); });
}

[[nodiscard]] py::object cast_capsules(const SharedPartition& p, py::handle a, py::handle b,
                                       py::handle radii, py::handle directions,
                                       const std::string& find, py::handle min_t, py::handle max_t,
                                       const Filter& filter) {
  CapsuleInput capsules(a, b, radii);
  const CastBatch casts({&capsules}, directions, min_t, max_t);
  return cast_many(p, casts.count, chosen(kFinds, find, "find"), filter, "cast_capsules",
                   [&](std::size_t i) { return casts.cast(CapsuleCast{capsules[i]}, i); });
}

// --- regions -----------------------------------------------------------------------------------

/// Runs `count` region queries; region_at(i) makes the i-th.
template <typename RegionAt>
[[nodiscard]] py::object overlap_many(const SharedPartition& p, std::size_t count,
                                      const std::string& order_name, const Filter& filter,
                                      const char* call, RegionAt&& region_at) {
  const Order order = chosen(kOrders, order_name, "order");
  auto lists = std::make_shared<Lists<ObjectId>>(count);
  std::vector<std::uint64_t> crossing(count);
  read_or_throw(p.mutex, call, [&] {
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
  for (std::size_t i = 0; i < count; ++i) crossing[i] += lists->first[i];
  const ObjectId* const ids = lists->entries.data();
  return table("Overlaps", given(std::vector(lists->first)), given(std::move(crossing)),
               shown(std::shared_ptr<const void>(lists), ids, lists->entries.size()));
}

[[nodiscard]] py::object overlap_points(const SharedPartition& p, py::handle points,
                                        const std::string& order, const Filter& filter) {
  const Numbers point(points, "points", {3});
  return overlap_many(p, point.count(), order, filter, "overlap_points", [&](std::size_t i) {
    // A point in double is replaced by the box of its float neighbours.
    return point.is_single() ? Region(point_at(point, i)) : Region(box_at(point, i));
  });
}

[[nodiscard]] py::object overlap_spheres(const SharedPartition& p, py::handle centers,
                                         py::handle radii, const std::string& order,
                                         const Filter& filter) {
  const SphereInput spheres(centers, radii);
  return overlap_many(p, spheres.count(), order, filter, "overlap_spheres",
                      [&](std::size_t i) { return Region(spheres[i]); });
}

[[nodiscard]] py::object overlap_capsules(const SharedPartition& p, py::handle a, py::handle b,
                                          py::handle radii, const std::string& order,
                                          const Filter& filter) {
  const CapsuleInput capsules(a, b, radii);
  return overlap_many(p, capsules.count(), order, filter, "overlap_capsules",
                      [&](std::size_t i) { return Region(capsules[i]); });
}

[[nodiscard]] py::object overlap_oriented_boxes(const SharedPartition& p, py::handle centers,
                                                py::handle halves, py::handle axes,
                                                const std::string& order, const Filter& filter) {
  Numbers center(centers, "centers", {3}, Valid::finite);
  Numbers half(halves, "half", {3}, Valid::length);
  Numbers turn(axes, "axes", {3, 3}, Valid::finite);
  const std::size_t count = agree({&center, &half, &turn});
  return overlap_many(p, count, order, filter, "overlap_oriented_boxes", [&](std::size_t i) {
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

[[nodiscard]] py::object overlap_frusta(const SharedPartition& p, py::handle frusta,
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

[[nodiscard]] py::object overlap_planes(const SharedPartition& p, py::handle planes,
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
  read_or_throw(p.mutex, "overlap_boxes",
                [&] { return p.partition.overlap(boxes.view(room), *out, filter, order); });
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
      accept(Status::invalid_argument, "frustum " + std::to_string(i));
    }
    std::memcpy(to, static_cast<const void*>(&frustum), sizeof(Frustum));
  }
  return result;
}

[[nodiscard]] py::array perspective(py::handle eyes, py::handle forwards, py::handle ups,
                                    float vertical_fov, float aspect, float near_t, float far_t) {
  Numbers eye(eyes, "eye", {3}, Valid::finite);
  Numbers forward(forwards, "forward", {3}, Valid::direction);
  Numbers up(ups, "up", {3}, Valid::direction);
  return frustum_rows(agree({&eye, &forward, &up}), [&](std::size_t i) {
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

[[nodiscard]] py::object nearest(const SharedPartition& p, py::handle lower, std::size_t count,
                                 py::handle upper, py::handle radii, const Filter& filter) {
  BoxInput boxes(lower, upper.is_none() ? lower : upper);
  Numbers radius(radii, "radius", {});
  const std::size_t queries = agree({&boxes, &radius});
  if (count != 0 && queries > (std::size_t{1} << 40U) / count) {
    throw Refusal(Status::out_of_memory, "nearest");
  }
  FreshHits found(queries, count);
  read_or_throw(p.mutex, "nearest", [&] {
    std::vector<HitBuffer> buffers(tasks_for(queries));
    return answer_all(p.execution, queries, [&](std::size_t task, std::size_t i) {
      HitBuffer& hits = buffers[task];
      const Status status =
          p.partition.nearest(boxes[i], count, static_cast<float>(radius.at(i)), hits, filter);
      if (status != Status::ok) return status;
      for (std::size_t k = 0; k < count; ++k) {
        found.put(i * count + k, k < hits.size() ? hits[k] : Hit{});
      }
      return status;
    });
  });
  return found.shown();
}

}  // namespace

void add_queries(py::module_& module, PartitionClass& partition) {
  partition.def("cast_rays", filtered(&cast_rays))
      .def("cast_boxes", filtered(&cast_boxes))
      .def("cast_spheres", filtered(&cast_spheres))
      .def("cast_capsules", filtered(&cast_capsules))
      .def("overlap_boxes", filtered(&overlap_boxes))
      .def("overlap_points", filtered(&overlap_points))
      .def("overlap_spheres", filtered(&overlap_spheres))
      .def("overlap_capsules", filtered(&overlap_capsules))
      .def("overlap_oriented_boxes", filtered(&overlap_oriented_boxes))
      .def("overlap_frusta", filtered(&overlap_frusta))
      .def("overlap_planes", filtered(&overlap_planes))
      .def("nearest", filtered(&nearest));
  add_function(module, "perspective", &perspective);
  add_function(module, "frusta_of", &frusta_of);
}

}  // namespace winnow::python
