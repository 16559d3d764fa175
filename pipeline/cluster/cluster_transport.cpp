#include <winnow/pipeline/cluster_transport.h>

#include "core/memory/catch_bad_alloc.h"
#include "pipeline/cluster/bisection.h"

#include <algorithm>
#include <tuple>

namespace winnow {

LoopbackTransport::LoopbackTransport(std::uint32_t ranks) noexcept
    : ranks_(std::clamp(ranks, 1U, 65'536U)) {}

Status LoopbackTransport::exchange(std::span<const RankMessage> sent,
                                   std::span<const RankMessage>& received,
                                   const OverlappedWork& meanwhile) {
  meanwhile();
  const auto keep = [&] {
    messages_.assign(sent.begin(), sent.end());
    return Status::ok;
  };
  const Status kept = catch_bad_alloc(keep, Status::out_of_memory);
  if (kept != Status::ok) return kept;
  std::sort(messages_.begin(), messages_.end(), [](const RankMessage& a, const RankMessage& b) {
    return std::tie(a.to, a.from) < std::tie(b.to, b.from);
  });
  received = messages_;
  return Status::ok;
}

Status LoopbackTransport::reduce(std::span<std::uint64_t>, std::span<std::uint64_t>) {
  return Status::ok;
}

Status LoopbackTransport::cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) {
  const auto cut_all = [&] {
    bisect(work, cuts);
    return Status::ok;
  };
  return catch_bad_alloc(cut_all, Status::out_of_memory);
}

}  // namespace winnow
