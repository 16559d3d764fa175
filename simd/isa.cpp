#include <winnow/simd/isa.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>

namespace winnow {
namespace {

constexpr std::array<Isa, 4> kAll{Isa::sse42, Isa::avx2, Isa::avx512, Isa::neon64};

bool supported(Isa isa) noexcept {
  switch (isa) {
#ifdef WINNOW_HAVE_SSE42
    case Isa::sse42:
#ifdef __wasm__
      return true;
#else
      return __builtin_cpu_supports("sse4.2") != 0;
#endif
#endif
#ifdef WINNOW_HAVE_AVX2
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#endif
#ifdef WINNOW_HAVE_AVX512
    case Isa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512cd") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512vl") != 0;
#endif
#ifdef WINNOW_HAVE_NEON64
    case Isa::neon64:
      return true;
#endif
    default:
      return false;
  }
}

struct IsaSelection {
  std::array<Isa, kAll.size()> available{};
  std::size_t count = 0;
  std::atomic<Isa> active{};

  IsaSelection() noexcept {
    for (const Isa isa : kAll) {
      if (supported(isa)) available[count++] = isa;
    }
    active = available[count > 0 ? count - 1 : 0];
    if (const char* requested = std::getenv("WINNOW_ISA"); requested != nullptr) {
      for (std::size_t i = 0; i < count; ++i) {
        if (std::string_view(to_string(available[i])) == requested) active = available[i];
      }
    }
  }
};

IsaSelection& selection() noexcept {
  static IsaSelection instance;
  return instance;
}

}  // namespace

const char* to_string(Isa isa) noexcept {
  switch (isa) {
    case Isa::sse42:
      return "sse42";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
    case Isa::neon64:
      return "neon64";
  }
  return "unknown";
}

std::span<const Isa> available_isas() noexcept {
  return {selection().available.data(), selection().count};
}

Isa active_isa() noexcept {
  return selection().active.load(std::memory_order_relaxed);
}

const char* isa_name() noexcept {
  return to_string(active_isa());
}

Status set_isa(Isa isa) noexcept {
  for (const Isa have : available_isas()) {
    if (have == isa) {
      selection().active.store(isa, std::memory_order_relaxed);
      return Status::ok;
    }
  }
  return Status::invalid_argument;
}

Status set_isa(std::string_view name) noexcept {
  for (const Isa have : available_isas()) {
    if (name == to_string(have)) return set_isa(have);
  }
  return Status::invalid_argument;
}

}  // namespace winnow
