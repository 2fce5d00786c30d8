// What the files of the Python module share: the engine's structs as NumPy dtypes, and arrays over their
// memory.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "lumbrical/mesh.h"
#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/tick.h"

namespace lumbrical::python {

namespace py = pybind11;

/// What classes of the module derive from.
struct Bound {};
template <class Class>
concept IsBound =
    std::derived_from<Class, Bound> || std::same_as<Class, State> || std::same_as<Class, Ground>;

/// A file's, from text, bytes or a pathlib.Path.
struct Path {
  std::string text;
};

}  // namespace lumbrical::python

namespace pybind11::detail {

/// Refuses what __new__ has made without __init__: it would be read before it is constructed.
template <lumbrical::python::IsBound Class>
class type_caster<Class> : public type_caster_base<Class> {
 public:
  bool load(handle source, bool convert) { return this->template load_impl<type_caster>(source, convert); }
  void load_value(value_and_holder&& held) {
    if (held.value_ptr() == nullptr) throw type_error("the object was not made by a call of its class");
    type_caster_base<Class>::load_value(std::move(held));
  }
};

/// Refuses a NUL: what is behind it would be dropped, and another file be meant.
template <>
class type_caster<lumbrical::python::Path> {
 public:
  PYBIND11_TYPE_CASTER(lumbrical::python::Path, const_name("os.PathLike"));
  bool load(handle source, bool) {
    value.text = module_::import("os").attr("fsencode")(source).cast<std::string>();
    if (value.text.find('\0') != std::string::npos) throw value_error("the path holds a NUL");
    return true;
  }
};

}  // namespace pybind11::detail

namespace lumbrical::python {

/// A tick of a recording, as Recording.read gives it.
struct RecordedTick {
  DeviceFrame frame;
  ActuatorFrame output;
  std::uint64_t state_hash = 0;
  std::uint32_t duration_ns = 0;
};

/// A contact with the names of what touches what.
struct ContactRow {
  std::uint32_t segment = 0, object = 0, triangle = 0, primitive = 0;
  double depth = 0, area = 0, volume = 0, error = 0;
  Vec3 centroid, centre, normal, force;
};

/// The dtype of one of the engine's structs, with its names: memory is shared, nothing is converted.
template <class Struct>
py::dtype dtype_of();

/// Text whatever its bytes: those that are no UTF-8, of a file's name say, become what Python itself makes of
/// them (surrogateescape), so that a path is still the path.
inline py::str text_of(const std::string& bytes) {
  PyObject* const made =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "surrogateescape");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

/// The path of a file to read. "-" is none: standard input is the program's own.
inline const std::string& file_of(const Path& path) {
  if (path.text == "-") throw py::value_error("nothing is read from standard input here; give a path");
  return path.text;
}

/// Throws ValueError with the message.
[[noreturn]] inline void refuse(const std::string& message) {
  PyErr_SetObject(PyExc_ValueError, text_of(message).ptr());
  throw py::error_already_set();
}
inline void check(const Status& status) {
  if (!status.ok()) refuse(status.message());
}

/// One call at a time: while the GIL is released another thread may come.
class Busy {
 public:
  explicit Busy(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true, std::memory_order_acquire))
      throw std::runtime_error("another thread is in a call of this object");
  }
  ~Busy() { flag_.store(false, std::memory_order_release); }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::atomic<bool>& flag_;
};

