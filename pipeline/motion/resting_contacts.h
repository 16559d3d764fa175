#pragma once

#include "pipeline/motion/moving_pair.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow::impact {

/// What becomes of shapes that share a point at the start of their motions.
enum class StartTouch : std::uint8_t {
  meets,      ///< they meet at time 0
  left_out,   ///< they do not meet
  is_entered  ///< they meet at time 0 unless they slide or part there
};

/// The contacts that two bodies have at the start of their motions. A motion slides or parts there
/// if the normal of a contact parts the parts in contact all the time, but for the depth that they
/// have. Other parts of the bodies that lie flush with these, or lower, do not meet then either.
class RestingContacts {
 public:
  /// Parts are in contact that are no farther apart than a share of their size and a length. Those
  /// that share a point do not get deeper if it is by no more than that; they are no contacts if
  /// they meet at the start.
  RestingContacts(double share, double length, StartTouch touch) noexcept
      : share_(share), length_(length), touch_(touch) {}

  /// Notes the contact of two convex parts, if they have one.
  void note(const ShapeTables& tables, const MovingPart& a, const MovingPart& b) noexcept;
  /// True if none was noted.
  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  /// True if two parts slide or part along their own contact or along one that was noted.
  [[nodiscard]] bool part(const ShapeTables& tables, const MovingPart& a,
                          const MovingPart& b) const noexcept;

 private:
  struct Contact {
    /// Unit, from a to b.
    Vec normal;
    /// Along it, in the caller's lengths; below 0 where the parts overlap.
    double gap;
    /// The gap is surely above 0, and must stay so.
    bool apart;
  };
  class OrderedPair;

  [[nodiscard]] double tolerance(const MovingPair& pair) const noexcept;
  [[nodiscard]] bool find(const ShapeTables& tables, OrderedPair& pair,
                          Contact& contact) const noexcept;
  [[nodiscard]] bool parts(const Contact& contact, OrderedPair& pair) const noexcept;
  void keep(const Contact& contact) noexcept;

  /// Contacts along further normals are not kept: what slides along these may meet other parts.
  static constexpr std::size_t kMost = 8;

  double share_;
  double length_;
  StartTouch touch_;
  std::size_t count_ = 0;
  std::array<Contact, kMost> contacts_;
};

}  // namespace winnow::impact
