// Boxes on the ranks of an MPI program, which Python has by mpi4py, or on virtual ranks.

#include "pipeline/python/cluster.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/choices.h"
#include "pipeline/python/made.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/refusal.h"

#include <winnow/pipeline/cluster.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// Ranks that are processes, by what an mpi4py communicator has: rank, size, alltoall, allgather.
/// What Python raises is kept, to be raised once the cluster has told of the failure.
class PythonTransport final : public Transport {
 public:
  explicit PythonTransport(py::object communicator)
      : communicator_(std::move(communicator)),
        ranks_(communicator_.attr("size").cast<std::uint32_t>()),
        rank_(communicator_.attr("rank").cast<std::uint32_t>()),
        cutter_(ranks_) {
    if (rank_ >= ranks_)
      throw Refusal(Status::invalid_argument, "comm: its rank is not below its size");
  }
  ~PythonTransport() override {
    const py::gil_scoped_acquire hold;
    communicator_ = py::object();
  }

  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return rank_; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return 1; }

  Status exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                  const Meanwhile& meanwhile) override {
    // It has no calls that come back before all has arrived.
    meanwhile();
    const Status status = asking([&] { exchange_lists(sent); });
    received = parcels_;
    return status;
  }
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override {
    return asking([&] {
      const py::list all = gather(numbers_of(sums), numbers_of(greatest));
      std::fill(sums.begin(), sums.end(), 0U);
      std::fill(greatest.begin(), greatest.end(), 0U);
      for (const py::handle one : all) {
        const auto both = one.cast<std::pair<py::list, py::list>>();
        for (std::size_t i = 0; i < sums.size(); ++i) {
          sums[i] += both.first[i].cast<std::uint64_t>();
        }
        for (std::size_t i = 0; i < greatest.size(); ++i) {
          greatest[i] = std::max(greatest[i], both.second[i].cast<std::uint64_t>());
        }
      }
    });
  }
  Status cut(std::span<const CutWork> work, std::span<RegionCut> cuts) override {
    Status status = Status::ok;
    const Status asked = asking([&] {
      const py::list all = gather(bytes_of(std::as_bytes(work.front().boxes)),
                                  bytes_of(std::as_bytes(work.front().works)));
      std::vector<std::vector<Aabb>> boxes(ranks_);
      std::vector<std::vector<std::uint32_t>> works(ranks_);
      std::vector<CutWork> of_all;
      for (std::size_t i = 0; i < ranks_; ++i) {
        const auto both = all[i].cast<std::pair<py::bytes, py::bytes>>();
        boxes[i] = values_of<Aabb>(both.first);
        works[i] = values_of<std::uint32_t>(both.second);
        of_all.push_back({boxes[i], works[i]});
      }
      status = cutter_.cut(of_all, cuts);
    });
    return asked == Status::ok ? status : asked;
  }

  /// Raises what Python has raised.
  void raise_if_failed() {
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
  }

 private:
  [[nodiscard]] static py::bytes bytes_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  template <typename T>
  [[nodiscard]] static std::vector<T> values_of(const py::bytes& bytes) {
    const auto text = static_cast<std::string_view>(bytes);
    std::vector<T> values(text.size() / sizeof(T));
    std::memcpy(values.data(), text.data(), values.size() * sizeof(T));
    return values;
  }
  [[nodiscard]] static py::list numbers_of(std::span<const std::uint64_t> numbers) {
    py::list list;
    for (const std::uint64_t number : numbers) list.append(number);
    return list;
  }
  template <typename Body>
  [[nodiscard]] Status asking(Body&& body) noexcept {
    const py::gil_scoped_acquire hold;
    try {
      body();
      return Status::ok;
    } catch (const std::bad_alloc&) {
      return Status::out_of_memory;
    } catch (...) {
      raised_ = std::current_exception();
      return Status::communication_failed;
    }
  }
  [[nodiscard]] py::list gather(const py::object& first, const py::object& second) {
    const py::list all(communicator_.attr("allgather")(py::make_tuple(first, second)));
    if (all.size() != ranks_) throw py::value_error("allgather: one of each rank is wanted");
    return all;
  }
  void exchange_lists(std::span<const Parcel> sent) {
    parcels_.clear();
    std::vector<py::object> out(ranks_, py::none());
    for (const Parcel& parcel : sent) {
      if (parcel.to == rank_) {
        parcels_.push_back(parcel);
        continue;
      }
      const auto& c = parcel.columns;
      out[parcel.to] =
          py::make_tuple(bytes_of(c[0]), bytes_of(c[1]), bytes_of(c[2]), bytes_of(c[3]));
    }
    py::list to_all;
    for (const py::object& one : out) to_all.append(one);
    const py::list told(communicator_.attr("alltoall")(to_all));
    if (told.size() != ranks_) throw py::value_error("alltoall: one of each rank is wanted");
    columns_.clear();
    columns_.reserve(std::size_t{4} * ranks_);
    for (std::uint32_t from = 0; from < ranks_; ++from) take_from(from, told[from]);
    std::sort(parcels_.begin(), parcels_.end(),
              [](const Parcel& a, const Parcel& b) { return a.from < b.from; });
  }
  void take_from(std::uint32_t from, const py::object& one) {
    if (one.is_none() || from == rank_) return;
    const auto columns = one.cast<std::tuple<py::bytes, py::bytes, py::bytes, py::bytes>>();
    Parcel parcel{from, rank_, {}};
    const auto show = [&](std::size_t c, const py::bytes& bytes) {
      // Copied to where numbers of 8 bytes may lie.
      const auto text = static_cast<std::string_view>(bytes);
      auto& words = columns_.emplace_back((text.size() + 7) / 8);
      std::memcpy(words.data(), text.data(), text.size());
      parcel.columns[c] = std::as_bytes(std::span(words)).first(text.size());
    };
    show(0, std::get<0>(columns));
    show(1, std::get<1>(columns));
    show(2, std::get<2>(columns));
    show(3, std::get<3>(columns));
    parcels_.push_back(parcel);
  }

  py::object communicator_;
  std::uint32_t ranks_;
  std::uint32_t rank_;
  LoopbackTransport cutter_;  // cuts what all have told
  std::vector<std::vector<std::uint64_t>> columns_;
  std::vector<Parcel> parcels_;
  std::exception_ptr raised_;
};

