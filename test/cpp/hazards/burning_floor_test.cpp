#include "robotteamsim/hazards/burning_floor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robotteamsim::hazards {
namespace {

constexpr int kRows = 3, kCols = 5, kCell = 1 * kCols + 3;

/// One room whose only fuel is in row 1, column 3. No heat is lost, and nothing spreads within a step.
BurningFloor OneFuel() {
  const std::vector<std::uint8_t> open(kRows * kCols, 1);
  Links links(kRows, kCols, open, open, {}, 0);
  std::vector<int> fuel(kRows * kCols, -1);
  fuel[kCell] = 0;
  Fire fire(links, {{1000.0, 50.0, 50.0}}, fuel, 1.0);
  AirModel air;
  air.cell_m = 0.5;
  air.diffusivity_m2_s = 1e-9;
  air.convection_kw_m2_k = air.emissivity = 0.0;
  return BurningFloor(std::move(links), std::move(fire), air, {0.004, 0.7}, {});
}

TEST(BurningFloor, ValuesAreRowByRowWithoutABorder) {
  BurningFloor floor = OneFuel();
  EXPECT_EQ(floor.States(), std::vector<Burning>(kRows * kCols, Burning::kNot));
  ASSERT_TRUE(floor.Ignite(kCell));
  floor.Advance(2.0);
  for (int cell = 0; cell < kRows * kCols; ++cell) {
    EXPECT_EQ(floor.States()[cell], cell == kCell ? Burning::kBurns : Burning::kNot);
    EXPECT_EQ(floor.Soot()[cell] > 1e-6, cell == kCell);
    EXPECT_EQ(floor.Temperature(20.0F, 0.0F)[cell] > 20.01F, cell == kCell);
  }
}

TEST(BurningFloor, SootIsItsYieldOfTheHeatPerArea) {
  BurningFloor floor = OneFuel();
  floor.Ignite(kCell);
  floor.Advance(2.0);
  ASSERT_EQ(floor.fire().releases().size(), 1U);
  const double heat = floor.fire().releases()[0].heat_kj;
  const std::vector<double> soot = floor.Soot();
  EXPECT_NEAR(std::accumulate(soot.begin(), soot.end(), 0.0), 0.004 * heat / 0.25, 1e-12);
  EXPECT_NEAR(floor.SootDensity(2.5)[kCell], soot[kCell] / 2.5, 1e-6 * soot[kCell]);
}

TEST(BurningFloor, IsAtLeastAsHotAsFlamesWhereItBurnsOnly) {
  BurningFloor floor = OneFuel();
  floor.Ignite(kCell);
  floor.Advance(0.1);
  const std::vector<float> temperature = floor.Temperature(20.0F, 820.0F);
  EXPECT_EQ(temperature[kCell], 820.0F);
  EXPECT_EQ(std::count(temperature.begin(), temperature.end(), 820.0F), 1);
  floor.Advance(1000.0);  // it has burnt out
  floor.Advance(1.0);
  EXPECT_EQ(floor.States()[kCell], Burning::kBurntOut);
  EXPECT_NE(floor.Temperature(20.0F, 1e6F)[kCell], 1e6F);
}

/// Returns the soot beyond a door after a step, of which each link through the door passes a share.
double SootBeyond(double open_share) {
  const std::vector<std::uint8_t> open(kRows * kCols, 1);
  std::vector<Crossing> crossings;
  for (int row = 0; row < kRows; ++row) crossings.push_back({0, row * kCols + 3, true});
  Links links(kRows, kCols, open, open, crossings, 1);
  std::vector<int> fuel(kRows * kCols, -1);
  fuel[kCell] = 0;
  Fire fire(links, {{1000.0, 50.0, 50.0}}, fuel, 1.0);
  AirModel air;
  air.cell_m = 0.5;
  air.diffusivity_m2_s = 0.01;
  BurningFloor floor(std::move(links), std::move(fire), air, {0.004, 0.7}, {{false, open_share, 0.0, -1.0}});
  floor.Ignite(kCell);
  floor.Advance(1.0);
  const std::vector<double> soot = floor.Soot();
  return soot[4] + soot[kCols + 4] + soot[2 * kCols + 4];
}

TEST(BurningFloor, LinksThroughAnOpenDoorCarryItsShare) {
  EXPECT_NEAR(SootBeyond(1.5), 1.5 * SootBeyond(1.0), 1e-8);
  EXPECT_NEAR(SootBeyond(0.4), 0.4 * SootBeyond(1.0), 1e-8);
}

TEST(BurningFloor, RefusesSharesAndGapsThatCannotBe) {
  EXPECT_THROW(SootBeyond(2.1), std::invalid_argument);
  EXPECT_THROW(SootBeyond(-0.1), std::invalid_argument);
  const std::vector<std::uint8_t> open(1, 1);
  const Links links(1, 1, open, open, {}, 0);
  for (const double gap : {-1.0, 101.0, std::nan("")}) {
    EXPECT_THROW(Fire(links, {{1000.0, 50.0, 50.0}}, {0}, gap), std::invalid_argument);
  }
}

TEST(BurningFloor, RefusesAHeightOfZeroAndTemperaturesThatAreNotFinite) {
  const BurningFloor floor = OneFuel();
  EXPECT_THROW(floor.SootDensity(0.0), std::invalid_argument);
  EXPECT_THROW(floor.Temperature(std::nanf(""), 820.0F), std::invalid_argument);
  EXPECT_THROW(floor.Temperature(20.0F, INFINITY), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::hazards
