// _core.recording: ROS messages and the bytes that are sent, in the formats of ROS 1 and of ROS 2 (CDR).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "message_bytes.hpp"

namespace robotteamsim::bindings {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr std::int64_t kMostValues = 10'000'000;  // of an array of fixed length

// How values of one type of the definitions become bytes, and bytes values. code: of their class in the buffers of
// Python: (f)loat, (i)nt, (u)nsigned or (n)one.
struct Basic {
  void (*put)(Bytes* out, nb::handle value);
  void (*put_nothing)(Bytes* out);
  nb::object (*get)(Source* in);
  nb::object (*get_array)(Source* in, std::size_t count);  // nullptr: of such values there are lists
  std::size_t size;
  char code;
};

template <typename Number>
Number NumberOf(nb::handle value) {
  if constexpr (std::is_same_v<Number, bool>) {
    const int truth = PyObject_IsTrue(value.ptr());
    if (truth < 0) throw nb::python_error();
    return truth != 0;
  } else if constexpr (std::is_floating_point_v<Number>) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (number == -1.0 && PyErr_Occurred() != nullptr) throw nb::python_error();
    if (std::isfinite(number) && std::abs(number) > static_cast<double>(std::numeric_limits<Number>::max())) {
      throw std::out_of_range("a number that is too large");
    }
    return static_cast<Number>(number);
  } else if constexpr (std::is_same_v<Number, std::uint64_t>) {
    const auto whole = nb::steal(PyNumber_Index(value.ptr()));
    if (!whole.is_valid()) throw nb::python_error();
    const std::uint64_t number = PyLong_AsUnsignedLongLong(whole.ptr());
    if (number == static_cast<std::uint64_t>(-1) && PyErr_Occurred() != nullptr) throw nb::python_error();
    return number;
  } else {
    const std::int64_t number = PyLong_AsLongLong(value.ptr());
    if (number == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
    if (number < static_cast<std::int64_t>(std::numeric_limits<Number>::min()) ||
        number > static_cast<std::int64_t>(std::numeric_limits<Number>::max())) {
      throw std::out_of_range("a number that is too large or too small");
    }
    return static_cast<Number>(number);
  }
}

template <typename Number>
nb::object GetNumber(Source* in) {
  if constexpr (std::is_same_v<Number, bool>) {
    return nb::bool_(in->Get<std::uint8_t>() != 0);
  } else {
    return nb::cast(in->Get<Number>());
  }
}

template <typename Number>
nb::object GetNumbers(Source* in, std::size_t count) {
  using Array = nb::ndarray<nb::numpy, Number, nb::ndim<1>, nb::device::cpu>;
  if (count > 0) in->Align(sizeof(Number));
  if (sizeof(Number) * count > in->left()) throw std::invalid_argument("too short");
  auto numbers = std::make_unique<Number[]>(count);
  in->Copy(numbers.get(), sizeof(Number), count);
  if constexpr (std::is_same_v<Number, bool>) {
    auto* bytes = reinterpret_cast<std::uint8_t*>(numbers.get());
    for (std::size_t i = 0; i < count; ++i) bytes[i] = bytes[i] != 0 ? 1 : 0;
  }
  Number* data = numbers.release();
  const nb::capsule owner(data, [](void* owned) noexcept { delete[] static_cast<Number*>(owned); });
  return nb::cast(Array(data, {count}, owner));
}

template <typename Number>
Basic NumberType(char code) {
  return {[](Bytes* out, nb::handle value) { out->Put(NumberOf<Number>(value)); },
          [](Bytes* out) { out->Put(Number{}); },
          GetNumber<Number>,
          GetNumbers<Number>,
          sizeof(Number),
          code};
}

void PutText(Bytes* out, nb::handle value) {
  Py_ssize_t size = 0;
  const char* text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (text == nullptr) throw nb::python_error();
  out->PutText(text, static_cast<std::size_t>(size));
}

nb::object GetText(Source* in) {
  std::size_t size = in->GetCount(1);
  const char* text = in->Skip(size);
  if (in->is_cdr() && size-- == 0) throw std::invalid_argument("a text without its end");
  PyObject* found = PyUnicode_DecodeUTF8(text, static_cast<Py_ssize_t>(size), nullptr);
  if (found == nullptr) throw nb::python_error();
  return nb::steal(found);
}

nb::object GetTime(Source* in) {
  const auto seconds = in->Get<std::uint32_t>();
  const std::int64_t signed_seconds = in->is_cdr() ? static_cast<std::int32_t>(seconds) : std::int64_t{seconds};
  return nb::cast(signed_seconds * kNsPerS + in->Get<std::uint32_t>());
}

void PutSeconds(Bytes* out, std::int64_t seconds, std::int64_t nanoseconds) {
  out->Put(static_cast<std::uint32_t>(seconds));
  out->Put(static_cast<std::uint32_t>(nanoseconds));
}

// Of a whole number of nanoseconds.
void PutTime(Bytes* out, nb::handle value) {
  const auto time_ns = NumberOf<std::int64_t>(value);
  const std::int64_t seconds = time_ns / kNsPerS - (time_ns % kNsPerS < 0 ? 1 : 0);
  const auto most = out->is_cdr() ? static_cast<std::int64_t>(std::numeric_limits<std::int32_t>::max())
                                  : static_cast<std::int64_t>(std::numeric_limits<std::uint32_t>::max());
  if (seconds < std::numeric_limits<std::int32_t>::min() || seconds > most) throw std::out_of_range("a time too late");
  PutSeconds(out, seconds, time_ns - seconds * kNsPerS);
}

const std::map<std::string, Basic>& BasicTypes() {
  static const std::map<std::string, Basic> types = {
      {"bool", NumberType<bool>('u')},
      {"byte", NumberType<std::int8_t>('i')},
      {"char", NumberType<std::uint8_t>('u')},
      {"int8", NumberType<std::int8_t>('i')},
      {"uint8", NumberType<std::uint8_t>('u')},
      {"int16", NumberType<std::int16_t>('i')},
      {"uint16", NumberType<std::uint16_t>('u')},
      {"int32", NumberType<std::int32_t>('i')},
      {"uint32", NumberType<std::uint32_t>('u')},
      {"int64", NumberType<std::int64_t>('i')},
      {"uint64", NumberType<std::uint64_t>('u')},
      {"float32", NumberType<float>('f')},
      {"float64", NumberType<double>('f')},
      {"string", {PutText, [](Bytes* out) { out->PutText("", 0); }, GetText, nullptr, 0, 'n'}},
      {"time", {PutTime, [](Bytes* out) { PutSeconds(out, 0, 0); }, GetTime, nullptr, 0, 'n'}},
  };
  return types;
}

// The code of a `Basic` of the format of a buffer, as of the module struct.
char CodeOf(const char* format) {
  const std::string text = format == nullptr ? "B" : format;
  const char last = text.empty() ? 'n' : text.back();
  if (text.size() > 2 || (text.size() == 2 && text[0] != '<' && text[0] != '=' && text[0] != '@')) return 'n';
  if (last == 'f' || last == 'd') return 'f';
  if (std::strchr("bhilq", last) != nullptr) return 'i';
  return std::strchr("BHILQ?", last) != nullptr ? 'u' : 'n';
}

// A contiguous array of numbers of the wanted type, which is copied as it is; none for other values.
class Numbers {
 public:
  Numbers(nb::handle value, const Basic& wanted) {
    if (wanted.size == 0 || PyObject_CheckBuffer(value.ptr()) == 0) return;
    is_open_ = PyObject_GetBuffer(value.ptr(), &view_, PyBUF_FORMAT | PyBUF_C_CONTIGUOUS) == 0;
    if (!is_open_) PyErr_Clear();
    is_wanted_ =
        is_open_ && static_cast<std::size_t>(view_.itemsize) == wanted.size && CodeOf(view_.format) == wanted.code;
  }
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  ~Numbers() {
    if (is_open_) PyBuffer_Release(&view_);
  }

