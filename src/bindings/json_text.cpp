#include "json_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// Long enough for the shortest digits of any number, as in -2.2250738585072014e-308.
using Digits = std::array<char, 32>;

// Writes the shortest digits that tell a finite number from all others, as in 1.25e+02; returns their end.
char* WriteShortest(double number, Digits* text) {
#ifdef __cpp_lib_to_chars
  return std::to_chars(text->data(), text->data() + text->size(), number, std::chars_format::scientific).ptr;
#else
  for (int digits = 0;; ++digits) {
    const std::unique_ptr<char, decltype(&PyMem_Free)> tried(PyOS_double_to_string(number, 'e', digits, 0, nullptr),
                                                             &PyMem_Free);
    if (digits < 16 && std::strtod(tried.get(), nullptr) != number) continue;
    return std::copy_n(tried.get(), std::strlen(tried.get()), text->data());
  }
#endif
}

// As repr writes it: plain, unless it is below 1e-4 or has more than 16 digits before the point.
void AppendFinite(double number, std::string* text) {
  Digits shortest;
  char* const end = WriteShortest(std::abs(number), &shortest);
  const char* const mark = std::find(shortest.data(), end, 'e');
  int exponent = 0;
  for (const char* digit = mark + 2; digit != end; ++digit) exponent = 10 * exponent + (*digit - '0');
  if (mark[1] == '-') exponent = -exponent;
  std::array<char, 64> plain;  // all of it, as each addition to the text costs as much as many digits
  char* to = plain.data();
  if (std::signbit(number)) *to++ = '-';
  if (exponent < -4 || exponent >= 16) {
    to = std::copy(shortest.data(), end, to);
  } else {
    // The digits after the first one follow a point, if there are any.
    const char* next = std::min<const char*>(shortest.data() + 2, mark);
    if (exponent < 0) {
      *to++ = '0';
      *to++ = '.';
      to = std::fill_n(to, -exponent - 1, '0');
      *to++ = shortest[0];
    } else {
      *to++ = shortest[0];
      for (int i = 0; i < exponent; ++i) *to++ = next < mark ? *next++ : '0';
      *to++ = '.';
      if (next == mark) *to++ = '0';
    }
    to = std::copy(next, mark, to);
  }
  text->append(plain.data(), to);
}

void AppendFloat(double number, std::string* text) {
  if (std::isfinite(number)) {
    AppendFinite(number, text);
  } else {
    *text += std::isnan(number) ? "NaN" : number > 0.0 ? "Infinity" : "-Infinity";
  }
}

bool IsPlain(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
}

void AppendString(py::handle value, std::string* text) {
  if (PyUnicode_IS_ASCII(value.ptr())) {
    const std::string_view plain(reinterpret_cast<const char*>(PyUnicode_DATA(value.ptr())),
                                 static_cast<std::size_t>(PyUnicode_GET_LENGTH(value.ptr())));
    if (IsPlain(plain)) {
      text->append("\"").append(plain) += '"';
      return;
    }
  }
  *text += py::module_::import("json").attr("dumps")(value).cast<std::string>();
}

void Append(py::handle value, std::string* text);

void AppendItems(py::handle sequence, std::string* text) {
  const bool is_tuple = PyTuple_Check(sequence.ptr());
  const Py_ssize_t size = is_tuple ? PyTuple_GET_SIZE(sequence.ptr()) : PyList_GET_SIZE(sequence.ptr());
  *text += '[';
  for (Py_ssize_t i = 0; i < size; ++i) {
    if (i > 0) *text += ", ";
    Append(is_tuple ? PyTuple_GET_ITEM(sequence.ptr(), i) : PyList_GET_ITEM(sequence.ptr(), i), text);
  }
  *text += ']';
}

void AppendPairs(py::handle pairs, std::string* text) {
  *text += '{';
  PyObject *key = nullptr, *value = nullptr;
  bool is_first = true;
  for (Py_ssize_t place = 0; PyDict_Next(pairs.ptr(), &place, &key, &value) != 0; is_first = false) {
    if (!PyUnicode_Check(key)) throw py::type_error("keys must be text");
    if (!is_first) *text += ", ";
    AppendString(key, text);
    *text += ": ";
    Append(value, text);
  }
  *text += '}';
}

void Append(py::handle value, std::string* text) {
  PyObject* const item = value.ptr();
  if (item == Py_None) {
    *text += "null";
  } else if (PyBool_Check(item)) {
    *text += item == Py_True ? "true" : "false";
  } else if (PyFloat_Check(item)) {
    AppendFloat(PyFloat_AS_DOUBLE(item), text);
  } else if (PyLong_Check(item)) {
    int overflow = 0;
    const long number = PyLong_AsLongAndOverflow(item, &overflow);
    *text += overflow == 0 ? std::to_string(number) : py::str(value).cast<std::string>();
  } else if (PyUnicode_Check(item)) {
    AppendString(value, text);
  } else if (PyTuple_Check(item) || PyList_Check(item)) {
    AppendItems(value, text);
  } else if (PyDict_Check(item)) {
    AppendPairs(value, text);
  } else {
    throw py::type_error("there is no JSON for an object of class " + std::string(Py_TYPE(item)->tp_name));
  }
}

}  // namespace

py::object JsonText(py::handle value) {
  std::string text;
  text.reserve(512);
  Append(value, &text);
  // All of it is ASCII, so there is nothing to decode.
  const auto made = py::reinterpret_steal<py::object>(PyUnicode_New(static_cast<Py_ssize_t>(text.size()), 127));
  if (!made) throw py::error_already_set();
  std::copy(text.begin(), text.end(), static_cast<char*>(PyUnicode_DATA(made.ptr())));
  return made;
}

}  // namespace robotteamsim::bindings
