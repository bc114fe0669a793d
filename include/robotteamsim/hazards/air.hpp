#pragma once

#include <vector>

#include "robotteamsim/hazards/links.hpp"

namespace robotteamsim::hazards {

/// How smoke and heat spread over a floor, and how heat is lost; docs/fire.md has the equations.
struct AirModel {
  double cell_m = 0.5;  ///< size of a cell
  double diffusivity_m2_s = 0.25;
  double ambient_k = 293.15;
  double heat_capacity_kj_m2_k = 3.14;  ///< of the air above a square metre
  double convection_kw_m2_k = 0.010;
  double emissivity = 0.8;
  double height_m = 2.6;  ///< over which smoke mixes
};

/// A cell over which a floor is open, and the cell below it: their air is exchanged through the opening.
struct OpeningCell {
  int above = 0;  ///< row * cols + column
  int below = 0;
  double share = 1.0;    ///< of the cell that is open
  double area_m2 = 1.0;  ///< of the whole opening
  double rise_m = 3.0;   ///< from floor to floor
};

/// Soot and heat in the air of each cell. Soot only moves: its mass is conserved.
///
/// Through openings in floors, the same volume of air flows up as down: by the diffusivity and, where the air below is
/// hotter, by buoyancy.
class Air {
 public:
  /// Throws std::invalid_argument: a number of the model or an opening is out of range.
  Air(const AirModel& model, const Links& links, std::vector<OpeningCell> openings = {});

  /// Adds soot [g/m^2] and heat [kJ/m^2] to a cell.
  /// Throws std::invalid_argument: it has more than single precision can hold in what follows, 1e12 K or 1e28 g/m^2.
  void Add(int padded, double soot_g_m2, double heat_kj_m2);

  /// Lets soot and heat spread through the links, and heat be lost, for some time [s].
  void Advance(const Links& links, double seconds);

  /// Soot of each cell, with a border [g/m^2].
  const std::vector<double>& soot() const { return soot_; }
  /// Temperature above the ambient one, with a border [K].
  const std::vector<float>& excess() const { return excess_; }

 private:
  void Spread(const Links& links, double share, int passes);
  void Exchange(int stride, double seconds);
  void Cool(int stride, double seconds);

  AirModel model_;
  std::vector<OpeningCell> openings_;  ///< of cells with a border
  int rows_;
  std::vector<double> soot_;
  std::vector<float> excess_;  ///< single precision, because heat is lost anyway
  std::vector<double> soot_after_;
  std::vector<float> excess_after_;
  std::vector<double> soot_from_south_;  ///< of one row, in the order in which rows are computed
  std::vector<float> excess_from_south_;
  int first_;  ///< rows, with the border, that have soot or heat
  int last_;
};

}  // namespace robotteamsim::hazards
