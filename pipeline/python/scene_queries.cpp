// Queries of the exact shapes of a scene, in batches.

#include "pipeline/python/batch.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/filters.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/motions.h"
#include "pipeline/python/refusal.h"
#include "pipeline/python/shared_scene.h"

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

enum class FindMode { closest, any, all };
constexpr Choices<FindMode, 3> kFindModes{
    {{"closest", FindMode::closest}, {"any", FindMode::any}, {"all", FindMode::all}}};
constexpr Choices<PairRules, 2> kRules{{{"scene", PairRules::scene}, {"none", PairRules::none}}};

/// Runs body() with shared access to the scene, after a refresh if needed.
template <typename Body>
[[nodiscard]] Outcome with_unchanged_scene(SharedScene& s, Body&& body) {
  InCallback::forbid();
  const WithoutGil release;
  for (;;) {
    {
      const std::shared_lock lock(s.mutex);
      const std::shared_lock shapes_lock(s.shapes->mutex);
      if (!s.is_stale && s.shapes_seen == s.shapes->revision) return body();
    }
    const std::unique_lock lock(s.mutex);
    const std::shared_lock shapes_lock(s.shapes->mutex);
    const Status status = s.scene.refresh();
    if (status != Status::ok) return {status, 0};
    s.is_stale = false;
    s.shapes_seen = s.shapes->revision.load();
  }
}

/// As with_unchanged_scene, and raises exceptions of Python functions.
template <typename Body>
[[nodiscard]] Outcome run_query(SharedScene& s, Body&& body) {
  return s.shapes->raised.during([&] { return with_unchanged_scene(s, body); });
}

/// A query object for the duration of a query.
class QueryLease {
 public:
  explicit QueryLease(SharedScene& s) : scene_(s), queries_(s.take_queries()) {}
  ~QueryLease() { scene_.put_queries(std::move(queries_)); }
  QueryLease(const QueryLease&) = delete;
  QueryLease& operator=(const QueryLease&) = delete;
  SceneQueries* operator->() const noexcept { return queries_.get(); }

 private:
  SharedScene& scene_;
  std::unique_ptr<SceneQueries> queries_;
};

/// Collects the results of each query as lists.
template <typename Entry, typename Query>
[[nodiscard]] std::shared_ptr<Lists<Entry>> list_all(SharedScene& s, std::size_t count,
                                                     const char* call, Query&& query) {
  auto lists = std::make_shared<Lists<Entry>>(count);
  accept(run_query(s,
                   [&] {
                     const Outcome done =
                         answer_all(s.execution, count, [&](std::size_t task, std::size_t i) {
                           const QueryLease lease(s);
                           std::span<const Entry> found;
                           const Status status = query(lease, i, found);
                           if (status == Status::ok)
                             lists->put(task, i, found.data(), found.data() + found.size());
                           return status;
                         });
                     if (done.status == Status::ok) lists->join();
                     return done;
                   }),
         call);
  return lists;
}

template <typename Entry>
[[nodiscard]] EntryColumns<Entry> columns_of(const std::shared_ptr<Lists<Entry>>& lists) {
  return {lists, lists->entries};
}

[[nodiscard]] py::object shown_lists(const std::shared_ptr<Lists<SceneHit>>& lists, FindMode mode) {
  const EntryColumns<SceneHit> hits = columns_of(lists);
  const auto made = [&](const char* name, auto&&... first) {
    return hits.table(name, &SceneHit::key, &SceneHit::data, &SceneHit::part, &SceneHit::t,
                      &SceneHit::normal, &SceneHit::point, first...);
  };
  if (mode != FindMode::all) return made("SceneHits");
  return made("SceneHitLists", given(std::vector(lists->first)));
}

[[nodiscard]] py::object shown_distances(const std::shared_ptr<Lists<SceneDistance>>& lists) {
  using D = SceneDistance;
  const EntryColumns<D> answers = columns_of(lists);
  return answers.table("SceneDistances", given(std::vector(lists->first)), &D::key, &D::data,
                       &D::part_a, &D::part, &D::distance, &D::error_bound, &D::normal, &D::point_a,
                       &D::point_b);
}

/// The result of a query without a hit.
[[nodiscard]] SceneHit nothing() {
  SceneHit hit;
  hit.t = std::numeric_limits<double>::infinity();
  return hit;
}

// --- rays --------------------------------------------------------------------------------------

