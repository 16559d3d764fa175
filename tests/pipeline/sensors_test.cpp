// Sensors: overlaps, arrivals and departures compared with tests of every pair of a sensor and a
// body.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/sensors.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Stamped = std::pair<ObjectId, std::uint32_t>;
using SensedSet = std::set<std::pair<Stamped, Stamped>>;

Stamped stamped(Key key) {
  return {key.id, key.stamp};
}

/// Balls in a cube, and ball-shaped sensors.
class BallRoom {
 public:
  explicit BallRoom(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : scene(shapes), sensors(scene, memory) {
    for (const double radius : kRadii) {
      ShapeId id = expect_ok(shapes.add(SphereShape{radius}));
      balls_.push_back(id);
    }
  }

  void add_body() {
    BodyDefinition body;
    const std::size_t size = random.below(kSizes);
    body.shape = balls_[size];
    body.pose = somewhere();
    body.state = static_cast<BodyState>(random.below(kBodyStates));
    body.filter.layers = random.chance(0.2) ? 2 : 1;
    body.data = random.bits();
    Key key = expect_ok(scene.add(body));
    bodies.push_back(key);
  }

  void add_sensor() {
    SensorDefinition sensor;
    sensor.shape = balls_[random.below(kSizes)];
    sensor.pose = somewhere();
    sensor.filter.mask = random.chance(0.3) ? 1 : ~0U;
    if (random.chance(0.3)) sensor.carrier = bodies[random.below(bodies.size())];
    sensor.data = random.bits();
    Key key = expect_ok(sensors.add(sensor));
    goals.push_back(key);
  }

  void change() {
    for (Key& key : bodies) {
      if (random.chance(0.3)) {
        ASSERT_EQ(scene.move(key, somewhere()), Status::ok);
      }
      if (random.chance(0.1)) {
        ASSERT_EQ(scene.set_body_state(key, static_cast<BodyState>(random.below(kBodyStates))),
                  Status::ok);
      }
    }
    for (const Key& key : goals) {
      if (random.chance(0.2)) {
        ASSERT_EQ(sensors.move(key, somewhere()), Status::ok);
      }
    }
    // New bodies and sensors reuse the ids at once.
    ASSERT_EQ(scene.remove(bodies.back()), Status::ok);
    bodies.pop_back();
    add_body();
    ASSERT_EQ(sensors.remove(goals.front()), Status::ok);
    goals.erase(goals.begin());
    add_sensor();
  }

  [[nodiscard]] SensedSet expected() const {
    SensedSet sensed;
    for (const Key goal : goals) {
      SensorDefinition sensor = expect_ok(sensors.sensor(goal));
      for (const Key key : bodies) {
        BodyDefinition body = expect_ok(scene.body(key));
        if (key == sensor.carrier || (sensor.filter.mask & body.filter.layers) == 0) continue;
        const double* const a = sensor.pose.position.data();
        const double* const b = body.pose.position.data();
        const double reach = radius_of(sensor.shape) + radius_of(body.shape);
        if (std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) <= reach) {
          sensed.insert({stamped(goal), stamped(key)});
        }
      }
    }
    return sensed;
  }

  ShapePool shapes;
  Scene scene;
  Sensors sensors;
  std::vector<Key> bodies;
  std::vector<Key> goals;
  Random random{5};

 private:
  static constexpr double kRadii[] = {0.2, 0.7, 1.5};
  static constexpr std::size_t kSizes = std::size(kRadii);

