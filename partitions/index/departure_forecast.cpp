#include "partitions/index/departure_forecast.h"

namespace winnow {

void DepartureForecast::begin(const Rows& rows) noexcept {
  samples_.clear();
  const std::size_t regular = rows.regions().regular;
  for (std::size_t i = 0; i < kSample && regular >= kSample; ++i) {
    const std::size_t row = (2 * i + 1) * regular / (2 * kSample);
    const ObjectId id = rows.pool().ids()[row];
    if (id == kNoObject) continue;
    SampledRow sampled{.id = id, .low = {}};
    for (std::size_t a = 0; a < 3; ++a) sampled.low[a] = rows.pool().column(a)[row];
    (void)samples_.push_back(sampled);
  }
}

float DepartureForecast::share(const Rows& rows, const Structure& structure, std::size_t frames,
                               std::size_t ahead) const noexcept {
  if (samples_.empty() || frames == 0) return 0.0F;
  const float steps = static_cast<float>(ahead) / static_cast<float>(frames);
  std::size_t staying = 0;
  std::size_t leaving = 0;
  for (const SampledRow& sampled : samples_) {
    if (!rows.keys().is_live(sampled.id)) continue;
    const std::size_t row = rows.keys().row_of(sampled.id);
    if (row >= rows.regions().regular) continue;
    Structure::ObjectBox place = structure.box_of_row(row);
    for (std::size_t a = 0; a < 3; ++a) {
      const float way = steps * (place.low[a] - sampled.low[a]);
      place.low[a] += way;
      place.high[a] += way;
    }
    ++(structure.fits(row, place) ? staying : leaving);
  }
  return leaving == 0 ? 0.0F : static_cast<float>(leaving) / static_cast<float>(leaving + staying);
}

}  // namespace winnow
