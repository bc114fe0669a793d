#pragma once

#include <pybind11/pybind11.h>

namespace robotteamsim::bindings {

/// The text that `json.dumps` makes of a value: of dictionaries with keys of text, lists and tuples of any class, text,
/// numbers, booleans and None. Raises TypeError for anything else.
pybind11::object JsonText(pybind11::handle value);

}  // namespace robotteamsim::bindings