  Pose somewhere() {
    return Pose::at(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
  }
  [[nodiscard]] double radius_of(ShapeId id) const { return kRadii[id.index()]; }

  std::vector<ShapeId> balls_;
};

TEST(Sensors, overlaps_arrivals_and_departures_match_brute_force) {
  BallRoom room;
  for (int i = 0; i < 60; ++i) room.add_body();
  for (int i = 0; i < 15; ++i) room.add_sensor();
  SensedSet before;
  for (std::size_t frame = 0; frame < scaled(60); ++frame) {
    ASSERT_EQ(room.sensors.sense(), Status::ok);
    const SensedSet expected = room.expected();
    ASSERT_EQ(room.sensors.sensed().size(), expected.size());
    std::pair<ObjectId, ObjectId> last{0, 0};
    for (const SensedBody& in : room.sensors.sensed()) {
      const auto pair = std::pair(stamped(in.sensor), stamped(in.body));
      EXPECT_TRUE(expected.contains(pair));
      EXPECT_EQ(in.event == ContactEvent::persisted, before.contains(pair));
      SensorDefinition sensor;
      BodyDefinition body;
      sensor = expect_ok(room.sensors.sensor(in.sensor));
      body = expect_ok(room.scene.body(in.body));
      EXPECT_EQ(in.sensor_data, sensor.data);
      EXPECT_EQ(in.body_data, body.data);
      const std::pair<ObjectId, ObjectId> at{in.sensor.id, in.body.id};
      EXPECT_LE(last, at);
      last = at;
    }
    SensedSet left;
    for (const ExitedBody& out : room.sensors.left()) {
      left.insert({stamped(out.sensor), stamped(out.body)});
    }
    SensedSet gone;
    for (const auto& pair : before) {
      if (!expected.contains(pair)) gone.insert(pair);
    }
    EXPECT_EQ(left, gone);
    EXPECT_EQ(room.sensors.left().size(), gone.size());
    before = expected;
    room.change();
  }
}

TEST(Sensors, results_match_on_any_thread_count) {
  ShapePool shapes;
  ShapeId ball = expect_ok(shapes.add(SphereShape{0.7}));
  std::vector<SensedBody> one_thread;
  for (const Workers& workers : all_workers()) {
    Scene scene(shapes, {.execution = workers.execution()});
    CountingMemory memory;
    Sensors sensors(scene, &memory);
    Random random(71);
    const auto somewhere = [&] {
      return Pose::at(random.uniform(0, 9), random.uniform(0, 9), random.uniform(0, 9));
    };
    Key key;
    for (int i = 0; i < 300; ++i) {
      key = expect_ok(scene.add({.shape = ball, .pose = somewhere()}));
      key = expect_ok(sensors.add({.shape = ball, .pose = somewhere()}));
      if (i % 7 == 0) {
        ASSERT_EQ(sensors.remove(key), Status::ok);
      }
    }
    ASSERT_EQ(Threads(workers.threads).run([&] { return sensors.sense(); }), Status::ok);
    const std::vector<SensedBody> sensed(sensors.sensed().begin(), sensors.sensed().end());
    EXPECT_GT(sensed.size(), 100U);
    EXPECT_EQ(sensors.footprint().total().reserved, memory.outstanding());
    if (one_thread.empty()) one_thread = sensed;
    ASSERT_EQ(sensed.size(), one_thread.size());
    for (std::size_t i = 0; i < sensed.size(); ++i) {
      EXPECT_EQ(sensed[i].sensor.id, one_thread[i].sensor.id);
      EXPECT_EQ(sensed[i].body.id, one_thread[i].body.id);
    }
  }
}

TEST(Sensors, sensors_add_no_contacts) {
  BallRoom room;
  for (int i = 0; i < 20; ++i) room.add_body();
  Contacts contacts;
  ASSERT_EQ(room.scene.collide(ContactLevel::boolean, contacts), Status::ok);
  const std::size_t pairs = contacts.size();
  for (int i = 0; i < 20; ++i) room.add_sensor();
  ASSERT_EQ(room.sensors.sense(), Status::ok);
  ASSERT_EQ(room.scene.collide(ContactLevel::boolean, contacts), Status::ok);
  EXPECT_EQ(contacts.size(), pairs);
}

TEST(Sensors, composite_sensor_uses_every_part) {
  ShapePool shapes;
  CompositePool composites(shapes);
  Scene scene(shapes, {.composites = &composites});
  Sensors sensors(scene);
  ShapeId ball = expect_ok(shapes.add(SphereShape{0.5}));
  const CompoundChild children[] = {{ball, Pose::at(-3, 0, 0)}, {ball, Pose::at(3, 0, 0)}};
  ShapeId gate = expect_ok(composites.add_compound(children));
  expect_ok(sensors.add({.shape = gate, .pose = Pose::at(0, 0, 1)}));
  Key body = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0, 0, 1)}));
  ASSERT_EQ(sensors.sense(), Status::ok);
  EXPECT_TRUE(sensors.sensed().empty());
  ASSERT_EQ(scene.move(body, Pose::at(3.9, 0, 1)), Status::ok);
  ASSERT_EQ(sensors.sense(), Status::ok);
  ASSERT_EQ(sensors.sensed().size(), 1U);
  EXPECT_EQ(sensors.sensed()[0].event, ContactEvent::begun);
  ASSERT_EQ(sensors.sense(), Status::ok);
  EXPECT_EQ(sensors.sensed()[0].event, ContactEvent::persisted);

  // After its shape is removed, a sensor makes `sense` fail, and the earlier results stay.
  ASSERT_EQ(composites.remove(gate), Status::ok);
  EXPECT_EQ(sensors.sense(), Status::invalid_key);
  ASSERT_EQ(sensors.sensed().size(), 1U);
  EXPECT_EQ(sensors.sensed()[0].body, body);
}

