// Soak test of a scene: plays random frames on a scene, on a copy loaded from its snapshot, and on
// a model, and compares them. Called by soak.cpp.

#include <winnow/winnow.h>

#include <algorithm>
#include <array>
#include <set>

#include "tests/pipeline/scene_world.h"
#include "tests/soak/soak.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::size_t kBodies = 40;
constexpr double kMargin = 0.05;

class SceneSoak {
 public:
  explicit SceneSoak(const SoakPlan& plan);

  SoakTally run();

 private:
  /// A change of one body, which is made on the model and then on each scene.
  struct Event {
    enum class Kind { add, remove, move, state, shape, filter, ignore } kind;
    std::size_t body;
    std::size_t other = 0;  // for `ignore`
    bool ignored = false;
  };

  void plan_frame(std::uint64_t frame);
  void change(std::size_t i);
  void apply_event(const Event& event, Scene& scene, std::size_t which);
  void collide(Scene& scene, Contacts& contacts);
  void report_events();
  void check();
  void save();
  void follow();
  [[nodiscard]] std::size_t held() const;

  SoakPlan plan_;
  SoakTally tally_;
  CountingMemory memory_;
  CountingMemory saved_memory_;  // for snapshots
  SceneWorld world_;
  Random random_;
  Threads threads_;
  Scene scene_;
  Scene loaded_;
  Contacts contacts_{&memory_};
  Contacts loaded_contacts_{&saved_memory_};
  Column<std::byte> saved_{&saved_memory_};
  Column<std::byte> saved_contacts_{&saved_memory_};
  std::uint64_t followed_ = 0;  // remaining frames in which the loaded copy is compared

  std::vector<Event> events_;
  std::array<std::vector<Key>, 2> keys_;  // by scene, then by body of the world
  std::set<Names> ignored_;
  std::set<Names> shown_;    // in the last frame
  std::set<Names> dormant_;  // pairs of two bodies that have rested since they were reported
  double step_ = 0.02;
  FrameTimes times_{plan_.threads};
};

SceneOptions options_of(const SoakPlan& plan, CountingMemory& memory) {
  return {.memory = &memory,
          .execution = Workers{plan.threads}.execution(),
          .structures = {static_bvh(), automatic(), linear_bvh()},
          .contact_margin = kMargin,
          .warm_start = true};
}

SceneSoak::SceneSoak(const SoakPlan& plan)
    : plan_(plan),
      world_(kBodies, plan.seed),
      random_(plan.seed + 1),
      threads_(plan.threads),
      scene_(world_.pool, options_of(plan, memory_)),
      loaded_(world_.pool, options_of(plan, saved_memory_)) {
  tally_.name = "scene";
  require(add_all(scene_, world_) == Status::ok, "add was refused");
  keys_[0] = keys_[1] = world_.keys;
}

/// Changes the state, shape or filter of a body, or sets it to ignore another body.
void SceneSoak::change(std::size_t i) {
  BodyDefinition& body = world_.bodies[i];
  switch (random_.below(8)) {
    case 0:
      body.shape = world_.shapes[random_.below(world_.shapes.size())];
      events_.push_back({Event::Kind::shape, i});
      break;
    case 1:
      body.filter = random_.chance(0.7) ? ObjectFilter{} : ObjectFilter{2, ~2U, 0};
      events_.push_back({Event::Kind::filter, i});
      break;
    case 2: {
      const std::size_t other = random_.below(world_.bodies.size());
      if (other == i || world_.removed[other]) break;
      const Names both = names(body.data, world_.bodies[other].data);
      const bool ignored = ignored_.erase(both) == 0;
      if (ignored) ignored_.insert(both);
      events_.push_back({Event::Kind::ignore, i, other, ignored});
      break;
    }
    default:
      // Most bodies fall asleep or wake up.
      body.state = body.state == BodyState::dynamic ? BodyState::sleeping : BodyState::dynamic;
      if (random_.chance(0.1)) body.state = BodyState::fixed;
      events_.push_back({Event::Kind::state, i});
  }
}

void SceneSoak::plan_frame(std::uint64_t frame) {
  events_.clear();
  if (frame % 64 == 0) step_ = random_.chance(0.2) ? 0.5 : random_.log_uniform(1e-3, 0.1);
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    BodyDefinition& body = world_.bodies[i];
    if (world_.removed[i]) {
      if (!random_.chance(0.05)) continue;
      body.pose = world_.random_pose();
      world_.removed[i] = false;
      events_.push_back({Event::Kind::add, i});
    } else if (random_.chance(0.005)) {
      world_.removed[i] = true;
      std::erase_if(ignored_, [&](const Names& both) {
        return both.first == body.data || both.second == body.data;
      });
      events_.push_back({Event::Kind::remove, i});
    } else if (random_.chance(0.02)) {
      change(i);
    } else if (body.state == BodyState::dynamic && random_.chance(0.7)) {
      for (double& p : body.pose.position) {
        p = std::clamp(p + random_.uniform(-step_, step_), 0.0, world_.side);
      }
      for (double& q : body.pose.orientation) q += random_.uniform(-step_, step_);
      if (!body.pose.is_valid()) body.pose.orientation[0] = 1.0;
      events_.push_back({Event::Kind::move, i});
    }
  }
}

