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
  accept(reading(p.mutex,
                 [&] {
                   out = p.take_pairs(incremental, changes != nullptr);
                   const Status status = changes == nullptr
                                             ? p.partition.self_pairs(*out, options)
                                             : p.partition.self_pairs(*out, *changes, options);
                   if (status == Status::ok) p.keep_pairs(out);
                   return status;
                 }),
         "self_pairs");
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
  using py::arg;
  py::class_<Events, std::shared_ptr<Events>>(
      module, "PairEvents", "Changes of pairs between two frames. Each access returns a new array.")
      .def(py::init([](bool client_data) { return std::make_shared<Events>(client_data); }),
           py::kw_only(), arg("client_data") = false,
           "Events without a last frame. With `client_data` they include it, for 8 bytes an object "
           "and 16 a pair that begins or ends.")
      .def_property_readonly(
          "begun",
          [](const Events& e) {
            const auto held = e.hold();
            return twos(e.value()->begun());
          },
          "Pairs of this frame that are not in the last one: (m, 2) uint64 of keys, sorted by id.")
      .def_property_readonly(
          "ended",
          [](const Events& e) {
            const auto held = e.hold();
            return twos(e.value()->ended());
          },
          "Pairs of the last frame that are not in this one: (m, 2) uint64 of keys, sorted by id; "
          "keys of removed objects are stale.")
      .def_property_readonly(
          "begun_data",
          [](const Events& e) {
            const auto held = e.hold();
            return twos(e.value()->begun_data());
          },
          "Client data of the pairs in `begun`: (m, 2) uint64; (0, 2) without `client_data`.")
      .def_property_readonly(
          "ended_data",
          [](const Events& e) {
            const auto held = e.hold();
            return twos(e.value()->ended_data());
          },
          "Client data of the pairs in `ended`, including removed objects: (m, 2) uint64; (0, 2) "
          "without `client_data`.")
      .def_property_readonly(
          "persisting",
          [](const Events& e) {
            const auto held = e.hold();
            return e.value()->persisting();
          },
          "Number of pairs that are in both frames.")
      .def(
          "clear",
          [](const Events& e) {
            const auto held = e.hold();
            e.to_fill("events").clear();
          },
          "Forgets everything.");
  partition
      .def("self_pairs", &self_pairs, arg("events") = py::none(), py::kw_only(),
           arg("order") = "fast", arg("incremental") = true, arg("predicate") = py::none(),
           "Finds all pairs of objects whose volumes overlap: (m, 2) uint32 of ids, first < "
           "second. The array is a read-only view that never changes. Drop it before the next "
           "call, which then updates it in place if few objects moved; else pairs are written to "
           "another buffer. `order`: 'fast' or 'canonical' (sorted). With `events`, the changes "
           "since the last call are written there. `predicate(first, second)`, which cannot be "
           "combined with events (unsupported), is called for each pair of ids and decides. Calls "
           "come from any working thread, one at a time, because each needs the GIL; filters, or a "
           "test of the resulting array of pairs, are much faster. It must not call winnow "
           "(unsupported); this call raises its exceptions.")
      .def("pair_changes", &pair_changes, arg("events"), py::kw_only(),
           arg("predicate") = py::none(),
           "Finds only the changes of all pairs since the last call with these events, in time "
           "proportional to the objects that moved, or with a `predicate`, as in `self_pairs`, in "
           "the time of all pairs. If the predicate raises, the events are cleared.")
      .def("pairs_with", &pairs_with, arg("other"), py::kw_only(), arg("order") = "fast",
           arg("predicate") = py::none(),
           "All pairs (object of this, object of `other`) whose boxes overlap: (m, 2) uint32 of "
           "ids. `predicate` as in `self_pairs`.");
}

}  // namespace winnow::python