/// A cluster and how its ranks talk, one call after another.
class SharedCluster : public NeedsInit {
 public:
  SharedCluster(const py::object& communicator, std::uint32_t ranks, const std::string& structure,
                double imbalance) {
    ClusterOptions options;
    options.structure = structure_of(structure);
    options.imbalance = imbalance;
    if (communicator.is_none()) {
      transport_ = std::make_unique<LoopbackTransport>(ranks);
    } else {
      auto made = std::make_unique<PythonTransport>(communicator);
      python_ = made.get();
      transport_ = std::move(made);
    }
    call(
        [&] {
          cluster_.emplace(*transport_, options);
          return cluster_->status();
        },
        "Cluster");
  }

  [[nodiscard]] const Cluster& cluster() const noexcept { return *cluster_; }

  /// Without the GIL.
  template <typename Body>
  void call(Body&& body, const char* name) {
    Status status = Status::ok;
    {
      const py::gil_scoped_release release;
      const std::lock_guard lock(mutex_);
      status = body();
    }
    if (python_ != nullptr) python_->raise_if_failed();
    accept(status, name);
  }
  /// A hosted rank, by default the first.
  [[nodiscard]] std::uint32_t hosted(const std::optional<std::uint32_t>& rank) const {
    const std::uint32_t first = cluster_->first_hosted();
    const std::uint32_t chosen = rank.value_or(first);
    if (chosen - first < cluster_->hosted()) return chosen;
    throw Refusal(Status::invalid_argument, "rank: none of this process");
  }
  [[nodiscard]] Cluster& own() noexcept { return *cluster_; }

 private:
  std::unique_ptr<Transport> transport_;
  PythonTransport* python_ = nullptr;
  std::optional<Cluster> cluster_;
  std::mutex mutex_;
};