  explicit operator bool() const { return is_wanted_; }
  const void* data() const { return view_.buf; }
  std::size_t size() const { return static_cast<std::size_t>(view_.len); }

 private:
  Py_buffer view_{};
  bool is_open_ = false, is_wanted_ = false;
};

class MessageType;

// An attribute of a message. count: of a fixed array, 0 of a sequence, -1 of a single value.
struct Attribute {
  nb::str name;
  Basic basic{};
  const MessageType* nested = nullptr;
  std::int64_t count = -1;

  std::size_t LeastBytesOfOne() const;
  std::size_t LeastBytes() const { return count < 0 ? LeastBytesOfOne() : count == 0 ? 4 : count * LeastBytesOfOne(); }
};

// A type of messages.
class MessageType {
 public:
  MessageType(std::string name, bool is_cdr) : name_(std::move(name)), is_cdr_(is_cdr) {}

  void Add(const nb::str& name, nb::handle type, std::int64_t count) {
    if (count < -1 || count > kMostValues) throw std::invalid_argument(name_ + "." + name.c_str() + ": a wrong length");
    Attribute attribute{name, {}, nullptr, count};
    if (nb::isinstance<nb::str>(type)) {
      const auto found = BasicTypes().find(nb::cast<std::string>(type));
      if (found == BasicTypes().end()) {
        throw std::invalid_argument(name_ + "." + name.c_str() + ": " + nb::cast<std::string>(type) +
                                    " is not supported");
      }
      attribute.basic = found->second;
    } else {
      attribute.nested = &nb::cast<const MessageType&>(type);
    }
    least_bytes_ += attribute.LeastBytes();
    attributes_.push_back(std::move(attribute));
  }

