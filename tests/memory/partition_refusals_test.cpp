// Refuses each memory request of each call of a partition in turn (refusals.h has the loop over
// requests).

#include <algorithm>
#include <deque>

#include "tests/memory/refusals.h"
#include "tests/support/answers.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

/// Two partitions, result buffers, and a digest of the results so far.
struct PartitionWorld {
  PartitionWorld(std::pmr::memory_resource* memory, StructureKind structure, Volume volume,
                 FatMargin fat_margin, Execution execution)
      : partition(
            structure,
            {.memory = memory, .execution = execution, .volume = volume, .fat_margin = fat_margin}),
        other(linear_bvh(), {.memory = memory, .execution = execution}),
        pairs(memory),
        cross(memory),
        events({memory, true}),
        events_only(memory),
        hits(memory),
        batch(memory),
        objects(memory) {}

  void describe(Digest& digest) const {
    describe(partition, digest);
    describe(other, digest);
    digest.insert(digest.end(), answers.begin(), answers.end());
  }
  static void describe(const Partition& p, Digest& digest) {
    digest.push_back(p.size());
    for (ObjectId id = 0; id < 400; ++id) {
      const Key key = p.key_of(id);
      digest.push_back(key.id);
      Aabb box;
      if (p.bounds(key).get(box) != Status::ok) continue;
      for (int k = 0; k < 3; ++k) {
        put(digest, static_cast<double>(box.min[k]));
        put(digest, static_cast<double>(box.max[k]));
      }
      ObjectFilter filter = expect_ok(p.filter(key));
      digest.insert(digest.end(), {p.client_data_of(id), filter.layers, filter.mask});
    }
  }

  /// Adds the pairs in sorted order, which earlier refusals do not affect.
  void answer(const PairBuffer& found) {
    std::vector<Pair> sorted(found.begin(), found.end());
    std::sort(sorted.begin(), sorted.end());
    for (const Pair& pair : sorted)
      answers.push_back(std::uint64_t{pair.first} << 32U | pair.second);
  }
  void answer(std::span<const Hit> found) {
    for (const Hit& hit : found) {
      answers.push_back(hit.key.id);
      put(answers, static_cast<double>(hit.t));
    }
  }

  Partition partition;
  Partition other;
  PairBuffer pairs;
  PairBuffer cross;
  PairEvents events;
  PairEvents events_only;
  HitBuffer hits;
  HitBuffer batch;
  OverlapBuffer objects;
  std::vector<Key> keys;
  Digest answers;
};

/// Arguments of the calls, equal for all worlds.
struct Script {
  Script() {
    Random random(61);
    rays = plain_rays(boxes, 40, random);
  }
  std::vector<Aabb> boxes = mixed_boxes(150, 3);
  std::vector<Aabb> later = mixed_boxes(150, 4);
  std::vector<Ray> rays;
};

const Script& script() {
  static const Script one;
  return one;
}

Status insert(PartitionWorld& w, Partition& partition, std::span<const Aabb> boxes) {
  std::vector<ClientData> data(boxes.size());
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = 7 * i;
  std::vector<Key> keys(boxes.size());
  const Status status = partition.insert(boxes, data, keys);
  if (status != Status::ok) {
    EXPECT_EQ(keys, std::vector<Key>(keys.size()));
    return status;
  }
  for (const Key& key : keys) w.answers.push_back(key.id);
  if (&partition == &w.partition) w.keys.insert(w.keys.end(), keys.begin(), keys.end());
  return status;
}

Status self_pairs(PartitionWorld& w, Order order) {
  const Status status = w.partition.self_pairs(w.pairs, w.events, {.order = order});
  if (status == Status::ok) w.answer(w.pairs);
  const auto data_of = [&](ObjectId id) { return w.partition.client_data_of(id); };
  EXPECT_TRUE(std::ranges::equal(
      w.events.begun(), w.events.begun_data(),
      [&](const KeyPair& pair, const ClientDataPair& data) {
        return data == ClientDataPair{data_of(pair.first.id), data_of(pair.second.id)};
      }));
  EXPECT_EQ(w.events.ended().size(), w.events.ended_data().size());
  return status;
}

Status only_changes(PartitionWorld& w) {
  return w.partition.self_pairs(w.events_only);
}

using Calls = std::vector<Call<PartitionWorld>>;

/// Adds calls that insert, move, filter, remove and insert again.
void add_changes(Calls& calls) {
  calls.push_back({"insert", [](auto& w) {
                     return insert(w, w.partition, std::span(script().boxes).first(100));
                   }});
  calls.push_back({"pairs", [](auto& w) { return self_pairs(w, Order::fast); }});
  calls.push_back({"only changes", only_changes});
  calls.push_back({"update some", [](auto& w) {
                     const std::vector<std::uint32_t> listed{1, 5, 9, 60};
                     return w.partition.update(w.keys, std::span(script().later).first(100),
                                               IndexSubset::listed(listed));
                   }});
  calls.push_back({"pairs after moves", [](auto& w) { return self_pairs(w, Order::fast); }});
  calls.push_back({"only changes after moves", only_changes});
  calls.push_back({"filter", [](auto& w) {
                     const ObjectFilter filters[] = {{2, 2, 0}, {1, 3, 1}};
                     return w.partition.set_filter(std::span(w.keys).first(2), filters);
                   }});
  calls.push_back({"remove", [](auto& w) {
                     const std::vector<Key> gone(w.keys.begin() + 20, w.keys.begin() + 40);
                     const Status status = w.partition.remove(gone);
                     if (status == Status::ok)
                       w.keys.erase(w.keys.begin() + 20, w.keys.begin() + 40);
                     return status;
                   }});
  calls.push_back({"insert again", [](auto& w) {
                     return insert(w, w.partition, std::span(script().boxes).last(50));
                   }});
  calls.push_back({"insert one", [](auto& w) {
                     Key key;
                     const Status status = w.partition.insert(script().later[7], 9).get(key);
                     if (status == Status::ok) w.keys.push_back(key);
                     return status;
                   }});
  calls.push_back({"update all", [](auto& w) {
                     return w.partition.update(w.keys,
                                               std::span(script().later).first(w.keys.size()));
                   }});
  calls.push_back({"canonical pairs", [](auto& w) { return self_pairs(w, Order::canonical); }});
}

