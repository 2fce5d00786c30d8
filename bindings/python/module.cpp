// The Python module: dtypes, meshes, and what is asked of them without a session.
#include <optional>
#include <string_view>

#include "bind.h"
#include "lumbrical/probe.h"
#include "lumbrical/shapes.h"

namespace lumbrical::python {
namespace {

// numpy.dtype from names, formats and offsets.
class DtypeBuilder {
 public:
  void add(const char* name, const py::object& format, const void* field, const void* start) {
    names_.append(name);
    formats_.append(format);
    offsets_.append(static_cast<const char*>(field) - static_cast<const char*>(start));
  }
  [[nodiscard]] py::dtype finish(std::size_t size) const {
    using namespace py::literals;
    const py::dict description("names"_a = names_, "formats"_a = formats_, "offsets"_a = offsets_,
                               "itemsize"_a = size);
    return py::module_::import("numpy").attr("dtype")(description).cast<py::dtype>();
  }

 private:
  py::list names_, formats_, offsets_;
};

py::object plain(const char* text) { return py::str(text); }
py::object many(const py::object& format, int count) { return py::make_tuple(format, py::make_tuple(count)); }

py::object format_of(const double&) { return plain("<f8"); }
py::object format_of(const float&) { return plain("<f4"); }
py::object format_of(const std::uint64_t&) { return plain("<u8"); }
py::object format_of(const std::uint32_t&) { return plain("<u4"); }
py::object format_of(const InputKind&) { return plain("u1"); }
py::object format_of(const Vec3&) { return plain("(3,)<f8"); }
py::object format_of(const Quat&) { return plain("(4,)<f8"); }  // w x y z
template <class Struct>
requires std::is_class_v<Struct> py::object format_of(const Struct&) { return dtype_of<Struct>(); }
py::object format_of(const std::array<Vec3, kSegmentCount>&) { return plain("(16,3)<f8"); }
template <class Item, std::size_t kCount>
py::object format_of(const std::array<Item, kCount>& items) {
  return many(format_of(items[0]), static_cast<int>(kCount));
}

#define FIELD(name) builder.add(#name, format_of(row.name), &row.name, &row)

template <class Struct>
py::dtype built(void (*list)(DtypeBuilder&, const Struct&)) {
  static const Struct row{};
  DtypeBuilder builder;
  list(builder, row);
  return builder.finish(sizeof(Struct));
}

}  // namespace

template <>
py::dtype dtype_of<double>() {
  return py::dtype("<f8");
}
template <>
py::dtype dtype_of<std::uint32_t>() {
  return py::dtype("<u4");
}
template <>
py::dtype dtype_of<Pose>() {
  return built<Pose>([](DtypeBuilder& builder, const Pose& row) {
    FIELD(position);
    FIELD(orientation);
  });
}
template <>
py::dtype dtype_of<Wrench>() {
  return built<Wrench>([](DtypeBuilder& builder, const Wrench& row) {
    FIELD(force);
    FIELD(torque);
  });
}
template <>
py::dtype dtype_of<JointPose>() {
  return built<JointPose>([](DtypeBuilder& builder, const JointPose& row) {
    FIELD(position);
    FIELD(orientation);
  });
}
template <>
py::dtype dtype_of<DeviceFrame>() {
  return built<DeviceFrame>([](DtypeBuilder& builder, const DeviceFrame& row) {
    FIELD(base);
    FIELD(kind);
    FIELD(flags);
    FIELD(valid);
    FIELD(joint);
    FIELD(angle);
  });
}
template <>
py::dtype dtype_of<ActuatorFrame>() {
  return built<ActuatorFrame>([](DtypeBuilder& builder, const ActuatorFrame& row) {
    FIELD(tick);
    FIELD(flags);
    FIELD(contact_count);
    FIELD(evaluations);
    FIELD(error_estimate);
    FIELD(force_error);
    FIELD(segment);
    FIELD(joint_torque);
    FIELD(flexion_torque);
  });
}
template <>
py::dtype dtype_of<ContactRow>() {
  return built<ContactRow>([](DtypeBuilder& builder, const ContactRow& row) {
    FIELD(segment);
    FIELD(object);
    FIELD(triangle);
    FIELD(primitive);
    FIELD(depth);
    FIELD(area);
    FIELD(volume);
    FIELD(error);
    FIELD(centroid);
    FIELD(centre);
    FIELD(normal);
    FIELD(force);
  });
}
template <>
py::dtype dtype_of<ObjectFrame>() {
  return dtype_of<Pose>();
}
template <>
py::dtype dtype_of<ObjectOutput>() {
  return built<ObjectOutput>([](DtypeBuilder& builder, const ObjectOutput& row) {
    FIELD(pose);
    FIELD(wrench);
    FIELD(coordinate);
  });
}
template <>
py::dtype dtype_of<RecordedTick>() {
  return built<RecordedTick>([](DtypeBuilder& builder, const RecordedTick& row) {
    FIELD(frame);
    FIELD(output);
    FIELD(state_hash);
    FIELD(duration_ns);
  });
}
template <>
py::dtype dtype_of<ProbeContact>() {
  return built<ProbeContact>([](DtypeBuilder& builder, const ProbeContact& row) {
    FIELD(triangle);
    FIELD(primitive);
    FIELD(depth);
    FIELD(area);
    FIELD(volume);
    FIELD(error);
    FIELD(centroid);
    FIELD(centre);
    FIELD(normal);
    FIELD(force);
  });
}

std::vector<DeviceFrame> frames_of(const py::handle& given) {
  std::vector<DeviceFrame> frames = rows_of<DeviceFrame>(given, "frames", "frame_dtype");
  if (given.attr("ndim").cast<int>() > 1) throw py::value_error("frames has more than one dimension");
  for (const DeviceFrame& frame : frames)
    if (static_cast<std::uint8_t>(frame.kind) > 1)
      throw py::value_error("frames[\"kind\"] is neither 0 (joint poses) nor 1 (joint angles)");
  return frames;
}

namespace {

// None where NumPy makes no array of it, or one of text, dates, complex numbers or objects.
std::optional<py::array> real_numbers(const py::handle& given) {
  constexpr std::string_view kKinds = "biuf";
  const auto array = py::array::ensure(given);
  if (!array) PyErr_Clear();
  if (!array || is_masked(given) || kKinds.find(array.dtype().kind()) == std::string_view::npos)
    return std::nullopt;
  return array;
}

}  // namespace

template <class Number>
std::vector<Number> numbers_of(const py::handle& given, std::vector<py::ssize_t> shape, const char* name) {
  if (given.is_none()) throw py::type_error(std::string(name) + " is None");
  const std::optional<py::array> real = real_numbers(given);
  if (!real) throw py::type_error(std::string(name) + " is not an array of real numbers, with none masked");
  const auto array = py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(*real);
  if (!array) throw std::bad_alloc();
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (std::size_t i = 0; fits && i < shape.size(); ++i)
    fits = shape[i] < 0 || shape[i] == array.shape(static_cast<py::ssize_t>(i));
  if (!fits) {
    std::string text;
    for (const py::ssize_t n : shape) text += (text.empty() ? "" : ", ") + (n < 0 ? "n" : std::to_string(n));
    throw py::value_error(std::string(name) + " is not of shape (" + text + ")");
  }
  std::vector<Number> numbers(array.data(), array.data() + array.size());
  if constexpr (std::is_floating_point_v<Number>)
    for (const Number number : numbers)
      if (!is_finite(number)) throw py::value_error(std::string(name) + " holds a number that is not finite");
  return numbers;
}
template std::vector<double> numbers_of<double>(const py::handle&, std::vector<py::ssize_t>, const char*);

Vec3 vec3_of(const py::handle& given, const char* name) {
  const auto v = numbers_of<double>(given, {3}, name);
  return {v[0], v[1], v[2]};
}

Pose pose_of(const py::handle& position, const py::handle& orientation) {
  const auto q = numbers_of<double>(orientation, {4}, "orientation");
  const Quat rotation{q[0], q[1], q[2], q[3]};
  const double square = dot(rotation, rotation);
  if (!(square > 1e-12 && is_finite(square)))
    throw py::value_error(
        "orientation is no quaternion that can be made one of length 1: it is zero, or too long");
  return {vec3_of(position, "position"), normalized(rotation)};
}

// Whole numbers only: 0.5 must not become a vertex.
Mesh mesh_of(const py::handle& vertices, const py::handle& triangles) {
  const auto xyz = numbers_of<double>(vertices, {-1, 3}, "vertices");
  if (!py::isinstance<py::array>(triangles) && !py::isinstance<py::sequence>(triangles))
    throw py::type_error("triangles is not an array");
  const auto kind = py::array::ensure(triangles);
  if (!kind || (kind.dtype().kind() != 'i' && kind.dtype().kind() != 'u')) {
    PyErr_Clear();
    throw py::type_error("triangles is not an array of whole numbers");
  }
  const auto corners = numbers_of<double>(triangles, {-1, 3}, "triangles");
  Mesh mesh;
  for (std::size_t i = 0; i < xyz.size(); i += 3) mesh.vertices.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
  const auto corner = [&](std::size_t i) {
    if (!(corners[i] >= 0 && corners[i] < static_cast<double>(mesh.vertices.size())))
      throw py::value_error("triangle " + std::to_string(i / 3) + " names a vertex that is not there");
    return static_cast<std::uint32_t>(corners[i]);
  };
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.triangles.push_back({corner(i), corner(i + 1), corner(i + 2)});
  return mesh;
}

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));

