// Contacts from frame to frame, under every combination of scene options, compared with a model
// that stores whole frames: contact cache, warm start, reduction, offsets, ghost contacts on
// floors, sleep, several Contacts of one scene, and snapshots.

#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/contacts_model.h"
#include "tests/fuzz/every_shape.h"
#include "tests/fuzz/target.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

/// The work of all programs of this process, printed at its end.
struct Tally {
  std::uint64_t operations = 0;
  std::uint64_t frames = 0;
  std::uint64_t pairs = 0;
  std::uint64_t cached = 0;
  std::uint64_t points = 0;
  std::uint64_t followed = 0;

  ~Tally() {
    std::printf("%llu operations, %llu frames of %llu pairs, of which %llu were cached; ",
                number(operations), number(frames), number(pairs), number(cached));
    std::printf("%llu points, of which %llu were in the last frame\n", number(points),
                number(followed));
  }
  static unsigned long long number(std::uint64_t n) { return n; }
};
Tally tally;

constexpr std::size_t kMaxBodies = 14;
constexpr std::size_t kContacts = 2;

class ContactsProgram {
 public:
  explicit ContactsProgram(Bytes& bytes);
  void step(Bytes& bytes);

 private:
  static SceneOptions some_options(Bytes& bytes, const EveryShape& shapes, CountingMemory& memory);
  [[nodiscard]] Pose some_pose(Bytes& bytes) const;
  [[nodiscard]] ContactOffsets some_offsets(Bytes& bytes) const;
  [[nodiscard]] ShapeId some_shape(Bytes& bytes) const;
  [[nodiscard]] ModelBody* some_body(Bytes& bytes);

  void add(Bytes& bytes);
  void remove(Bytes& bytes);
  void nudge(Bytes& bytes);
  void move(ModelBody& body, const Pose& pose);
  void set_body_state(Bytes& bytes);
  void reshape(Bytes& bytes);
  void part(Bytes& bytes);
  void change_surface(Bytes& bytes);
  void collide(Bytes& bytes);
  void save();
  void load();
  void check_memory() const;

  /// The part of a program's state that can be saved.
  struct Checkpoint {
    explicit Checkpoint(const ModelScene& now) : world(now) {}

    Column<std::byte> scene{std::pmr::get_default_resource()};
    Column<std::byte> contacts[kContacts] = {Column<std::byte>{std::pmr::get_default_resource()},
                                             Column<std::byte>{std::pmr::get_default_resource()}};
    ModelScene world;
    ContactsModel models[kContacts];
    bool is_filled[kContacts] = {};
  };

  EveryShape shapes_;
  CountingMemory memory_;
  ModelScene world_;
  double far_ = 0.0;
  double step_ = 0.0;
  ContactLevel level_ = ContactLevel::manifold;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<Contacts> contacts_[kContacts];
  /// True if this scene was the last one to fill the Contacts.
  bool is_filled_[kContacts] = {};
  ContactsModel models_[kContacts];
  PairReference reference_;
  std::optional<Checkpoint> checkpoint_;
  ClientData named_ = 0;
};

ContactsProgram::ContactsProgram(Bytes& bytes)
    : shapes_(bytes),
      world_{shapes_.pool, shapes_.composites, some_options(bytes, shapes_, memory_)} {
  constexpr double kFar[] = {0.0, 0.0, 0.0, 1e5};
  far_ = kFar[bytes.below(4)];
  // Steps below, near and above the cache tolerance.
  constexpr double kSteps[] = {0.0078125, 0.03125, 0.0546875, 0.125};
  step_ = kSteps[bytes.below(4)];
  scene_ = std::make_unique<Scene>(shapes_.pool, world_.options);
  for (auto& contacts : contacts_) contacts = std::make_unique<Contacts>(&memory_);
}

