#pragma once

#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/sensors.h>
#include "pipeline/recording/query_digest.h"

namespace winnow {

/// Adds all results of continuous collision detection. Of a key, only the id is added.
inline void add_to(Digest& digest, const ContinuousCollision& ccd) noexcept {
  for (const SceneImpact& impact : ccd.impacts()) {
    digest.add(std::uint64_t{impact.a.id} << 32U | impact.b.id);
    digest.add(impact.data_a);
    digest.add(impact.data_b);
    digest.add(std::uint64_t{impact.part_a} << 32U | impact.part_b);
    digest.add(impact.time);
    digest.add(impact.gap);
    digest.add(impact.error_bound);
    add_to(digest, impact.normal);
    add_to(digest, impact.point);
  }
  digest.add(std::uint64_t{ccd.impacts().size()});
  digest.add_array(ccd.first());
}

/// Adds all sensed bodies, and all bodies that left a sensor. Of a key, only the id is added.
inline void add_to(Digest& digest, const Sensors& sensors) noexcept {
  for (const SensedBody& in : sensors.sensed()) {
    digest.add(std::uint64_t{in.sensor.id} << 32U | in.body.id);
    digest.add(in.sensor_data);
    digest.add(in.body_data);
    digest.add(static_cast<std::uint64_t>(in.event));
  }
  digest.add(std::uint64_t{sensors.sensed().size()});
  for (const ExitedBody& out : sensors.left()) {
    digest.add(std::uint64_t{out.sensor.id} << 32U | out.body.id);
    digest.add(out.sensor_data);
    digest.add(out.body_data);
  }
  digest.add(std::uint64_t{sensors.left().size()});
}

}  // namespace winnow
