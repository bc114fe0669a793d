// _core.network: links between robots.
#include <memory>
#include <utility>

#include "bindings.hpp"
#include "casters.hpp"
#include "mission_state.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/team_links.hpp"

namespace robotteamsim::bindings {

void BindNetwork(nb::module_&& m) {
  m.def("hop_count", &network::CountHops, "adjacency"_a);
  m.def("fiedler_value", &network::FiedlerValue, "adjacency"_a);
  nb::class_<network::TeamLinks>(m, "TeamLinks")
      .def(
          "__init__",
          [](network::TeamLinks* self, std::shared_ptr<const propagation::FaceSet> faces,
             const propagation::RadioModel& model, bool by_distance, double lost_below_dbm, double max_distance_m,
             double endangered_below_dbm) {
            new (self) network::TeamLinks(std::move(faces), model,
                                          {by_distance, lost_below_dbm, max_distance_m, endangered_below_dbm});
          },
          "faces"_a, "model"_a, nb::kw_only(), "by_distance"_a, "lost_below_dbm"_a, "max_distance_m"_a,
          "endangered_below_dbm"_a)
      .def(
          "step", [](network::TeamLinks& links, MissionState& state) { links.Step(&state.one(), 0); }, "state"_a);
}

}  // namespace robotteamsim::bindings
