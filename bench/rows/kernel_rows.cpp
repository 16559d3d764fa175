#include "bench/rows/kernel_rows.h"

#include "bench/measure/kernel_race.h"
#include "bench/rows/named_scene.h"

namespace winnow::bench {

void add_kernels(Results& results, std::size_t rounds, const std::string& text) {
  for (const KernelTiming& one : race_kernels(rounds, text)) {
    Json row{{"kernel", one.kernel},
             {"isa", to_string(one.isa)},
             {"ns", to_value(one.ns)},
             {"command", "bench/run kernels --kernel " + shell_word(one.kernel) + " --rounds " +
                             std::to_string(rounds)}};
    if (one.tests != 0) {
      row["tests_per_us"] = 1e3 * static_cast<double>(one.tests) / median_of(one.ns);
      row["pairs"] = one.pairs;
    }
    results.add("kernels", std::move(row));
  }
}

}  // namespace winnow::bench