  nb::bytes Encode(nb::handle message) const {
    Bytes out(is_cdr_);
    Put(&out, message);
    return nb::bytes(out.bytes().data(), out.bytes().size());
  }

  nb::object Decode(nb::handle data) const {
    Py_buffer view;
    if (PyObject_GetBuffer(data.ptr(), &view, PyBUF_SIMPLE) != 0) throw nb::python_error();
    const std::unique_ptr<Py_buffer, decltype(&PyBuffer_Release)> held(&view, &PyBuffer_Release);
    try {
      Source in(static_cast<const char*>(view.buf), static_cast<std::size_t>(view.len), is_cdr_);
      nb::object message = Get(&in);
      // Middlewares of ROS 2 fill up the last four bytes.
      if (in.left() > (is_cdr_ ? 3 : 0)) throw std::invalid_argument("too long");
      return message;
    } catch (nb::python_error& error) {
      nb::raise_from(error, PyExc_ValueError, "not a %s: a text that is not UTF-8", name_.c_str());
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("not a " + name_ + ": " + error.what());
    }
  }

  std::size_t least_bytes() const { return least_bytes_; }

 private:
  nb::object Get(Source* in) const {
    static const nb::handle kind = nb::object(nb::module_::import_("types").attr("SimpleNamespace")).release();
    nb::dict values;
    for (const Attribute& attribute : attributes_) values[attribute.name] = GetValue(in, attribute);
    return kind(**values);
  }

  static nb::object GetValue(Source* in, const Attribute& attribute) {
    if (attribute.count < 0) return GetOne(in, attribute);
    const std::size_t count =
        attribute.count > 0 ? static_cast<std::size_t>(attribute.count) : in->GetCount(attribute.LeastBytesOfOne());
    if (attribute.basic.get_array != nullptr) {
      return attribute.basic.get_array(in, count);
    }
    if (count > in->left()) throw std::invalid_argument("too short");
    nb::list values;
    for (std::size_t i = 0; i < count; ++i) values.append(GetOne(in, attribute));
    return std::move(values);
  }

  static nb::object GetOne(Source* in, const Attribute& attribute) {
    return attribute.nested != nullptr ? attribute.nested->Get(in) : attribute.basic.get(in);
  }

