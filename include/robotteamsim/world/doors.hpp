#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/solid.hpp"

class b2Body;
class b2World;

namespace robotteamsim::world {

/// The leaf of a door that swings or slides. It never pushes: it waits while anything is in its way.
struct MovingLeaf {
  int door = 0;              ///< whose leaf it is
  double opening = 0.0;      ///< 0: across its gap, 1: open
  bool shall_close = false;  ///< where it goes
  bool is_held = false;      ///< whether something was in its way in the last step
  Polygon outline;           ///< where it is now
  double reach = 0.0;        ///< how far from the hinge it is at most, wherever it is [m]

  bool IsThere() const { return opening == (shall_close ? 0.0 : 1.0); }
};

/// What the leaf of a door does.
enum class LeafActivity { kStill, kOpens, kCloses, kHeld };

/// A door after a step.
struct DoorState {
  bool closed = true;                            ///< whether the leaf is all across its gap
  double opening = 0.0;                          ///< 0: closed, 1: open; a door without a moving leaf has one of both
  LeafActivity activity = LeafActivity::kStill;  ///< kHeld: something is in its way

  bool operator==(const DoorState& other) const {
    return closed == other.closed && opening == other.opening && activity == other.activity;
  }
};

/// The doors of a world, in their order.
class Doors {
 public:
  /// Whether a leaf that goes from its first to its second outline comes nearer to something in its way.
  using IsBlocked = std::function<bool(const Polygon& now, const Polygon& next)>;

  /// Throws std::invalid_argument on a motion that cannot be.
  explicit Doors(std::vector<Door> doors);

  /// Begins again with the doors as they were first, in a new Box2D world that counts from origin.
  void Place(b2World& box, const base::Point& origin);

  /// Has a door closed or opened: at once, or by its leaf in the steps to come.
  void SetClosed(int door, bool closed);

  /// Moves the leaves on by a time [s], as far as nothing is in the way.
  void Advance(double time, const IsBlocked& is_blocked);

  const std::vector<Door>& all() const { return doors_; }
  const std::vector<MovingLeaf>& leaves() const { return leaves_; }

  /// All doors as of the last UpdateStates.
  const std::vector<DoorState>& states() const { return states_; }
  /// 0 at the start, and grows whenever a state changes: equal versions mean equal states.
  std::int64_t version() const { return version_; }
  /// Takes over what the doors did, once per step.
  void UpdateStates();

  /// How far any leaf that is on its way moves at most in a time [m].
  double Travel(double time) const;
  /// Whether a leaf that swings or slides is within a distance of a point.
  bool IsLeafNear(const base::Point& point, double distance) const;

 private:
  Polygon OutlineAt(const MovingLeaf& leaf, double opening) const;
  double Pace(const MovingLeaf& leaf) const;
  void PutBody(const MovingLeaf& leaf);
  void GoOn(MovingLeaf& leaf, double time, const IsBlocked& is_blocked);

  const std::vector<Door> first_;
  base::Point origin_;
  std::vector<Door> doors_;
  std::vector<MovingLeaf> leaves_;
  std::vector<b2Body*> bodies_;
  std::vector<DoorState> states_;
  std::int64_t version_ = -1;
};

}  // namespace robotteamsim::world