void SceneSoak::apply_event(const Event& event, Scene& scene, std::size_t which) {
  const BodyDefinition& body = world_.bodies[event.body];
  Key& key = keys_[which][event.body];
  const auto apply = [&] {
    switch (event.kind) {
      case Event::Kind::add:
        return scene.add(body).get(key);
      case Event::Kind::remove:
        return scene.remove(key);
      case Event::Kind::move:
        return scene.move(key, body.pose);
      case Event::Kind::state:
        return scene.set_body_state(key, body.state);
      case Event::Kind::shape:
        return scene.set_shape(key, body.shape);
      case Event::Kind::filter:
        return scene.set_filter(key, body.filter);
      default:
        return scene.set_ignored(key, keys_[which][event.other], event.ignored);
    }
  };
  require(apply() == Status::ok, "a change was refused");
}

void SceneSoak::collide(Scene& scene, Contacts& contacts) {
  const Status status =
      threads_.run([&] { return scene.collide(ContactLevel::manifold, contacts); });
  require(status == Status::ok, "collide was refused");
}

/// Checks events: pairs begin if they were neither reported nor dormant; pairs that are no longer
/// reported end or become dormant.
void SceneSoak::report_events() {
  std::set<Names> before = shown_;
  before.insert(dormant_.begin(), dormant_.end());
  shown_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Names both = names(contacts_.data_a()[i], contacts_.data_b()[i]);
    require(shown_.insert(both).second, "a pair is reported twice");
    const bool persists = contacts_.event()[i] == ContactEvent::persisted;
    require(!persists || before.contains(both), "a pair persists that had not begun");
    before.erase(both);
  }
  for (const EndedContact& pair : contacts_.ended()) {
    // A pair ends and begins again if a body was replaced or has another shape.
    const Names both = names(pair.data_a, pair.data_b);
    require(before.erase(both) == 1 || shown_.contains(both), "a pair ends that had not begun");
  }
  for (const Names& both : before) {
    require(!world_.removed[both.first] && !world_.removed[both.second] &&
                world_.bodies[both.first].state != BodyState::dynamic &&
                world_.bodies[both.second].state != BodyState::dynamic,
            "a pair is neither shown nor ended, and does not rest");
  }
  dormant_ = std::move(before);
}

void SceneSoak::check() {
  std::set<Names> truth;
  for (const auto& [both, distance] : world_.touching(kMargin)) {
    if (!ignored_.contains(both)) truth.insert(both);
  }
  require(shown_ == truth, "contacts are not the touching pairs");
  const std::uint64_t live = scene_.size();
  tally_.comparisons += live * (live - 1) / 2;
  ++tally_.checks;
}

void SceneSoak::save() {
  saved_.clear();
  saved_contacts_.clear();
  require(scene_.save(saved_) == Status::ok, "save was refused");
  require(scene_.save_contacts(contacts_, saved_contacts_) == Status::ok, "save was refused");
  require(loaded_.load({saved_.data(), saved_.size()}) == Status::ok, "load was refused");
  require(loaded_.load_contacts({saved_contacts_.data(), saved_contacts_.size()},
                                loaded_contacts_) == Status::ok,
          "load of contacts was refused");
  for (std::size_t i = 0; i < keys_[0].size(); ++i) {
    keys_[1][i] = loaded_.key_of(keys_[0][i].id);
  }
  followed_ = plan_.follow_frames;
}

void SceneSoak::follow() {
  for (const Event& event : events_) apply_event(event, loaded_, 1);
  collide(loaded_, loaded_contacts_);
  require(digest(contacts_) == digest(loaded_contacts_), "the loaded scene has other contacts");
  if (--followed_ == 0) ++tally_.snapshots;
}

std::size_t SceneSoak::held() const {
  std::size_t bytes = saved_.bytes().reserved + saved_contacts_.bytes().reserved;
  for (const Scene* one : {&scene_, &loaded_}) bytes += one->footprint().total().reserved;
  for (const Contacts* one : {&contacts_, &loaded_contacts_}) {
    bytes += one->footprint().total().reserved;
  }
  return bytes;
}

SoakTally SceneSoak::run() {
  MemoryWatch watch(tally_, memory_, saved_memory_, plan_.frames);
  for (std::uint64_t frame = 0; frame < plan_.frames; ++frame) {
    plan_frame(frame);
    times_.begin();
    for (const Event& event : events_) apply_event(event, scene_, 0);
    collide(scene_, contacts_);
    times_.end();
    report_events();
    tally_.operations += events_.size() + 1;
    if (followed_ != 0) {
      follow();
    } else if (frame % plan_.save_every == plan_.save_every / 2) {
      save();
    }
    if (frame % plan_.check_every == 0) check();
    watch.look(frame, held());
    ++tally_.frames;
  }
  tally_.median_us = times_.quantile(0.5);
  tally_.p999_us = times_.quantile(0.999);
  return tally_;
}

}  // namespace

SoakTally soak_scene(const SoakPlan& plan) {
  return SceneSoak(plan).run();
}

}  // namespace winnow::test
