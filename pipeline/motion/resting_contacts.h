#pragma once

#include "pipeline/motion/moving_pair.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow::impact {

/// How shapes that overlap at the start of their motions are treated.
enum class StartTouch : std::uint8_t {
  impact,                ///< an impact at time 0
  ignored,               ///< no impact
  impact_unless_sliding  ///< an impact at time 0 unless they slide or separate there
};

/// The contacts of two bodies at the start of their motions. Bodies slide or separate at a contact
/// if, during the whole motion, the gap of the two parts along the contact's normal stays positive
/// or, if the parts overlap at the start, does not fall below the initial gap, up to the tolerance.
/// Then no impact is reported for other parts either whose gap along this normal is at least as
/// large.
class RestingContacts {
 public:
  /// Parts are in contact if their distance is at most share * size + length. Overlapping parts may
  /// get deeper by at most the same amount. With StartTouch::impact, overlapping parts are an
  /// impact and not a contact.
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
  struct RestingContact {
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
                          RestingContact& contact) const noexcept;
  [[nodiscard]] bool parts(const RestingContact& contact, OrderedPair& pair) const noexcept;
  void keep(const RestingContact& contact) noexcept;

  /// Further contacts are not stored. A body that slides along a contact that is not stored may be
  /// reported to hit other parts that are flush with it.
  static constexpr std::size_t kMaxContacts = 8;

  double share_;
  double length_;
  StartTouch touch_;
  std::size_t count_ = 0;
  std::array<RestingContact, kMaxContacts> contacts_;
};

}  // namespace winnow::impact
