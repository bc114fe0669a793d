#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

namespace robotteamsim::bindings {
namespace fast_calls {

/// What an object of a bound class holds; nullptr where it was never initialised.
template <typename Class>
Class* ValueOf(PyObject* object) {
  auto* const instance = reinterpret_cast<pybind11::detail::instance*>(object);
  return static_cast<Class*>(instance->get_value_and_holder().value_ptr());
}

/// An argument as pybind11 converts it.
template <typename Argument, typename = void>
class Converted {
 public:
  bool Load(PyObject* source) { return caster_.load(source, true); }
  decltype(auto) Get() { return pybind11::detail::cast_op<Argument>(std::move(caster_)); }

 private:
  pybind11::detail::make_caster<Argument> caster_;
};

template <typename Argument>
constexpr bool kIsBound = std::is_base_of_v<pybind11::detail::type_caster_base<std::decay_t<Argument>>,
                                            pybind11::detail::make_caster<Argument>>;

/// A reference to an object of a bound class, of that class itself: pybind11 looks the class up in each call.
template <typename Argument>
class Converted<Argument, std::enable_if_t<kIsBound<Argument> && std::is_lvalue_reference_v<Argument>>> {
 public:
  bool Load(PyObject* source) {
    static const auto* const cls = reinterpret_cast<PyTypeObject*>(pybind11::type::of<Value>().ptr());
    if (Py_TYPE(source) != cls) return false;
    value_ = ValueOf<Value>(source);
    return value_ != nullptr;
  }
  Argument Get() { return *value_; }

 private:
  using Value = std::decay_t<Argument>;
  Value* value_ = nullptr;
};

/// Tells Python of the exception in flight, as pybind11 does.
inline void TellPython() {
  try {
    throw;
  } catch (pybind11::error_already_set& error) {
    error.restore();
  } catch (const pybind11::builtin_exception& error) {
    error.set_error();
  } catch (const std::bad_alloc& error) {
    PyErr_SetString(PyExc_MemoryError, error.what());
  } catch (const std::out_of_range& error) {
    PyErr_SetString(PyExc_IndexError, error.what());
  } catch (const std::logic_error& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
}

template <typename Result>
PyObject* ToPython(Result&& result) {
  using Caster = pybind11::detail::make_caster<Result>;
  return Caster::cast(std::forward<Result>(result), pybind11::return_value_policy::move, {}).ptr();
}

/// Calls a function with arguments of Python, which follow the object where it is a method, as METH_FASTCALL has them.
template <auto function, typename Result, typename... Args, std::size_t... i, typename... Object>
PyObject* CallWith(std::index_sequence<i...>, PyObject* const* args, Py_ssize_t num_args, Object*... object) {
  try {
    std::tuple<Converted<Args>...> converted;
    const bool fits = (... && (object != nullptr)) && num_args == sizeof...(Args);
    if (!fits || !(... && std::get<i>(converted).Load(args[i]))) {
      throw pybind11::type_error("incompatible function arguments; wanted " + std::to_string(sizeof...(Args)) +
                                 " by position");
    }
    if constexpr (std::is_void_v<Result>) {
      std::invoke(function, *object..., std::get<i>(converted).Get()...);
      Py_RETURN_NONE;
    } else {
      return ToPython(std::invoke(function, *object..., std::get<i>(converted).Get()...));
    }
  } catch (...) {
    TellPython();
    return nullptr;
  }
}

template <auto function, typename Class, typename Result, typename... Args>
struct Method {
  static PyObject* Call(PyObject* self, PyObject* const* args, Py_ssize_t num_args) {
    return CallWith<function, Result, Args...>(std::index_sequence_for<Args...>(), args, num_args,
                                               ValueOf<std::remove_const_t<Class>>(self));
  }
};

template <auto function, typename Result, typename... Args>
struct Function {
  static PyObject* Call(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
    return CallWith<function, Result, Args...>(std::index_sequence_for<Args...>(), args, num_args);
  }
};

template <auto function, typename Result, typename... Args>
constexpr auto FunctionOf(Result (*)(Args...)) {
  return &Function<function, Result, Args...>::Call;
}

template <auto function, typename Result, typename Class, typename... Args>
constexpr auto MethodOf(Result (*)(Class&, Args...)) {
  return &Method<function, Class, Result, Args...>::Call;
}
template <auto function, typename Result, typename Class, typename... Args>
constexpr auto MethodOf(Result (Class::*)(Args...)) {
  return &Method<function, Class, Result, Args...>::Call;
}
template <auto function, typename Result, typename Class, typename... Args>
constexpr auto MethodOf(Result (Class::*)(Args...) const) {
  return &Method<function, const Class, Result, Args...>::Call;
}

}  // namespace fast_calls

/// Binds `function`, one of the class or one that takes its object first, as the method `name` with arguments by
/// position. What pybind11's own `def` does for each call takes longer than many functions that every step calls.
template <auto function, typename Class, typename... Options>
pybind11::class_<Class, Options...>& DefFast(pybind11::class_<Class, Options...>& cls, const char* name) {
  auto* const call = fast_calls::MethodOf<function>(function);
  static PyMethodDef definition{name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(call)), METH_FASTCALL,
                                nullptr};
  PyObject* const method = PyDescr_NewMethod(reinterpret_cast<PyTypeObject*>(cls.ptr()), &definition);
  if (method == nullptr) throw pybind11::error_already_set();
  cls.attr(name) = pybind11::reinterpret_steal<pybind11::object>(method);
  return cls;
}

template <auto function>
void DefFast(pybind11::module_& m, const char* name) {
  auto* const call = fast_calls::FunctionOf<function>(function);
  static std::array<PyMethodDef, 2> definitions{
      PyMethodDef{name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(call)), METH_FASTCALL, nullptr},
      PyMethodDef{nullptr, nullptr, 0, nullptr}};
  if (PyModule_AddFunctions(m.ptr(), definitions.data()) != 0) throw pybind11::error_already_set();
}

}  // namespace robotteamsim::bindings
