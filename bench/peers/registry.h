#pragma once

#include <memory>
#include <type_traits>
#include <vector>

namespace winnow::bench {

/// Makes an engine for at most this many threads.
template <typename Engine>
using MakePeer = std::unique_ptr<Engine> (*)(int threads);

/// Returns the adapters of one interface that are linked, in the order of their sources.
template <typename Engine>
std::vector<MakePeer<Engine>>& registered_peers() {
  static std::vector<MakePeer<Engine>> makers;
  return makers;
}

/// Registers an adapter, which is made from the arguments or, if it takes it, the number of
/// threads. The source of the adapter has a constant of this type.
template <typename Engine, typename Adapter, auto... arguments>
struct RegisteredPeer {
  RegisteredPeer() {
    registered_peers<Engine>().push_back(
        []([[maybe_unused]] int threads) -> std::unique_ptr<Engine> {
          if constexpr (sizeof...(arguments) == 0 && std::is_constructible_v<Adapter, int>) {
            return std::make_unique<Adapter>(threads);
          } else {
            return std::make_unique<Adapter>(arguments...);
          }
        });
  }
};

}  // namespace winnow::bench
