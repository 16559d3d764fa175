// ClusterScene: collective calls, each a sequence of steps on the hosted ranks (rank_scene.h) and
// exchanges between ranks (rank_group.h). Queries are in cluster_queries.cpp.

#include <winnow/pipeline/cluster_scene.h>

#include "core/memory/byte_stream.h"
#include "core/memory/catch_bad_alloc.h"
#include "core/threads/float_environment.h"
#include "pipeline/cluster/cluster_scene_state.h"

namespace winnow {

ClusterSceneState::ClusterSceneState(Transport& given, const ShapePool& shapes,
                                     const ClusterSceneOptions& options)
    : RankGroup(given, options.imbalance, options.scene.memory) {
  for (std::uint32_t i = 0; i < given.hosted(); ++i) {
    scenes.emplace_back(first + i, ranks, shapes, options.scene);
  }
  const SceneOptions& scene = options.scene;
  if (scene.cache_tolerance != 0.0 || scene.warm_start || scene.suppress_ghost_contacts ||
      scene.recorder != nullptr || !scenes.front().is_good()) {
    status = Status::invalid_argument;
  }
}

Status ClusterSceneState::migrate() {
  // Report errors only after the exchange, because other processes wait for this one.
  Status found = Status::ok;
  for (RankScene& one : scenes) {
    if (found == Status::ok) found = one.refresh();
  }
  const Regions before = regions;
  was_cut = needs_cut && !is_single_rank();
  if (was_cut) {
    std::vector<CutWork> work;
    for (RankScene& one : scenes) work.push_back(one.cut_work());
    const Status answer = cut_space(work);
    if (answer != Status::ok) return answer;
  }
  needs_cut = false;
  for (RankScene& one : scenes) {
    one.send(before, regions, was_cut);
    one.pack(messages);
  }
  const Status answer = deliver();
  return answer == Status::communication_failed || found == Status::ok ? answer : found;
}

/// Exchanges the packed messages, and applies the received ones.
Status ClusterSceneState::deliver() {
  std::span<const RankMessage> received;
  Status answer = is_single_rank() ? Status::ok : exchange(received);
  for (std::uint32_t i = 0; i < scenes.size() && answer == Status::ok; ++i) {
    answer = scenes[i].receive(messages_for(received, first + i));
  }
  return answer;
}

/// Removes bodies on every rank before their names can be added again.
Status ClusterSceneState::deliver_removals() {
  for (RankScene& one : scenes) {
    one.send_removals(regions);
    one.pack(messages);
  }
  return deliver();
}

/// A batch that was refused requests no names.
Status ClusterSceneState::take_names_of(std::span<const std::span<const BodyName>> requested,
                                        std::span<Status> answers) {
  std::vector<std::vector<BodyName>> removed;
  std::vector<std::span<const BodyName>> freed;
  std::vector<std::span<const BodyName>> accepted_names;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    freed.emplace_back(removed.emplace_back(scenes[i].take_removed()));
    accepted_names.push_back(answers[i] == Status::ok ? requested[i] : std::span<const BodyName>{});
  }
  return is_single_rank() ? Status::ok : take_names(freed, accepted_names, answers);
}

Status ClusterSceneState::add(std::span<const ClusterSceneBatch> batches,
                              std::span<Status> answers) {
  Status answer = deliver_removals();
  if (answer != Status::ok) return answer;
  std::vector<std::span<const BodyName>> requested;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    answers[i] = scenes[i].check(batches[i]);
    requested.push_back(batches[i].names);
  }
  answer = take_names_of(requested, answers);
  for (std::size_t i = 0; i < scenes.size() && answer == Status::ok; ++i) {
    if (answers[i] == Status::ok) {
      answer = scenes[i].insert(batches[i].names, records_of(batches[i].bodies));
    }
  }
  return answer;
}

Status ClusterSceneState::restore(std::span<const RecordBatch> batches, std::span<Status> answers) {
  Status answer = deliver_removals();
  if (answer != Status::ok) return answer;
  std::vector<std::span<const BodyName>> requested;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (answers[i] == Status::ok) {
      const auto bodies = definitions_of(batches[i].names, batches[i].bodies);
      answers[i] = scenes[i].check({batches[i].names, bodies});
    }
    requested.push_back(batches[i].names);
  }
  answer = take_names_of(requested, answers);
  for (std::size_t i = 0; i < scenes.size() && answer == Status::ok; ++i) {
    if (answers[i] != Status::ok) continue;
    answer = scenes[i].insert(batches[i].names, batches[i].bodies);
    scenes[i].events().add_touching(batches[i].touching);
  }
  return answer;
}