/// Rays of a batch. They are read in place if they are of double and have one stride, and if they
/// are endless; else they are copied.
class ShapeRayInput {
 public:
  ShapeRayInput(py::handle origins, py::handle directions, py::handle min_ts, py::handle max_ts)
      : origin_(origins, "origins", {3}, Valid::finite),
        direction_(directions, "directions", {3}, Valid::direction),
        min_t_(min_ts, "min_t", {}),
        max_t_(max_ts, "max_t", {}),
        count_(agree({&origin_, &direction_, &min_t_, &max_t_})) {}
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] ShapeRay operator[](std::size_t i) const {
    return {origin_.vector(i), direction_.vector(i), min_t_.at(i), max_t_.at(i)};
  }
  [[nodiscard]] ShapeRayBatch view(std::vector<ShapeRay>& room) const {
    const bool endless = min_t_.is_one() && min_t_.at(0) == 0.0 && max_t_.is_one() &&
                         max_t_.at(0) == std::numeric_limits<double>::infinity();
    if (endless && !origin_.is_one() && !origin_.is_single() && !direction_.is_single() &&
        origin_.stride() == direction_.stride()) {
      return {{origin_.column<double>(0), origin_.column<double>(1), origin_.column<double>(2)},
              {direction_.column<double>(0), direction_.column<double>(1),
               direction_.column<double>(2)},
              count(),
              nullptr,
              nullptr,
              static_cast<std::size_t>(origin_.stride())};
    }
    room.resize(count());
    for (std::size_t i = 0; i < room.size(); ++i) room[i] = (*this)[i];
    return ShapeRayBatch(std::span<const ShapeRay>(room));
  }

 private:
  Numbers origin_;
  Numbers direction_;
  Numbers min_t_;
  Numbers max_t_;
  std::size_t count_;
};

/// Three columns in one array, and that array transposed to rows.
[[nodiscard]] std::pair<std::array<double*, 3>, py::array> vectors(std::size_t count) {
  auto columns = fresh<double>(3, count);
  double* const first = columns.mutable_data();
  return {{first, first + count, first + 2 * count}, py::array(columns.attr("T"))};
}

[[nodiscard]] py::object cast_rays(SharedScene& s, py::handle origins, py::handle directions,
                                   const std::string& find, py::handle min_ts, py::handle max_ts,
                                   const SceneFilter& filter) {
  const FindMode mode = chosen(kFindModes, find, "find");
  const ShapeRayInput rays(origins, directions, min_ts, max_ts);
  std::vector<ShapeRay> room;
  if (mode == FindMode::all) {
    auto lists = std::make_shared<Lists<SceneHit>>(rays.count());
    accept(run_query(s,
                     [&] {
                       const QueryLease lease(s);
                       SceneHitLists found;
                       const Status status = lease->all(rays.view(room), filter).get(found);
                       if (status != Status::ok) return Outcome{status, 0};
                       lists->entries.assign(found.hits.begin(), found.hits.end());
                       if (rays.count() != 0)
                         lists->first.assign(found.first.begin(), found.first.end());
                       return Outcome{};
                     }),
           "cast_rays");
    return shown_lists(lists, mode);
  }
  auto key = fresh<std::uint64_t>(rays.count());
  auto data = fresh<std::uint64_t>(rays.count());
  auto part = fresh<std::uint32_t>(rays.count());
  auto t = fresh<double>(rays.count());
  const auto [normal, normals] = vectors(rays.count());
  const auto [point, points] = vectors(rays.count());
  const SceneHitColumns out{
      keys_in(key), data.mutable_data(), part.mutable_data(), t.mutable_data(), normal, point};
  accept(run_query(s,
                   [&] {
                     const QueryLease lease(s);
                     const ShapeRayBatch batch = rays.view(room);
                     return Outcome{mode == FindMode::any ? lease->any(batch, out, filter)
                                                          : lease->closest(batch, out, filter),
                                    0};
                   }),
         "cast_rays");
  return table("SceneHits", key, data, part, t, normals, points);
}

[[nodiscard]] py::object crossings(SharedScene& s, py::handle origins, py::handle directions,
                                   py::handle min_ts, py::handle max_ts,
                                   const SceneFilter& filter) {
  using C = SceneCrossing;
  const ShapeRayInput rays(origins, directions, min_ts, max_ts);
  const auto lists =
      list_all<C>(s, rays.count(), "crossings",
                  [&](const QueryLease& lease, std::size_t i, std::span<const C>& found) {
                    return lease->crossings(rays[i], filter).get(found);
                  });
  return columns_of(lists).table("SceneCrossings", given(std::vector(lists->first)), &C::key,
                                 &C::data, &C::part, &C::t, &C::exits, &C::normal, &C::point,
                                 &C::barycentric);
}

