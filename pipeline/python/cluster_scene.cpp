// The class ClusterScene: bodies with shapes on ranks.

#include "pipeline/python/bodies.h"
#include "pipeline/python/bytes.h"
#include "pipeline/python/cluster.h"
#include "pipeline/python/contact_choices.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/ranks.h"
#include "pipeline/python/shared_scene.h"

#include <winnow/pipeline/cluster_scene.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// A cluster, its ranks and the shapes. No shape may be removed while the cluster exists, because
/// bodies that come from other processes refer to shapes only by id.
struct RanksWithBodies {
  RanksWithBodies(std::shared_ptr<SharedShapes> of, const py::object& communicator,
                  std::uint32_t count)
      : shapes(std::move(of)), ranks(communicator, count) {
    shapes->pin(1);
  }
  ~RanksWithBodies() { shapes->pin(-1); }
  RanksWithBodies(const RanksWithBodies&) = delete;
  RanksWithBodies& operator=(const RanksWithBodies&) = delete;

  const std::shared_ptr<SharedShapes> shapes;
  Ranks ranks;
  std::optional<ClusterScene> cluster;
};

/// The Python object: the cluster, and the contacts of each rank. Arrays of contacts keep the
/// cluster alive.
class SharedClusterScene : public NeedsInit {
 public:
  SharedClusterScene(const std::shared_ptr<SharedShapes>& shapes, const py::object& communicator,
                     std::uint32_t ranks, const ClusterSceneOptions& options)
      : state_(std::make_shared<RanksWithBodies>(shapes, communicator, ranks)) {
    call(
        [&] {
          own().emplace(state_->ranks.transport(), shapes->pool, options);
          return own()->status();
        },
        "ClusterScene");
    const std::uint32_t first = cluster().first_hosted();
    for (std::uint32_t rank = first; rank < first + cluster().hosted(); ++rank) {
      // Lent contacts are never changed through this pointer.
      auto* const shown = const_cast<Contacts*>(&cluster().contacts(rank));
      contacts_.push_back(std::make_shared<HeldContacts>(
          std::shared_ptr<Contacts>(shown, [kept = state_](Contacts*) {})));
    }
  }

  [[nodiscard]] const SharedShapes& shapes() const noexcept { return *state_->shapes; }
  [[nodiscard]] const ClusterScene& cluster() const noexcept { return *state_->cluster; }
  [[nodiscard]] std::optional<ClusterScene>& own() noexcept { return state_->cluster; }
  [[nodiscard]] std::uint32_t hosted(const Rank& rank) const { return state_->ranks.hosted(rank); }
  [[nodiscard]] const std::shared_ptr<HeldContacts>& contacts(const Rank& rank) const {
    return contacts_[hosted(rank) - cluster().first_hosted()];
  }

  /// Runs body() without the GIL, while shapes do not change.
  template <typename Body>
  void call(Body&& body, const char* name) const {
    state_->shapes->raised.during([&] {
      state_->ranks.call(
          [&] {
            const std::shared_lock lock(state_->shapes->mutex);
            return body();
          },
          name);
      return true;
    });
  }
  /// As `call`, for calls that fill contacts.
  template <typename Body>
  void filling(Body&& body, const char* name) const {
    std::vector<std::unique_lock<std::mutex>> held;
    for (const auto& contacts : contacts_) held.push_back(contacts->hold());
    call(std::forward<Body>(body), name);
  }

 private:
  std::shared_ptr<RanksWithBodies> state_;
  std::vector<std::shared_ptr<HeldContacts>> contacts_;
};

[[nodiscard]] std::shared_ptr<SharedClusterScene> make_cluster(
    const std::shared_ptr<SharedShapes>& shapes, const py::object& comm, std::uint32_t ranks,
    double contact_margin, const std::string& tier, bool part_manifolds,
    const std::vector<std::string>& structures, bool parallel, double imbalance) {
  ClusterSceneOptions options;
  options.scene = scene_options(contact_margin, tier, structures, parallel);
  options.scene.composites = &shapes->composites;
  options.scene.part_manifolds = part_manifolds;
  options.imbalance = imbalance;
  return std::make_shared<SharedClusterScene>(shapes, comm, ranks, options);
}

/// Bodies with their names.
struct NamedBodies {
  NamedBodies(const SharedShapes& shapes, py::handle name_array, py::handle shape_array,
              py::handle poses, py::handle states, py::handle layers, py::handle mask,
              py::handle environment)
      : names(name_array, "names"), pose(poses), shape(shapes, shape_array) {
    EachInteger state = body_states(states);
    FilterInput filter(layers, mask, environment);
    bodies.resize(names.count());
    expect_all(names.count(), {&pose, &shape, &state});
    filter.expect(names.count());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i] = {shape[i], pose[i], static_cast<BodyState>(state[i]), filter[i], 0, {}, 0};
    }
  }
  [[nodiscard]] ClusterSceneBatch batch() const noexcept { return {names.values(), bodies}; }

  Integers<std::uint64_t> names;
  PoseInput pose;
  ShapeInput shape;
  std::vector<BodyDefinition> bodies;
};