MeshArrays arrays_of(Mesh mesh) {
  auto kept = std::make_unique<Mesh>(std::move(mesh));
  const Mesh& held = *kept;
  const py::capsule owner(kept.release(), [](void* p) { delete static_cast<Mesh*>(p); });
  const auto rows = [](const auto& items) { return static_cast<py::ssize_t>(items.size()); };
  return {
      view_of(reinterpret_cast<const double*>(held.vertices.data()), {rows(held.vertices), 3}, owner, true),
      view_of(reinterpret_cast<const std::uint32_t*>(held.triangles.data()), {rows(held.triangles), 3}, owner,
              true)};
}

void check_argument(bool good, const char* name, const std::string& range) {
  if (!good) throw py::value_error(std::string(name) + " is out of range: give " + range);
}

void check_length(double value, const char* name, double below = 1e6) {
  check_argument(value > 0 && value < below, name,
                 "more than 0 and less than " + std::to_string(static_cast<int>(below)) + " m");
}

void check_count(std::uint32_t value, const char* name, std::uint32_t least, std::uint32_t most) {
  check_argument(value >= least && value <= most, name,
                 std::to_string(least) + " to " + std::to_string(most));
}

MeshArrays mug_of(double radius, double height, double wall, std::uint32_t segments) {
  check_length(radius, "radius", 1000);
  check_length(height, "height", 1000);
  check_length(wall, "wall", 1000);
  check_count(segments, "segments", 8, 2048);
  MugShape shape;
  shape.radius = radius;
  shape.height = height;
  shape.wall = wall;
  shape.segments = segments;
  Mesh mesh = make_mug(shape);
  if (mesh.triangles.empty())
    throw py::value_error(
        "radius, height and wall make no mug: the wall has to be less than half of radius and height, and "
        "the handle, 12 mm thick and 33 mm off the wall, has to fit between bottom and rim and end in the "
        "wall");
  return arrays_of(std::move(mesh));
}