/// Asks now and then, from a call that has released the GIL, whether Ctrl-C or another signal has come whose
/// handler raises: then the call ends, and `raise` raises it.
class Interrupts {
 public:
  bool came() {
    const auto now = std::chrono::steady_clock::now();
    if (came_ || now - asked_ < std::chrono::milliseconds(50)) return came_;
    asked_ = now;
    const py::gil_scoped_acquire acquire;
    return came_ = PyErr_CheckSignals() != 0;
  }
  static void raise() {
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point asked_ = std::chrono::steady_clock::now();
  bool came_ = false;
};

/// A view of memory that `owner` keeps alive.
template <class Struct>
py::array view_of(const Struct* data, std::vector<py::ssize_t> shape, py::handle owner, bool writable) {
  py::array array(dtype_of<Struct>(), std::move(shape), data, owner);
  if (!writable) array.attr("flags").attr("writeable") = false;
  return array;
}

/// An array that has taken a vector's memory over.
template <class Struct>
py::array array_of(std::vector<Struct>&& rows) {
  auto kept = std::make_unique<std::vector<Struct>>(std::move(rows));
  const auto size = static_cast<py::ssize_t>(kept->size());
  const Struct* const data = kept->data();
  const py::capsule owner(kept.release(), [](void* p) { delete static_cast<std::vector<Struct>*>(p); });
  return view_of(data, {size}, owner, true);
}

/// A row that was taken out of a structured array, which numpy hands out as a numpy.void.
inline bool is_row(const py::handle& given) {
  return py::isinstance(given, py::module_::import("numpy").attr("void"));
}

/// Whose masked places would be taken for what lies under them.
inline bool is_masked(const py::handle& given) {
  return py::isinstance(given, py::module_::import("numpy").attr("ma").attr("MaskedArray"));
}

/// Rows of a structured array of that dtype, of any shape, or one row by itself. Copied: nobody can change
/// them meanwhile.
template <class Struct>
std::vector<Struct> rows_of(const py::handle& given, const std::string& name, const char* dtype_name) {
  const py::dtype wanted = dtype_of<Struct>();
  if (!(py::isinstance<py::array>(given) || is_row(given)) || !py::object(given.attr("dtype")).equal(wanted))
    throw py::type_error(name + " is not an array of lumbrical." + dtype_name);
  if (is_masked(given)) throw py::type_error(name + " is a masked array; give its data");
  const auto array = py::array::ensure(given, py::array::c_style);
  if (!array) throw std::bad_alloc();
  std::vector<Struct> rows(static_cast<std::size_t>(array.size()));
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), array.data(), rows.size() * sizeof(Struct));
  return rows;
}

/// Frames with a kind that is one.
std::vector<DeviceFrame> frames_of(const py::handle& given);

/// Numbers of this shape (-1: any), converted to Number if need be; none of them NaN or infinite. No text,
/// dates or complex numbers, which NumPy would convert, too.
template <class Number>
std::vector<Number> numbers_of(const py::handle& given, std::vector<py::ssize_t> shape, const char* name);

using MeshArrays = std::pair<py::array, py::array>;  // vertices (n, 3), triangles (m, 3)
Mesh mesh_of(const py::handle& vertices, const py::handle& triangles);
Vec3 vec3_of(const py::handle& given, const char* name);
Pose pose_of(const py::handle& position, const py::handle& orientation);

template <class Enum>
Enum parsed(const std::optional<Enum>& value, const std::string& text, const char* what) {
  if (!value) throw py::value_error("\"" + text + "\" is no " + what);
  return *value;
}

Law law_of(const std::string& text);
Execution execution_of(std::uint32_t threads, const std::string& broadphase, const std::string& isa);

/// What a property is set to. Left to itself pybind11 refuses without the property's name.
template <class Value>
Value taken(const py::object& given, const char* name, const char* takes) {
  try {
    return given.cast<Value>();
  } catch (const py::cast_error&) {
    const std::string message = std::string(name) + " takes " + takes;
    if (std::is_arithmetic_v<Value> && py::isinstance<py::int_>(given)) throw py::value_error(message);
    throw py::type_error(message);
  }
}

// A session takes it by reference: by a shared pointer pybind11 would refuse one that __new__ has made with
// a RuntimeError.
struct PyModel : Bound, std::enable_shared_from_this<PyModel> {
  Model model;
  State start;
};

void bind_scene(py::module_& module);
void bind_session(py::module_& module);
void bind_recording(py::module_& module);

}  // namespace lumbrical::python