SceneOptions ContactsProgram::some_options(Bytes& bytes, const EveryShape& shapes,
                                           CountingMemory& memory) {
  SceneOptions options{.memory = &memory, .composites = &shapes.composites};
  options.execution = bytes.chance(4) ? Execution::parallel() : Execution::serial();
  const auto all = all_structures();
  for (StructureKind& kind : options.structures) kind = all[bytes.below(all.size())];
  if (bytes.chance(2)) options.contact_margin = 0.0625;
  if (!bytes.chance(3)) options.cache_tolerance = 0.0625;
  options.warm_start = bytes.chance(2);
  options.part_manifolds = !bytes.chance(2);
  options.suppress_ghost_contacts = bytes.chance(4);
  if (bytes.chance(8)) options.tier = NarrowTier::reference;
  return options;
}

// Returns positions on a lattice, so that shapes touch exactly, rest flush and share edges.
Pose ContactsProgram::some_pose(Bytes& bytes) const {
  Pose pose;
  for (double& x : pose.position) {
    x = far_ + 0.25 * static_cast<double>(bytes.below(9)) - 1.0;
  }
  if (bytes.chance(2)) {
    for (double& q : pose.orientation) q = bytes.grid_value();
  }
  if (!pose.is_valid()) pose.orientation[0] = 1.0;
  return pose;
}

ContactOffsets ContactsProgram::some_offsets(Bytes& bytes) const {
  ContactOffsets offsets;
  if (!bytes.chance(3)) return offsets;
  offsets.contact = 0.03125 * static_cast<double>(bytes.below(5));
  offsets.rest = std::min(offsets.contact, 0.015625 * (static_cast<double>(bytes.below(5)) - 2.0));
  return offsets;
}

// Returns mostly convex shapes.
ShapeId ContactsProgram::some_shape(Bytes& bytes) const {
  return shapes_.ids[bytes.below(bytes.chance(3) ? shapes_.ids.size() : shapes_.convex)];
}

ModelBody* ContactsProgram::some_body(Bytes& bytes) {
  if (world_.bodies.empty()) return nullptr;
  const auto at = std::next(world_.bodies.begin(),
                            static_cast<std::ptrdiff_t>(bytes.below(world_.bodies.size())));
  return &at->second;
}

void ContactsProgram::add(Bytes& bytes) {
  for (std::size_t count = 1 + bytes.below(5); count > 0; --count) {
    if (world_.bodies.size() >= kMaxBodies) return;
    ModelBody body;
    body.definition.shape = some_shape(bytes);
    body.definition.pose = some_pose(bytes);
    body.definition.state =
        bytes.chance(3) ? static_cast<BodyState>(bytes.below(3)) : BodyState::dynamic;
    body.definition.data = named_++;
    body.definition.offsets = some_offsets(bytes);
    WINNOW_REQUIRE(scene_->add(body.definition).get(body.key) == Status::ok);
    world_.bodies.emplace(body.definition.data, body);
  }
}

void ContactsProgram::remove(Bytes& bytes) {
  const ModelBody* const body = some_body(bytes);
  if (body == nullptr) return;
  const ClientData data = body->definition.data;
  WINNOW_REQUIRE(scene_->remove(body->key) == Status::ok);
  world_.bodies.erase(data);
  std::erase_if(world_.ignored,
                [&](const auto& pair) { return pair.first == data || pair.second == data; });
}

void ContactsProgram::move(ModelBody& body, const Pose& pose) {
  body.definition.pose = pose;
  WINNOW_REQUIRE(scene_->move(body.key, pose) == Status::ok);
}

// Moves and rotates one body or all of them a little.
void ContactsProgram::nudge(Bytes& bytes) {
  double by[3];
  for (double& x : by) x = step_ * (static_cast<double>(bytes.below(3)) - 1.0);
  const bool turns = bytes.chance(3);
  const auto nudged = [&](const Pose& from) {
    Pose to = from;
    for (int k = 0; k < 3; ++k) to.position[k] += by[k];
    if (turns) to.orientation[3] += 0.125 * step_;
    return to.is_valid() ? to : from;
  };
  if (bytes.chance(6)) {
    for (auto& [data, body] : world_.bodies) move(body, nudged(body.definition.pose));
    return;
  }
  ModelBody* const body = some_body(bytes);
  if (body != nullptr) move(*body, nudged(body->definition.pose));
}