void add(SharedClusterScene& c, py::handle names, py::handle shapes, py::handle poses,
         py::handle states, py::handle layers, py::handle mask, py::handle environment,
         const Rank& rank) {
  const NamedBodies bodies(c.shapes(), names, shapes, poses, states, layers, mask, environment);
  const std::uint32_t to = c.hosted(rank) - c.cluster().first_hosted();
  std::vector<ClusterSceneBatch> batches(c.cluster().hosted());
  std::vector<Status> answers(batches.size(), Status::ok);
  batches[to] = bodies.batch();
  c.call([&] { return c.own()->add(batches, answers); }, "add");
  accept(answers[to], "add");
}

void replicate(SharedClusterScene& c, py::handle names, py::handle shapes, py::handle poses,
               py::handle layers, py::handle mask, py::handle environment) {
  const NamedBodies bodies(c.shapes(), names, shapes, poses, py::str("fixed"), layers, mask,
                           environment);
  c.call([&] { return c.own()->replicate(bodies.batch()); }, "replicate");
}

void move_replicated(SharedClusterScene& c, py::handle name_array, py::handle poses) {
  const Integers<std::uint64_t> names(name_array, "names");
  PoseInput pose(poses);
  pose.expect(names.count());
  std::vector<Pose> room;
  c.call([&] { return c.own()->move_replicated(names.values(), pose.packed(room)); },
         "move_replicated");
}

void move(SharedClusterScene& c, py::handle name_array, py::handle poses, const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  PoseInput pose(poses);
  pose.expect(names.count());
  const std::uint32_t on = c.hosted(rank);
  std::vector<Pose> room;
  c.call([&] { return c.own()->move(on, names.values(), pose.view(room)); }, "move");
}

void remove(SharedClusterScene& c, py::handle name_array, const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  const std::uint32_t on = c.hosted(rank);
  c.call([&] { return c.own()->remove(on, names.values()); }, "remove");
}

void collide(SharedClusterScene& c, const std::string& level_name) {
  const ContactLevel level = chosen(kLevels, level_name, "level");
  c.filling([&] { return c.own()->collide(level); }, "collide");
}

[[nodiscard]] std::string digest(SharedClusterScene& c) {
  ClusterDigest digest;
  c.call([&] { return c.own()->digest().get(digest); }, "digest");
  return digits_of(digest);
}

[[nodiscard]] py::dict body_columns(const SharedClusterScene& c, const Rank& rank) {
  const std::uint32_t on = c.hosted(rank);
  std::vector<std::uint64_t> names;
  std::vector<BodyDefinition> bodies;
  c.call(
      [&] {
        std::vector<ClusterBody> own(c.cluster().size(on));
        Status status = c.cluster().bodies(on, own);
        for (const ClusterBody& body : own) {
          if (status != Status::ok) break;
          names.push_back(body.name);
          status = c.cluster().body(on, body.name).get(bodies.emplace_back());
        }
        return status;
      },
      "bodies");
  const auto columns = columns_of(std::move(bodies));
  return py::dict(py::arg("name") = given(std::move(names)),
                  py::arg("shape") = columns.of(&BodyDefinition::shape),
                  py::arg("pose") = columns.of(&BodyDefinition::pose),
                  py::arg("state") = columns.of(&BodyDefinition::state));
}

[[nodiscard]] py::tuple migrated(const SharedClusterScene& c, const Rank& rank) {
  const std::uint32_t on = c.hosted(rank);
  std::vector<std::uint64_t> came;
  std::vector<std::uint64_t> went;
  c.call(
      [&] {
        for (const ClusterBody& body : c.cluster().arrived(on)) came.push_back(body.name);
        const auto departed = c.cluster().departed(on);
        went.assign(departed.begin(), departed.end());
        return Status::ok;
      },
      "migrated");
  return py::make_tuple(given(std::move(came)), given(std::move(went)));
}

[[nodiscard]] py::bytes save(const SharedClusterScene& c, const Rank& rank) {
  const std::uint32_t on = c.hosted(rank);
  std::vector<std::byte> bytes;
  c.call([&] { return c.cluster().save(on, bytes); }, "save");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void restore(SharedClusterScene& c, const std::vector<py::buffer>& saved) {
  std::vector<std::unique_ptr<BytesInput>> inputs;
  std::vector<std::span<const std::byte>> bytes;
  for (const py::buffer& one : saved) {
    bytes.push_back(inputs.emplace_back(std::make_unique<BytesInput>(one))->bytes());
  }
  std::vector<Status> answers(bytes.size(), Status::ok);
  c.call([&] { return c.own()->restore(bytes, answers); }, "restore");
  for (const Status answer : answers) accept(answer, "restore");
}

}  // namespace

void add_cluster_scene(py::module_& module) {
  Class<SharedClusterScene> type(module, "ClusterScene");
  add_ranks(type);
  type.def(py::init(&make_cluster))
      .property("statistics",
                [](const SharedClusterScene& c) {
                  ClusterStatistics found;
                  c.call(
                      [&] {
                        found = c.cluster().statistics();
                        return Status::ok;
                      },
                      "statistics");
                  return counters_of(found);
                })
      .def("add", &add)
      .def("replicate", &replicate)
      .def("move_replicated", &move_replicated)
      .def("move", &move)
      .def("remove", &remove)
      .def("collide", &collide)
      .def("contacts", &SharedClusterScene::contacts)
      .def("digest", &digest)
      .def("bodies", &body_columns)
      .def("migrated", &migrated)
      .def("save", &save)
      .def("restore", &restore);
}

}  // namespace winnow::python
