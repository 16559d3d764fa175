// Pairs of a partition's objects, and their changes from frame to frame.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"

#include <cstring>
#include <optional>
#include <utility>

namespace winnow::python {

std::shared_ptr<PairBuffer> SharedPartition::take_pairs(bool incremental, bool with_events) {
  std::shared_ptr<PairBuffer> last;
  {
    const std::lock_guard lock(pairs_mutex_);
    last = std::exchange(last_pairs_, nullptr);
  }
  const std::size_t changes = changes_.exchange(0);
  if (last && last.use_count() == 1) {
    std::atomic_thread_fence(std::memory_order_acquire);
    return last;
  }
  std::shared_ptr<PairBuffer> out = pair_pool->take();
  // If a quarter of the objects or more have changed, the last pairs are not copied, and self_pairs
  // finds all pairs again.
  const bool few = changes < partition.size() / 4;
  const bool carries = with_events || (incremental && few);
  if (last && carries && !out->assign(*last)) out->clear();
  return out;
}

void SharedPartition::keep_pairs(std::shared_ptr<PairBuffer> pairs) {
  const std::lock_guard lock(pairs_mutex_);
  last_pairs_ = std::move(pairs);
}

py::array shown_pairs(const std::shared_ptr<PairBuffer>& pairs) {
  const auto* const ids = reinterpret_cast<const ObjectId*>(pairs->pairs().data());
  return shown_rows(pairs, ids, pairs->size(), 2, sizeof(Pair));
}

namespace {

/// Pairs that a predicate accepts. Finds all pairs again, because a buffer does not store which
/// predicate filtered it.
[[nodiscard]] py::array passing_pairs(SharedPartition& p, Order order, const py::object& function) {
  Predicate predicate(function, "predicate");
  const std::shared_ptr<PairBuffer> out = p.pair_pool->take();
  const Status status = reading(p.mutex, [&] {
    return p.partition.self_pairs(*out, PairOptions{order, false, pair_predicate(predicate)});
  });
  predicate.raise_if_failed();
  accept(status, "self_pairs");
  return shown_pairs(out);
}

[[nodiscard]] py::array self_pairs(SharedPartition& p, Events* events, const std::string& order,
                                   bool incremental, const py::object& predicate) {
  const PairOptions options{chosen(kOrders, order, "order"), incremental, {}};
  if (!predicate.is_none()) {
    if (events == nullptr) return passing_pairs(p, options.order, predicate);
    throw Refusal(Status::unsupported, "self_pairs: pair_changes tells events of a predicate");
  }
  std::unique_lock<std::mutex> filling;
  PairEvents* changes = nullptr;
  if (events != nullptr) {
    filling = events->hold();
    changes = &events->to_fill("events");
  }
  std::shared_ptr<PairBuffer> out;
  read_or_throw(p.mutex, "self_pairs", [&] {
    out = p.take_pairs(incremental, changes != nullptr);
    const Status status = changes == nullptr ? p.partition.self_pairs(*out, options)
                                             : p.partition.self_pairs(*out, *changes, options);
    if (status == Status::ok) p.keep_pairs(out);
    return status;
  });
  return shown_pairs(out);
}

void pair_changes(SharedPartition& p, Events& events, const py::object& function) {
  std::optional<Predicate> predicate;
  if (!function.is_none()) predicate.emplace(function, "predicate");
  const std::unique_lock<std::mutex> filling = events.hold();
  PairEvents& changes = events.to_fill("events");
  // If this or the last fill used a predicate, all pairs are found again: an update would keep what
  // the old predicate returned for pairs that did not move.
  const bool anew = events.is_filtered.exchange(predicate.has_value()) || predicate;
  PairOptions options{Order::fast, !anew, {}};
  if (predicate) options.predicate = pair_predicate(*predicate);
  const Status status = reading(p.mutex, [&] { return p.partition.self_pairs(changes, options); });
  if (predicate && predicate->has_failed()) {
    changes.clear();
    predicate->raise();
  }
  // The pairs are still those of the last fill, which may have used a predicate.
  if (status != Status::ok) events.is_filtered = true;
  accept(status, "pair_changes");
}

[[nodiscard]] py::array pairs_with(const SharedPartition& p, const SharedPartition& other,
                                   const std::string& order, const py::object& function) {
  std::optional<Predicate> predicate;
  if (!function.is_none()) predicate.emplace(function, "predicate");
  const PairOptions options{chosen(kOrders, order, "order"), !predicate,
                            predicate ? pair_predicate(*predicate) : PairPredicate{}};
  const std::shared_ptr<PairBuffer> out = p.pair_pool->take();
  const auto query = [&] { return p.partition.pairs_with(other.partition, *out, options); };
  const Status status = reading_two(p.mutex, other.mutex, query);
  if (predicate) predicate->raise_if_failed();
  accept(status, "pairs_with");
  return shown_pairs(out);
}

/// A new array (n, 2) of pairs of keys or of client data.
template <typename OfTwo>
[[nodiscard]] py::array twos(std::span<const OfTwo> pairs) {
  static_assert(sizeof(OfTwo) == 2 * sizeof(std::uint64_t));
  py::array_t<std::uint64_t> rows = fresh<std::uint64_t>(pairs.size(), 2);
  if (!pairs.empty()) std::memcpy(rows.mutable_data(), pairs.data(), pairs.size_bytes());
  return rows;
}

}  // namespace

void add_pairs(py::module_& module, PartitionClass& partition) {
  Class<Events>(module, "PairEvents")
      .def(py::init([](bool client_data) { return std::make_shared<Events>(client_data); }))
      .property("begun",
                [](const Events& e) {
                  const auto held = e.hold();
                  return twos(e.value()->begun());
                })
      .property("ended",
                [](const Events& e) {
                  const auto held = e.hold();
                  return twos(e.value()->ended());
                })
      .property("begun_data",
                [](const Events& e) {
                  const auto held = e.hold();
                  return twos(e.value()->begun_data());
                })
      .property("ended_data",
                [](const Events& e) {
                  const auto held = e.hold();
                  return twos(e.value()->ended_data());
                })
      .property("persisting",
                [](const Events& e) {
                  const auto held = e.hold();
                  return e.value()->persisting();
                })
      .def("clear", [](const Events& e) {
        const auto held = e.hold();
        e.to_fill("events").clear();
      });
  partition.def("self_pairs", &self_pairs)
      .def("pair_changes", &pair_changes)
      .def("pairs_with", &pairs_with);
}

}  // namespace winnow::python
