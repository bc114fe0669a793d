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
#include "tuples.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

/// The links of a team as `NetworkState`; arrays that stay as they were are the same objects, to be read only.
class TeamLinkStates {
 public:
  // Args: state: the class `NetworkState`; traffic: what each state tells of it.
  TeamLinkStates(py::object faces, py::object model, py::type state, py::object traffic, bool by_distance,
                 double lost_below_dbm, double max_distance_m, double endangered_below_dbm)
      : links_({by_distance, lost_below_dbm, max_distance_m, endangered_below_dbm}),
        kept_(py::make_tuple(faces, model)),
        faces_(faces.cast<const FaceSet*>()),
        model_(model.cast<const RadioModel*>()),
        state_(std::move(state)),
        traffic_(std::move(traffic)) {}

  py::object Step(const Doubles& positions_m) {
    if (positions_m.ndim() != 2 || positions_m.shape(1) != 2) throw std::invalid_argument("positions_m must be (n, 2)");
    const py::ssize_t n = positions_m.shape(0);
    py::object rssi = NewArray<double>({n, n}), link = links_.rule().by_distance ? NewArray<double>({n, n}) : rssi;
    if (links_.Step(*faces_, *model_, Eigen::Map<const Positions>(positions_m.data(), n, 2), Room(rssi, n),
                    Room(link, n))) {
      adjacency_ = Kept(links_.adjacency());
      hops_ = Kept(links_.hops());
      no_break_ = Kept(CellValues::Zero(n, n).eval());
    }
    if (as_kept_.rows() != n || as_kept_ != links_.endangered()) {
      as_kept_ = links_.endangered();
      endangered_ = Kept(as_kept_);
    }
    py::object breaks = links_.fiedler_value() == 0.0 ? py::cast(BreakMatrix(Room(link, n), links_.hops())) : no_break_;
    return state_.Of({rssi.release().ptr(), link.release().ptr(), NewReference(adjacency_), NewReference(hops_),
                      breaks.release().ptr(), PyFloat_FromDouble(links_.fiedler_value()), NewReference(endangered_),
                      NewReference(traffic_)});
  }

 private:
  static Eigen::Map<CellValues> Room(const py::object& array, py::ssize_t n) {
    return {static_cast<double*>(py::reinterpret_borrow<py::array>(array).mutable_data()), n, n};
  }

  static PyObject* NewReference(const py::object& object) { return object.inc_ref().ptr(); }

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
  TupleClass state_;
  py::object traffic_;
  py::object adjacency_, hops_, no_break_, endangered_;
  Adjacency as_kept_;  // what endangered_ holds
};

}  // namespace

void BindNetwork(py::module_& m) {
  m.def("hop_count", &CountHops, py::arg("adjacency"));
  m.def("break_matrix", &BreakMatrix, py::arg("link"), py::arg("hops"));
  m.def("fiedler_value", &FiedlerValue, py::arg("adjacency"));
  py::class_<TeamLinkStates> links(m, "TeamLinks");
  links.def(py::init<py::object, py::object, py::type, py::object, bool, double, double, double>(), py::arg("faces"),
            py::arg("model"), py::arg("state"), py::arg("traffic"), py::kw_only(), py::arg("by_distance"),
            py::arg("lost_below_dbm"), py::arg("max_distance_m"), py::arg("endangered_below_dbm"));
  DefFast<&TeamLinkStates::Step>(links, "step");
}

}  // namespace robotteamsim::bindings