MeshArrays plane_of(double extent, std::uint32_t cells) {
  check_length(extent, "extent");
  check_count(cells, "cells", 1, 16384);
  return arrays_of(make_plane(extent, cells));
}

MeshArrays box_of(const py::object& given_size, std::uint32_t cells) {
  const Vec3 size = vec3_of(given_size, "size");
  for (const double side : {size.x, size.y, size.z}) check_length(side, "size");
  check_count(cells, "cells", 1, 8192);
  return arrays_of(make_box(size, cells));
}

MeshArrays sphere_of(double radius, std::uint32_t cells) {
  check_length(radius, "radius");
  check_count(cells, "cells", 1, 8192);
  return arrays_of(make_sphere(radius, cells));
}

std::vector<ProbePrimitive> primitives_of(const py::object& spheres, const py::object& capsules,
                                          const py::object& cylinders) {
  std::vector<ProbePrimitive> primitives;
  if (!spheres.is_none()) {
    const auto n = numbers_of<double>(spheres, {-1, 4}, "spheres");
    for (std::size_t i = 0; i < n.size(); i += 4)
      primitives.push_back({ProbeShape::sphere, {n[i], n[i + 1], n[i + 2]}, {}, n[i + 3], 0});
  }
  if (!capsules.is_none()) {
    const auto n = numbers_of<double>(capsules, {-1, 8}, "capsules");
    for (std::size_t i = 0; i < n.size(); i += 8)
      primitives.push_back({ProbeShape::capsule,
                            {n[i], n[i + 1], n[i + 2]},
                            {n[i + 4], n[i + 5], n[i + 6]},
                            n[i + 3],
                            n[i + 7]});
  }
  if (!cylinders.is_none()) {
    const auto n = numbers_of<double>(cylinders, {-1, 7}, "cylinders");
    for (std::size_t i = 0; i < n.size(); i += 7)
      primitives.push_back(
          {ProbeShape::cylinder, {n[i], n[i + 1], n[i + 2]}, {n[i + 3], n[i + 4], n[i + 5]}, n[i + 6], 0});
  }
  return primitives;
}

