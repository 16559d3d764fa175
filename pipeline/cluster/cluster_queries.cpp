// Queries of a ClusterScene, in two exchanges: each rank sends its queries to the ranks that may
// have results, and receives their results. Each kind of query (RayAll, ProbeOverlap, ...) defines
// these ranks, the query of one scene, and the order in which results are merged.

#include <winnow/pipeline/cluster_scene.h>

#include <winnow/pipeline/scene_queries.h>
#include "core/threads/float_environment.h"
#include "pipeline/cluster/cluster_scene_state.h"
#include "pipeline/cluster/send_queue.h"
#include "pipeline/composites/parts.h"
#include "pipeline/rays/shape_entries.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <deque>
#include <new>
#include <tuple>
#include <utility>
#include <vector>

namespace winnow {

/// The results that one hosted rank received.
template <typename Answer>
struct AnswerLists {
  std::vector<Answer> answers;
  std::vector<std::size_t> first;

  [[nodiscard]] ClusterResults<Answer> view() const noexcept { return {answers, first}; }
};

template <typename Answer>
using AnswersOfRanks = std::vector<AnswerLists<Answer>>;

namespace {

/// A result of one rank, with the index of its query.
template <typename Answer>
struct NumberedAnswer {
  std::uint32_t number;
  Answer answer;
};

/// The scene of a rank, with an object for queries.
struct RankQueries {
  const RankScene& rank;
  SceneQueries queries;
};

[[nodiscard]] ClusterHit hit_of(const SceneHit& hit) noexcept {
  ClusterHit named{.name = hit.data, .t = hit.t, .part = hit.part};
  named.normal = hit.normal;
  named.point = hit.point;
  return named;
}

struct RayAll {
  static constexpr CollectiveCall kCall = CollectiveCall::all;
  using Query = ShapeRay;
  using Answer = ClusterHit;

  static Status check(const RankScene&, const ShapeRay& ray) noexcept {
    return is_valid(ray) ? Status::ok : Status::invalid_argument;
  }
  static void find_ranks(const RankGroup& group, const RankScene&, const ShapeRay& ray,
                         std::vector<std::uint32_t>& ranks) {
    group.regions.ranks_of(ray, ranks);
  }
  template <typename Give>
  static Status answer(RankQueries& scene, std::span<const ShapeRay> rays,
                       const SceneFilter& filter, Give&& give) {
    const auto lists = scene.queries.all(ShapeRayBatch(rays), filter);
    if (lists.status != Status::ok) return lists.status;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      for (std::size_t h = lists.first[i]; h < lists.first[i + 1]; ++h) {
        give(i, hit_of(lists.hits[h]));
      }
    }
    return Status::ok;
  }
  static auto order(const ClusterHit& hit) noexcept { return std::tuple(hit.t, hit.name); }
  static std::size_t most(const ShapeRay&) noexcept { return ~std::size_t{0}; }
};

/// Columns for the results of a batch of `closest`.
struct HitColumnsOfRays {
  explicit HitColumnsOfRays(std::size_t rays) : name(rays), part(rays) {
    for (std::vector<double>& column : number) column.resize(rays);
  }
  [[nodiscard]] SceneHitColumns columns() noexcept {
    const auto column = [this](std::size_t i) { return number[i].data(); };
    return {.data = name.data(),
            .part = part.data(),
            .t = column(0),
            .normal = {column(1), column(2), column(3)},
            .point = {column(4), column(5), column(6)}};
  }
  [[nodiscard]] bool is_hit(std::size_t ray) const noexcept {
    return number[0][ray] != std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] ClusterHit operator[](std::size_t i) const noexcept {
    ClusterHit hit{.name = name[i], .t = number[0][i], .part = part[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hit.normal[axis] = number[1 + axis][i];
      hit.point[axis] = number[4 + axis][i];
    }
    return hit;
  }

  std::vector<ClientData> name;
  std::vector<std::uint32_t> part;
  std::vector<double> number[7];
};

/// A scene breaks ties by id, a cluster by name. So each ray that hits is cast again, with a
/// maximal t of 1 + 1e-6 times that of its hit. If this ray hits several bodies, all hits of the
/// whole ray are sent.
struct RayClosest : RayAll {
  static constexpr CollectiveCall kCall = CollectiveCall::closest;
  template <typename Give>
  static Status answer(RankQueries& scene, std::span<const ShapeRay> rays,
                       const SceneFilter& filter, Give&& give) {
    // Hits of the shorter rays are not sent: the last digits of a hit depend on the ray's maximal
    // t.
    constexpr double kBehind = 1.0 + 1e-6;
    HitColumnsOfRays table(rays.size());
    Status status = scene.queries.closest(ShapeRayBatch(rays), table.columns(), filter);
    if (status != Status::ok) return status;
    std::vector<ShapeRay> shorter;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!table.is_hit(i)) continue;
      shorter.push_back(rays[i]);
      shorter.back().max_t = std::min(rays[i].max_t, table[i].t * kBehind);
      of.push_back(i);
    }
    const auto lists = scene.queries.all(ShapeRayBatch(shorter), filter);
    if (lists.status != Status::ok) return lists.status;
    std::vector<ShapeRay> tied;
    std::vector<std::size_t> tied_of;
    for (std::size_t k = 0; k < of.size(); ++k) {
      if (lists.first[k + 1] - lists.first[k] <= 1) {
        give(of[k], table[of[k]]);
        continue;
      }
      tied.push_back(rays[of[k]]);
      tied_of.push_back(of[k]);
    }
    return RayAll::answer(scene, tied, filter,
                          [&](std::size_t k, const ClusterHit& hit) { give(tied_of[k], hit); });
  }
  static std::size_t most(const ShapeRay&) noexcept { return 1; }
};

