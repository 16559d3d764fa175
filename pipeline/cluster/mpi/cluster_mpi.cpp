// Transport over MPI (make_mpi_transport in cluster_mpi.h). Each collective step begins with an
// exchange of headers, by which the ranks compare what they do. Waits for messages have a time
// limit.

#include <winnow/pipeline/cluster_mpi.h>

#include "core/memory/catch_bad_alloc.h"
#include "pipeline/cluster/mpi/mpi.h"
#include "pipeline/cluster/mpi/zoltan_cuts.h"

#include <zoltan.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <new>
#include <numeric>
#include <thread>
#include <vector>

namespace winnow {
namespace {

using Clock = std::chrono::steady_clock;
/// The step that a rank takes; must be the same on all ranks.
enum class Step : std::uint64_t { exchange, reduce, arrive, cut };
/// Message from each rank to each other rank at the beginning of a step.
struct Header {
  std::uint64_t step = 0;                // call and step
  std::array<std::uint64_t, 4> sizes{};  // bytes of a message's columns
};
constexpr int kHeaderWords = sizeof(Header) / sizeof(std::uint64_t);

/// Task of the thread that calls Zoltan. It may outlive the call that started it.
struct CutTask {
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> works;
  std::vector<SplitPlane> cuts;

  [[nodiscard]] Status run(MPI_Comm communicator) noexcept {
    return catch_bad_alloc(
        [&] {
          return cut_by_zoltan(communicator, {boxes, works}, cuts);
        },
        Status::out_of_memory);
  }
};

/// MPI datatype of the columns of a message, where they are stored: in pieces whose sizes fit in an
/// int.
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
  /// The caller frees the type with MPI_Type_free.
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

[[nodiscard]] std::uint64_t sum_of(const Header& header) noexcept {
  return std::accumulate(header.sizes.begin(), header.sizes.end(), std::uint64_t{0});
}

/// Number of 8-byte words that a received column occupies.
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
    int threads = MPI_THREAD_SINGLE;
    MPI_Query_thread(&threads);
    has_threads_ = threads >= MPI_THREAD_SERIALIZED;
  }
  ~MpiTransport() override {
    if (failed_) {
      leave_buffers();
    } else {
      MPI_Comm_free(&communicator_);
    }
  }

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::uint32_t ranks() const noexcept override { return ranks_; }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return rank_; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return 1; }

  void begin(std::uint32_t call) noexcept override { call_ = call; }
  Status exchange(std::span<const RankMessage> sent, std::span<const RankMessage>& received,
                  const OverlappedWork& meanwhile) override;
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override;
  Status cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) override;

 private:
  /// Waits for the first `count` requests; fails after the time limit.
  [[nodiscard]] Status wait_for(std::size_t count);
  /// Waits for all requests.
  [[nodiscard]] Status finish();
  /// Begins a step: sends headers with the sizes of the messages.
  void start(Step step, std::span<const RankMessage> sent = {});
  /// Waits for the headers, the first request; fails unless all ranks take the same step.
  [[nodiscard]] Status synchronize();
  /// A whole step in which no messages are sent.
  [[nodiscard]] Status synchronize(Step step);
  [[nodiscard]] Status cut_in_time(const CutWork& work, std::span<SplitPlane> cuts);
  /// After a failed step MPI may still write to the receive buffers: leaks them.
  void leave_buffers() noexcept;
  void start_receiving();
  void start_sending(const RankMessage& message);
  void keep(int result) noexcept { failed_ = failed_ || result != MPI_SUCCESS; }
  [[nodiscard]] MPI_Request& new_request() { return requests_.emplace_back(MPI_REQUEST_NULL); }

  static constexpr int kTag = 1;

  MPI_Comm communicator_ = MPI_COMM_NULL;
  std::chrono::duration<double> limit_;
  std::uint32_t rank_ = 0;
  std::uint32_t ranks_ = 1;
  bool failed_ = false;
  bool has_threads_ = false;  // MPI allows calls from other threads than the main one
  std::uint32_t call_ = 0;
  std::vector<MPI_Request> requests_;
  std::vector<Header> out_;           // by rank
  std::vector<Header> in_;            // by rank
  std::vector<std::uint64_t> words_;  // received columns, or sums
  std::vector<RankMessage> messages_;
};

