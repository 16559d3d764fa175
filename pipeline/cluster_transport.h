#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// A plane that divides a region of space. The cuts of a cluster form a binary tree, root first;
/// its leaves are ranks.
struct SplitPlane {
  float at = 0.0F;         ///< finite; smaller coordinates are below the plane
  std::uint32_t axis = 0;  ///< 0, 1 or 2
  /// Children: below the plane, and at or above it. Each is the index of another cut, or, if it is
  /// a rank, the negative number `~rank`.
  std::array<std::int32_t, 2> sides{~0, ~0};
};

/// Work of a rank, input of a partitioning of space: a column of boxes, and the amount of work that
/// each box caused.
struct CutWork {
  std::span<const Aabb> boxes;           ///< may extend to infinity
  std::span<const std::uint32_t> works;  ///< one count per box, at least 1
};

/// A message from one rank to another: columns, sent from where they are stored.
struct RankMessage {
  std::uint32_t from = 0;                               ///< sending rank
  std::uint32_t to = 0;                                 ///< receiving rank
  std::array<std::span<const std::byte>, 4> columns{};  ///< each of its own type

  /// Returns the bytes of all columns.
  [[nodiscard]] std::size_t bytes() const noexcept {
    std::size_t sum = 0;
    for (const auto& column : columns) sum += column.size();
    return sum;
  }
};

/// A function that a process runs while messages are in transit.
struct OverlappedWork {
  void (*work)(void* context) noexcept = nullptr;  ///< null: nothing
  void* context = nullptr;                         ///< passed to `work`

  /// Runs the function.
  void operator()() const noexcept {
    if (work != nullptr) work(context);
  }
};

/// Communication between the ranks of a cluster. Each process hosts a consecutive range of ranks:
/// one with MPI, all within one process. All calls are collective: every process makes the same
/// calls in the same order. A call that fails (`communication_failed`) fails on every process
/// within the time limit of the transport, and so does every later call.
class WINNOW_API Transport {
 public:
  virtual ~Transport() = default;
  Transport& operator=(Transport&&) = delete;  // neither copied nor moved

  /// Returns the number of ranks of all processes; at least 1.
  [[nodiscard]] virtual std::uint32_t ranks() const noexcept = 0;
  /// Returns the first rank that this process hosts.
  [[nodiscard]] virtual std::uint32_t first_hosted() const noexcept = 0;
  /// Returns the number of ranks that this process hosts; at least 1.
  [[nodiscard]] virtual std::uint32_t hosted() const noexcept = 0;

  /// Called at the start of each collective call of a cluster, with its number, for transports that
  /// check that all processes make the same call. Does nothing by default.
  virtual void begin(std::uint32_t call) noexcept { static_cast<void>(call); }

  /// Sends messages of hosted ranks, at most one from each rank to each other rank, and returns the
  /// messages to hosted ranks, sorted by `to`, then by `from`. The returned messages are valid
  /// until the next exchange, unless the data sent by this process are moved. Calls `meanwhile`
  /// once unless an error occurred, preferably when all sends are under way.
  virtual Status exchange(std::span<const RankMessage> sent, std::span<const RankMessage>& received,
                          const OverlappedWork& meanwhile) = 0;

  /// Replaces each number of `sums` by its sum, and each number of `greatest` by its maximum, over
  /// all processes.
  virtual Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) = 0;

  /// Partitions space so that the ranks get about equal work: `ranks() - 1` cuts, the same on every
  /// process. `work` has one entry per hosted rank. The position of the planes affects no result.
  virtual Status cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) = 0;

 protected:
  Transport() = default;
};

/// A transport with all ranks in this process, for tests, and to measure how much data a number of
/// ranks would send and store. It partitions space by recursive bisection (Berger and Bokhari 1987:
/// "A Partitioning Strategy for Nonuniform Problems on Multiprocessors"), across the axis on which
/// the fewest boxes are cut. Messages are not copied.
class WINNOW_API LoopbackTransport final : public Transport {
 public:
  /// Creates 1 to 65,536 ranks; other numbers are clamped.
  explicit LoopbackTransport(std::uint32_t ranks) noexcept;

  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return 0; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return ranks_; }
  Status exchange(std::span<const RankMessage> sent, std::span<const RankMessage>& received,
                  const OverlappedWork& meanwhile) override;
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override;
  Status cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) override;

 private:
  std::uint32_t ranks_;
  std::vector<RankMessage> messages_;
};

}  // namespace winnow