/// Checks that all processes passed the same arguments (compares their digest) and that none
/// refuses.
Status ClusterSceneState::agree(std::uint64_t argument_digest, Status& refused) {
  std::uint64_t greatest[3] = {static_cast<std::uint64_t>(refused), argument_digest,
                               ~argument_digest};
  const Status answer = transport.reduce({}, greatest);
  if (answer != Status::ok) return answer;
  refused = static_cast<Status>(greatest[0]);
  if (greatest[1] != ~greatest[2]) refused = Status::invalid_argument;
  return Status::ok;
}

Status ClusterSceneState::replicate(const ClusterSceneBatch& batch, Status& refused) {
  Status answer = deliver_removals();
  if (answer != Status::ok) return answer;
  refused = Status::ok;
  for (RankScene& one : scenes) {
    if (refused == Status::ok) refused = one.check(batch);
  }
  for (const BodyDefinition& body : batch.bodies) {
    if (refused == Status::ok && body.state != BodyState::fixed) refused = Status::unsupported;
  }
  answer = agree(digest_of_batch(batch), refused);
  if (answer != Status::ok || refused != Status::ok) return answer;
  // Rank 0 requests the names for all ranks.
  std::vector<Status> answers(scenes.size(), Status::ok);
  std::vector<std::span<const BodyName>> requested(scenes.size());
  if (first == 0) requested.front() = batch.names;
  answer = take_names_of(requested, answers);
  if (answer != Status::ok) return answer;
  refused = answers.front();
  answer = agree(0, refused);
  for (RankScene& one : scenes) {
    if (answer == Status::ok && refused == Status::ok) answer = one.replicate(batch);
  }
  return answer;
}

Status ClusterSceneState::move_replicated(std::span<const BodyName> bodies,
                                          std::span<const Pose> poses, Status& refused) {
  refused = Status::ok;
  for (RankScene& one : scenes) {
    if (refused == Status::ok) refused = one.check_replicated(bodies, poses);
  }
  Digest argument_digest;
  argument_digest.add_array(bodies);
  argument_digest.add_array(poses);
  Status answer = agree(argument_digest.value(), refused);
  for (RankScene& one : scenes) {
    if (answer == Status::ok && refused == Status::ok) answer = one.move_replicated(poses);
  }
  return answer;
}

Status ClusterSceneState::collide(ContactLevel level) {
  Status found = migrate();
  if (found == Status::communication_failed) return found;
  for (RankScene& one : scenes) {
    if (found == Status::ok) found = one.collide(level);
  }
  const Status agreed = agree_on_events();
  if (agreed != Status::ok) return agreed;
  return count_found(found);
}

/// Exchanges messages even after an error on this process, because other processes wait for this
/// one. They get the error later, from count_found.
Status ClusterSceneState::agree_on_events() {
  std::span<const RankMessage> received;
  if (!is_single_rank()) {
    for (RankScene& one : scenes) one.events().request(messages);
    Status answer = exchange(received);
    if (answer != Status::ok) return answer;
    for (std::uint32_t i = 0; i < scenes.size(); ++i) {
      scenes[i].events().answer(messages_for(received, first + i), messages);
    }
    answer = exchange(received);
    if (answer != Status::ok) return answer;
  }
  for (std::uint32_t i = 0; i < scenes.size(); ++i) {
    scenes[i].events().conclude(messages_for(received, first + i));
    scenes[i].show_events();
  }
  return Status::ok;
}

Status ClusterSceneState::count_found(Status found) {
  std::vector<RankCounts> counts;
  for (const RankScene& one : scenes) counts.push_back(one.counts());
  const Status answer = count(counts, found);
  if (answer != Status::ok || !needs_cut) return answer;
  for (RankScene& one : scenes) one.measure_work();
  return Status::ok;
}