void ContactsProgram::set_body_state(Bytes& bytes) {
  const auto state = static_cast<BodyState>(bytes.below(3));
  const bool all = bytes.chance(4);
  ModelBody* const one = some_body(bytes);
  for (auto& [data, body] : world_.bodies) {
    if (!all && &body != one) continue;
    body.definition.state = state;
    WINNOW_REQUIRE(scene_->set_body_state(body.key, state) == Status::ok);
  }
}

void ContactsProgram::reshape(Bytes& bytes) {
  ModelBody* const body = some_body(bytes);
  if (body == nullptr) return;
  const BodyDefinition before = body->definition;
  if (bytes.chance(2)) {
    body->definition.offsets = some_offsets(bytes);
    WINNOW_REQUIRE(scene_->set_offsets(body->key, body->definition.offsets) == Status::ok);
  } else {
    body->definition.shape = some_shape(bytes);
    WINNOW_REQUIRE(scene_->set_shape(body->key, body->definition.shape) == Status::ok);
  }
  const bool is_as_before =
      body->definition.shape == before.shape && body->definition.offsets == before.offsets;
  if (!is_as_before) ++body->reshaped;
}

// Sets or clears one of the rules that prevent pairs: ignores two bodies, or changes the filter or
// the layer of one body.
void ContactsProgram::part(Bytes& bytes) {
  ModelBody* const a = some_body(bytes);
  ModelBody* const b = some_body(bytes);
  if (a == nullptr || a == b) return;
  const bool apart = bytes.chance(2);
  switch (bytes.below(3)) {
    case 0: {
      WINNOW_REQUIRE(scene_->set_ignored(a->key, b->key, apart) == Status::ok);
      const ModelScene::Names names = std::minmax(a->definition.data, b->definition.data);
      if (apart) {
        world_.ignored.insert(names);
      } else {
        world_.ignored.erase(names);
      }
      break;
    }
    case 1:
      a->definition.filter.mask = apart ? 2U : ~0U;
      WINNOW_REQUIRE(scene_->set_filter(a->key, a->definition.filter) == Status::ok);
      break;
    default: {
      a->definition.layer = static_cast<std::uint16_t>(bytes.below(3));
      WINNOW_REQUIRE(scene_->set_layer(a->key, a->definition.layer) == Status::ok);
      WINNOW_REQUIRE(scene_->set_layers_collide(1, 2, !apart) == Status::ok);
      if (apart) {
        world_.layers_apart.insert({1, 2});
      } else {
        world_.layers_apart.erase({1, 2});
      }
    }
  }
}

void ContactsProgram::change_surface(Bytes& bytes) {
  for (const ShapeId id : shapes_.ids) {
    const HeightField* const field = shapes_.composites.height_field(id);
    if (field == nullptr) continue;
    const float height = static_cast<float>(0.25 * bytes.extent());
    const float heights[] = {height};
    const auto at = static_cast<std::uint32_t>(bytes.below(9));
    WINNOW_REQUIRE(shapes_.composites.update_height_field(
                       id, at % 3, at / 3, {heights, 1, 1, 0, {1.0, 1.0}}) == Status::ok);
    ++world_.surfaces_changed;
    // A snapshot of a scene does not contain its pools. The saved scene does not match the changed
    // pool, so it is dropped.
    checkpoint_.reset();
    return;
  }
}