/// Adds the queries. The first of each kind allocates its buffer.
void add_queries(Calls& calls) {
  calls.push_back({"insert into the other partition", [](auto& w) {
                     return insert(w, w.other, std::span(script().later).first(60));
                   }});
  calls.push_back({"pairs with the other partition", [](auto& w) {
                     const Status status = w.partition.pairs_with(w.other, w.cross);
                     if (status == Status::ok) w.answer(w.cross);
                     return status;
                   }});
  calls.push_back({"refresh", [](auto& w) { return w.partition.refresh(); }});
  calls.push_back({"all hits of a ray", [](auto& w) {
                     const Status status = w.partition.all(script().rays[0], w.hits);
                     if (status == Status::ok) w.answer(w.hits.hits());
                     return status;
                   }});
  calls.push_back({"all hits of many rays", [](auto& w) {
                     const Status status = w.partition.all(RayBatch(script().rays), w.batch);
                     if (status == Status::ok) w.answer(w.batch.hits());
                     return status;
                   }});
  calls.push_back({"closest hits", [](auto& w) {
                     std::vector<Key> keys(script().rays.size());
                     const Status status = w.partition.closest(RayBatch(script().rays),
                                                               {keys.data(), nullptr, nullptr});
                     if (status != Status::ok) return status;
                     for (const Key& key : keys) w.answers.push_back(key.id);
                     Hit hit;
                     return w.partition.any(script().rays[1]).get(hit);
                   }});
  calls.push_back({"overlap with a sphere", [](auto& w) {
                     const Sphere sphere{script().boxes[3].min, 20.0F};
                     const Status status =
                         w.partition.overlap(sphere, w.objects, {}, Order::canonical);
                     if (status != Status::ok) return status;
                     for (const ObjectId id : w.objects.ids()) w.answers.push_back(id);
                     return status;
                   }});
  calls.push_back({"overlap with boxes", [](auto& w) {
                     const Status status = w.partition.overlap(BoxView(script().boxes), w.cross);
                     if (status == Status::ok) w.answer(w.cross);
                     return status;
                   }});
  calls.push_back({"nearest", [](auto& w) {
                     const Status status = w.partition.nearest(script().boxes[8], 30, 1e9F, w.hits);
                     if (status == Status::ok) w.answer(w.hits.hits());
                     return status;
                   }});
}

/// Adds calls that change the structure, reserve and release memory.
void add_upkeep(Calls& calls) {
  calls.push_back({"other structure", [](auto& w) {
                     return w.partition.set_structure(
                         w.partition.structure() == flat_grid() ? linear_bvh() : flat_grid());
                   }});
  calls.push_back(
      {"refresh of the other structure", [](auto& w) { return w.partition.refresh(); }});
  calls.push_back(
      {"pairs of the other structure", [](auto& w) { return self_pairs(w, Order::canonical); }});
  calls.push_back({"reserve", [](auto& w) { return w.partition.reserve(600, Pages::prefaulted); }});
  calls.push_back(
      {"reserve of pairs", [](auto& w) { return w.partition.reserve_pairs(w.pairs, 20'000); }});
  calls.push_back({"clear", [](auto& w) {
                     w.partition.clear();
                     w.partition.release_memory();
                     w.keys.clear();
                     return Status::ok;
                   }});
  calls.push_back(
      {"insert after clear", [](auto& w) { return insert(w, w.partition, script().later); }});
  calls.push_back({"pairs at the end", [](auto& w) { return self_pairs(w, Order::fast); }});
}

class PartitionRefusals : public Conformance {
 protected:
  std::size_t check(Volume volume, FatMargin fat_margin) const {
    Calls calls;
    add_changes(calls);
    add_queries(calls);
    add_upkeep(calls);
    return RefusedPlay<PartitionWorld, StructureKind, Volume, FatMargin, Execution>(
               calls, config().threads, structure_named(config().partition), volume, fat_margin,
               config().execution())
        .check();
  }
};

TEST_P(PartitionRefusals, refused_memory_changes_nothing) {
  EXPECT_GT(check(Volume::aabb, {}), 100U);
}

TEST_P(PartitionRefusals, refused_memory_with_margins_changes_nothing) {
  // Margins double the number of columns. Test the volume with the fewest and the one with the
  // most.
  for (const Volume volume : {Volume::sphere, Volume::kdop26}) check(volume, {0.1F, 0.05F});
}

std::vector<Config> refusal_configs() {
  std::vector<Config> configs;
  for (const std::string_view name : structure_names()) {
    for (const int threads : {1, 2})
      configs.push_back({std::string(name), available_isas().back(), threads});
  }
  return configs;
}

INSTANTIATE_TEST_SUITE_P(All, PartitionRefusals, testing::ValuesIn(refusal_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