Status ClusterSceneState::digest(ClusterDigest& digest) {
  std::uint64_t sums[2] = {0, 0};
  for (const RankScene& one : scenes) {
    const ClusterDigest part = digest_of(one.contacts());
    sums[0] += part.high;
    sums[1] += part.low;
  }
  const Status answer = transport.reduce(sums, {});
  if (answer == Status::ok) digest = {sums[0], sums[1]};
  return answer;
}

namespace {

/// Hashes the names and manifolds of one pair of contacts, but not its event.
std::uint64_t digest_of_pair(const Contacts& contacts, std::size_t pair, std::uint64_t seed) {
  Digest digest;
  digest.add(seed);
  digest.add(contacts.data_a()[pair]);
  digest.add(contacts.data_b()[pair]);
  if (contacts.manifold_first().empty()) return digest.value();
  const bool has_distance = !contacts.distance().empty();
  const bool has_point = !contacts.point(0).empty();
  const bool has_points = !contacts.point_first().empty();
  for (std::size_t m = contacts.manifold_first()[pair]; m < contacts.manifold_first()[pair + 1];
       ++m) {
    digest.add(std::uint64_t{contacts.part_a()[m]} << 32U | contacts.part_b()[m]);
    if (has_distance) {
      digest.add(contacts.distance()[m]);
      digest.add(contacts.error_bound()[m]);
      for (int axis = 0; axis < 3; ++axis) digest.add(contacts.normal(axis)[m]);
    }
    for (int axis = 0; has_point && axis < 3; ++axis) digest.add(contacts.point(axis)[m]);
    if (!has_points) continue;
    for (std::size_t p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
      const ContactPoint point = contacts.contact(p);
      for (const float coordinate : point.position) digest.add(coordinate);
      digest.add(point.depth);
      digest.add(point.feature);
    }
  }
  return digest.value();
}

}  // namespace

ClusterDigest digest_of(const Contacts& contacts) noexcept {
  ClusterDigest sum;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    sum.high += digest_of_pair(contacts, i, 0x9E3779B97F4A7C15ULL);
    sum.low += digest_of_pair(contacts, i, 0xD1B54A32D192ED03ULL);
  }
  return sum;
}

// ---- public functions

ClusterScene::ClusterScene(Transport& transport, const ShapePool& shapes,
                           const ClusterSceneOptions& options) noexcept
    : state_(catch_bad_alloc([&] { return new ClusterSceneState(transport, shapes, options); },
                             static_cast<ClusterSceneState*>(nullptr))) {}

ClusterScene::~ClusterScene() {
  delete state_;
}

Status ClusterScene::status() const noexcept {
  return state_ == nullptr ? Status::out_of_memory : state_->status;
}

std::uint32_t ClusterScene::ranks() const noexcept {
  return state_ == nullptr ? 0 : state_->ranks;
}

std::uint32_t ClusterScene::first_hosted() const noexcept {
  return state_ == nullptr ? 0 : state_->first;
}

std::uint32_t ClusterScene::hosted() const noexcept {
  return state_ == nullptr ? 0 : static_cast<std::uint32_t>(state_->scenes.size());
}

Status ClusterScene::add(std::span<const ClusterSceneBatch> batches, std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  const bool fit = batches.size() == hosted() && answers.size() == hosted();
  const Status status = collective(state_, CollectiveCall::add, [&] {
    if (fit) return state_->add(batches, answers);
    // The call is collective: other processes wait for this one, which adds no bodies.
    const std::vector<ClusterSceneBatch> nothing(hosted());
    std::vector<Status> ignored(hosted());
    return state_->add(nothing, ignored);
  });
  return status == Status::ok && !fit ? Status::size_mismatch : status;
}

Status ClusterScene::replicate(const ClusterSceneBatch& batch) {
  const DefaultFloatEnvironment environment;
  Status refused = Status::ok;
  const Status status = collective(state_, CollectiveCall::replicate,
                                   [&] { return state_->replicate(batch, refused); });
  return status == Status::ok ? refused : status;
}

Status ClusterScene::move_replicated(std::span<const BodyName> names, std::span<const Pose> poses) {
  const DefaultFloatEnvironment environment;
  Status refused = Status::ok;
  const Status status = collective(state_, CollectiveCall::move_replicated,
                                   [&] { return state_->move_replicated(names, poses, refused); });
  return status == Status::ok ? refused : status;
}

Status ClusterScene::move(std::uint32_t rank, std::span<const BodyName> names,
                          const PoseView& poses) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankScene& one) { return one.move(names, poses); });
}