/// The result is one empty hit for each ray that hits anything.
struct RayAny : RayAll {
  static constexpr CollectiveCall kCall = CollectiveCall::any;
  template <typename Give>
  static Status answer(RankQueries& scene, std::span<const ShapeRay> rays,
                       const SceneFilter& filter, Give&& give) {
    std::vector<double> ts(rays.size());
    const Status status =
        scene.queries.any(ShapeRayBatch(rays), SceneHitColumns{.t = ts.data()}, filter);
    for (std::size_t i = 0; status == Status::ok && i < rays.size(); ++i) {
      if (ts[i] != std::numeric_limits<double>::infinity()) give(i, ClusterHit{});
    }
    return status;
  }
  static std::size_t most(const ShapeRay&) noexcept { return 1; }
};

struct ProbeOverlap {
  static constexpr CollectiveCall kCall = CollectiveCall::overlap;
  using Query = ShapeProbe;
  using Answer = ClusterOverlap;

  static Status check(const RankScene& rank, const ShapeProbe& probe) noexcept {
    return rank.check_shape(probe.shape, probe.pose);
  }
  static void find_ranks(const RankGroup& group, const RankScene& rank, const ShapeProbe& probe,
                         std::vector<std::uint32_t>& ranks) {
    group.regions.ranks_of(rank.box_around(probe.shape, probe.pose), ranks);
  }
  template <typename Give>
  static Status answer(RankQueries& scene, std::span<const ShapeProbe> probes,
                       const SceneFilter& filter, Give&& give) {
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const auto bodies = scene.queries.overlap(probes[i].shape, probes[i].pose, filter);
      if (bodies.status != Status::ok) return bodies.status;
      for (const SceneOverlap& body : bodies) give(i, ClusterOverlap{body.data, body.part});
    }
    return Status::ok;
  }
  static auto order(const ClusterOverlap& body) noexcept { return body.name; }
  static std::size_t most(const ShapeProbe&) noexcept { return ~std::size_t{0}; }
};

struct PointNearest {
  static constexpr CollectiveCall kCall = CollectiveCall::nearest;
  using Query = NearestProbe;
  using Answer = ClusterDistance;

