// The class Cluster: boxes on ranks.

#include "pipeline/python/cluster.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/choices.h"
#include "pipeline/python/init_checks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/ranks.h"
#include "pipeline/python/refusal.h"

#include <winnow/pipeline/cluster.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// A cluster and its ranks; runs one call at a time.
class SharedCluster : public NeedsInit {
 public:
  SharedCluster(const py::object& communicator, std::uint32_t ranks, const std::string& structure,
                double imbalance)
      : ranks_(communicator, ranks) {
    ClusterOptions options;
    options.structure = structure_of(structure);
    options.imbalance = imbalance;
    call(
        [&] {
          cluster_.emplace(ranks_.transport(), options);
          return cluster_->status();
        },
        "Cluster");
  }

  [[nodiscard]] const Cluster& cluster() const noexcept { return *cluster_; }
  [[nodiscard]] Cluster& own() noexcept { return *cluster_; }
  template <typename Body>
  void call(Body&& body, const char* name) {
    ranks_.call(std::forward<Body>(body), name);
  }
  [[nodiscard]] std::uint32_t hosted(const Rank& rank) const { return ranks_.hosted(rank); }

 private:
  Ranks ranks_;
  std::optional<Cluster> cluster_;
};

void add(SharedCluster& c, py::handle name_array, py::handle lower, py::handle upper,
         const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  BoxInput boxes(lower, upper);
  boxes.expect(names.count());
  const std::uint32_t to = c.hosted(rank) - c.cluster().first_hosted();
  std::vector<ClusterBatch> batches(c.cluster().hosted());
  std::vector<Status> answers(batches.size(), Status::ok);
  std::vector<Aabb> room;
  c.call(
      [&] {
        batches[to] = {names.values(), boxes.view(room)};
        return c.own().add(batches, answers);
      },
      "add");
  accept(answers[to], "add");
}

void move(SharedCluster& c, py::handle name_array, py::handle lower, py::handle upper,
          const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  BoxInput boxes(lower, upper);
  boxes.expect(names.count());
  const std::uint32_t on = c.hosted(rank);
  std::vector<Aabb> room;
  c.call([&] { return c.own().move(on, names.values(), boxes.view(room)); }, "move");
}

void remove(SharedCluster& c, py::handle name_array, const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  const std::uint32_t on = c.hosted(rank);
  c.call([&] { return c.own().remove(on, names.values()); }, "remove");
}

[[nodiscard]] py::array self_pairs(SharedCluster& c, const std::string& order) {
  const Order pair_order = chosen(kOrders, order, "order");
  std::vector<std::uint64_t> found;
  c.call(
      [&] {
        const Status status = c.own().self_pairs(pair_order);
        if (status != Status::ok) return status;
        const std::uint32_t first = c.cluster().first_hosted();
        for (std::uint32_t rank = first; rank < first + c.cluster().hosted(); ++rank) {
          for (const NamePair pair : c.cluster().pairs(rank)) {
            found.insert(found.end(), {pair.first, pair.second});
          }
        }
        return status;
      },
      "self_pairs");
  return given(std::move(found), 2);
}

[[nodiscard]] py::tuple bodies(SharedCluster& c, const Rank& rank) {
  const std::uint32_t on = c.hosted(rank);
  std::vector<std::uint64_t> names;
  std::vector<float> corners[2];
  c.call(
      [&] {
        std::vector<ClusterBody> own(c.cluster().size(on));
        std::vector<Aabb> boxes(own.size());
        const Status status = c.cluster().bodies(on, own, boxes);
        if (status != Status::ok) return status;
        for (std::size_t i = 0; i < own.size(); ++i) {
          names.push_back(own[i].name);
          for (int axis = 0; axis < 3; ++axis) {
            corners[0].push_back(boxes[i].min[axis]);
            corners[1].push_back(boxes[i].max[axis]);
          }
        }
        return status;
      },
      "bodies");
  return py::make_tuple(given(std::move(names)), given(std::move(corners[0]), 3),
                        given(std::move(corners[1]), 3));
}

[[nodiscard]] std::string digest(SharedCluster& c) {
  ClusterDigest digest;
  c.call([&] { return c.own().digest().get(digest); }, "digest");
  return digits_of(digest);
}

[[nodiscard]] py::dict statistics(const SharedCluster& c) {
  return counters_of(c.cluster().statistics());
}

}  // namespace

void add_cluster(py::module_& module) {
  Class<SharedCluster> type(module, "Cluster");
  add_ranks(type);
  type.def(py::init([](const py::object& comm, std::uint32_t ranks, const std::string& structure,
                       double imbalance) {
        return std::make_shared<SharedCluster>(comm, ranks, structure, imbalance);
      }))
      .def("add", &add)
      .def("move", &move)
      .def("remove", &remove)
      .def("self_pairs", &self_pairs)
      .def("bodies", &bodies)
      .def("digest", &digest)
      .property("statistics", &statistics);
}

}  // namespace winnow::python