  void Put(Bytes* out, nb::handle message) const {
    if (!nb::isinstance<nb::dict>(message)) throw nb::type_error((name_ + ": expected a dict").c_str());
    Py_ssize_t used = 0;
    for (const Attribute& attribute : attributes_) {
      const nb::handle value = PyDict_GetItemWithError(message.ptr(), attribute.name.ptr());
      if (!value.is_valid()) {
        PutNothing(out, attribute);
        continue;
      }
      ++used;
      try {
        PutValue(out, attribute, value);
      } catch (nb::python_error& error) {
        if (attribute.nested != nullptr && error.matches(PyExc_ValueError)) throw;  // which names the attribute
        nb::raise_from(error, PyExc_ValueError, "%s.%s: %.80s", name_.c_str(), attribute.name.c_str(),
                       nb::repr(value).c_str());
      } catch (const std::out_of_range& error) {
        throw std::invalid_argument(name_ + "." + attribute.name.c_str() + ": " + error.what());
      }
    }
    if (used != PyDict_Size(message.ptr())) ThrowUnknown(nb::cast<nb::dict>(message));
  }

  [[noreturn]] void ThrowUnknown(const nb::dict& message) const {
    for (const auto& [key, value] : message) {
      bool is_known = false;
      for (const Attribute& attribute : attributes_) is_known = is_known || attribute.name.equal(key);
      if (!is_known) throw std::invalid_argument(name_ + " has no attribute " + nb::repr(key).c_str());
    }
    throw std::logic_error("unreachable");
  }

  static void PutOne(Bytes* out, const Attribute& attribute, nb::handle value) {
    if (attribute.nested != nullptr) {
      attribute.nested->Put(out, value);
    } else {
      attribute.basic.put(out, value);
    }
  }

  static void PutValue(Bytes* out, const Attribute& attribute, nb::handle value) {
    if (attribute.count < 0) {
      PutOne(out, attribute, value);
      return;
    }
    if (attribute.nested == nullptr) {
      if (const Numbers numbers(value, attribute.basic); numbers) {
        PutLength(out, attribute, numbers.size() / attribute.basic.size);
        if (numbers.size() == 0) return;
        out->Align(attribute.basic.size);
        out->Append(numbers.data(), numbers.size());
        return;
      }
    }
    nb::object values = nb::borrow(value);
    if (!nb::isinstance<nb::list>(value)) {
      values = nb::steal(PySequence_List(value.ptr()));
      if (!values.is_valid()) throw nb::python_error();
    }
    const auto list = nb::borrow<nb::list>(values);
    PutLength(out, attribute, list.size());
    for (const nb::handle one : list) PutOne(out, attribute, one);
  }

  static void PutLength(Bytes* out, const Attribute& attribute, std::size_t length) {
    if (attribute.count == 0) {
      out->PutCount(length);
    } else if (length != static_cast<std::size_t>(attribute.count)) {
      throw std::out_of_range(std::to_string(length) + " values; expected " + std::to_string(attribute.count));
    }
  }

  static void PutNothing(Bytes* out, const Attribute& attribute) {
    if (attribute.count == 0) {
      out->PutCount(0);
      return;
    }
    for (std::int64_t i = 0; i < (attribute.count < 0 ? 1 : attribute.count); ++i) {
      if (attribute.nested == nullptr) {
        attribute.basic.put_nothing(out);
      } else {
        for (const Attribute& part : attribute.nested->attributes_) PutNothing(out, part);
      }
    }
  }

  std::string name_;
  bool is_cdr_;
  std::vector<Attribute> attributes_;
  std::size_t least_bytes_ = 0;
};

std::size_t Attribute::LeastBytesOfOne() const {
  if (nested != nullptr) return nested->least_bytes();
  return basic.size > 0 ? basic.size : 4;
}

}  // namespace

void BindRecording(nb::module_&& m) {
  nb::class_<MessageType>(m, "MessageType")
      .def(nb::init<std::string, bool>(), "type_name"_a, "is_cdr"_a)
      .def("add", &MessageType::Add, "attribute"_a, "type"_a, "count"_a, nb::keep_alive<1, 3>(),
           nb::sig("def add(self, attribute: str, type: str | MessageType, count: int) -> None"))
      .def("encode", &MessageType::Encode, "message"_a,
           nb::sig("def encode(self, message: collections.abc.Mapping[str, typing.Any]) -> bytes"))
      .def("decode", &MessageType::Decode, "data"_a,
           nb::sig("def decode(self, data: bytes | memoryview) -> typing.Any"));
}

}  // namespace robotteamsim::bindings
