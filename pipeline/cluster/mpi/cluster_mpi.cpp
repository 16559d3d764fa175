#include <winnow/pipeline/cluster_mpi.h>

#include "pipeline/cluster/mpi/mpi.h"
#include "pipeline/cluster/mpi/zoltan_cuts.h"

#include <zoltan.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

namespace winnow {
namespace {

using Clock = std::chrono::steady_clock;
using Sizes = std::array<std::uint64_t, 4>;  // bytes of a parcel's columns

/// Ends all processes unless it is gone in time: for libraries that wait as long as it takes.
class Watchdog {
 public:
  Watchdog(MPI_Comm communicator, std::chrono::duration<double> limit)
      : thread_([this, communicator, limit] {
          std::unique_lock lock(mutex_);
          if (!gone_.wait_for(lock, limit, [this] { return is_gone_; })) {
            MPI_Abort(communicator, 1);
          }
        }) {}
  ~Watchdog() {
    {
      const std::lock_guard lock(mutex_);
      is_gone_ = true;
    }
    gone_.notify_one();
    thread_.join();
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable gone_;
  bool is_gone_ = false;
  std::thread thread_;
};

/// The columns of a parcel where they lie, as MPI describes them: in pieces whose bytes an int can
/// count.
class ColumnsType {
 public:
  void add(const void* column, std::uint64_t bytes) {
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 30U;
    for (std::uint64_t done = 0; done < bytes; done += kPiece) {
      MPI_Aint address = 0;
      MPI_Get_address(static_cast<const std::byte*>(column) + done, &address);
      places_.push_back(address);
      lengths_.push_back(static_cast<int>(std::min(kPiece, bytes - done)));
    }
  }
  /// To be freed by MPI_Type_free.
  [[nodiscard]] MPI_Datatype make() const {
    MPI_Datatype type = MPI_DATATYPE_NULL;
    MPI_Type_create_hindexed(static_cast<int>(places_.size()), lengths_.data(), places_.data(),
                             MPI_BYTE, &type);
    MPI_Type_commit(&type);
    return type;
  }

 private:
  std::vector<MPI_Aint> places_;
  std::vector<int> lengths_;
};

[[nodiscard]] std::uint64_t sum_of(const Sizes& sizes) noexcept {
  return sizes[0] + sizes[1] + sizes[2] + sizes[3];
}

/// Words of 8 bytes that a column takes where it is received.
[[nodiscard]] std::uint64_t words_of(std::uint64_t bytes) noexcept {
  return (bytes + 7) / 8;
}

class MpiTransport final : public Transport {
 public:
  MpiTransport(MPI_Comm communicator, const MpiOptions& options) : limit_(options.time_limit) {
    failed_ = MPI_Comm_dup(communicator, &communicator_) != MPI_SUCCESS;
    if (failed_) return;
    MPI_Comm_set_errhandler(communicator_, MPI_ERRORS_RETURN);
    int rank = 0;
    int ranks = 1;
    MPI_Comm_rank(communicator_, &rank);
    MPI_Comm_size(communicator_, &ranks);
    rank_ = static_cast<std::uint32_t>(rank);
    ranks_ = static_cast<std::uint32_t>(ranks);
  }
  ~MpiTransport() override {
    if (!failed_) MPI_Comm_free(&communicator_);
  }

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return rank_; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return 1; }

  Status exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                  const Meanwhile& meanwhile) override;
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override;
  Status cut(std::span<const CutWork> work, std::span<RegionCut> cuts) override;

 private:
  /// Waits for the first `count` of the requests that were made; fails once they take too long.
  [[nodiscard]] Status wait_for(std::size_t count);
  /// Waits for all of them.
  [[nodiscard]] Status finish();
  void start_sizes(std::span<const Parcel> sent);
  void start_receiving();
  void start_sending(const Parcel& parcel);
  void keep(int result) noexcept { failed_ = failed_ || result != MPI_SUCCESS; }
  [[nodiscard]] MPI_Request& new_request() { return requests_.emplace_back(MPI_REQUEST_NULL); }

  static constexpr int kTag = 1;

