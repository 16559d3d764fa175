// Untrusted checkpoints of clusters and untrusted saved height fields are restored and loaded, or
// refused. Their digests are made to fit, so that the code behind the digest check is reached.

#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/surfaces.h>
#include <winnow/winnow.h>

#include <array>
#include <cstring>
#include <vector>

#include "tests/fuzz/target.h"
#include "tests/pipeline/cluster_scene_world.h"
#include "tests/recording/mutations.h"

namespace winnow::test {
namespace {

using Saved = std::vector<std::byte>;

constexpr std::size_t kMaxMemory = std::size_t{64} << 20U;

/// Writes the correct size and digest into a checkpoint.
void seal_checkpoint(Saved& bytes) {
  if (bytes.size() < 24) return;
  const std::uint64_t size = bytes.size() - 16;
  std::memcpy(bytes.data() + 8, &size, sizeof size);
  Digest digest;
  digest.add(std::span<const std::byte>(bytes).subspan(16, bytes.size() - 24));
  const std::uint64_t value = digest.value();
  std::memcpy(bytes.data() + bytes.size() - 8, &value, sizeof value);
}

const WorldShapes& shapes() {
  static const WorldShapes all;
  return all;
}

/// Restores twice: the bytes as they are, whose digest seldom fits, and sealed.
void restore(Saved bytes) {
  for (const bool sealed : {false, true}) {
    if (sealed) seal_checkpoint(bytes);
    LoopbackTransport transport(1);
    ClusterScene cluster(transport, shapes().shapes,
                         {.scene = {.composites = &shapes().composites}});
    const std::span<const std::byte> given[] = {bytes};
    std::array<Status, 1> answers{Status::unsupported};
    WINNOW_REQUIRE(cluster.restore(given, answers) == Status::ok);
    if (answers[0] != Status::ok) {
      WINNOW_REQUIRE(cluster.size(0) == 0);
      continue;
    }
    const Status status = cluster.collide(ContactLevel::distance);
    WINNOW_REQUIRE(status == Status::ok || status == Status::invalid_key);
    Saved again;
    WINNOW_REQUIRE(cluster.save(0, again) == Status::ok);
  }
}

void load_field(Saved bytes) {
  seal_snapshot(bytes);
  LimitedMemory memory(kMaxMemory);
  HeightField field(&memory);
  if (field.load(bytes) != Status::ok) return;
  Column<std::byte> again(&memory);
  WINNOW_REQUIRE(field.save(again) == Status::ok && again.size() == bytes.size() &&
                 std::memcmp(again.data(), bytes.data(), bytes.size()) == 0);
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  const std::span<const std::byte> bytes = std::as_bytes(input);
  restore({bytes.begin(), bytes.end()});
  load_field({bytes.begin(), bytes.end()});
}

std::vector<std::string> fuzz_seeds() {
  std::vector<Saved> whole;
  Random random(8);
  ClusterSceneWorld world(shapes(), 1);
  world.add(12, 3.0, random);
  world.check(ContactLevel::distance);
  whole.push_back(world.saved()[0]);
  HeightField field;
  const std::vector<float> heights{0, 1, 0.5F, 0.2F, 0.1F, 0.3F};
  WINNOW_REQUIRE(field.build({.heights = heights, .columns = 3, .rows = 2}) == Status::ok);
  Column<std::byte> saved(std::pmr::get_default_resource());
  WINNOW_REQUIRE(field.save(saved) == Status::ok);
  whole.emplace_back(saved.begin(), saved.end());
  std::vector<std::string> seeds{""};
  for (std::size_t i = 0; i < scaled(300); ++i) {
    Saved bytes = whole[i % whole.size()];
    if (i >= whole.size()) mutate(bytes, random);
    seeds.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return seeds;
}

}  // namespace winnow::test
