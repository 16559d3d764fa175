#pragma once

#include <winnow/winnow.h>

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tests/pipeline/history_twin.h"

namespace winnow::test {

/// A body as the program defined it. Its client data is its own.
struct ModelBody {
  BodyDefinition definition;
  Key key;
  /// Grows when the shape or the offsets change.
  std::uint64_t reshaped = 0;
};

/// What a program told a scene, in plain containers.
struct ModelScene {
  using Names = std::pair<ClientData, ClientData>;

  const ShapePool& shapes;
  const CompositePool& composites;
  SceneOptions options;
  std::map<ClientData, ModelBody> bodies{};
  /// Of two each, the smaller first.
  std::set<Names> ignored{};
  std::set<std::pair<std::uint16_t, std::uint16_t>> layers_apart{};
  /// Grows when a mesh or a field changes in place.
  std::uint64_t surfaces_changed = 0;

  [[nodiscard]] bool may_pair(const ModelBody& a, const ModelBody& b) const;
  /// The pair is a contact up to this distance, before rest offsets are counted.
  [[nodiscard]] double gap(const ModelBody& a, const ModelBody& b) const;
  [[nodiscard]] double radius(const ModelBody& body) const;
  /// As far as it matters to the two.
  [[nodiscard]] std::uint64_t surfaces_changed_of(const ModelBody& a, const ModelBody& b) const;
};

/// One manifold as a Contacts shows it.
struct ModelManifold {
  std::uint32_t part[2] = {kWholeShape, kWholeShape};
  double distance = 0.0;
  double error_bound = 0.0;
  double normal[3] = {};
  double point[3] = {};  ///< at level distance
  std::vector<ContactPoint> points{};
};
using ModelManifolds = std::vector<ModelManifold>;

/// Each pair's contacts from the two bodies only: by the narrow phase's call for one pair of convex
/// shapes, by a new scene of two bodies for others. No manifolds: the pair does not touch.
class PairReference {
 public:
  [[nodiscard]] const ModelManifolds& contacts(const ModelScene& world, ContactLevel level,
                                               const ModelBody& a, const ModelBody& b);
  /// The distance of two convex shapes, whatever their gap, before rest offsets are counted.
  [[nodiscard]] static PairAnswer distance(const ModelScene& world, const ModelBody& a,
                                           const ModelBody& b);

 private:
  /// What an answer was computed from.
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

/// What Contacts have to show after each call of Scene::collide, by their documentation: which
/// pairs, in which order, with which events, manifolds and places in the last frame. It keeps
/// whole frames and compares all with all.
class ContactsModel {
 public:
  /// Aborts with a message if `contacts`, which `scene` just filled, show anything else.
  void check(const ModelScene& world, const Scene& scene, ContactLevel level,
             const Contacts& contacts, PairReference& reference);
  /// The contacts remember nothing.
  void forget();

  /// Manifolds that stayed as they were made before a move, since the start.
  std::uint64_t carried = 0;

 private:
  /// Two bodies in the order of contacts, and the kinds of their shapes: in another order or with
  /// other kinds they begin anew.
  struct Name {
    ClientData a;
    ClientData b;
    std::uint32_t kinds;

    friend auto operator<=>(const Name&, const Name&) = default;
  };
  /// When and as what shown manifolds may have been made.
  struct Origin {
    Pose pose[2];
    std::uint64_t reshaped[2];
    std::uint64_t surfaces_changed;
    ModelManifolds made;
  };
  struct Kept {
    std::uint64_t order = 0;
    EndedContact ended{};
    /// Those that explain what was shown last.
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
  HistoryTwin history_;
};

}  // namespace winnow::test