// --- other queries -----------------------------------------------------------------------------

/// Casts `count` moving shapes; cast_at(i) returns the i-th.
template <typename CastAt>
[[nodiscard]] py::object cast_moving(SharedScene& s, std::size_t count, const std::string& find,
                                     const char* call, const SceneFilter& filter, double tolerance,
                                     CastAt&& cast_at) {
  const FindMode mode = chosen(kFindModes, find, "find");
  if (mode == FindMode::any) {
    throw Refusal(Status::invalid_argument, "find: of moving shapes 'closest' or 'all'");
  }
  std::vector<SceneHit> one(tasks_for(count));
  const auto lists = list_all<SceneHit>(
      s, count, call,
      [&](const QueryLease& lease, std::size_t i, std::span<const SceneHit>& found) {
        if (mode == FindMode::all) return lease->all(cast_at(i), filter, tolerance).get(found);
        SceneHit& hit = one[i / kQueriesPerTask] = nothing();
        const Status status = lease->closest(cast_at(i), filter, tolerance).get(hit);
        if (!hit) hit = nothing();
        found = {&hit, 1};
        return status;
      });
  return shown_lists(lists, mode);
}

[[nodiscard]] py::object cast_shapes(SharedScene& s, py::handle shape_array, py::handle poses,
                                     py::handle directions, const std::string& find,
                                     py::handle max_ts, double tolerance, bool touching,
                                     const SceneFilter& filter) {
  PoseInput pose(poses);
  ShapeInput shape(*s.shapes, shape_array);
  Numbers direction(directions, "directions", {3}, Valid::finite);
  Numbers max_t(max_ts, "max_t", {});
  const std::size_t count = agree({&pose, &shape, &direction, &max_t});
  return cast_moving(s, count, find, "cast_shapes", filter, tolerance, [&](std::size_t i) {
    return ShapeCast{shape[i], pose[i], direction.vector(i), max_t.at(i), touching};
  });
}

[[nodiscard]] py::object cast_motions(SharedScene& s, py::handle shape_array, py::handle motions,
                                      const std::string& find, double tolerance, bool touching,
                                      const SceneFilter& filter) {
  RigidMotionInput motion(motions);
  ShapeInput shape(*s.shapes, shape_array);
  return cast_moving(s, agree({&motion, &shape}), find, "cast_motions", filter, tolerance,
                     [&](std::size_t i) {
                       return MotionCast{shape[i], motion[i], touching};
                     });
}

[[nodiscard]] py::object overlap(SharedScene& s, py::handle shape_array, py::handle poses,
                                 const SceneFilter& filter) {
  PoseInput pose(poses);
  ShapeInput shape(*s.shapes, shape_array);
  const auto lists = list_all<SceneOverlap>(
      s, agree({&pose, &shape}), "overlap",
      [&](const QueryLease& lease, std::size_t i, std::span<const SceneOverlap>& found) {
        return lease->overlap(shape[i], pose[i], filter).get(found);
      });
  const EntryColumns<SceneOverlap> bodies = columns_of(lists);
  return bodies.table("SceneOverlaps", given(std::vector(lists->first)), &SceneOverlap::key,
                      &SceneOverlap::data, &SceneOverlap::part);
}

[[nodiscard]] py::object distances(SharedScene& s, py::handle shape_array, py::handle poses,
                                   py::handle limits, const SceneFilter& filter) {
  PoseInput pose(poses);
  ShapeInput shape(*s.shapes, shape_array);
  Numbers limit(limits, "limit", {}, Valid::finite);
  return shown_distances(list_all<SceneDistance>(
      s, agree({&pose, &shape, &limit}), "distances",
      [&](const QueryLease& lease, std::size_t i, std::span<const SceneDistance>& found) {
        return lease->distances(shape[i], pose[i], limit.at(i), filter).get(found);
      }));
}

[[nodiscard]] py::object distance(SharedScene& s, py::handle a, py::handle b, double limit,
                                  const std::string& rules) {
  const PairRules taken = chosen(kRules, rules, "rules");
  KeyInput first(s, a, "a");
  KeyInput second(s, b, "b");
  const std::size_t count = agree({&first, &second});
  std::vector<SceneDistance> one(tasks_for(count));
  return shown_distances(list_all<SceneDistance>(
      s, count, "distance",
      [&](const QueryLease& lease, std::size_t i, std::span<const SceneDistance>& found) {
        SceneDistance& answer = one[i / kQueriesPerTask];
        const Status status =
            lease->distance(first.keys()[i], second.keys()[i], limit, taken).get(answer);
        if (answer) found = {&answer, 1};
        return status;
      }));
}