  static Status check(const RankScene&, const NearestProbe& probe) noexcept {
    return is_finite(probe.point) && probe.radius >= 0.0 ? Status::ok : Status::invalid_argument;
  }
  static void find_ranks(const RankGroup& group, const RankScene&, const NearestProbe&,
                         std::vector<std::uint32_t>& ranks) {
    ranks.resize(group.ranks);
    for (std::uint32_t rank = 0; rank < group.ranks; ++rank) ranks[rank] = rank;
  }
  template <typename Give>
  static Status answer(RankQueries& scene, std::span<const NearestProbe> probes,
                       const SceneFilter& filter, Give&& give) {
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const NearestProbe& probe = probes[i];
      auto bodies = scene.queries.nearest(probe.point, probe.count, probe.radius, filter);
      if (bodies.status == Status::ok && probe.count != 0 && bodies.size() == probe.count) {
        // Other bodies may be at the same distance as the last one, with smaller names.
        const double radius = std::max(bodies.back().distance, 0.0);
        bodies = scene.queries.nearest(probe.point, ~std::size_t{0}, radius, filter);
      }
      if (bodies.status != Status::ok) return bodies.status;
      for (const SceneDistance& body : bodies) {
        ClusterDistance named{.name = body.data,
                              .distance = body.distance,
                              .error_bound = body.error_bound,
                              .part = body.part};
        named.normal = body.normal;
        named.point = body.point_b;
        give(i, named);
      }
    }
    return Status::ok;
  }
  static auto order(const ClusterDistance& body) noexcept {
    return std::tuple(body.distance, body.name);
  }
  static std::size_t most(const NearestProbe& probe) noexcept { return probe.count; }
};

/// One collective query of one kind.
template <typename Kind>
class CollectiveQuery {
 public:
  using Query = typename Kind::Query;
  using Answer = typename Kind::Answer;
  using Numbered = NumberedAnswer<Answer>;

  CollectiveQuery(ClusterSceneState& cluster, std::span<const ClusterQueryBatch<Query>> batches)
      : cluster_(cluster), batches_(batches), sent_(batches.size()), answered_(batches.size()) {}

  /// Fills `lists`, and sets the status of each hosted rank.
  Status run(AnswersOfRanks<Answer>& lists, std::span<Status> answers) {
    const Status migrated = cluster_.migrate();
    if (migrated == Status::communication_failed) return migrated;
    for (std::size_t i = 0; i < batches_.size(); ++i) {
      answers[i] = check(i);
      if (answers[i] == Status::ok) send(i);
    }
    std::span<const RankMessage> received;
    Status status = cluster_.exchange(received);
    if (status != Status::ok) return status;
    std::uint64_t worst[] = {static_cast<std::uint64_t>(migrated)};
    for (std::size_t i = 0; i < batches_.size(); ++i) {
      const Status found = answer(i, received);
      worst[0] = std::max(worst[0], static_cast<std::uint64_t>(found));
    }
    status = cluster_.exchange(received);
    if (status != Status::ok) return status;
    lists.assign(batches_.size(), {});
    for (std::size_t i = 0; i < batches_.size(); ++i) gather(i, received, answers[i], lists[i]);
    status = cluster_.transport.reduce({}, worst);
    return status == Status::ok ? static_cast<Status>(worst[0]) : status;
  }

 private:
  struct AddressedQuery {
    std::uint32_t to;
    std::uint32_t number;
  };
  /// Data of the sent messages; must stay in place until all results have been received.
  struct Sent {
    std::vector<Query> queries;
    std::vector<std::uint32_t> numbers;
    ObjectFilter filter;
  };

  [[nodiscard]] std::uint32_t rank_of(std::size_t i) const noexcept {
    return cluster_.first + static_cast<std::uint32_t>(i);
  }

  [[nodiscard]] Status check(std::size_t i) const noexcept {
    const SceneFilter& filter = batches_[i].filter;
    if (filter.predicate.accept != nullptr || filter.layer != kEveryLayer ||
        filter.ignored != Key{}) {
      return Status::unsupported;
    }
    for (const Query& query : batches_[i].queries) {
      const Status good = Kind::check(cluster_.scenes[i], query);
      if (good != Status::ok) return good;
    }
    return Status::ok;
  }

