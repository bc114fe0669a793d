// Floor 3: who hears whom.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <stdexcept>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/team_links.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

/// The links of a team as arrays of `NetworkState`; those that stay as they were are the same objects, to be read only.
class TeamLinkArrays {
 public:
  TeamLinkArrays(py::object faces, py::object model, bool by_distance, double lost_below_dbm, double max_distance_m,
                 double endangered_below_dbm)
      : links_({by_distance, lost_below_dbm, max_distance_m, endangered_below_dbm}),
        kept_(py::make_tuple(faces, model)),
        faces_(faces.cast<const FaceSet*>()),
        model_(model.cast<const RadioModel*>()) {}

  // Of `NetworkState`: rssi_dbm, link, adjacency, hop_count, break_matrix of a connected team, fiedler_value,
  // endangered.
  py::tuple Step(const Doubles& positions_m) {
    if (positions_m.ndim() != 2 || positions_m.shape(1) != 2) throw std::invalid_argument("positions_m must be (n, 2)");
    const Eigen::Map<const Positions> positions(positions_m.data(), positions_m.shape(0), 2);
    if (links_.Step(*faces_, *model_, positions)) {
      adjacency_ = Kept(links_.adjacency());
      hops_ = Kept(links_.hops());
      no_break_ = Kept(CellValues::Zero(positions.rows(), positions.rows()).eval());
    }
    py::object rssi = py::cast(std::move(links_.rssi()));
    py::object link = links_.rule().by_distance ? py::cast(std::move(links_.distances())) : rssi;
    if (as_kept_.rows() != positions.rows() || as_kept_ != links_.endangered()) {
      as_kept_ = links_.endangered();
      endangered_ = Kept(as_kept_);
    }
    return py::make_tuple(rssi, link, adjacency_, hops_, no_break_, links_.fiedler_value(), endangered_);
  }

 private:
  template <typename Matrix>
  static py::object Kept(const Matrix& matrix) {
    py::object array = py::cast(matrix);
    array.attr("setflags")(py::arg("write") = false);
    return array;
  }

  TeamLinks links_;
  py::object kept_;  // what these two look at
  const FaceSet* faces_;
  const RadioModel* model_;
  py::object adjacency_, hops_, no_break_, endangered_;
  Adjacency as_kept_;  // what endangered_ holds
};

}  // namespace

void BindNetwork(py::module_& m) {
  m.def("hop_count", &CountHops, py::arg("adjacency"));
  m.def("fiedler_value", &FiedlerValue, py::arg("adjacency"));
  py::class_<TeamLinkArrays> links(m, "TeamLinks");
  links.def(py::init<py::object, py::object, bool, double, double, double>(), py::arg("faces"), py::arg("model"),
            py::kw_only(), py::arg("by_distance"), py::arg("lost_below_dbm"), py::arg("max_distance_m"),
            py::arg("endangered_below_dbm"));
  DefFast<&TeamLinkArrays::Step>(links, "step");
}

}  // namespace robotteamsim::bindings
