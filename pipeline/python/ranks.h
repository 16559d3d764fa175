#pragma once

// The ranks of a cluster: processes of an MPI program (by mpi4py), or virtual ranks in this
// process.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/described.h"
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

/// A rank of this process; by default the first one.
using Rank = std::optional<std::uint32_t>;

/// The transport between ranks, and a lock that allows one call at a time.
class Ranks {
 public:
  /// Uses the processes of a communicator, or `ranks` virtual ones if it is None.
  Ranks(const py::object& communicator, std::uint32_t ranks);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] Transport& transport() noexcept { return *transport_; }
  [[nodiscard]] std::uint32_t hosted(const Rank& rank) const;
  /// Runs body() without the GIL. Throws if its status is not ok, or if the transport stored a
  /// Python exception.
  template <typename Body>
  void call(Body&& body, const char* name) {
    Status status = Status::ok;
    InCallback::forbid();
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
  /// `transport_` if it is a PythonTransport, else null.
  PythonTransport* python_ = nullptr;
  std::mutex mutex_;
};

/// Adds the properties `ranks` and `hosted` to a class.
template <typename Shared>
void add_ranks(Class<Shared>& type) {
  type.property("ranks", [](const Shared& c) { return c.cluster().ranks(); })
      .property("hosted", [](const Shared& c) {
        const std::uint32_t first = c.cluster().first_hosted();
        return py::make_tuple(first, first + c.cluster().hosted());
      });
}

/// A digest as 32 digits.
[[nodiscard]] std::string digits_of(const ClusterDigest& digest);
/// Counters by name.
[[nodiscard]] py::dict counters_of(const ClusterStatistics& found);

}  // namespace winnow::python