  void send(std::size_t i) {
    std::vector<AddressedQuery> posted;
    std::vector<std::uint32_t> ranks;
    const auto queries = batches_[i].queries;
    for (std::uint32_t number = 0; number < queries.size(); ++number) {
      Kind::find_ranks(cluster_, cluster_.scenes[i], queries[number], ranks);
      for (const std::uint32_t to : ranks) posted.push_back({to, number});
    }
    std::ranges::stable_sort(posted, {}, &AddressedQuery::to);
    Sent& sent = sent_[i];
    sent.filter = batches_[i].filter.object();
    for (const AddressedQuery& one : posted) {
      sent.queries.push_back(queries[one.number]);
      sent.numbers.push_back(one.number);
    }
    const std::span<const AddressedQuery> all(posted);
    for_each_receiver(all, std::span<const AddressedQuery>(),
                      [&](std::uint32_t to, auto ones, auto) {
                        const auto at = static_cast<std::size_t>(ones.data() - all.data());
                        cluster_.messages.push_back(
                            {rank_of(i),
                             to,
                             {std::as_bytes(std::span(sent.queries).subspan(at, ones.size())),
                              std::as_bytes(std::span(sent.numbers).subspan(at, ones.size())),
                              std::as_bytes(std::span(&sent.filter, 1))}});
                      });
  }

  /// Runs the queries that were sent to a hosted rank.
  [[nodiscard]] Status answer(std::size_t i, std::span<const RankMessage> received) {
    RankQueries scene{cluster_.scenes[i], SceneQueries(cluster_.scenes[i].scene())};
    std::vector<Numbered>& out = answered_[i];
    std::vector<std::pair<std::uint32_t, std::size_t>> begins;
    Status status = Status::ok;
    for (const RankMessage& message : messages_for(received, rank_of(i))) {
      const auto numbers = column_of<std::uint32_t>(message, 1);
      const ObjectFilter by = column_of<ObjectFilter>(message, 2).front();
      begins.emplace_back(message.from, out.size());
      if (status != Status::ok) continue;
      status = Kind::answer(scene, column_of<Query>(message, 0),
                            {.layers = by.layers, .mask = by.mask, .environment = by.environment},
                            [&](std::size_t k, const Answer& given) {
                              out.push_back({numbers[k], given});
                            });
    }
    for (std::size_t k = 0; k < begins.size(); ++k) {
      const std::size_t end = k + 1 < begins.size() ? begins[k + 1].second : out.size();
      const auto part = std::span(out).subspan(begins[k].second, end - begins[k].second);
      if (part.empty()) continue;
      cluster_.messages.push_back({rank_of(i), begins[k].first, {std::as_bytes(part)}});
    }
    return status;
  }

  /// Sorts the results that a hosted rank received, and removes duplicates: each rank that has a
  /// body or a copy of it reports the body.
  void gather(std::size_t i, std::span<const RankMessage> received, Status answered,
              AnswerLists<Answer>& lists) const {
    std::vector<Numbered> all;
    for (const RankMessage& message : messages_for(received, rank_of(i))) {
      const auto part = column_of<Numbered>(message, 0);
      all.insert(all.end(), part.begin(), part.end());
    }
    const auto order = [](const Numbered& one) {
      return std::tuple(one.number, Kind::order(one.answer));
    };
    std::ranges::sort(all, {}, order);
    const auto same = [&](const Numbered& a, const Numbered& b) { return order(a) == order(b); };
    all.erase(std::unique(all.begin(), all.end(), same), all.end());
    const std::size_t count = answered == Status::ok ? batches_[i].queries.size() : 0;
    auto next = all.cbegin();
    lists.first.push_back(0);
    for (std::size_t number = 0; number < count; ++number) {
      const std::size_t most = Kind::most(batches_[i].queries[number]);
      for (std::size_t k = 0; next != all.cend() && next->number == number; ++next, ++k) {
        if (k < most) lists.answers.push_back(next->answer);
      }
      lists.first.push_back(lists.answers.size());
    }
  }

  ClusterSceneState& cluster_;
  std::span<const ClusterQueryBatch<Query>> batches_;
  std::vector<Sent> sent_;
  std::vector<std::vector<Numbered>> answered_;
};

}  // namespace

/// The results of the last queries.
struct ClusterQueryState {
  ClusterSceneState* cluster;
  AnswersOfRanks<ClusterHit> hits;
  std::vector<std::vector<std::uint8_t>> blocked;
  AnswersOfRanks<ClusterOverlap> overlaps;
  AnswersOfRanks<ClusterDistance> distances;

