#pragma once

#include <winnow/pipeline/cluster_transport.h>

#include <memory>

namespace winnow::bench {

/// Initializes MPI and finalizes it at destruction. Available only if the tool was built with MPI.
class MpiSession {
 public:
  /// Connects the processes that mpirun started. `time_limit` is in seconds, see MpiOptions. Throws
  /// std::runtime_error.
  explicit MpiSession(double time_limit);
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  ~MpiSession();

  [[nodiscard]] Transport& transport() noexcept { return *transport_; }
  /// Ends all processes immediately; for errors after which a process cannot respond to the others.
  [[noreturn]] static void abort();

  /// Returns true if the tool was built with MPI and Zoltan.
  [[nodiscard]] static bool is_available() noexcept;
  /// Returns true if mpirun started this process.
  [[nodiscard]] static bool is_started() noexcept;

 private:
  std::unique_ptr<Transport> transport_;
};

}  // namespace winnow::bench
