// Smoke and heat against a straightforward computation, cell by cell.
#include "robotteamsim/hazards/air.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "robotteamsim/hazards/links.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr int kRows = 7, kCols = 19;
constexpr double kCell = 0.5, kDiffusivity = 0.25;

std::vector<std::uint8_t> Pattern(int period) {
  std::vector<std::uint8_t> links(kRows * kCols);
  for (int i = 0; i < kRows * kCols; ++i) links[i] = i % period == 0 ? 0 : 1;
  return links;
}

// One step of explicit diffusion between linked neighbours.
std::vector<double> Plain(const std::vector<double>& from, const std::vector<std::uint8_t>& east,
                          const std::vector<std::uint8_t>& north, double share) {
  std::vector<double> to = from;
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const int cell = row * kCols + col;
      if (col + 1 < kCols && east[cell] != 0) {
        to[cell] += share * (from[cell + 1] - from[cell]);
        to[cell + 1] -= share * (from[cell + 1] - from[cell]);
      }
      if (row + 1 < kRows && north[cell] != 0) {
        to[cell] += share * (from[cell + kCols] - from[cell]);
        to[cell + kCols] -= share * (from[cell + kCols] - from[cell]);
      }
    }
  }
  return to;
}

AirModel WithoutLosses() {
  AirModel model;
  model.cell_m = kCell;
  model.diffusivity_m2_s = kDiffusivity;
  model.heat_capacity_kj_m2_k = 2.0;
  model.convection_kw_m2_k = 0.0;
  model.emissivity = 0.0;
  return model;
}

TEST(Air, SpreadsAsAStraightforwardComputationDoes) {
  const auto east = Pattern(5), north = Pattern(4), none = Pattern(1);
  const Links links(kRows, kCols, east, north, {}, 0);
  Air air(WithoutLosses(), links);
  std::vector<double> soot(kRows * kCols, 0.0);
  soot[3 * kCols + 8] = 5.0;
  air.Add(links.Padded(3 * kCols + 8), 5.0, 0.0);
  for (int second = 0; second < 30; ++second) {
    air.Advance(links, 1.0);
    // 1 s is three passes, in each of which a third flows (0.25 / 0.25 = 1): first along rows, then across them.
    for (int pass = 0; pass < 3; ++pass) soot = Plain(Plain(soot, east, none, 1.0 / 3.0), none, north, 1.0 / 3.0);
  }
  for (int cell = 0; cell < kRows * kCols; ++cell) EXPECT_NEAR(air.soot()[links.Padded(cell)], soot[cell], 1e-12);
}

TEST(Air, KeepsAllSootWhileDoorsChange) {
  std::vector<Crossing> crossings;
  std::vector<std::uint8_t> east(kRows * kCols, 1);
  for (int row = 0; row < kRows; ++row) {
    if (row == 3) {
      crossings.push_back({0, row * kCols + 9, true});
    } else {
      east[row * kCols + 9] = 0;
    }
  }
  Links links(kRows, kCols, east, std::vector<std::uint8_t>(kRows * kCols, 1), crossings, 1);
  Air air(WithoutLosses(), links);
  air.Add(links.Padded(3 * kCols + 2), 7.0, 3.0);
  for (int second = 0; second < 1000; ++second) {
    links.SetDoor(0, second % 3 == 0 ? 1.0 : second % 3 == 1 ? 0.01 : 0.0, true);
    air.Advance(links, 1.0);
    EXPECT_NEAR(std::accumulate(air.soot().begin(), air.soot().end(), 0.0), 7.0, 7e-12);
  }
  EXPECT_GT(air.soot()[links.Padded(3 * kCols + 15)], 0.0);
}

TEST(Air, PassesNoClosedDoor) {
  const std::vector<std::uint8_t> all(kRows * kCols, 1);
  std::vector<Crossing> crossings;
  for (int row = 0; row < kRows; ++row) crossings.push_back({0, row * kCols + 9, true});
  Links links(kRows, kCols, all, all, crossings, 1);
  links.SetDoor(0, 0.0, true);
  Air air(WithoutLosses(), links);
  air.Add(links.Padded(2), 1.0, 1.0);
  for (int second = 0; second < 500; ++second) air.Advance(links, 1.0);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 10; col < kCols; ++col) {
      EXPECT_EQ(air.soot()[links.Padded(row * kCols + col)], 0.0);
      EXPECT_EQ(air.excess()[links.Padded(row * kCols + col)], 0.0F);
    }
  }
}