  template <typename Kind>
  Status run_query(std::span<const ClusterQueryBatch<typename Kind::Query>> batches,
                   std::span<Status> answers, AnswersOfRanks<typename Kind::Answer>& lists) {
    const std::size_t hosted = cluster == nullptr ? 0 : cluster->scenes.size();
    const bool fit = batches.size() == hosted && answers.size() == hosted;
    const Status status = collective(cluster, Kind::kCall, [&] {
      if (fit) return CollectiveQuery<Kind>(*cluster, batches).run(lists, answers);
      // The call is collective: other processes wait for this one, which has no queries.
      const std::vector<ClusterQueryBatch<typename Kind::Query>> nothing(hosted);
      std::vector<Status> ignored(hosted);
      return CollectiveQuery<Kind>(*cluster, nothing).run(lists, ignored);
    });
    return status == Status::ok && !fit ? Status::size_mismatch : status;
  }

  /// The results of a hosted rank; null for any other.
  template <typename Lists>
  [[nodiscard]] const auto* of(const Lists& lists, std::uint32_t rank) const noexcept {
    const std::uint32_t place = cluster == nullptr ? rank : rank - cluster->first;
    return place < lists.size() ? &lists[place] : nullptr;
  }
};

ClusterQueries::ClusterQueries(ClusterScene& cluster) noexcept
    : state_(new (std::nothrow) ClusterQueryState{cluster.state_, {}, {}, {}, {}}) {}

ClusterQueries::~ClusterQueries() {
  delete state_;
}

Status ClusterQueries::closest(std::span<const ClusterQueryBatch<ShapeRay>> rays,
                               std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  return state_->run_query<RayClosest>(rays, answers, state_->hits);
}

Status ClusterQueries::all(std::span<const ClusterQueryBatch<ShapeRay>> rays,
                           std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  return state_->run_query<RayAll>(rays, answers, state_->hits);
}

Status ClusterQueries::any(std::span<const ClusterQueryBatch<ShapeRay>> rays,
                           std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  AnswersOfRanks<ClusterHit> found;
  const Status status = state_->run_query<RayAny>(rays, answers, found);
  if (status != Status::ok) return status;
  state_->blocked.assign(found.size(), {});
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::vector<std::size_t>& first = found[i].first;
    for (std::size_t k = 0; k + 1 < first.size(); ++k) {
      state_->blocked[i].push_back(first[k + 1] != first[k] ? 1 : 0);
    }
  }
  return Status::ok;
}

Status ClusterQueries::overlap(std::span<const ClusterQueryBatch<ShapeProbe>> shapes,
                               std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  return state_->run_query<ProbeOverlap>(shapes, answers, state_->overlaps);
}

Status ClusterQueries::nearest(std::span<const ClusterQueryBatch<NearestProbe>> points,
                               std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  return state_->run_query<PointNearest>(points, answers, state_->distances);
}

ClusterResults<ClusterHit> ClusterQueries::hits(std::uint32_t rank) const noexcept {
  const auto* const lists = state_ == nullptr ? nullptr : state_->of(state_->hits, rank);
  return lists == nullptr ? ClusterResults<ClusterHit>{} : lists->view();
}

std::span<const std::uint8_t> ClusterQueries::blocked(std::uint32_t rank) const noexcept {
  const auto* const rays = state_ == nullptr ? nullptr : state_->of(state_->blocked, rank);
  return rays == nullptr ? std::span<const std::uint8_t>{} : std::span(*rays);
}

ClusterResults<ClusterOverlap> ClusterQueries::overlaps(std::uint32_t rank) const noexcept {
  const auto* const lists = state_ == nullptr ? nullptr : state_->of(state_->overlaps, rank);
  return lists == nullptr ? ClusterResults<ClusterOverlap>{} : lists->view();
}

ClusterResults<ClusterDistance> ClusterQueries::neighbours(std::uint32_t rank) const noexcept {
  const auto* const lists = state_ == nullptr ? nullptr : state_->of(state_->distances, rank);
  return lists == nullptr ? ClusterResults<ClusterDistance>{} : lists->view();
}

}  // namespace winnow
