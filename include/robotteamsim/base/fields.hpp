#pragma once

namespace robotteamsim::base {

/// A member of a struct and its name, which it also has in scenarios. A tuple of them next to a struct of parameters
/// serves its checks and its binding.
template <typename Struct, typename Value>
struct Field {
  const char* name;
  Value Struct::*member;
};

template <typename Struct, typename Value>
Field(const char*, Value Struct::*) -> Field<Struct, Value>;

}  // namespace robotteamsim::base
