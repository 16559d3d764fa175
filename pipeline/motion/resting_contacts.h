#pragma once

#include "pipeline/motion/moving_pair.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow::impact {

/// How shapes that overlap at the start of their motions are treated.
enum class StartTouch : std::uint8_t {
  meets,                 ///< an impact at time 0
  ignored,               ///< no impact
  impact_unless_sliding  ///< an impact at time 0 unless they slide or separate there
};

/// The contacts of two bodies at the start of their motions. Bodies slide or separate at a contact
/// if its normal separates the parts in contact all the time, up to their initial depth. Other
/// parts of the bodies that are flush with these parts, or lower, are then not hit either.
class RestingContacts {
 public:
  /// Parts are in contact if their distance is at most share * size + length. Overlapping parts may
  /// get deeper by at most the same amount. They are not contacts if `touch` makes them an impact.
  RestingContacts(double share, double length, StartTouch touch) noexcept
      : share_(share), length_(length), touch_(touch) {}

  /// Records the contact of two convex parts, if they have one.
  void record(const ShapeTables& tables, const MovingPart& a, const MovingPart& b) noexcept;
  /// Returns whether no contact was recorded.
  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  /// Returns whether two parts slide or separate along their own contact or along a recorded one.
  [[nodiscard]] bool part(const ShapeTables& tables, const MovingPart& a,
                          const MovingPart& b) const noexcept;

 private:
  struct Contact {
    /// Unit vector from a to b.
    Vec normal;
    /// The gap along the normal, in the caller's lengths; negative if the parts overlap.
    double gap;
    /// The gap is certainly positive, and must remain so.
    bool apart;
  };
  class OrderedPair;

  [[nodiscard]] double tolerance(const MovingPair& pair) const noexcept;
  [[nodiscard]] bool find(const ShapeTables& tables, OrderedPair& pair,
                          Contact& contact) const noexcept;
  [[nodiscard]] bool parts(const Contact& contact, OrderedPair& pair) const noexcept;
  void keep(const Contact& contact) noexcept;

  /// Contacts beyond these are not stored; a motion that slides along them may then hit other
  /// parts.
  static constexpr std::size_t kMaxContacts = 8;

  double share_;
  double length_;
  StartTouch touch_;
  std::size_t count_ = 0;
  std::array<Contact, kMaxContacts> contacts_;
};

}  // namespace winnow::impact