Status MpiTransport::wait_for(std::size_t count) {
  const Clock::time_point start = Clock::now();
  for (int done = 0; !failed_ && done == 0;) {
    keep(MPI_Testall(static_cast<int>(count), requests_.data(), &done, MPI_STATUSES_IGNORE));
    if (done != 0) break;
    const auto waited = Clock::now() - start;
    failed_ = failed_ || waited > limit_;
    // If there are more ranks than cores, a waiting rank must not use up the time of others.
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

void MpiTransport::start(Step step, std::span<const RankMessage> sent) {
  const Header header{std::uint64_t{call_} << 8U | static_cast<std::uint64_t>(step), {}};
  out_.assign(ranks_, header);
  in_.assign(ranks_, header);
  for (const RankMessage& message : sent) {
    for (std::size_t c = 0; c < 4; ++c) out_[message.to].sizes[c] = message.columns[c].size();
  }
  keep(MPI_Ialltoall(out_.data(), kHeaderWords, MPI_UINT64_T, in_.data(), kHeaderWords,
                     MPI_UINT64_T, communicator_, &new_request()));
}

Status MpiTransport::synchronize() {
  const Status status = wait_for(1);
  if (status != Status::ok) return status;
  const std::uint64_t step = out_[rank_].step;
  failed_ = !std::ranges::all_of(in_, [&](const Header& header) { return header.step == step; });
  return failed_ ? Status::communication_failed : Status::ok;
}

Status MpiTransport::synchronize(Step step) {
  start(step);
  const Status status = synchronize();
  requests_.clear();
  return status;
}

void MpiTransport::leave_buffers() noexcept {
  (void)catch_bad_alloc(
      [&] {
        (void)new std::vector<Header>(std::move(out_));
        (void)new std::vector<Header>(std::move(in_));
        (void)new std::vector<std::uint64_t>(std::move(words_));
        return true;
      },
      false);
}

void MpiTransport::start_receiving() {
  std::uint64_t words = 0;
  for (const Header& header : in_) {
    for (const std::uint64_t bytes : header.sizes) words += words_of(bytes);
  }
  words_.resize(words);
  const std::byte* place = reinterpret_cast<const std::byte*>(words_.data());
  for (std::uint32_t from = 0; from < ranks_; ++from) {
    const auto& sizes = in_[from].sizes;
    if (from == rank_ || sum_of(in_[from]) == 0) continue;
    RankMessage& message = messages_.emplace_back(RankMessage{from, rank_, {}});
    ColumnsType columns;
    for (std::size_t c = 0; c < 4; ++c) {
      message.columns[c] = {place, sizes[c]};
      columns.add(place, sizes[c]);
      place += words_of(sizes[c]) * 8;
    }
    MPI_Datatype type = columns.make();
    keep(MPI_Irecv(MPI_BOTTOM, 1, type, static_cast<int>(from), kTag, communicator_,
                   &new_request()));
    MPI_Type_free(&type);
  }
}

void MpiTransport::start_sending(const RankMessage& message) {
  ColumnsType columns;
  for (const auto& column : message.columns) columns.add(column.data(), column.size());
  MPI_Datatype type = columns.make();
  keep(MPI_Isend(MPI_BOTTOM, 1, type, static_cast<int>(message.to), kTag, communicator_,
                 &new_request()));
  MPI_Type_free(&type);
}

Status MpiTransport::exchange(std::span<const RankMessage> sent,
                              std::span<const RankMessage>& received,
                              const OverlappedWork& meanwhile) {
  if (failed_) return Status::communication_failed;
  messages_.clear();
  start(Step::exchange, sent);
  for (const RankMessage& message : sent) {
    if (message.to == rank_) {
      messages_.push_back(message);
    } else if (message.bytes() != 0) {
      start_sending(message);
    }
  }
  meanwhile();
  // The sends may not complete before the receiver has posted its receives.
  const Status status = synchronize();
  if (status != Status::ok) return status;
  start_receiving();
  std::ranges::sort(messages_, {}, &RankMessage::from);
  received = messages_;
  return finish();
}

Status MpiTransport::reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) {
  if (failed_) return Status::communication_failed;
  Status status = synchronize(Step::reduce);
  if (status != Status::ok) return status;
  words_.assign(sums.begin(), sums.end());
  words_.insert(words_.end(), greatest.begin(), greatest.end());
  const auto start = [this](std::size_t begin, std::size_t count, MPI_Op operation) {
    if (count == 0) return;
    keep(MPI_Iallreduce(MPI_IN_PLACE, words_.data() + begin, static_cast<int>(count), MPI_UINT64_T,
                        operation, communicator_, &new_request()));
  };
  start(0, sums.size(), MPI_SUM);
  start(sums.size(), greatest.size(), MPI_MAX);
  status = finish();
  if (status != Status::ok) return status;
  std::copy_n(words_.begin(), sums.size(), sums.begin());
  std::copy_n(words_.end() - static_cast<std::ptrdiff_t>(greatest.size()), greatest.size(),
              greatest.begin());
  return Status::ok;
}

// Zoltan has no time limit. Two steps before it detect a rank that is late or makes another call: a
// rank completes the second step only after all ranks have completed the first one.
Status MpiTransport::cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) {
  if (failed_) return Status::communication_failed;
  for (const Step step : {Step::arrive, Step::cut}) {
    const Status status = synchronize(step);
    if (status != Status::ok) return status;
  }
  const Status status = has_threads_ ? cut_in_time(work.front(), cuts)
                                     : cut_by_zoltan(communicator_, work.front(), cuts);
  failed_ = status != Status::ok;
  return status;
}

// Calls Zoltan on a thread, which is abandoned after the time limit.
Status MpiTransport::cut_in_time(const CutWork& work, std::span<SplitPlane> cuts) {
  const auto task = std::make_shared<CutTask>();
  task->boxes.assign(work.boxes.begin(), work.boxes.end());
  task->works.assign(work.works.begin(), work.works.end());
  task->cuts.resize(cuts.size());
  std::packaged_task<Status()> run(
      [task, communicator = communicator_] { return task->run(communicator); });
  std::future<Status> answer = run.get_future();
  std::thread(std::move(run)).detach();
  if (answer.wait_for(limit_) != std::future_status::ready) return Status::communication_failed;
  std::ranges::copy(task->cuts, cuts.begin());
  return answer.get();
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
