// Scenes and the models built from them, for Python.
#include <algorithm>
#include <optional>
#include <string_view>

#include "bind.h"
#include "lumbrical/motion.h"

namespace lumbrical::python {
namespace {

struct PyScene : Bound {
  Scene scene;
  Execution execution;
  Motion motion;
  double seconds = 0;
};

std::unique_ptr<PyScene> new_scene(const std::string& side, double hand_length) {
  if (side != "left" && side != "right") throw py::value_error("side is neither \"left\" nor \"right\"");
  if (!(hand_length >= 0.05 && hand_length <= 0.5)) throw py::value_error("hand_length is not 0.05 to 0.5 m");
  auto made = std::make_unique<PyScene>();
  made->scene.hand = default_hand(side == "left" ? Side::left : Side::right, hand_length);
  return made;
}

std::unique_ptr<PyScene> load(const Path& path) {
  const std::string& name = file_of(path);
  SceneFile file;
  Status status;
  {
    const py::gil_scoped_release release;
    status = load_scene_file(name, file);
    if (status.ok()) status = check_plain(file);
  }
  check(status);
  auto made = std::make_unique<PyScene>();
  made->scene = std::move(file.scene);
  made->execution = file.execution;
  made->motion = std::move(file.motion);
  made->seconds = file.seconds;
  return made;
}

// Of the solid inside the mesh; of none where nothing is given, which what is given where it goes may do.
MassProperties mass_of(const Mesh& mesh, Winding winding, double density, double mass) {
  if (density == 0 && mass == 0) return {};
  Mesh wound = mesh;
  wind_outwards(wound, winding);
  MassProperties body;
  check(mass_properties(wound, density > 0 ? density : 1, body));
  if (mass > 0) scale_to_mass(mass, body);
  return body;
}

struct Moves {
  std::string moves;
  double density, mass, damping;
  py::object pivot, axis;
  double lower, upper, spring, rest, dry_friction, detent_force, detent_pitch;
  std::optional<std::uint32_t> latch_object;
  double latch_opens;
};

Mechanism mechanism_of(const Moves& given, const SceneObject& object) {
  Mechanism mechanism;
  mechanism.mobility = parsed(parse_mobility(given.moves), given.moves,
                              "way to move: fixed, given, free, hinge, slider or ball");
  check(check_weight(mechanism.mobility, given.density, given.mass));
  mechanism.body = mass_of(object.mesh, object.winding, given.density, given.mass);
  mechanism.damping = given.damping;
  if (!given.pivot.is_none() && mechanism.mobility < Mobility::hinge)
    throw py::value_error("pivot acts on a hinge, slider or ball only, and this is \"" + given.moves +
                          "\": leave it out, or let the object move so");
  if (!given.latch_object && given.latch_opens != 0)
    throw py::value_error(
        "latch_opens acts on a latch only: give latch_object, the handle that opens it, too");
  if (moves_by_itself(mechanism))
    mechanism.pivot = given.pivot.is_none() ? object.pose.position : vec3_of(given.pivot, "pivot");
  mechanism.axis = unit_or(vec3_of(given.axis, "axis"), {});
  mechanism.lower = given.lower;
  mechanism.upper = given.upper;
  mechanism.spring = given.spring;
  mechanism.rest = given.rest;
  mechanism.dry_friction = given.dry_friction;
  mechanism.detent_force = given.detent_force;
  mechanism.detent_pitch = given.detent_pitch;
  if (given.latch_object) mechanism.latch = {*given.latch_object, given.latch_opens};
  return mechanism;
}

struct Feel {
  double crease_angle;
  py::object friction_factors, grip, bumps;
};

// (image, period, black, white); greys of 0 .. 1, rows from the top.
Texture texture_of(const py::object& given, const char* name) {
  if (given.is_none()) return {};
  if (!py::isinstance<py::sequence>(given) || py::len(given) != 4)
    throw py::type_error(std::string(name) + " is not (image, period, black, white)");
  const auto parts = given.cast<py::sequence>();
  const py::object image = parts[0];
  const std::vector<double> greys = numbers_of<double>(image, {-1, -1}, name);
  const auto shape = py::array::ensure(image);
  if (greys.empty() || greys.size() > kMostTexels)
    throw py::value_error(std::string(name) + " has no texels, or more than 4194304");
  const auto number = [&](std::size_t i) {
    return taken<double>(parts[i], name,
                         "(image, period, black, white), of which the last three are numbers");
  };
  Texture texture{
      {static_cast<std::uint32_t>(shape.shape(1)), static_cast<std::uint32_t>(shape.shape(0)), {}},
      number(1),
      number(2),
      number(3)};
  for (const double grey : greys) {
    if (!(grey >= 0 && grey <= 1))
      throw py::value_error(std::string(name) + " has a grey that is not 0 to 1");
    texture.image.grey.push_back(static_cast<std::uint16_t>(65535 * grey + 0.5));
  }
  return texture;
}

Surface surface_of(const Feel& given) {
  Surface surface;
  surface.crease_angle = given.crease_angle;
  if (!given.friction_factors.is_none())
    surface.friction_factor = numbers_of<double>(given.friction_factors, {-1}, "friction_factors");
  surface.grip = texture_of(given.grip, "grip");
  surface.bumps = texture_of(given.bumps, "bumps");
  return surface;
}

void add_object(PyScene& self, std::string name, const py::object& vertices, const py::object& triangles,
                const py::object& position, const py::object& orientation, const std::string& winding,
                Material material, const Moves& moves, const Feel& feel) {
  SceneObject object;
  object.name = std::move(name);
  object.mesh = mesh_of(vertices, triangles);
  object.winding = parsed(parse_winding(winding), winding, "winding: auto, as is or flip");
  object.pose = pose_of(position, orientation);
  object.material = material;
  object.mechanism = mechanism_of(moves, object);
  object.surface = surface_of(feel);
  if (!is_apart(object)) {
    place_mesh(object.pose, object.mesh);
    object.pose = {};
  }
  self.scene.objects.push_back(std::move(object));
}

// A tracker's hand: its palm, and its radii where it has some.
void fit_hand_of(PyScene& self, const py::object& given, const py::object& radii) {
  const std::vector<DeviceFrame> frames = frames_of(given);
  if (frames.size() != 1) throw py::value_error("frame is not one frame");
  std::array<double, kJointCount> radius{};
  if (!radii.is_none()) {
    const std::vector<double> told = numbers_of<double>(radii, {kJointCount}, "radii");
    std::copy(told.begin(), told.end(), radius.begin());
  }
  check(fit_hand_to(frames[0], radius, self.scene.hand));
}

// The scene file's motion at the times of ticks.
py::array motion_frames(const PyScene& self) {
  if (self.motion.samples.empty()) throw py::value_error("the scene has no motion; only one from a file has");
  const double rate = self.scene.settings.rate;
  if (!(rate >= 1 && rate <= 100000)) throw py::value_error("rate is out of range: give 1 to 100000 Hz");
  std::vector<DeviceFrame> frames(tick_count(self.seconds, rate));
  {
    const py::gil_scoped_release release;
    for (std::size_t i = 0; i < frames.size(); ++i)
      frames[i] = resample(self.motion, static_cast<double>(i) / rate);
  }
  return array_of(std::move(frames));
}

std::shared_ptr<PyModel> build(const PyScene& self, std::optional<std::uint32_t> threads,
                               const std::optional<std::string>& broadphase, const std::string& isa) {
  Execution execution = self.execution;
  const Execution given = execution_of(threads.value_or(execution.threads), broadphase.value_or("auto"), isa);
  execution.threads = given.threads;
  execution.isa = given.isa;
  if (broadphase) execution.broadphase = given.broadphase;
  auto built = std::make_shared<PyModel>();
  const Scene scene = self.scene;  // nobody changes it meanwhile
  Status status;
  {
    const py::gil_scoped_release release;
    status = build_model(scene, execution, built->model);
  }
  check(status);
  built->start = make_state(built->model);
  return built;
}

std::shared_ptr<PyModel> share(const PyModel& world, const PyScene& scene) {
  auto built = std::make_shared<PyModel>();
  const Hand hand = scene.scene.hand;  // nobody changes it meanwhile
  Status status;
  {
    const py::gil_scoped_release release;
    status = share_world(world.model, hand, built->model);
  }
  check(status);
  built->start = make_state(built->model);
  return built;
}

template <class T>
py::array shared_view(const SharedArray<T>& items, py::handle owner) {
  return view_of(items.data(), {static_cast<py::ssize_t>(items.size())}, owner, false);
}

py::tuple vertices(const py::object& self) {
  const Triangles& world = self.cast<const PyModel&>().model.triangles;
  return py::make_tuple(shared_view(world.x, self), shared_view(world.y, self), shared_view(world.z, self));
}

py::tuple triangles(const py::object& self) {
  const Triangles& world = self.cast<const PyModel&>().model.triangles;
  return py::make_tuple(shared_view(world.a, self), shared_view(world.b, self), shared_view(world.c, self));
}

py::list object_names(const PyModel& self) {
  py::list names;
  for (const World::Object& object : all_objects(self.model)) names.append(text_of(object.name));
  return names;
}

// Read only, so that nobody writes into the copy that scene.ground gives.
void bind_ground(py::module_& module) {
  using namespace py::literals;
  py::class_<Ground>(module, "Ground",
                     "A plane that free objects rest on, normal . p = offset; the hand does not feel it.")
      .def(py::init([](const py::object& normal, double offset, double friction) {
             return Ground{unit_or(vec3_of(normal, "normal"), {}), offset, friction};
           }),
           py::kw_only(), "normal"_a = py::make_tuple(0, 0, 1), "offset"_a = Ground{}.offset,
           "friction"_a = Ground{}.friction)
      .def_property_readonly(
          "normal",
          [](const Ground& self) { return py::make_tuple(self.normal.x, self.normal.y, self.normal.z); })
      .def_readonly("offset", &Ground::offset)
      .def_readonly("friction", &Ground::friction);
}

// None where segments follow different laws.
std::optional<std::string_view> common_law(const PyScene& self) {
  const auto& laws = self.scene.settings.law;
  if (std::any_of(laws.begin(), laws.end(), [&](Law law) { return law != laws[0]; })) return std::nullopt;
  return law_name(laws[0]);
}

py::tuple laws_of(const PyScene& self) {
  py::list laws;
  for (const Law law : self.scene.settings.law) laws.append(law_name(law));
  return py::tuple(laws);
}

void set_laws(PyScene& self, const std::vector<std::string>& names) {
  if (names.size() != kSegmentCount)
    throw py::value_error("laws are " + std::to_string(names.size()) + "; give 16, one for each segment");
  std::array<Law, kSegmentCount> laws{};
  for (std::size_t i = 0; i < laws.size(); ++i) laws[i] = law_of(names[i]);
  self.scene.settings.law = laws;
}

std::string described(const PyScene& self) {
  const Scene& scene = self.scene;
  return "<lumbrical.Scene: " + std::string(side_name(scene.hand.side)) + " hand, " +
         std::to_string(scene.objects.size()) + (scene.objects.size() == 1 ? " object" : " objects") +
         (scene.world ? " and a world" : "") + ">";
}

std::string described(const PyModel& self) {
  std::size_t triangles = self.model.triangles.size();
  for (const ApartObject& apart : self.model.apart) triangles += apart.shape->triangles.size();
  return "<lumbrical.Model: " + std::string(side_name(self.model.hand.side)) + " hand, " +
         std::to_string(triangles) + " triangles>";
}

// A property that is set to a Value.
template <class Value, class Class, class Get, class Set>
void bind_property(Class& bound, const char* name, const char* takes, const Get& get, const Set& set) {
  bound.def_property(name, get, [=](PyScene& self, const py::object& given) {
    set(self, taken<Value>(given, name, takes));
  });
}

bool is_one_number(const py::object& given) {
  const auto array = py::array::ensure(given);
  if (!array) PyErr_Clear();
  return array && array.ndim() == 0;
}

// Numbers that are written to in place, or set together: to as many, or where `one_for_all` to one.
template <class Class, class Data>
void bind_view(Class& bound, const char* name, const std::vector<py::ssize_t>& shape, bool one_for_all,
               const Data& data) {
  const auto get = [=](const py::object& self) {
    return view_of(static_cast<const double*>(data(self.cast<PyScene&>())), shape, self, true);
  };
  bound.def_property(name, get, [=](PyScene& self, const py::object& given) {
    py::ssize_t count = 1;
    for (const py::ssize_t n : shape) count *= n;
    double* const target = data(self);
    if (one_for_all && is_one_number(given))
      std::fill_n(target, count, numbers_of<double>(given, {}, name)[0]);
    else
      std::ranges::copy(numbers_of<double>(given, shape, name), target);
  });
}

// Settings that are one number.
template <class Class, class Number>
void bind_number(Class& bound, const char* name, Number Settings::*field) {
  bind_property<Number>(
      bound, name, std::is_integral_v<Number> ? "a whole number, 0 to 4294967295" : "a number",
      [field](const PyScene& self) { return self.scene.settings.*field; },
      [field](PyScene& self, Number value) { self.scene.settings.*field = value; });
}

}  // namespace

Law law_of(const std::string& text) {
  return parsed(parse_law(text), text, "law: field, column, max-depth, centroid or point");
}

Execution execution_of(std::uint32_t threads, const std::string& broadphase, const std::string& isa) {
  Execution execution;
  execution.threads = threads;
  execution.broadphase =
      parsed(parse_broadphase(broadphase), broadphase, "broadphase: auto, tree, grid, voxel or brute");
  execution.isa =
      parsed(parse_isa(isa), isa, "instruction set: auto, scalar, sse2, avx2, avx512, neon or simd128");
  return execution;
}

void bind_scene(py::module_& module) {
  using namespace py::literals;
  const Mechanism mechanism;
  bind_ground(module);
  py::class_<PyScene> scene(module, "Scene", "What is touched, by which hand, and how forces are computed.");
  scene.def(py::init(&new_scene), "side"_a = "right", "hand_length"_a = 0.19);
  scene.def_static("load", &load, "path"_a);
  scene.def(
      "add_object",
      [](PyScene& self, std::string name, const py::object& xyz, const py::object& corners,
         const py::object& position, const py::object& orientation, const std::string& winding,
         double friction, std::optional<double> kinetic_friction, double viscosity, double shear_stiffness,
         const std::string& moves, double density, double mass, double damping, const py::object& pivot,
         const py::object& axis, double lower, double upper, double spring, double rest, double dry_friction,
         double detent_force, double detent_pitch, std::optional<std::uint32_t> latch_object,
         double latch_opens, double crease_angle, const py::object& friction_factors, const py::object& grip,
         const py::object& bumps) {
        add_object(self, std::move(name), xyz, corners, position, orientation, winding,
                   {friction, kinetic_friction.value_or(friction), viscosity, shear_stiffness},
                   {moves, density, mass, damping, pivot, axis, lower, upper, spring, rest, dry_friction,
                    detent_force, detent_pitch, latch_object, latch_opens},
                   {crease_angle, friction_factors, grip, bumps});
      },
      "name"_a, "vertices"_a, "triangles"_a, py::kw_only(), "position"_a = py::make_tuple(0, 0, 0),
      "orientation"_a = py::make_tuple(1, 0, 0, 0), "winding"_a = "auto", "friction"_a = 0.0,
      "kinetic_friction"_a = py::none(), "viscosity"_a = 0.0,
      "shear_stiffness"_a = Material{}.shear_stiffness, "moves"_a = "fixed", "density"_a = 0.0,
      "mass"_a = 0.0, "damping"_a = 0.0, "pivot"_a = py::none(), "axis"_a = py::make_tuple(0, 0, 1),
      "lower"_a = mechanism.lower, "upper"_a = mechanism.upper, "spring"_a = 0.0, "rest"_a = 0.0,
      "dry_friction"_a = 0.0, "detent_force"_a = 0.0, "detent_pitch"_a = mechanism.detent_pitch,
      "latch_object"_a = py::none(), "latch_opens"_a = 0.0, "crease_angle"_a = 0.0,
      "friction_factors"_a = py::none(), "grip"_a = py::none(), "bumps"_a = py::none());
  scene.def("__repr__", [](const PyScene& self) { return described(self); });
  scene.def("frames", &motion_frames, "the scene file's motion, a frame per tick");
  scene.def("fit_hand", &fit_hand_of, "frame"_a, "radii"_a = py::none(),
            "The palm of a frame of pose_frames in which all joints are tracked, and radii (26,) [m], 0 "
            "where unknown.");
  bind_number(scene, "stiffness", &Settings::stiffness);
  bind_number(scene, "rate", &Settings::rate);
  bind_number(scene, "point_area", &Settings::point_area);
  bind_number(scene, "max_force", &Settings::max_force);
  bind_number(scene, "fade_time", &Settings::fade_time);
  bind_number(scene, "proxy_stiffness", &Settings::proxy_stiffness);
  bind_number(scene, "effort", &Settings::effort);
  bind_number(scene, "max_candidates", &Settings::max_candidates);
  static_assert(sizeof(PadLayer) == 2 * sizeof(double));
  bind_view(scene, "pad_layers", {kPadLayers, 2}, false,
            [](PyScene& self) { return &self.scene.settings.pad.layer[0].from; });
  bind_property<double>(
      scene, "pad_damping", "a number", [](const PyScene& self) { return self.scene.settings.pad.damping; },
      [](PyScene& self, double value) { self.scene.settings.pad.damping = value; });
  bind_view(scene, "precision", {kSegmentCount}, true,
            [](PyScene& self) { return self.scene.settings.precision.data(); });
  bind_view(scene, "radii", {kJointCount}, false,
            [](PyScene& self) { return self.scene.hand.radius.data(); });
  bind_view(scene, "gravity", {3}, false, [](PyScene& self) { return &self.scene.gravity.x; });
  bind_property<std::vector<std::string>>(scene, "laws", "16 strings, one for each segment", &laws_of,
                                          &set_laws);
  bind_property<std::optional<Ground>>(
      scene, "ground", "a Ground or None", [](const PyScene& self) { return self.scene.ground; },
      [](PyScene& self, const std::optional<Ground>& ground) { self.scene.ground = ground; });
  bind_property<std::string>(
      scene, "law", "a string", &common_law,
      [](PyScene& self, const std::string& law) { self.scene.settings.law.fill(law_of(law)); });
  bind_property<std::string>(
      scene, "felt_once", "a string",
      [](const PyScene& self) { return felt_once_name(self.scene.settings.felt_once); },
      [](PyScene& self, const std::string& felt_once) {
        self.scene.settings.felt_once =
            parsed(parse_felt_once(felt_once), felt_once, "felt_once: never, by-samples or always");
      });
  scene.def_property_readonly("side", [](const PyScene& self) { return side_name(self.scene.hand.side); });

  py::class_<PyModel, std::shared_ptr<PyModel>> model(
      module, "Model", "A scene built for ticks: immutable, for any number of sessions and threads.");
  model.def(py::init(&build), "scene"_a, py::kw_only(), "threads"_a = py::none(), "broadphase"_a = py::none(),
            "isa"_a = "auto");
  model.def("__repr__", [](const PyModel& self) { return described(self); });
  model.def("share", &share, "scene"_a, "this world for another hand, that of `scene`");
  model.def_property_readonly("vertices", &vertices);
  model.def_property_readonly("triangles", &triangles);
  model.def_property_readonly("object_names", &object_names);
  model.def_property_readonly("rate", [](const PyModel& self) { return self.model.settings.rate; });
  model.def_property_readonly("side", [](const PyModel& self) { return side_name(self.model.hand.side); });
}

}  // namespace lumbrical::python
