// Pairs of a partition's objects, and what changed of them.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"

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
  // Where much has moved, all pairs are asked for anew, wherever they are written.
  const bool few = changes < partition->size() / 4;
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

/// What a predicate lets pass: all pairs anew, for a buffer does not tell whom it asked.
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
  // What a predicate said of pairs that did not move would stand.
  const bool anew = events.is_filtered.exchange(predicate.has_value()) || predicate;
  PairOptions options{Order::fast, !anew, {}};
  if (predicate) options.predicate = pair_predicate(*predicate);
  const Status status = reading(p.mutex, [&] { return p.partition.self_pairs(changes, options); });
  if (predicate && predicate->has_failed()) {
    changes.clear();
    predicate->raise();
  }
  accept(status, "pair_changes");
}

[[nodiscard]] py::array pairs_with(const SharedPartition& p, const SharedPartition& other,
                                   const std::string& order, const py::object& function) {
  std::optional<Predicate> predicate;
  if (!function.is_none()) predicate.emplace(function, "predicate");
  const PairOptions options{chosen(kOrders, order, "order"), !predicate,
                            predicate ? pair_predicate(*predicate) : PairPredicate{}};
  if (p.recorder != other.recorder) {
    throw Refusal(Status::unsupported, "pairs_with: of two that are not recorded together");
  }
  const std::shared_ptr<PairBuffer> out = p.pair_pool->take();
  const auto ask = [&] { return p.partition.pairs_with(other.partition, *out, options); };
  const Status status = reading_two(p.mutex, other.mutex, ask);
  if (predicate) predicate->raise_if_failed();
  accept(status, "pairs_with");
  return shown_pairs(out);
}

/// Pairs of keys or of client data.
template <typename OfTwo>
[[nodiscard]] py::array shown_twos(const std::shared_ptr<PairEvents>& events,
                                   std::span<const OfTwo> pairs) {
  static_assert(sizeof(OfTwo) == 2 * sizeof(std::uint64_t));
  const auto* const words = reinterpret_cast<const std::uint64_t*>(pairs.data());
  return shown_rows(std::shared_ptr<const void>(events), words, pairs.size(), 2, sizeof(OfTwo));
}

}  // namespace

void add_pairs(py::module_& module, PartitionClass& partition) {
  using py::arg;
  py::class_<Events, std::shared_ptr<Events>>(
      module, "PairEvents",
      "What changed between two frames. Its arrays show what winnow wrote; while "
      "one of them is alive, filling the events again is a BufferError.")
      .def(py::init([](bool client_data) { return std::make_shared<Events>(client_data); }),
           py::kw_only(), arg("client_data") = false,
           "Events that remember nothing. With `client_data` they give that with the pairs, for 8 "
           "bytes an object and 16 a pair that begins or ends.")
      .def_property_readonly(
          "begun",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_twos(e.value(), e.value()->begun());
          },
          "Pairs of this frame that the last one had not: (m, 2) uint64 of "
          "keys, sorted by id.")
      .def_property_readonly(
          "ended",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_twos(e.value(), e.value()->ended());
          },
          "Pairs of the last frame that this one has not: (m, 2) uint64 of "
          "keys, sorted by id; those of removed objects are stale.")
      .def_property_readonly(
          "begun_data",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_twos(e.value(), e.value()->begun_data());
          },
          "Client data of the pairs in `begun`: (m, 2) uint64; (0, 2) unless they were asked for.")
      .def_property_readonly(
          "ended_data",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_twos(e.value(), e.value()->ended_data());
          },
          "Client data of the pairs in `ended`, of removed objects as of others: (m, 2) uint64; "
          "(0, 2) unless they were asked for.")
      .def_property_readonly(
          "persisting",
          [](const Events& e) {
            const auto held = e.hold();
            return e.value()->persisting();
          },
          "How many pairs are in both frames.")
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
           "All pairs of objects whose volumes overlap: (m, 2) uint32 of ids, first < second. An "
           "array that shows what winnow wrote, to be read; it never changes. Drop it before the "
           "next call, and that updates it in place where little moved; else pairs go to another "
           "buffer. `order`: 'fast' or 'canonical' (sorted). With `events`, what changed since the "
           "last call is written there. `predicate(first, second)`, which goes without events "
           "(unsupported), has the last word on each pair of ids. It is called from any thread "
           "that works, one at a time, for each needs the GIL: filters, or a look at the array of "
           "pairs, take a hundredth of that. It asks winnow nothing (unsupported); what it raises "
           "the call raises.")
      .def("pair_changes", &pair_changes, arg("events"), py::kw_only(),
           arg("predicate") = py::none(),
           "What changed of all pairs since the last call with these events, alone: costs what "
           "moved, or with a `predicate`, as in `self_pairs`, all pairs. Where that raises, the "
           "events forget everything.")
      .def("pairs_with", &pairs_with, arg("other"), py::kw_only(), arg("order") = "fast",
           arg("predicate") = py::none(),
           "All pairs (object of this, object of `other`) whose boxes overlap: (m, 2) uint32 of "
           "ids. `predicate` as in `self_pairs`.");
}

}  // namespace winnow::python
