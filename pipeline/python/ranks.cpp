// Transport between ranks.

#include "pipeline/python/ranks.h"

#include <winnow/core/volumes.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

namespace winnow::python {

/// Ranks that are processes, through an mpi4py communicator (rank, size, alltoall, allgather).
/// Python exceptions are stored, and raised after the cluster has reported the failure.
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
    const WithGil hold;
    communicator_ = py::object();
  }

  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return rank_; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return 1; }

  Status exchange(std::span<const RankMessage> sent, std::span<const RankMessage>& received,
                  const OverlappedWork& meanwhile) override {
    // alltoall blocks, so meanwhile() cannot run during it.
    meanwhile();
    const Status status = call_communicator([&] { exchange_lists(sent); });
    received = messages_;
    return status;
  }
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override {
    return call_communicator([&] {
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
  Status cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) override {
    Status status = Status::ok;
    const Status called = call_communicator([&] {
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
    return called == Status::ok ? status : called;
  }

  /// Raises the stored Python exception.
  void raise_if_failed() {
    if (raised_) raise(std::exchange(raised_, py::object()));
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
  [[nodiscard]] Status call_communicator(Body&& body) noexcept {
    Status status = Status::ok;
    call_python(body, [&] {
      try {
        throw;
      } catch (const std::bad_alloc&) {
        status = Status::out_of_memory;
      } catch (...) {
        raised_ = caught_exception();
        status = Status::communication_failed;
      }
    });
    return status;
  }
  [[nodiscard]] py::list gather(const py::object& first, const py::object& second) {
    const py::list all(communicator_.attr("allgather")(py::make_tuple(first, second)));
    if (all.size() != ranks_) throw py::value_error("allgather: expected one value of each rank");
    return all;
  }
  void exchange_lists(std::span<const RankMessage> sent) {
    messages_.clear();
    std::vector<py::object> out(ranks_, py::none());
    for (const RankMessage& message : sent) {
      if (message.to == rank_) {
        messages_.push_back(message);
        continue;
      }
      const auto& c = message.columns;
      out[message.to] =
          py::make_tuple(bytes_of(c[0]), bytes_of(c[1]), bytes_of(c[2]), bytes_of(c[3]));
    }
    py::list to_all;
    for (const py::object& one : out) to_all.append(one);
    const py::list gathered(communicator_.attr("alltoall")(to_all));
    if (gathered.size() != ranks_)
      throw py::value_error("alltoall: expected one value of each rank");
    columns_.clear();
    columns_.reserve(std::size_t{4} * ranks_);
    for (std::uint32_t from = 0; from < ranks_; ++from) take_from(from, gathered[from]);
    std::sort(messages_.begin(), messages_.end(),
              [](const RankMessage& a, const RankMessage& b) { return a.from < b.from; });
  }
  void take_from(std::uint32_t from, const py::object& one) {
    if (one.is_none() || from == rank_) return;
    const auto columns = one.cast<std::tuple<py::bytes, py::bytes, py::bytes, py::bytes>>();
    RankMessage message{from, rank_, {}};
    const auto show = [&](std::size_t c, const py::bytes& bytes) {
      // Copied, to align 8-byte numbers.
      const auto text = static_cast<std::string_view>(bytes);
      auto& words = columns_.emplace_back((text.size() + 7) / 8);
      std::memcpy(words.data(), text.data(), text.size());
      message.columns[c] = std::as_bytes(std::span(words)).first(text.size());
    };
    show(0, std::get<0>(columns));
    show(1, std::get<1>(columns));
    show(2, std::get<2>(columns));
    show(3, std::get<3>(columns));
    messages_.push_back(message);
  }

  py::object communicator_;
  std::uint32_t ranks_;
  std::uint32_t rank_;
  LoopbackTransport cutter_;  // cuts space by the gathered work of all ranks
  std::vector<std::vector<std::uint64_t>> columns_;
  std::vector<RankMessage> messages_;
  py::object raised_;
};

Ranks::Ranks(const py::object& communicator, std::uint32_t ranks) {
  if (communicator.is_none()) {
    transport_ = std::make_unique<LoopbackTransport>(ranks);
    return;
  }
  auto made = std::make_unique<PythonTransport>(communicator);
  python_ = made.get();
  transport_ = std::move(made);
}

Ranks::~Ranks() = default;

std::uint32_t Ranks::hosted(const Rank& rank) const {
  const std::uint32_t first = transport_->first_hosted();
  const std::uint32_t chosen = rank.value_or(first);
  if (chosen - first < transport_->hosted()) return chosen;
  throw Refusal(Status::invalid_argument, "rank: none of this process");
}

void Ranks::raise_if_failed() {
  if (python_ != nullptr) python_->raise_if_failed();
}

std::string digits_of(const ClusterDigest& digest) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint64_t half : {digest.high, digest.low}) {
    for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[half >> shift & 15U];
  }
  return text;
}

py::dict counters_of(const ClusterStatistics& found) {
  return py::dict(py::arg("bodies") = found.bodies, py::arg("ghosts") = found.ghosts,
                  py::arg("pairs") = found.pairs, py::arg("bytes") = found.bytes,
                  py::arg("messages") = found.messages, py::arg("migrated") = found.migrated,
                  py::arg("cuts") = found.cuts, py::arg("imbalance") = found.imbalance);
}

}  // namespace winnow::python