Status ClusterScene::move(std::uint32_t rank, std::span<const Key> keys, const PoseView& poses) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankScene& one) { return one.move(keys, poses); });
}

Status ClusterScene::remove(std::uint32_t rank, std::span<const BodyName> names) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankScene& one) { return one.remove(names); });
}

Status ClusterScene::collide(ContactLevel level) {
  const DefaultFloatEnvironment environment;
  if (level > ContactLevel::manifold) return Status::invalid_argument;
  return collective(state_, CollectiveCall::find, [&] { return state_->collide(level); });
}

const Contacts& ClusterScene::contacts(std::uint32_t rank) const noexcept {
  static const Contacts kNothing(std::pmr::null_memory_resource());
  const RankScene* const one = state_ == nullptr ? nullptr : state_->find(rank);
  return one == nullptr ? kNothing : one->contacts();
}

Answer<ClusterDigest> ClusterScene::digest() {
  const DefaultFloatEnvironment environment;
  ClusterDigest digest;
  const Status status =
      collective(state_, CollectiveCall::digest, [&] { return state_->digest(digest); });
  if (status != Status::ok) return status;
  return digest;
}

Status ClusterScene::save(std::uint32_t rank, std::vector<std::byte>& bytes) const {
  return on_rank(state_, rank, [&](RankScene& one) {
    RecordBatch kept;
    one.records(kept.names, kept.bodies);
    return write_checkpoint(kept.names, kept.bodies, one.events().touching(), bytes);
  });
}

Status ClusterScene::restore(std::span<const std::span<const std::byte>> bytes,
                             std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  const bool fit = bytes.size() == hosted() && answers.size() == hosted();
  const Status status = collective(state_, CollectiveCall::restore, [&] {
    std::vector<RecordBatch> batches(hosted());
    std::vector<Status> read(hosted(), Status::ok);
    for (std::size_t i = 0; fit && i < bytes.size(); ++i) {
      read[i] = read_checkpoints(bytes[i], batches[i]);
    }
    const Status answer = state_->restore(batches, read);
    if (fit) std::copy(read.begin(), read.end(), answers.begin());
    return answer;
  });
  return status == Status::ok && !fit ? Status::size_mismatch : status;
}

std::size_t ClusterScene::size(std::uint32_t rank) const noexcept {
  const RankScene* const one = state_ == nullptr ? nullptr : state_->find(rank);
  return one == nullptr ? 0 : one->size();
}

Status ClusterScene::bodies(std::uint32_t rank, std::span<ClusterBody> bodies) const {
  return on_rank(state_, rank, [&](RankScene& one) { return one.bodies(bodies); });
}

Answer<Key> ClusterScene::key_of(std::uint32_t rank, BodyName name) const noexcept {
  Key key;
  const Status status =
      on_rank(state_, rank, [&](RankScene& one) { return one.key_of(name, key); });
  if (status != Status::ok) return status;
  return key;
}

Answer<BodyDefinition> ClusterScene::body(std::uint32_t rank, BodyName name) const noexcept {
  BodyDefinition body;
  const Status status = on_rank(state_, rank, [&](RankScene& one) {
    Key key;
    const Status found = one.key_of(name, key);
    return found == Status::ok ? one.scene().body(key).get(body) : found;
  });
  if (status != Status::ok) return status;
  return body;
}

std::span<const ClusterBody> ClusterScene::arrived(std::uint32_t rank) const noexcept {
  const RankScene* const one = state_ == nullptr ? nullptr : state_->find(rank);
  return one == nullptr ? std::span<const ClusterBody>{} : one->arrived();
}

std::span<const BodyName> ClusterScene::departed(std::uint32_t rank) const noexcept {
  const RankScene* const one = state_ == nullptr ? nullptr : state_->find(rank);
  return one == nullptr ? std::span<const BodyName>{} : one->departed();
}

const ClusterStatistics& ClusterScene::statistics() const noexcept {
  static const ClusterStatistics kNothing;
  return state_ == nullptr ? kNothing : state_->statistics;
}

Bytes ClusterScene::bytes() const noexcept {
  Bytes sum;
  if (state_ == nullptr) return sum;
  for (const RankScene& one : state_->scenes) sum += one.bytes();
  return sum;
}

}  // namespace winnow
