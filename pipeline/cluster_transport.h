#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/export.h>
#include <winnow/core/status.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// A plane that cuts a region of space in two. The cuts of a cluster are a binary tree, the root
/// first; its leaves are ranks.
struct RegionCut {
  float at = 0.0F;         ///< finite; coordinates less than it lie below
  std::uint32_t axis = 0;  ///< 0, 1 or 2
  /// What lies below and at or above: the number of another cut, or `~rank`, which is negative.
  std::array<std::int32_t, 2> sides{~0, ~0};
};

/// What a rank has to do, for cuts to share out: a column of boxes, and of each how much work it
/// made, in counts.
struct CutWork {
  std::span<const Aabb> boxes;           ///< finite or not
  std::span<const std::uint32_t> works;  ///< one of each box, at least 1
};

/// What one rank sends another: columns, which are sent from where they lie.
struct Parcel {
  std::uint32_t from = 0;                               ///< rank
  std::uint32_t to = 0;                                 ///< rank
  std::array<std::span<const std::byte>, 4> columns{};  ///< each of a type of its own

  /// Of all columns.
  [[nodiscard]] std::size_t bytes() const noexcept {
    std::size_t sum = 0;
    for (const auto& column : columns) sum += column.size();
    return sum;
  }
};

/// What a process has to do while parcels are on their way.
struct Meanwhile {
  void (*work)(void* context) noexcept = nullptr;  ///< null: nothing
  void* context = nullptr;                         ///< handed to `work`

  /// Does it.
  void operator()() const noexcept {
    if (work != nullptr) work(context);
  }
};

/// How the ranks of a cluster talk to each other. Each process hosts some of them, which follow
/// each other: over MPI one, within one process all. All calls are collective: every process makes
/// the same ones in the same order. One that fails (`communication_failed`) fails on every process
/// within the transport's limit of time, and so does every later one.
class WINNOW_API Transport {
 public:
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Of all processes; at least 1.
  [[nodiscard]] virtual std::uint32_t ranks() const noexcept = 0;
  /// The first that this process hosts.
  [[nodiscard]] virtual std::uint32_t first_hosted() const noexcept = 0;
  /// How many it hosts; at least 1.
  [[nodiscard]] virtual std::uint32_t hosted() const noexcept = 0;

  /// Names the collective call of a cluster that what follows is part of, for a transport that
  /// compares what processes do. Nothing otherwise.
  virtual void begin(std::uint32_t call) noexcept { static_cast<void>(call); }

  /// Sends parcels of hosted ranks, at most one from each rank to each, and gives those that are
  /// for hosted ranks, sorted by `to` and then by `from`. They are valid until the next exchange,
  /// and as long as what was sent by this process stays where it was. Calls `meanwhile` once, if
  /// nothing has failed: best when everything that can be sent is on its way.
  virtual Status exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                          const Meanwhile& meanwhile) = 0;

  /// Replaces each number by the sum over all processes, and by the greatest, respectively.
  virtual Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) = 0;

  /// Cuts space so that ranks get about as much work each: `ranks() - 1` cuts, the same on every
  /// process. One entry of `work` for each hosted rank. Where the planes lie decides on no answer.
  virtual Status cut(std::span<const CutWork> work, std::span<RegionCut> cuts) = 0;

 protected:
  Transport() = default;
};

/// All ranks in this process: for tests, and to count what a number of ranks would send and hold.
/// It cuts by recursive bisection (Berger and Bokhari 1987: "A Partitioning Strategy for Nonuniform
/// Problems on Multiprocessors"), across the axis on which fewest boxes are cut in two. Parcels are
/// not copied.
class WINNOW_API LoopbackTransport final : public Transport {
 public:
  /// 1 to 65,536 ranks; other numbers are taken for the nearest of these.
  explicit LoopbackTransport(std::uint32_t ranks) noexcept;

  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return 0; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return ranks_; }
  Status exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                  const Meanwhile& meanwhile) override;
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override;
  Status cut(std::span<const CutWork> work, std::span<RegionCut> cuts) override;

 private:
  std::uint32_t ranks_;
  std::vector<Parcel> parcels_;
};

}  // namespace winnow