/// Queries two sets of bodies.
template <typename Query>
void query_sets(SharedScene& s, py::handle a, py::handle b, const char* call, Query&& query) {
  const KeyInput first(s, a, "a");
  const KeyInput second(s, b, "b");
  accept(run_query(s,
                   [&] {
                     const QueryLease lease(s);
                     return Outcome{query(lease, first.keys(), second.keys()), 0};
                   }),
         call);
}

[[nodiscard]] py::array_t<std::uint64_t> rows_of(std::span<const KeyPair> pairs) {
  auto result = fresh<std::uint64_t>(pairs.size(), 2);
  Key* const keys = keys_in(result);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    keys[2 * i] = pairs[i].first;
    keys[2 * i + 1] = pairs[i].second;
  }
  return result;
}

[[nodiscard]] py::array_t<std::uint64_t> overlaps(SharedScene& s, py::handle a, py::handle b,
                                                  std::size_t most, const std::string& rules) {
  const PairRules taken = chosen(kRules, rules, "rules");
  std::vector<KeyPair> pairs;
  query_sets(s, a, b, "overlaps", [&](const QueryLease& lease, auto first, auto second) {
    std::span<const KeyPair> found;
    const Status status = lease->overlaps(first, second, most, taken).get(found);
    if (status == Status::ok) pairs.assign(found.begin(), found.end());
    return status;
  });
  return rows_of(pairs);
}

/// If `a` is None, tests the whole scene; if only `b` is None, tests the set `a` with itself.
[[nodiscard]] py::array_t<std::uint64_t> any_contact(SharedScene& s, const py::object& a,
                                                     const py::object& b, double contact_margin,
                                                     const std::string& rules) {
  const PairRules taken = chosen(kRules, rules, "rules");
  KeyPair pair;
  if (a.is_none()) {
    if (!b.is_none()) throw Refusal(Status::invalid_argument, "any_contact: b without a");
    accept(run_query(s,
                     [&] {
                       const QueryLease lease(s);
                       return Outcome{lease->any_contact(contact_margin, taken).get(pair), 0};
                     }),
           "any_contact");
  } else {
    const bool is_one = b.is_none();
    query_sets(s, a, is_one ? a : b, "any_contact",
               [&](const QueryLease& lease, auto first, auto second) {
                 return lease->any_contact(first, is_one ? first : second, contact_margin, taken)
                     .get(pair);
               });
  }
  return rows_of({&pair, pair.first == Key{} ? 0U : 1U});
}

[[nodiscard]] std::pair<py::array_t<std::uint64_t>, py::object> least_distance(
    SharedScene& s, py::handle a, py::handle b, double limit, const std::string& rules) {
  const PairRules taken = chosen(kRules, rules, "rules");
  SetDistance answer;
  query_sets(s, a, b, "least_distance", [&](const QueryLease& lease, auto first, auto second) {
    return lease->least_distance(first, second, limit, taken).get(answer);
  });
  auto lists = std::make_shared<Lists<SceneDistance>>(1);
  if (answer) lists->put(0, 0, &answer.to, &answer.to + 1);
  lists->join();
  auto nearest_a = fresh<std::uint64_t>(answer ? 1 : 0);
  if (answer) *keys_in(nearest_a) = answer.a;
  return {nearest_a, shown_distances(lists)};
}

[[nodiscard]] py::object nearest(SharedScene& s, py::handle points, std::size_t count,
                                 py::handle radii, const SceneFilter& filter) {
  Numbers point(points, "points", {3}, Valid::finite);
  Numbers radius(radii, "radius", {});
  return shown_distances(list_all<SceneDistance>(
      s, agree({&point, &radius}), "nearest",
      [&](const QueryLease& lease, std::size_t i, std::span<const SceneDistance>& found) {
        const double at[3] = {point.at(i, 0), point.at(i, 1), point.at(i, 2)};
        return lease->nearest(at, count, radius.at(i), filter).get(found);
      }));
}

}  // namespace

void add_scene_queries(SceneClass& scene) {
  scene.def("cast_rays", filtered(&cast_rays))
      .def("cast_shapes", filtered(&cast_shapes))
      .def("cast_motions", filtered(&cast_motions))
      .def("crossings", filtered(&crossings))
      .def("overlap", filtered(&overlap))
      .def("distances", filtered(&distances))
      .def("distance", &distance)
      .def("least_distance", &least_distance)
      .def("overlaps", &overlaps)
      .def("any_contact", &any_contact)
      .def("nearest", filtered(&nearest));
}

}  // namespace winnow::python
