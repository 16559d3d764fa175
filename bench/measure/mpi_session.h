#pragma once

#include <winnow/pipeline/cluster_transport.h>

#include <memory>

namespace winnow::bench {

/// MPI, from here to the end of the process; only where the tool was built with it.
class MpiSession {
 public:
  /// Joins the processes that were started together. Throws std::runtime_error. `time_limit` is
  /// that of MpiOptions.
  explicit MpiSession(double time_limit);
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  ~MpiSession();

  [[nodiscard]] Transport& transport() noexcept { return *transport_; }
  /// Ends all processes at once: what is left where one of them does not answer.
  [[noreturn]] static void abort();

  /// Whether the tool was built with MPI and Zoltan.
  [[nodiscard]] static bool is_there() noexcept;
  /// Whether this process was started by mpirun.
  [[nodiscard]] static bool is_started() noexcept;

 private:
  std::unique_ptr<Transport> transport_;
};

}  // namespace winnow::bench
