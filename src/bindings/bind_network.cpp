// Floor 3: who hears whom.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/team_links.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

/// The links of a team as arrays of `NetworkState`; those that stay as they were are the same objects, to be read only.
class TeamLinkArrays {
 public:
  TeamLinkArrays(bool by_distance, double lost_below_dbm, double max_distance_m, double endangered_below_dbm)
      : links_({by_distance, lost_below_dbm, max_distance_m, endangered_below_dbm}) {}

  // Of `NetworkState`: rssi_dbm, link, adjacency, hop_count, break_matrix of a connected team, fiedler_value,
  // endangered.
  py::tuple Step(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions) {
    if (links_.Step(faces, model, positions)) {
      adjacency_ = Kept(links_.adjacency());
      hops_ = Kept(links_.hops());
      no_break_ = Kept(CellValues::Zero(positions.rows(), positions.rows()).eval());
      none_endangered_ = Kept(Adjacency::Constant(positions.rows(), positions.rows(), false).eval());
    }
    py::object rssi = py::cast(std::move(links_.rssi()));
    py::object link = links_.rule().by_distance ? py::cast(std::move(links_.distances())) : rssi;
    py::object endangered = links_.any_endangered() ? py::cast(links_.endangered()) : none_endangered_;
    return py::make_tuple(rssi, link, adjacency_, hops_, no_break_, links_.fiedler_value(), endangered);
  }

 private:
  template <typename Matrix>
  static py::object Kept(const Matrix& matrix) {
    py::object array = py::cast(matrix);
    array.attr("setflags")(py::arg("write") = false);
    return array;
  }

  TeamLinks links_;
  py::object adjacency_, hops_, no_break_, none_endangered_;
};

}  // namespace

void BindNetwork(py::module_& m) {
  m.def("hop_count", &CountHops, py::arg("adjacency"));
  m.def("fiedler_value", &FiedlerValue, py::arg("adjacency"));
  py::class_<TeamLinkArrays>(m, "TeamLinks")
      .def(py::init<bool, double, double, double>(), py::kw_only(), py::arg("by_distance"), py::arg("lost_below_dbm"),
           py::arg("max_distance_m"), py::arg("endangered_below_dbm"))
      .def("step", &TeamLinkArrays::Step, py::arg("faces"), py::arg("model"), py::arg("positions_m"));
}

}  // namespace robotteamsim::bindings
