#pragma once

#include <nanobind/nanobind.h>

#include "robotteamsim/base/fields.hpp"

namespace robotteamsim::bindings {

/// Defines the constructor of a struct of parameters: one keyword argument per field, without defaults.
template <typename Struct, typename... Values>
void DefineFields(nanobind::class_<Struct>& bound, const base::Field<Struct, Values>&... fields) {
  bound.def(
      "__init__",
      [fields...](Struct* self, Values... values) {
        new (self) Struct();
        ((self->*fields.member = values), ...);
      },
      nanobind::kw_only(), nanobind::arg(fields.name)...);
}

}  // namespace robotteamsim::bindings
