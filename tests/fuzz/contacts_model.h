#pragma once

// The model of contacts_fuzz.cpp: the calls of a program as plain containers, a reference for the
// contacts of each pair, and the comparison of both with Contacts.

#include <winnow/winnow.h>

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tests/pipeline/history_reference.h"

namespace winnow::test {

/// A body as the program defined it, with unique client data.
struct ModelBody {
  BodyDefinition definition;
  Key key;
  /// Incremented when the shape or the offsets change.
  std::uint64_t reshaped = 0;
};

/// The calls of a program on a scene, as plain containers.
struct ModelScene {
  using Names = std::pair<ClientData, ClientData>;

  const ShapePool& shapes;
  const CompositePool& composites;
  SceneOptions options;
  std::map<ClientData, ModelBody> bodies{};
  /// Pairs of client data and pairs of layers, the smaller first.
  std::set<Names> ignored{};
  std::set<std::pair<std::uint16_t, std::uint16_t>> layers_apart{};
  /// Incremented when a mesh or a height field changes in place.
  std::uint64_t surfaces_changed = 0;

  [[nodiscard]] bool may_pair(const ModelBody& a, const ModelBody& b) const;
  /// Returns the distance up to which the pair is a contact, before rest offsets.
  [[nodiscard]] double gap(const ModelBody& a, const ModelBody& b) const;
  [[nodiscard]] double radius(const ModelBody& body) const;
  /// Returns surfaces_changed if it matters to one of the two bodies.
  [[nodiscard]] std::uint64_t surfaces_changed_of(const ModelBody& a, const ModelBody& b) const;
};

/// One manifold as Contacts reports it.
struct ModelManifold {
  std::uint32_t part[2] = {kWholeShape, kWholeShape};
  double distance = 0.0;
  double error_bound = 0.0;
  Vec3d normal{};
  Vec3d point{};  ///< at level distance
  std::vector<ContactPoint> points{};
};
using ModelManifolds = std::vector<ModelManifold>;

/// Computes the contacts of each pair from its two bodies only: with the single-pair call of the
/// narrow phase for convex shapes, with a new scene of two bodies for others. A pair that does not
/// touch has no manifolds.
class PairReference {
 public:
  [[nodiscard]] const ModelManifolds& contacts(const ModelScene& world, ContactLevel level,
                                               const ModelBody& a, const ModelBody& b);
  /// Returns the distance of two convex shapes, at any gap, before rest offsets.
  [[nodiscard]] static PairAnswer distance(const ModelScene& world, const ModelBody& a,
                                           const ModelBody& b);

 private:
  /// The inputs of a cached result.
  struct Inputs {
    Pose pose[2];
    std::uint64_t reshaped[2];
    std::uint64_t surfaces_changed;
    ContactLevel level;

    [[nodiscard]] bool operator==(const Inputs& other) const;
  };
  struct Answer {
    Inputs inputs;
    ModelManifolds manifolds;
  };

  std::map<ModelScene::Names, Answer> answers_;
};

/// The contents that Contacts must have after each call of Scene::collide, by its documentation:
/// the pairs, their order, events, manifolds and indices in the last frame. The model stores whole
/// frames and compares all pairs with all.
class ContactsModel {
 public:
  /// Aborts with a message if `contacts`, which `scene` has just filled, differs from the model.
  void check(const ModelScene& world, const Scene& scene, ContactLevel level,
             const Contacts& contacts, PairReference& reference);
  /// Makes the next frame the first one: it has no predecessor.
  void forget();

  /// Number of manifolds so far that were computed before a move and kept unchanged.
  std::uint64_t cached = 0;

 private:
  /// Two bodies in the order of contacts, and the kinds of their shapes: if the order or the kinds
  /// change, the pair begins anew.
  struct Name {
    ClientData a;
    ClientData b;
    std::uint32_t kinds;

    friend auto operator<=>(const Name&, const Name&) = default;
  };
  /// A state in which the reported manifolds may have been computed.
  struct Origin {
    Pose pose[2];
    std::uint64_t reshaped[2];
    std::uint64_t surfaces_changed;
    ModelManifolds made;
  };
  struct Kept {
    std::uint64_t order = 0;
    EndedContact ended{};
    /// The origins that explain the last reported manifolds.
    std::vector<Origin> origins{};
  };
  using KeptPairs = std::map<Name, Kept>;
  /// A pair in the order of contacts.
  struct Sides {
    const ModelBody& a;
    const ModelBody& b;
  };

  [[nodiscard]] static Sides sides(const ModelBody& one, const ModelBody& other);
  [[nodiscard]] static Name name_of(const Sides& pair);
  [[nodiscard]] static Kept new_pair(const Sides& pair);
  [[nodiscard]] KeptPairs list_shown(const ModelScene& world, const Contacts& contacts) const;
  void check_pairs(const ModelScene& world, ContactLevel level, const Contacts& contacts,
                   PairReference& reference, KeptPairs& shown);
  void check_shown(const ModelScene& world, ContactLevel level, const ModelManifolds& now,
                   const Sides& pair, const ModelManifolds& fresh, Kept& kept);
  static void check_not_shown(const ModelScene& world, ContactLevel level, const Sides& pair,
                              const ModelManifolds& fresh);
  void check_events(const ModelScene& world, const Contacts& contacts, const KeptPairs& shown);
  void check_ended(const Contacts& contacts, std::vector<Kept>& ended,
                   std::vector<Kept>& ended_asleep) const;
  void check_places(const ModelScene& world, const Scene& scene, ContactLevel level,
                    const Contacts& contacts);
  [[nodiscard]] bool keeps_manifolds(const ModelScene& world, ContactLevel level,
                                     const Sides& pair) const;

  std::optional<ContactLevel> level_;
  KeptPairs shown_;
  KeptPairs dormant_;
  HistoryReference history_;
};

}  // namespace winnow::test
