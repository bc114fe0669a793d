// The network of a team: signals of all links among 107 walls (428 faces), hops and Fiedler values; beside one ray and
// one logarithm per link, breadth-first search from one robot after the other, and all eigenvalues of the Laplacian.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

#include "../../test/cpp/network/graphs.hpp"
#include "../../test/cpp/propagation/scenes.hpp"
#include "robotteamsim/base/large_pages.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/propagation/radio.hpp"

namespace robotteamsim {
namespace {

const propagation::RadioModel kModel{0.0, 0.0, 0.0, 0.1};
constexpr double kWeakestLinkDbm = -80.0;

const propagation::FaceSet& Garage() {
  static const propagation::FaceSet faces = [] {
    std::mt19937 generator(3);
    return propagation::scenes::Walls(&generator, 107, 10, 6000);
  }();
  return faces;
}

propagation::Positions Team(int num_robots) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> x(0.0, 60.0), y(0.0, 40.0);
  propagation::Positions positions(num_robots, 2);
  for (int i = 0; i < num_robots; ++i) positions.row(i) << x(generator), y(generator);
  return positions;
}

void CountLinks(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(0) * (state.range(0) - 1) / 2);
}

void Links(benchmark::State& state) {
  const propagation::Positions positions = Team(static_cast<int>(state.range(0)));
  propagation::CellValues rssi_dbm(positions.rows(), positions.rows());
  base::AskForLargePages(rssi_dbm.data(), static_cast<std::size_t>(rssi_dbm.size()) * sizeof(double));  // as NumPy does
  for (auto _ : state) {
    propagation::WriteRssiMatrixDbm(Garage(), kModel, positions, rssi_dbm);
    benchmark::ClobberMemory();
  }
  CountLinks(state);
}

void LinksInFreshMemory(benchmark::State& state) {
  const propagation::Positions positions = Team(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(propagation::RssiMatrixDbm(Garage(), kModel, positions));
  CountLinks(state);
}

void LinksPlain(benchmark::State& state) {
  const propagation::Positions positions = Team(static_cast<int>(state.range(0)));
  std::vector<propagation::PointMm> points;
  for (Eigen::Index i = 0; i < positions.rows(); ++i)
    points.push_back(propagation::RoundToMm({positions(i, 0), positions(i, 1)}, ""));
  for (auto _ : state) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = i + 1; j < points.size(); ++j) {
        benchmark::DoNotOptimize(propagation::PathLossDb(Garage(), kModel, points[i], points[j]));
      }
    }
  }
  CountLinks(state);
}

/// The links that carry at least so much: with -80 dBm most pairs have one, with -65 dBm those within a few metres.
network::Adjacency LinksOf(int num_robots, double weakest_dbm) {
  network::Adjacency adjacency =
      (propagation::RssiMatrixDbm(Garage(), kModel, Team(num_robots)).array() >= weakest_dbm).matrix();
  for (int i = 0; i < num_robots; ++i) adjacency(i, i) = false;
  return adjacency;
}

void Hops(benchmark::State& state, double weakest_dbm) {
  const network::Adjacency adjacency = LinksOf(static_cast<int>(state.range(0)), weakest_dbm);
  for (auto _ : state) benchmark::DoNotOptimize(network::CountHops(adjacency));
}

void HopsPlain(benchmark::State& state, double weakest_dbm) {
  const network::Adjacency adjacency = LinksOf(static_cast<int>(state.range(0)), weakest_dbm);
  for (auto _ : state) benchmark::DoNotOptimize(network::graphs::HopsOneByOne(adjacency));
}

void Fiedler(benchmark::State& state, double weakest_dbm) {
  const network::Adjacency adjacency = LinksOf(static_cast<int>(state.range(0)), weakest_dbm);
  for (auto _ : state) benchmark::DoNotOptimize(network::FiedlerValue(adjacency));
}

void FiedlerPlain(benchmark::State& state, double weakest_dbm) {
  const network::Adjacency adjacency = LinksOf(static_cast<int>(state.range(0)), weakest_dbm);
  for (auto _ : state) {
    Eigen::MatrixXd laplacian = -adjacency.cast<double>();
    laplacian.diagonal() = adjacency.cast<double>().rowwise().sum();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian, Eigen::EigenvaluesOnly);
    benchmark::DoNotOptimize(solver.eigenvalues()[1]);
  }
}

BENCHMARK(Links)->Arg(100)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK(LinksInFreshMemory)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK(LinksPlain)->Arg(100)->Arg(1000)->Iterations(1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Hops, dense, kWeakestLinkDbm)->Arg(100)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(HopsPlain, dense, kWeakestLinkDbm)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Hops, sparse, -65.0)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(HopsPlain, sparse, -65.0)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Fiedler, dense, kWeakestLinkDbm)->Arg(100)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(FiedlerPlain, dense, kWeakestLinkDbm)
    ->Arg(100)
    ->Arg(1000)
    ->Iterations(1)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Fiedler, sparse, -65.0)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(FiedlerPlain, sparse, -65.0)->Arg(1000)->Iterations(1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace robotteamsim
