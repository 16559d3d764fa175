#pragma once

// Ranks of an MPI program, which Python has by mpi4py, or virtual ones, and calls to them.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/gil.h"
#include "pipeline/python/refusal.h"

#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_transport.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace winnow::python {

class PythonTransport;

/// One of this process's, by default the first.
using Rank = std::optional<std::uint32_t>;

/// How ranks talk, and one call to them after another.
class Ranks {
 public:
  /// The processes of a communicator, or so many virtual ones if it is None.
  Ranks(const py::object& communicator, std::uint32_t ranks);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] Transport& transport() noexcept { return *transport_; }
  [[nodiscard]] std::uint32_t hosted(const Rank& rank) const;
  /// Throws what body(), without the GIL, has answered, or what Python has raised.
  template <typename Body>
  void call(Body&& body, const char* name) {
    Status status = Status::ok;
    InCallback::refuse();
    {
      const WithoutGil release;
      const std::lock_guard lock(mutex_);
      status = std::forward<Body>(body)();
    }
    raise_if_failed();
    accept(status, name);
  }

 private:
  void raise_if_failed();

  std::unique_ptr<Transport> transport_;
  /// The same, or null.
  PythonTransport* python_ = nullptr;
  std::mutex mutex_;
};

/// Gives a class how many ranks there are, and which of them are this process's.
template <typename Shared>
void add_ranks(py::class_<Shared, std::shared_ptr<Shared>>& type) {
  type.def_property_readonly(
          "ranks", [](const Shared& c) { return c.cluster().ranks(); }, "Of all processes.")
      .def_property_readonly(
          "hosted",
          [](const Shared& c) {
            const std::uint32_t first = c.cluster().first_hosted();
            return py::make_tuple(first, first + c.cluster().hosted());
          },
          "Ranks of this process: the first, and one past the last.");
}

/// As 32 digits.
[[nodiscard]] std::string digits_of(const ClusterDigest& digest);
/// Counters by name.
[[nodiscard]] py::dict counters_of(const ClusterStatistics& found);

}  // namespace winnow::python