  MPI_Comm communicator_ = MPI_COMM_NULL;
  std::chrono::duration<double> limit_;
  std::uint32_t rank_ = 0;
  std::uint32_t ranks_ = 1;
  bool failed_ = false;
  std::vector<MPI_Request> requests_;
  std::vector<Sizes> sizes_out_;  // by rank
  std::vector<Sizes> sizes_in_;   // by rank
  std::vector<std::uint64_t> words_;
  std::vector<Parcel> parcels_;
};

Status MpiTransport::wait_for(std::size_t count) {
  const Clock::time_point start = Clock::now();
  for (int done = 0; !failed_ && done == 0;) {
    keep(MPI_Testall(static_cast<int>(count), requests_.data(), &done, MPI_STATUSES_IGNORE));
    if (done != 0) break;
    const auto waited = Clock::now() - start;
    failed_ = failed_ || waited > limit_;
    // Where there are more ranks than cores, those that wait must not keep others from computing.
    if (waited < std::chrono::milliseconds(1)) {
      std::this_thread::yield();
    } else {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }
  return failed_ ? Status::communication_failed : Status::ok;
}

Status MpiTransport::finish() {
  const Status status = wait_for(requests_.size());
  if (status == Status::ok) requests_.clear();
  return status;
}

void MpiTransport::start_sizes(std::span<const Parcel> sent) {
  sizes_out_.assign(ranks_, Sizes{});
  sizes_in_.assign(ranks_, Sizes{});
  for (const Parcel& parcel : sent) {
    for (std::size_t c = 0; c < 4; ++c) sizes_out_[parcel.to][c] = parcel.columns[c].size();
  }
  keep(MPI_Ialltoall(sizes_out_.data(), 4, MPI_UINT64_T, sizes_in_.data(), 4, MPI_UINT64_T,
                     communicator_, &new_request()));
}

void MpiTransport::start_receiving() {
  std::uint64_t words = 0;
  for (const Sizes& sizes : sizes_in_) {
    for (const std::uint64_t bytes : sizes) words += words_of(bytes);
  }
  words_.resize(words);
  const std::byte* place = reinterpret_cast<const std::byte*>(words_.data());
  for (std::uint32_t from = 0; from < ranks_; ++from) {
    const Sizes& sizes = sizes_in_[from];
    if (from == rank_ || sum_of(sizes) == 0) continue;
    Parcel& parcel = parcels_.emplace_back(Parcel{from, rank_, {}});
    ColumnsType columns;
    for (std::size_t c = 0; c < 4; ++c) {
      parcel.columns[c] = {place, sizes[c]};
      columns.add(place, sizes[c]);
      place += words_of(sizes[c]) * 8;
    }
    MPI_Datatype type = columns.make();
    keep(MPI_Irecv(MPI_BOTTOM, 1, type, static_cast<int>(from), kTag, communicator_,
                   &new_request()));
    MPI_Type_free(&type);
  }
}

void MpiTransport::start_sending(const Parcel& parcel) {
  ColumnsType columns;
  for (const auto& column : parcel.columns) columns.add(column.data(), column.size());
  MPI_Datatype type = columns.make();
  keep(MPI_Isend(MPI_BOTTOM, 1, type, static_cast<int>(parcel.to), kTag, communicator_,
                 &new_request()));
  MPI_Type_free(&type);
}

Status MpiTransport::exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                              const Meanwhile& meanwhile) {
  if (failed_) return Status::communication_failed;
  parcels_.clear();
  start_sizes(sent);
  for (const Parcel& parcel : sent) {
    if (parcel.to == rank_) {
      parcels_.push_back(parcel);
    } else if (parcel.bytes() != 0) {
      start_sending(parcel);
    }
  }
  meanwhile();
  // Sizes are the first request. What was sent may wait for who is still to ask for it.
  const Status status = wait_for(1);
  if (status != Status::ok) return status;
  start_receiving();
  std::ranges::sort(parcels_, {}, &Parcel::from);
  received = parcels_;
  return finish();
}

Status MpiTransport::reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) {
  if (failed_) return Status::communication_failed;
  const auto start = [this](std::span<std::uint64_t> values, MPI_Op operation) {
    if (values.empty()) return;
    keep(MPI_Iallreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_UINT64_T,
                        operation, communicator_, &new_request()));
  };
  start(sums, MPI_SUM);
  start(greatest, MPI_MAX);
  return finish();
}

Status MpiTransport::cut(std::span<const CutWork> work, std::span<RegionCut> cuts) {
  if (failed_) return Status::communication_failed;
  const Watchdog watchdog(communicator_, limit_);
  const Status status = cut_by_zoltan(communicator_, work.front(), cuts);
  failed_ = status != Status::ok;
  return status;
}

}  // namespace

Status make_mpi_transport(int communicator, std::unique_ptr<Transport>& transport,
                          const MpiOptions& options) {
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (initialized == 0 || !(options.time_limit > 0.0) || options.time_limit > 1e6) {
    return Status::invalid_argument;
  }
  float version = 0.0F;
  if (Zoltan_Initialize(0, nullptr, &version) != ZOLTAN_OK) return Status::communication_failed;
  try {
    auto made =
        std::make_unique<MpiTransport>(MPI_Comm_f2c(static_cast<MPI_Fint>(communicator)), options);
    if (made->failed()) return Status::communication_failed;
    transport = std::move(made);
  } catch (const std::bad_alloc&) {
    return Status::out_of_memory;
  }
  return Status::ok;
}

}  // namespace winnow
