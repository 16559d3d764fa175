#include <winnow/pipeline/cluster_transport.h>

#include "core/memory/guarded.h"
#include "pipeline/cluster/bisection.h"

#include <algorithm>
#include <tuple>

namespace winnow {

LoopbackTransport::LoopbackTransport(std::uint32_t ranks) noexcept
    : ranks_(std::clamp(ranks, 1U, 65'536U)) {}

Status LoopbackTransport::exchange(std::span<const Parcel> sent, std::span<const Parcel>& received,
                                   const Meanwhile& meanwhile) {
  meanwhile();
  const auto keep = [&] {
    parcels_.assign(sent.begin(), sent.end());
    return Status::ok;
  };
  const Status kept = guarded(keep, Status::out_of_memory);
  if (kept != Status::ok) return kept;
  std::sort(parcels_.begin(), parcels_.end(), [](const Parcel& a, const Parcel& b) {
    return std::tie(a.to, a.from) < std::tie(b.to, b.from);
  });
  received = parcels_;
  return Status::ok;
}

Status LoopbackTransport::reduce(std::span<std::uint64_t>, std::span<std::uint64_t>) {
  return Status::ok;
}

Status LoopbackTransport::cut(std::span<const CutWork> work, std::span<RegionCut> cuts) {
  const auto cut_all = [&] {
    bisect(work, cuts);
    return Status::ok;
  };
  return guarded(cut_all, Status::out_of_memory);
}

}  // namespace winnow
