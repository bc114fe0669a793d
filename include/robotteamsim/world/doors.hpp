#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/solid.hpp"

class b2Body;
class b2World;

namespace robotteamsim::world {

/// The leaf of a door that swings or slides. It never pushes: it waits while something blocks it.
struct MovingLeaf {
  int door = 0;              ///< whose leaf it is
  double opening = 0.0;      ///< 0: across its gap, 1: open
  bool shall_close = false;  ///< its target: closed or open
  bool is_held = false;      ///< whether something blocked it in the last step
  Polygon outline;           ///< where it is now
  double reach_m = 0.0;      ///< its greatest distance from the hinge in any position

  bool IsThere() const { return opening == (shall_close ? 0.0 : 1.0); }
};

/// The motion of a leaf.
enum class LeafActivity { kStill, kOpens, kCloses, kHeld };

/// Returns the name of an activity: still, opens, closes or held.
const char* NameOf(LeafActivity activity);

/// The state of a door after a step.
struct DoorState {
  bool closed = true;                            ///< whether the leaf is all across its gap
  double opening = 0.0;                          ///< 0: closed, 1: open; 0 or 1 for a door without a moving leaf
  LeafActivity activity = LeafActivity::kStill;  ///< kHeld: something blocks it

  bool operator==(const DoorState& other) const {
    return closed == other.closed && opening == other.opening && activity == other.activity;
  }
};

/// The doors of a world, in their order.
class Doors {
 public:
  /// Returns whether something blocks a leaf that moves from one outline to the next.
  using IsBlocked = std::function<bool(const Polygon& now, const Polygon& next)>;

  /// Throws std::invalid_argument if a motion is not finite or takes a negative time.
  explicit Doors(std::vector<Door> doors);

  /// Restarts with the doors as at the start, in a new Box2D world with this origin.
  void Place(b2World& box, const base::Point& origin);

  /// Closes or opens a door: instantly, or by its leaf in the next steps.
  void SetClosed(int door, bool closed);

  /// Moves the leaves for a time [s], as far as nothing blocks them.
  void Advance(double time_s, const IsBlocked& is_blocked);

  const std::vector<Door>& all() const { return doors_; }
  const std::vector<MovingLeaf>& leaves() const { return leaves_; }

  /// All doors as of the last UpdateStates.
  const std::vector<DoorState>& states() const { return states_; }
  /// 0 at the start; it grows with every change: equal versions mean equal states.
  std::int64_t version() const { return version_; }
  /// Updates the states after a step.
  void UpdateStates();

  /// Returns how far any moving leaf moves at most in a time [m].
  double Travel(double time_s) const;
  /// Returns whether a leaf that swings or slides is within a distance of a point.
  bool IsLeafNear(const base::Point& point, double distance_m) const;

 private:
  Polygon OutlineAt(const MovingLeaf& leaf, double opening) const;
  double Pace(const MovingLeaf& leaf) const;
  void PutBody(const MovingLeaf& leaf);
  void GoOn(MovingLeaf& leaf, double time_s, const IsBlocked& is_blocked);

  const std::vector<Door> first_;
  base::Point origin_;
  std::vector<Door> doors_;
  std::vector<MovingLeaf> leaves_;
  std::vector<b2Body*> bodies_;
  std::vector<DoorState> states_;
  std::int64_t version_ = -1;
};

}  // namespace robotteamsim::world
