#pragma once

#include <vector>

#include "robotteamsim/hazards/air.hpp"
#include "robotteamsim/hazards/fire.hpp"
#include "robotteamsim/hazards/links.hpp"

namespace robotteamsim::hazards {

/// A door as an obstacle for fire and smoke.
struct DoorModel {
  bool closed = false;
  double open_share = 1.0;    ///< of the air of a link that passes each link through the open door
  double closed_share = 0.0;  ///< the same when it is closed
  double endures_s = 0.0;     ///< a closed door burns through after so long beside flames; negative: never
};

/// What a fire gives to the air of its cell, per heat that it releases.
struct Yields {
  double soot_g_kj = 0.003;
  double warmth = 0.7;  ///< share of the heat that warms the air
};

/// Fire, smoke, heat and doors of one plan.
class BurningFloor {
 public:
  /// Args: doors: as many as the links have.  openings: between levels, for the air.
  /// Throws std::invalid_argument: a number is wrong.
  BurningFloor(Links links, Fire fire, const AirModel& air, const Yields& yields, std::vector<DoorModel> doors,
               std::vector<OpeningCell> openings = {});

  /// Ignites a cell, row * cols + column; returns false if it cannot burn.
  bool Ignite(int cell);

  /// Opens or closes a door; one that has burnt through stays open.
  void SetDoor(int door, bool closed);

  /// Lets everything burn, spread and cool for some time [s].
  void Advance(double seconds);

  /// The state of each cell, row by row, as all values below.
  std::vector<Burning> States() const;

  /// Soot above each square metre [g/m^2].
  std::vector<double> Soot() const;

  /// Soot in the air if it fills a height [m] evenly [g/m^3]. Throws std::invalid_argument if the height is not above
  /// 0.
  std::vector<float> SootDensity(double height_m) const;

  /// Temperature of the air [degC]; where it burns, at least that of flames.
  /// Throws std::invalid_argument if a number is not finite.
  std::vector<float> Temperature(float ambient_c, float flame_c) const;

  const Links& links() const { return links_; }
  const Fire& fire() const { return fire_; }
  const Air& air() const { return air_; }
  bool IsBurntThrough(int door) const { return is_burnt_through_.at(door); }

 private:
  void Apply(int door);

  Links links_;
  Fire fire_;
  Air air_;
  double cell_area_m2_;
  Yields yields_;
  std::vector<DoorModel> doors_;
  std::vector<double> heated_s_;  ///< time beside flames
  std::vector<bool> is_burnt_through_;
};

}  // namespace robotteamsim::hazards