using Rank = std::optional<std::uint32_t>;

void add(SharedCluster& c, py::handle name_array, py::handle lower, py::handle upper,
         const Rank& rank) {
  const Integers<std::uint64_t> names(name_array, "names");
  const BoxInput boxes(lower, upper);
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
  const BoxInput boxes(lower, upper);
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
  const Order wanted = chosen(kOrders, order, "order");
  std::vector<std::uint64_t> found;
  c.call(
      [&] {
        const Status status = c.own().self_pairs(wanted);
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
  c.call([&] { return c.own().digest(digest); }, "digest");
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint64_t half : {digest.high, digest.low}) {
    for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[half >> shift & 15U];
  }
  return text;
}

[[nodiscard]] py::dict statistics(const SharedCluster& c) {
  const ClusterStatistics found = c.cluster().statistics();
  py::dict result;
  result["bodies"] = found.bodies;
  result["ghosts"] = found.ghosts;
  result["pairs"] = found.pairs;
  result["bytes"] = found.bytes;
  result["messages"] = found.messages;
  result["migrated"] = found.migrated;
  result["cuts"] = found.cuts;
  result["imbalance"] = found.imbalance;
  return result;
}

}  // namespace

void add_cluster(py::module_& module) {
  using py::arg;
  py::class_<SharedCluster, std::shared_ptr<SharedCluster>>(
      module, "Cluster",
      "Boxes on any number of ranks, and which of them overlap: the pairs of one partition of all "
      "of "
      "them, each once, whatever the number of ranks. A body has a name, uint64, and belongs to "
      "the "
      "rank in whose region its centre lies: there it is moved and removed. Making one, add, "
      "self_pairs and digest are collective: every process calls them, in the same order.")
      .def(py::init([](const py::object& comm, std::uint32_t ranks, const std::string& structure,
                       double imbalance) {
             return std::make_shared<SharedCluster>(comm, ranks, structure, imbalance);
           }),
           arg("comm") = py::none(), arg("ranks") = 1, arg("structure") = "LinearBvh",
           arg("imbalance") = 1.1,
           "`comm`: an mpi4py communicator, whose processes are the ranks; or whatever has its "
           "rank, "
           "size, alltoall and allgather. None: so many virtual `ranks` in this process. Space is "
           "cut "
           "anew once a rank has more than `imbalance` times the mean work.")
      .def_property_readonly(
          "ranks", [](const SharedCluster& c) { return c.cluster().ranks(); }, "Of all processes.")
      .def_property_readonly(
          "hosted",
          [](const SharedCluster& c) {
            const std::uint32_t first = c.cluster().first_hosted();
            return py::make_tuple(first, first + c.cluster().hosted());
          },
          "Ranks of this process: the first, and one past the last.")
      .def(
          "add", &add, arg("names"), arg("lower"), arg("upper"), arg("rank") = py::none(),
          "Adds n bodies, names (n,) that no other has, boxes (n, 3) each; none for a process that "
          "adds nothing. `rank`: one of this process, by default its first. Collective.")
      .def("move", &move, arg("names"), arg("lower"), arg("upper"), arg("rank") = py::none(),
           "New boxes (n, 3) for bodies (n,) of a rank.")
      .def("remove", &remove, arg("names"), arg("rank") = py::none(), "Removes bodies of a rank.")
      .def("self_pairs", &self_pairs, arg("order") = "fast",
           "Pairs of names, the smaller first, that ranks of this process report: (m, 2) uint64. "
           "Bodies have come to where they belong then. Collective.")
      .def("bodies", &bodies, arg("rank") = py::none(),
           "(names, lower, upper) of what belongs to a rank: (n,) uint64 and (n, 3) float32 each.")
      .def("digest", &digest,
           "128 bits of the pairs of all ranks, as 32 digits: the same on any number of them. "
           "Collective.")
      .def_property_readonly(
          "statistics", &statistics,
          "Counters of all ranks, the same on each: bodies, ghosts, pairs, bytes, "
          "messages, migrated, cuts, imbalance.");
}

}  // namespace winnow::python