TEST(Sensors, bad_input_is_refused_and_changes_nothing) {
  BallRoom room;
  room.add_body();
  room.add_sensor();
  const Key goal = room.goals[0];
  SensorDefinition good = expect_ok(room.sensors.sensor(goal));
  SensorDefinition bad = good;
  bad.shape = {};
  expect_error(room.sensors.add(bad), Status::invalid_key);
  EXPECT_EQ(room.sensors.set(goal, bad), Status::invalid_key);
  bad = good;
  bad.pose.position[1] = std::nan("");
  expect_error(room.sensors.add(bad), Status::invalid_pose);
  EXPECT_EQ(room.sensors.set(goal, bad), Status::invalid_pose);
  EXPECT_EQ(room.sensors.move(goal, bad.pose), Status::invalid_pose);
  EXPECT_EQ(room.sensors.move(room.bodies[0], good.pose), Status::invalid_key);
  EXPECT_EQ(room.sensors.remove(Key{}), Status::invalid_key);
  EXPECT_EQ(room.sensors.size(), 1U);
  SensorDefinition now = expect_ok(room.sensors.sensor(goal));
  EXPECT_EQ(now.pose.position[1], good.pose.position[1]);
  ASSERT_EQ(room.sensors.remove(goal), Status::ok);
  EXPECT_FALSE(room.sensors.contains(goal));
  expect_error(room.sensors.sensor(goal), Status::invalid_key);
}

TEST(Sensors, footprint_is_exact_and_refused_memory_is_reported) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  {
    BallRoom room(&memory);
    for (int i = 0; i < 40; ++i) room.add_body();
    for (int i = 0; i < 10; ++i) room.add_sensor();
    ASSERT_EQ(room.sensors.sense(), Status::ok);
    EXPECT_EQ(room.sensors.footprint().total().reserved, memory.outstanding());
    ASSERT_EQ(room.sensors.sense(), Status::ok);
    const std::size_t requests = memory.requests();
    ASSERT_EQ(room.sensors.sense(), Status::ok);
    EXPECT_EQ(memory.requests(), requests);
  }
  for (std::size_t granted = 0; granted < 30; ++granted) {
    BallRoom room;
    for (int i = 0; i < 40; ++i) room.add_body();
    CountingMemory scarce;
    scarce.refuse_one_after(granted);
    Sensors sensors(room.scene, &scarce);
    Key key;
    SensorDefinition wide{.shape = ShapeId::of(ShapeKind::sphere, 2)};
    const Status added = sensors.add(wide).get(key);
    if (added == Status::ok) {
      const Status sensed = sensors.sense();
      EXPECT_TRUE(sensed == Status::ok || sensed == Status::out_of_memory);
      EXPECT_TRUE(sensed == Status::ok || sensors.sensed().empty());
    } else {
      EXPECT_EQ(added, Status::out_of_memory);
      EXPECT_EQ(sensors.size(), 0U);
    }
  }
}

// A refused request fails only its own call, whatever there is to sense at that moment.
TEST(Sensors, sense_recovers_after_refused_memory) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (const bool with_body : {false, true}) {
    for (const bool with_sensor : {false, true}) {
      bool was_refused = true;
      for (std::size_t granted = 0; was_refused && granted < 100; ++granted) {
        CountingMemory memory;
        ShapePool shapes;
        ShapeId ball = expect_ok(shapes.add(SphereShape{0.5}));
        Scene scene(shapes, {.memory = &memory, .execution = Execution::serial()});
        Sensors sensors(scene, &memory);
        Key key;
        if (with_body) {
          key = expect_ok(scene.add({.shape = ball}));
        }
        if (with_sensor) {
          key = expect_ok(sensors.add({.shape = ball}));
        }
        memory.refuse_one_after(granted);
        const auto call = [&](auto&& make) {
          const std::size_t before = memory.refusals();
          const Status status = make();
          if (status == Status::ok) return true;
          EXPECT_EQ(status, Status::out_of_memory);
          EXPECT_EQ(memory.refusals(), before + 1) << granted << " requests granted";
          return false;
        };
        (void)call([&] { return sensors.sense(); });
        const auto add = [&] { return sensors.add({.shape = ball}).get(key); };
        ASSERT_TRUE(with_sensor || call(add) || call(add));
        const auto sense = [&] { return sensors.sense(); };
        ASSERT_TRUE(call(sense) || call(sense));
        EXPECT_EQ(sensors.sensed().size(), with_body ? 1U : 0U);
        was_refused = memory.refusals() != 0;
        memory.grant_all();
      }
      EXPECT_FALSE(was_refused);
    }
  }
}

}  // namespace
}  // namespace winnow::test
