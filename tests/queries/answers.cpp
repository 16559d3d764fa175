// Checks of query results against the candidates of the reference implementation; the tests of
// queries and the fuzz targets call them.

#include "tests/queries/answers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

namespace winnow::test {
namespace {

using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

bool comes_before(const Hit& a, const Hit& b) {
  return a.t != b.t ? a.t < b.t : a.key.id < b.key.id;
}

AssertionResult well_formed(std::span<const Hit> got, const Partition& partition) {
  for (std::size_t i = 0; i < got.size(); ++i) {
    const Hit& hit = got[i];
    if (!hit || partition.key_of(hit.key.id) != hit.key ||
        partition.client_data_of(hit.key.id) != hit.data) {
      return AssertionFailure() << "hit " << i << " has not the key and data of its object "
                                << hit.key.id;
    }
    if (i != 0 && !comes_before(got[i - 1], hit)) {
      return AssertionFailure() << "hit " << i << " (object " << hit.key.id << ", t " << hit.t
                                << ") comes after object " << got[i - 1].key.id << ", t "
                                << got[i - 1].t;
    }
  }
  return AssertionSuccess();
}

template <typename Truth, typename Question>
std::vector<Candidate<Truth>> all_candidates(const Question& question,
                                             std::span<const Object> objects) {
  std::vector<Candidate<Truth>> result;
  for (const Object& object : objects) {
    const Truth truth = truth_of(question, object.box);
    if (truth.may) result.push_back({object.id, truth});
  }
  return result;
}

// Returns the candidate with this id, or null.
template <typename Truth>
const Candidate<Truth>* find(const std::vector<Candidate<Truth>>& candidates, ObjectId id) {
  const auto at = std::lower_bound(candidates.begin(), candidates.end(), id,
                                   [](const auto& c, ObjectId target) { return c.id < target; });
  return at != candidates.end() && at->id == id ? &*at : nullptr;
}

template <typename Truth>
AssertionResult none_missing(std::vector<ObjectId> ids,
                             const std::vector<Candidate<Truth>>& candidates) {
  std::sort(ids.begin(), ids.end());
  if (const auto twice = std::adjacent_find(ids.begin(), ids.end()); twice != ids.end()) {
    return AssertionFailure() << "object " << *twice << " is reported twice";
  }
  for (const auto& candidate : candidates) {
    if (candidate.truth.must && !std::binary_search(ids.begin(), ids.end(), candidate.id)) {
      return AssertionFailure() << "object " << candidate.id << " is missing";
    }
  }
  return AssertionSuccess();
}

}  // namespace

CastCandidates candidates(const Cast& cast, std::span<const Object> objects) {
  return all_candidates<CastTruth>(cast, objects);
}

RegionCandidates candidates(const Region& region, std::span<const Object> objects) {
  return all_candidates<RegionTruth>(region, objects);
}

AssertionResult right_hits(std::span<const Hit> got, const CastCandidates& candidates,
                           const Partition& partition) {
  if (AssertionResult formed = well_formed(got, partition); !formed) return formed;
  std::vector<ObjectId> ids;
  for (const Hit& hit : got) {
    ids.push_back(hit.key.id);
    const auto* candidate = find(candidates, hit.key.id);
    if (candidate == nullptr) {
      return AssertionFailure() << "object " << hit.key.id << " is not hit, t " << hit.t;
    }
    if (!is_first_touch(hit.t, candidate->truth)) {
      return AssertionFailure() << "object " << hit.key.id << " is first touched in ["
                                << candidate->truth.earliest << ", " << candidate->truth.latest
                                << "], not at " << hit.t;
    }
  }
  return none_missing(std::move(ids), candidates);
}

AssertionResult same_hits(std::span<const Hit> a, std::span<const Hit> b) {
  const auto same = [](const Hit& x, const Hit& y) {
    return x.key == y.key && x.data == y.data &&
           std::bit_cast<std::uint32_t>(x.t) == std::bit_cast<std::uint32_t>(y.t);
  };
  if (std::equal(a.begin(), a.end(), b.begin(), b.end(), same)) return AssertionSuccess();
  return AssertionFailure() << "other hits";
}

AssertionResult is_any_of(const Hit& hit, std::span<const Hit> all) {
  if (all.empty()) {
    return hit == Hit{} ? AssertionSuccess() : AssertionFailure() << "a hit although there is none";
  }
  for (const Hit& one : all) {
    if (same_hits({&hit, 1}, {&one, 1})) return AssertionSuccess();
  }
  return AssertionFailure() << "object " << hit.key.id << ", t " << hit.t << " is no hit";
}

AssertionResult is_first_of(const Hit& hit, std::span<const Hit> all) {
  return is_any_of(hit, all.first(std::min<std::size_t>(all.size(), 1)));
}

AssertionResult right_objects(const OverlapBuffer& got, const RegionCandidates& candidates,
                              Order order) {
  for (const ObjectId id : got.ids()) {
    if (find(candidates, id) == nullptr) {
      return AssertionFailure() << "object " << id << " does not overlap the region";
    }
  }
  std::vector<ObjectId> inside(got.inside().begin(), got.inside().end());
  std::vector<ObjectId> crossing(got.crossing().begin(), got.crossing().end());
  if (inside.size() + crossing.size() != got.size()) return AssertionFailure() << "sizes differ";
  if (order == Order::canonical && !(std::is_sorted(inside.begin(), inside.end()) &&
                                     std::is_sorted(crossing.begin(), crossing.end()))) {
    return AssertionFailure() << "canonical order is not sorted";
  }
  for (const ObjectId id : inside) {
    if (!find(candidates, id)->truth.may_inside) {
      return AssertionFailure() << "object " << id << " is not inside";
    }
  }
  for (const ObjectId id : crossing) {
    if (find(candidates, id)->truth.must_inside) {
      return AssertionFailure() << "object " << id << " is inside but reported as crossing";
    }
  }
  return none_missing({got.ids().begin(), got.ids().end()}, candidates);
}

AssertionResult right_nearest(std::span<const Hit> got, const Aabb& from, std::size_t count,
                              float radius, std::span<const Object> objects,
                              const Partition& partition) {
  if (AssertionResult formed = well_formed(got, partition); !formed) return formed;
  if (got.size() > count) return AssertionFailure() << "more than requested";
  std::vector<ObjectId> ids;
  for (const Hit& hit : got) ids.push_back(hit.key.id);
  if (AssertionResult once = none_missing(ids, RegionCandidates{}); !once) return once;
  std::sort(ids.begin(), ids.end());
  for (const Object& object : objects) {
    const double exact = distance(finite(from), finite(object.box));
    const CastTruth truth{true, true, exact * (1.0 - 1e-14), exact * (1.0 + 1e-14)};
    if (!std::binary_search(ids.begin(), ids.end(), object.id)) {
      if (truth.latest < static_cast<double>(radius) || exact == 0.0) {
        // An object may be left out only if `count` nearer ones are returned.
        if (got.size() < count)
          return AssertionFailure() << "object " << object.id << " is missing";
        if (got.empty()) continue;
        const Hit& last = got[got.size() - 1];
        if (truth.latest < static_cast<double>(last.t) ||
            (exact == 0.0 && last.t == 0.0F && object.id < last.key.id)) {
          return AssertionFailure() << "object " << object.id << " at " << exact
                                    << " is nearer than object " << last.key.id << " at " << last.t;
        }
      }
      continue;
    }
    const auto hit =
        std::find_if(got.begin(), got.end(), [&](const Hit& h) { return h.key.id == object.id; });
    if (!is_first_touch(hit->t, truth)) {
      return AssertionFailure() << "object " << object.id << " is at " << exact << ", not at "
                                << hit->t;
    }
    if (truth.earliest > static_cast<double>(radius)) {
      return AssertionFailure() << "object " << object.id << " is beyond the radius";
    }
  }
  return AssertionSuccess();
}

}  // namespace winnow::test
