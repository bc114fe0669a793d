// _core.simulation: missions that make their steps together, and totals over a trial.
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "mission_state.hpp"
#include "robotteamsim/simulation/batch.hpp"
#include "robotteamsim/simulation/team_totals.hpp"

namespace robotteamsim::bindings {
namespace {

using simulation::Batch;

void AddStep(simulation::TeamTotals& totals, const MissionState& view, const std::vector<bool>& excluded,
             bool running) {
  const state::State& state = view.one();
  totals.AddStep(state.Positions(0), {state.contact.begin(), state.contact.end()}, excluded, running);
}

void BindBatch(nb::module_& m) {
  nb::class_<Batch>(m, "Batch")
      .def(nb::init<std::size_t, std::size_t, std::size_t, int>(), "missions"_a, "robots"_a, "beams"_a, "threads"_a)
      .def(
          "put",
          [](Batch& batch, std::size_t mission, std::shared_ptr<world::World> world,
             std::shared_ptr<sensing::TeamSensors> sensors, std::shared_ptr<network::TeamLinks> links,
             std::shared_ptr<sensing::VoiceSensor> ear, std::shared_ptr<const base::Places> places) {
            batch.Put(mission,
                      {std::move(world), std::move(sensors), std::move(links), std::move(ear), std::move(places)});
          },
          "mission"_a, "world"_a, "sensors"_a, "links"_a, "ear"_a, "places"_a)
      .def(
          "move",
          [](Batch& batch, const Array<const double, -1, -1, 3>& twists, const std::vector<int>& missions) {
            const base::Table<const double> rows{twists.data(), twists.shape(0) * twists.shape(1), 3};
            const nb::gil_scoped_release release;
            batch.Move(rows, missions);
          },
          "twists"_a, "missions"_a)
      .def(
          "sense",
          [](Batch& batch, const std::vector<int>& missions) {
            std::shared_ptr<state::State> state;
            {
              const nb::gil_scoped_release release;
              state = batch.Sense(missions);
            }
            return MissionState(std::move(state), false);
          },
          "missions"_a);
}

}  // namespace

void BindSimulation(nb::module_&& m) {
  BindBatch(m);
  nb::class_<simulation::RobotTotals>(m, "RobotTotals")
      .def_ro("distance_m", &simulation::RobotTotals::distance_m)
      .def_ro("contact_steps", &simulation::RobotTotals::contact_steps)
      .def_ro("excluded_steps", &simulation::RobotTotals::excluded_steps)
      .def_ro("longest_stay_steps", &simulation::RobotTotals::longest_stay);
  nb::class_<simulation::TeamTotals>(m, "TeamTotals")
      .def(nb::init<int, double>(), "num_robots"_a, "longest_step_m"_a)
      .def("add_step", &AddStep, "state"_a, "excluded"_a, "running"_a)
      .def("totals", &simulation::TeamTotals::Totals);
}

}  // namespace robotteamsim::bindings