void ContactsProgram::collide(Bytes& bytes) {
  if (bytes.chance(12)) level_ = static_cast<ContactLevel>(bytes.below(4));
  const std::size_t which = bytes.chance(8) ? 1 : 0;
  Contacts& contacts = *contacts_[which];
  ContactsModel& model = models_[which];
  if (bytes.chance(32)) {
    contacts.clear();
    model.forget();
  }
  WINNOW_REQUIRE(scene_->collide(level_, contacts) == Status::ok);
  const std::uint64_t cached = model.cached;
  model.check(world_, *scene_, level_, contacts, reference_);
  WINNOW_REQUIRE(world_.options.cache_tolerance > 0.0 || contacts.cached_pairs() == 0);
  is_filled_[which] = true;
  ++tally.frames;
  tally.pairs += contacts.size();
  tally.cached += model.cached - cached;
  tally.points += contacts.previous_point().size();
  tally.followed += static_cast<std::uint64_t>(std::ranges::count_if(
      contacts.previous_point(), [](std::uint32_t before) { return before != kNoContact; }));
}

void ContactsProgram::save() {
  checkpoint_.emplace(world_);
  Checkpoint& to = *checkpoint_;
  WINNOW_REQUIRE(scene_->save(to.scene) == Status::ok);
  for (std::size_t i = 0; i < kContacts; ++i) {
    to.models[i] = models_[i];
    to.is_filled[i] = is_filled_[i];
    const Status status = scene_->save_contacts(*contacts_[i], to.contacts[i]);
    WINNOW_REQUIRE(status == (is_filled_[i] ? Status::ok : Status::invalid_key));
  }
}

// Continues with the saved scene in place of this one.
void ContactsProgram::load() {
  if (!checkpoint_) return;
  const Checkpoint& from = *checkpoint_;
  scene_ = std::make_unique<Scene>(shapes_.pool, from.world.options);
  WINNOW_REQUIRE(scene_->load({from.scene.data(), from.scene.size()}) == Status::ok);
  world_.bodies = from.world.bodies;
  world_.ignored = from.world.ignored;
  world_.layers_apart = from.world.layers_apart;
  for (const auto& [data, body] : world_.bodies) {
    BodyDefinition loaded;
    WINNOW_REQUIRE(scene_->body(body.key).get(loaded) == Status::ok && loaded.data == data);
  }
  for (std::size_t i = 0; i < kContacts; ++i) {
    models_[i] = from.models[i];
    is_filled_[i] = from.is_filled[i];
    if (!is_filled_[i]) {
      models_[i].forget();
      continue;
    }
    contacts_[i] = std::make_unique<Contacts>(&memory_);
    WINNOW_REQUIRE(scene_->load_contacts({from.contacts[i].data(), from.contacts[i].size()},
                                         *contacts_[i]) == Status::ok);
  }
}

void ContactsProgram::check_memory() const {
  std::size_t bytes = scene_->footprint().total().reserved;
  for (const auto& contacts : contacts_) bytes += contacts->footprint().total().reserved;
  WINNOW_REQUIRE(bytes == memory_.outstanding());
}

void ContactsProgram::step(Bytes& bytes) {
  ++tally.operations;
  const auto op = bytes.below(32);
  switch (op) {
    case 0:
    case 1:
      add(bytes);
      break;
    case 2:
      remove(bytes);
      break;
    case 3:
    case 4:
      set_body_state(bytes);
      break;
    case 5:
      reshape(bytes);
      break;
    case 6:
      part(bytes);
      break;
    case 7:
      if (ModelBody* const body = some_body(bytes)) move(*body, some_pose(bytes));
      break;
    case 8:
      if (bytes.chance(2)) {
        save();
      } else {
        load();
      }
      break;
    case 9:
      if (bytes.chance(3)) change_surface(bytes);
      break;
    case 10:
    case 11:
    case 12:
    case 13:
    case 14:
    case 15:
    case 16:
    case 17:
    case 18:
    case 19:
      collide(bytes);
      break;
    default:
      nudge(bytes);
  }
  check_memory();
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  ContactsProgram program(bytes);
  while (!bytes.empty()) program.step(bytes);
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(200, 1000);
}

}  // namespace winnow::test
