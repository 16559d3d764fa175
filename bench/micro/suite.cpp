#include "bench/micro/suite.h"

#include <winnow/simd/isa.h>

#include <utility>

namespace winnow::bench {

void add_per_isa(const std::string& name, std::function<void(benchmark::State&)> body) {
  for (const Isa isa : available_isas()) {
    const std::string full_name = name + "/" + to_string(isa);
    benchmark::RegisterBenchmark(full_name.c_str(), [isa, body](benchmark::State& state) {
      if (set_isa(isa) != Status::ok) {
        state.SkipWithError("the instruction set was refused");
        return;
      }
      body(state);
    })->UseRealTime();
  }
}

}  // namespace winnow::bench