py::array run_probe(const py::object& vertices, const py::object& triangles, const py::object& spheres,
                    const py::object& capsules, const py::object& cylinders, const std::string& law,
                    double stiffness) {
  const Mesh mesh = mesh_of(vertices, triangles);
  const std::vector<ProbePrimitive> primitives = primitives_of(spheres, capsules, cylinders);
  const Law which = law_of(law);
  std::vector<ProbeContact> contacts;
  Status status;
  {
    const py::gil_scoped_release release;
    status = probe(mesh, primitives, which, stiffness, contacts);
  }
  check(status);
  return array_of(std::move(contacts));
}

void bind_meshes(py::module_& module) {
  using namespace py::literals;
  module.def(
      "load_mesh",
      [](const Path& path, const std::string& unit) {
        const Unit which = parsed(parse_unit(unit), unit, "unit: give m, cm or mm");
        const std::string& name = file_of(path);
        Mesh mesh;
        Status status;
        {
          const py::gil_scoped_release release;
          status = load_mesh(name, which, mesh);
        }
        check(status);
        return arrays_of(std::move(mesh));
      },
      "path"_a, "unit"_a);
  const MugShape mug;
  module.def("make_mug", &mug_of, "radius"_a = mug.radius, "height"_a = mug.height, "wall"_a = mug.wall,
             "segments"_a = mug.segments);
  module.def("make_plane", &plane_of, "extent"_a, "cells"_a);
  module.def("make_box", &box_of, "size"_a, "cells"_a);
  module.def("make_sphere", &sphere_of, "radius"_a, "cells"_a);
  module.def("probe", &run_probe, "vertices"_a, "triangles"_a, "spheres"_a = py::none(),
             "capsules"_a = py::none(), "cylinders"_a = py::none(), "law"_a = "field", "stiffness"_a = 2e7,
             "Of dtype probe_dtype. Rows: spheres x y z r; capsules x y z r of both ends; cylinders two ends "
             "and r.");
}

}  // namespace

PYBIND11_MODULE(_lumbrical, module) {
  module.attr("__version__") = LUMBRICAL_VERSION;
  module.attr("pose_dtype") = dtype_of<Pose>();
  module.attr("wrench_dtype") = dtype_of<Wrench>();
  module.attr("frame_dtype") = dtype_of<DeviceFrame>();
  module.attr("output_dtype") = dtype_of<ActuatorFrame>();
  module.attr("contact_dtype") = dtype_of<ContactRow>();
  module.attr("object_dtype") = dtype_of<ObjectOutput>();
  module.attr("tick_dtype") = dtype_of<RecordedTick>();
  module.attr("probe_dtype") = dtype_of<ProbeContact>();
  py::list joints, segments;
  for (int j = 0; j < kJointCount; ++j) joints.append(joint_name(j));
  for (int s = 0; s < kSegmentCount; ++s) segments.append(segment_name(s));
  module.attr("joint_names") = py::tuple(joints);
  module.attr("segment_names") = py::tuple(segments);
  bind_meshes(module);
  bind_scene(module);
  bind_session(module);
  bind_recording(module);
}

}  // namespace lumbrical::python