TEST(Air, CoolsByConvectionAtTheRateOfItsModel) {
  const Links links(1, 1, {1}, {1}, {}, 0);
  AirModel model = WithoutLosses();
  model.convection_kw_m2_k = 0.01;
  Air air(model, links);
  air.Add(links.Padded(0), 0.0, 200.0);  // 100 K
  for (int second = 0; second < 60; ++second) air.Advance(links, 1.0);
  // x' = -2 h / C x, implicit steps of 1 s.
  EXPECT_NEAR(air.excess()[links.Padded(0)], 100.0 * std::pow(1.0 / 1.01, 60), 1e-3);
}

// Two cells without links, one above the other.
const Links kApart(1, 2, {0, 0}, {0, 0}, {}, 0);

TEST(Air, ExchangesSootThroughAnOpeningByTheDiffusivity) {
  // A quarter of the cell is open: 0.25 m^2/s over 3 m carry a quarter of it to and fro, of air of 2.6 m.
  Air air(WithoutLosses(), kApart, {{0, 1, 0.25, 4.0, 3.0}});
  air.Add(kApart.Padded(1), 8.0, 0.0);
  for (int second = 0; second < 100; ++second) air.Advance(kApart, 1.0);
  const double above = air.soot()[kApart.Padded(0)], below = air.soot()[kApart.Padded(1)];
  EXPECT_NEAR(above + below, 8.0, 1e-12);
  EXPECT_NEAR(below - above, 8.0 * std::exp(-2.0 * 0.25 * 0.25 / 3.0 / 2.6 * 100.0), 1e-9);
}

TEST(Air, HotAirRisesThroughAnOpeningAsInCfast) {
  // 100 K in the cell below. vex of CFAST's ventcf in terms of densities, of air at 1 atm.
  const double density_above = 353.0 / 293.15, density_below = 353.0 / 393.15;
  const double by_buoyancy = 0.1 *
                             std::sqrt(2.0 * 9.80665 * (density_above - density_below) * std::sqrt(std::pow(4.0, 5)) /
                                       (density_above + density_below)) /
                             4.0;
  for (const bool is_hot_below : {true, false}) {
    Air air(WithoutLosses(), kApart, {{0, 1, 1.0, 4.0, 3.0}});
    const int hot = kApart.Padded(is_hot_below ? 1 : 0), other = kApart.Padded(is_hot_below ? 0 : 1);
    air.Add(hot, 1.0, 200.0);
    air.Advance(kApart, 1e-3);
    const double flow_mps = 0.25 / 3.0 + (is_hot_below ? by_buoyancy : 0.0);
    EXPECT_NEAR(air.soot()[other], flow_mps / 2.6 * 1e-3, 1e-7);
    EXPECT_NEAR(air.excess()[other], 100.0 * flow_mps / 2.6 * 1e-3, 1e-5);
    EXPECT_NEAR(air.excess()[hot] + air.excess()[other], 100.0, 1e-4);
  }
}

TEST(Air, RejectsOpeningsThatJoinNoTwoCells) {
  EXPECT_THROW(Air(AirModel(), kApart, {{0, 2, 1.0, 1.0, 3.0}}), std::invalid_argument);
  EXPECT_THROW(Air(AirModel(), kApart, {{1, 1, 1.0, 1.0, 3.0}}), std::invalid_argument);
  EXPECT_THROW(Air(AirModel(), kApart, {{0, 1, 0.0, 1.0, 3.0}}), std::invalid_argument);
  EXPECT_THROW(Air(AirModel(), kApart, {{0, 1, 1.0, 1.0, -3.0}}), std::invalid_argument);
}

TEST(Air, RejectsImpossibleNumbers) {
  const Links links(1, 1, {1}, {1}, {}, 0);
  AirModel model;
  model.cell_m = 0.0;
  EXPECT_THROW(Air(model, links), std::invalid_argument);
  Air air(AirModel(), links);
  EXPECT_THROW(air.Advance(links, -1.0), std::invalid_argument);
}

TEST(Air, RejectsMoreHeatThanSinglePrecisionHolds) {
  const Links links(1, 1, {1}, {1}, {}, 0);
  AirModel model;
  model.heat_capacity_kj_m2_k = 1.0;
  model.emissivity = 0.0;
  // Up to 1e12 K, (x + 4 a) x^2 + ... is within 3.4e38; from 7e12 K on it is infinite, and 0 times it not a number.
  Air warm(model, links);
  warm.Add(links.Padded(0), 0.0, 1e12);
  warm.Advance(links, 1.0);
  EXPECT_NEAR(warm.excess()[links.Padded(0)], 1e12 / 1.02, 1e6);  // 2 h / C = 0.02 in one implicit step
  EXPECT_THROW(Air(model, links).Add(links.Padded(0), 0.0, 1e13), std::invalid_argument);
  EXPECT_THROW(Air(model, links).Add(links.Padded(0), 1e29, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::hazards
