// lumbrical.h: scenes and the models built from them.
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/floating_point.h"
#include "capi/boundary.h"
#include "capi/convert.h"
#include "model/ranges.h"
#include "model/scene_check.h"

using namespace lumbrical;
using namespace lumbrical::capi;

namespace {

// lumbrical_object::kinetic_friction that is the static one.
constexpr double kStaticFriction = -1;

Fault take_vertices(const lumbrical_object& given, Mesh& mesh) {
  if ((given.vertices == nullptr) == (given.float_vertices == nullptr))
    return bad_argument("give the object vertices or float_vertices, one of the two, or a mesh_file");
  if (Fault fault = check_pointer(given.triangles, "object->triangles")) return fault;
  if (given.vertex_count > UINT32_MAX - 1 || given.triangle_count > INT32_MAX)
    return bad_argument("object->vertex_count or triangle_count is above 2^32 - 2 or 2^31 - 1");
  const auto take = [&](const auto* xyz) {
    mesh.vertices.resize(given.vertex_count);
    for (std::size_t i = 0; i < given.vertex_count; ++i)
      mesh.vertices[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  };
  if (given.vertices != nullptr) {
    take(given.vertices);
  } else {
    take(given.float_vertices);
  }
  mesh.triangles.resize(given.triangle_count);
  std::memcpy(mesh.triangles.data(), given.triangles, given.triangle_count * sizeof(Triangle));
  return {};
}

// Which may be the host program's own.
Fault refuse_standard_input(const char* path, const char* what) {
  if (std::string_view(path) != "-") return {};
  return bad_argument(std::string(what) + " is not read from standard input here; give a path");
}

Fault take_mesh(const lumbrical_object& given, Convention convention, Mesh& mesh) {
  Unit unit{};
  if (Fault fault = check_enum(given.unit, 3, "object->unit", unit)) return fault;
  if (given.mesh_file != nullptr) {
    if (Fault fault = refuse_standard_input(given.mesh_file, "object->mesh_file")) return fault;
    if (given.vertices != nullptr || given.float_vertices != nullptr)
      return bad_argument("the object has a mesh_file and vertices; give one of the two");
    if (Fault fault = load_mesh(given.mesh_file, unit, mesh)) return fault;
  } else if (unit != Unit::metre) {
    return bad_argument(
        "object->unit is of a mesh_file's numbers, and vertices are in the convention's: leave it METRE");
  } else if (Fault fault = take_vertices(given, mesh)) {
    return fault;
  }
  // A file's unit is told, its axes are the convention's.
  const Quantity quantity = given.mesh_file != nullptr ? Quantity::direction : Quantity::position;
  for (Vec3& v : mesh.vertices) v = converted(convention, Convention::openxr, quantity, v);
  return {};
}

Fault take_mass(const lumbrical_object& given, const Mesh& mesh, Winding winding, MassProperties& body) {
  Mesh wound = mesh;
  wind_outwards(wound, winding);
  if (given.density > 0) return mass_properties(wound, given.density, body);
  if (Fault fault = mass_properties(wound, 1, body)) return fault;
  scale_to_mass(given.mass, body);
  return {};
}

// Where there is none it stays as it is given: a default converted would no longer be one.
Vec3 axis_of(const lumbrical_object& given, Convention convention, const Mechanism& mechanism) {
  if (!has_coordinate(mechanism)) return to_vec3(given.axis);
  const bool slides = mechanism.mobility == Mobility::slider;
  return converted(convention, Convention::openxr, slides ? Quantity::direction : Quantity::rotation,
                   to_vec3(given.axis));
}

// Of what has no joint, or no latch.
Fault refuse_idle(const lumbrical_object& given, const Mechanism& mechanism) {
  if (mechanism.mobility < Mobility::hinge && to_vec3(given.pivot) != Vec3{})
    return bad_argument("object->pivot acts on a hinge, slider or ball only, and this is \"" +
                        std::string(mobility_name(mechanism.mobility)) +
                        "\": leave it 0, or let the object move so");
  if (given.has_latch == 0 && (given.latch_object != 0 || given.latch_opens != 0))
    return bad_argument(
        "object->latch_object and latch_opens act on a latch only: set has_latch, or leave them 0");
  return {};
}

Fault take_mechanism(const lumbrical_object& given, Convention convention, SceneObject& object) {
  Mechanism& mechanism = object.mechanism;
  const Status weight = check_weight(mechanism.mobility, given.density, given.mass);
  if (!weight.ok()) return {weight, LUMBRICAL_BAD_ARGUMENT};
  if (Fault fault = refuse_idle(given, mechanism)) return fault;
  if (given.density != 0 || given.mass != 0) {
    if (Fault fault = check_object(object.name, object.mesh, 1)) return fault;
    if (Fault fault = take_mass(given, object.mesh, object.winding, mechanism.body)) return fault;
  }
  if (mechanism.mobility >= Mobility::hinge)
    mechanism.pivot = converted(convention, Convention::openxr, Quantity::position, to_vec3(given.pivot));
  mechanism.axis = axis_of(given, convention, mechanism);
  mechanism.damping = given.damping;
  mechanism.lower = given.lower;
  mechanism.upper = given.upper;
  mechanism.spring = given.spring;
  mechanism.rest = given.rest;
  mechanism.dry_friction = given.dry_friction;
  mechanism.detent_force = given.detent_force;
  mechanism.detent_pitch = given.detent_pitch;
  if (given.has_latch != 0) mechanism.latch = {given.latch_object, given.latch_opens};
  return {};
}

Fault take_texture(const lumbrical_texture& given, Texture& texture) {
  if (given.grey == nullptr) return {};
  const std::uint64_t texels = std::uint64_t{given.width} * given.height;
  if (texels == 0 || texels > kMostTexels)
    return bad_argument("a texture of the object has no texels, or more than 4194304");
  texture.image = {given.width, given.height, {given.grey, given.grey + texels}};
  texture.period = given.period;
  texture.black = given.black;
  texture.white = given.white;
  return {};
}

// A file has the triangles that it has: the caller's array ends where the caller says.
Fault check_factor_count(const lumbrical_object& given, const Mesh& mesh) {
  if (given.triangle_count == mesh.triangles.size()) return {};
  return bad_argument("object->triangle_count is " + std::to_string(given.triangle_count) +
                      " friction_factors, but the mesh_file has " + std::to_string(mesh.triangles.size()) +
                      " triangles; give one for each");
}

Fault take_surface(const lumbrical_object& given, SceneObject& object) {
  Surface& surface = object.surface;
  surface.crease_angle = given.crease_angle;
  if (const double* const factors = given.friction_factors) {
    if (Fault fault = check_factor_count(given, object.mesh)) return fault;
    surface.friction_factor.assign(factors, factors + given.triangle_count);
  }
  if (Fault fault = take_texture(given.grip, surface.grip)) return fault;
  return take_texture(given.bumps, surface.bumps);
}

Fault check_pose(const Pose& pose) {
  const double square = dot(pose.orientation, pose.orientation);
  if (is_finite(pose.position) && square > 0.25 && square < 4) return {};
  return bad_argument("object->pose is not finite, or its orientation no unit quaternion x y z w");
}

Fault to_object(const lumbrical_object& given, SceneObject& object) {
  Convention convention{};
  if (Fault fault = check_convention(given.convention, "object->convention", convention)) return fault;
  if (Fault fault = check_enum(given.mobility, 6, "object->mobility", object.mechanism.mobility))
    return fault;
  if (Fault fault = check_enum(given.winding, 3, "object->winding", object.winding)) return fault;
  if (given.reserved != 0) return bad_argument("object->reserved is not 0; call lumbrical_object_init first");
  if (given.name != nullptr) object.name = given.name;
  const bool same = given.kinetic_friction == kStaticFriction;
  object.material = {given.static_friction, same ? given.static_friction : given.kinetic_friction,
                     given.viscosity, given.shear_stiffness};
  const Pose pose = converted(convention, Convention::openxr, to_pose(given.pose));
  if (Fault fault = check_pose(pose)) return fault;
  object.pose = {pose.position, normalized(pose.orientation)};
  if (Fault fault = take_mesh(given, convention, object.mesh)) return fault;
  if (Fault fault = take_surface(given, object)) return fault;
  if (Fault fault = take_mechanism(given, convention, object)) return fault;
  if (is_apart(object)) return {};
  place_mesh(object.pose, object.mesh);
  object.pose = {};
  return {};
}

template <class Struct, class Fill>
int init(const char* function, Struct* out, const Fill& fill) noexcept {
  return call(function, [&]() -> Fault {
    if (Fault fault = check_pointer(out, "the struct")) return fault;
    *out = {};
    out->size = sizeof(Struct);
    fill(*out);
    return {};
  });
}

void to_c(const Scene& scene, lumbrical_settings& out) {
  const Settings& settings = scene.settings;
  out.effort = settings.effort;
  out.max_candidates = settings.max_candidates;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    out.law[s] = static_cast<std::int32_t>(settings.law[s]);
    out.precision[s] = settings.precision[s];
  }
  out.stiffness = settings.stiffness;
  out.rate = settings.rate;
  out.point_area = settings.point_area;
  out.max_force = settings.max_force;
  out.fade_time = settings.fade_time;
  out.proxy_stiffness = settings.proxy_stiffness;
  out.felt_once = static_cast<std::int32_t>(settings.felt_once);
  for (std::size_t i = 0; i < kPadLayers; ++i) {
    out.pad_from[i] = settings.pad.layer[i].from;
    out.pad_stiffness[i] = settings.pad.layer[i].stiffness;
  }
  out.pad_damping = settings.pad.damping;
  capi::to_c(scene.gravity, out.gravity);
  const Ground ground = scene.ground.value_or(Ground{});
  out.has_ground = scene.ground ? 1 : 0;
  capi::to_c(ground.normal, out.ground_normal);
  out.ground_offset = ground.offset;
  out.ground_friction = ground.friction;
}

Fault to_scene(const lumbrical_settings& given, Scene& scene) {
  Settings settings;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    const std::string name = "settings->law[" + std::to_string(s) + "]";
    if (Fault fault = check_enum(given.law[s], 5, name.c_str(), settings.law[s])) return fault;
    settings.precision[s] = given.precision[s];
  }
  settings.effort = given.effort;
  settings.max_candidates = given.max_candidates;
  settings.stiffness = given.stiffness;
  settings.rate = given.rate;
  settings.point_area = given.point_area;
  settings.max_force = given.max_force;
  settings.fade_time = given.fade_time;
  settings.proxy_stiffness = given.proxy_stiffness;
  if (Fault fault = check_enum(given.felt_once, 3, "settings->felt_once", settings.felt_once)) return fault;
  for (std::size_t i = 0; i < kPadLayers; ++i)
    settings.pad.layer[i] = {given.pad_from[i], given.pad_stiffness[i]};
  settings.pad.damping = given.pad_damping;
  scene.settings = settings;
  scene.gravity = to_vec3(given.gravity);
  scene.ground.reset();
  if (given.has_ground != 0)
    scene.ground = Ground{to_vec3(given.ground_normal), given.ground_offset, given.ground_friction};
  return {};
}

Fault build(const Scene& scene, const Execution& execution, std::shared_ptr<const BuiltModel>& result) {
  auto built = std::make_shared<BuiltModel>();
  if (Fault fault = build_model(scene, execution, built->model)) return fault;
  list_objects(*built);
  built->start = make_state(built->model);
  result = std::move(built);
  return {};
}

}  // namespace

const char* lumbrical_version(void) { return LUMBRICAL_VERSION; }

const char* lumbrical_joint_name(int32_t joint) {
  return joint >= 0 && joint < kJointCount ? joint_name(joint).data() : nullptr;
}
const char* lumbrical_segment_name(int32_t segment) {
  return segment >= 0 && segment < kSegmentCount ? segment_name(segment).data() : nullptr;
}

int lumbrical_object_init(lumbrical_object* object) {
  return init(__func__, object, [](lumbrical_object& out) {
    const Material material;
    const Mechanism mechanism;
    out.pose = capi::to_c(Pose{});
    out.kinetic_friction = kStaticFriction;
    out.shear_stiffness = material.shear_stiffness;
    capi::to_c(mechanism.axis, out.axis);
    out.lower = mechanism.lower;
    out.upper = mechanism.upper;
    out.detent_pitch = mechanism.detent_pitch;
  });
}

int lumbrical_settings_init(lumbrical_settings* settings) {
  return init(__func__, settings, [](lumbrical_settings& out) { to_c(Scene{}, out); });
}

int lumbrical_execution_init(lumbrical_execution* execution) {
  return init(__func__, execution, [](lumbrical_execution& out) {
    const Execution defaults;
    out.threads = defaults.threads;
    out.leaf_size = defaults.leaf_size;
  });
}

int lumbrical_frame_init(lumbrical_frame* frame) {
  return init(__func__, frame, [](lumbrical_frame& out) { capi::to_c(DeviceFrame{}, out); });
}

int lumbrical_scene_create(int32_t side, double hand_length, lumbrical_scene** scene) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_pointer(scene, "scene")) return fault;
    Side which{};
    if (Fault fault = check_enum(side, 2, "side", which)) return fault;
    if (!range::hand_length.holds(hand_length))
      return bad_argument("hand_length is out of range: give " + text_of(range::hand_length));
    auto made = std::make_unique<lumbrical_scene>();
    made->scene.hand = default_hand(which, hand_length);
    *scene = made.release();
    return {};
  });
}

int lumbrical_scene_load(const char* path, lumbrical_scene** scene) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_pointer(path, "path")) return fault;
    if (Fault fault = check_pointer(scene, "scene")) return fault;
    if (Fault fault = refuse_standard_input(path, "a scene")) return fault;
    SceneFile file;
    if (Fault fault = load_scene_file(path, file)) return fault;
    if (Fault fault = check_plain(file)) return fault;
    auto made = std::make_unique<lumbrical_scene>();
    made->scene = std::move(file.scene);
    made->execution = file.execution;
    made->motion = std::move(file.motion);
    made->seconds = file.seconds;
    *scene = made.release();
    return {};
  });
}

int lumbrical_scene_destroy(lumbrical_scene* scene) { return destroy(__func__, scene); }

int lumbrical_scene_add_object(lumbrical_scene* scene, const lumbrical_object* object) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_struct(object, "object")) return fault;
    const FloatingPointGuard guard;
    SceneObject made;
    if (Fault fault = to_object(*object, made)) return fault;
    scene->scene.objects.push_back(std::move(made));
    return {};
  });
}

int lumbrical_scene_settings(lumbrical_scene* scene, lumbrical_settings* settings) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_struct(settings, "settings")) return fault;
    to_c(scene->scene, *settings);
    return {};
  });
}

int lumbrical_scene_set_settings(lumbrical_scene* scene, const lumbrical_settings* settings) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_struct(settings, "settings")) return fault;
    return to_scene(*settings, scene->scene);
  });
}

int lumbrical_scene_set_radii(lumbrical_scene* scene, const double* radii) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_pointer(radii, "radii")) return fault;
    Hand hand = scene->scene.hand;
    std::memcpy(hand.radius.data(), radii, sizeof hand.radius);
    if (Fault fault = check_hand(hand)) return fault;
    scene->scene.hand = std::move(hand);
    return {};
  });
}

int lumbrical_scene_fit_hand(lumbrical_scene* scene, const void* xr_hand_joint_locations) {
  return call_with(__func__, scene, [&]() -> Fault {
    DeviceFrame frame;
    std::array<double, kJointCount> radius;
    if (Fault fault = read_openxr(xr_hand_joint_locations, frame, radius)) return fault;
    return fit_hand_to(frame, radius, scene->scene.hand);
  });
}

int lumbrical_scene_seconds(lumbrical_scene* scene, double* seconds) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_pointer(seconds, "seconds")) return fault;
    if (scene->motion.samples.empty())
      return bad_argument("the scene has no motion; only one from a file has");
    *seconds = scene->seconds;
    return {};
  });
}

int lumbrical_scene_frame(lumbrical_scene* scene, double time, lumbrical_frame* frame) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_struct(frame, "frame")) return fault;
    if (!std::isfinite(time)) return bad_argument("time is not finite");
    if (scene->motion.samples.empty())
      return bad_argument("the scene has no motion; only one from a file has");
    capi::to_c(resample(scene->motion, time), *frame);
    return {};
  });
}

int lumbrical_model_build(lumbrical_scene* scene, const lumbrical_execution* execution,
                          lumbrical_model** model) {
  return call_with(__func__, scene, [&]() -> Fault {
    if (Fault fault = check_pointer(model, "model")) return fault;
    Execution how = scene->execution;
    if (Fault fault = to_execution(execution, how)) return fault;
    std::shared_ptr<const BuiltModel> built;
    if (Fault fault = build(scene->scene, how, built)) return fault;
    *model = new lumbrical_model(std::move(built));
    return {};
  });
}

int lumbrical_model_share(const lumbrical_model* world, lumbrical_scene* hand, lumbrical_model** model) {
  return call_with(__func__, hand, [&]() -> Fault {
    if (Fault fault = check_handle(world)) return fault;
    if (Fault fault = check_pointer(model, "model")) return fault;
    auto built = std::make_shared<BuiltModel>();
    if (Fault fault = share_world(world->built->model, hand->scene.hand, built->model)) return fault;
    list_objects(*built);
    built->start = make_state(built->model);
    *model = new lumbrical_model(std::move(built));
    return {};
  });
}

int lumbrical_model_destroy(lumbrical_model* model) { return destroy(__func__, model); }

int lumbrical_model_describe(const lumbrical_model* model, lumbrical_model_info* info) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_handle(model)) return fault;
    if (Fault fault = check_struct(info, "info")) return fault;
    const Model& built = model->built->model;
    info->side = static_cast<std::int32_t>(built.hand.side);
    info->object_count = static_cast<std::uint32_t>(model->built->object_name.size());
    info->apart_count = static_cast<std::uint32_t>(built.apart.size());
    info->given_count = static_cast<std::uint32_t>(given_count(built));
    info->broadphase = static_cast<std::int32_t>(built.execution.broadphase);
    info->triangle_count = 0;
    for (const World::Object& object : all_objects(built)) info->triangle_count += object.triangle_count;
    info->rate = built.settings.rate;
    return {};
  });
}

int lumbrical_model_object_name(const lumbrical_model* model, uint32_t object, const char** name) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_handle(model)) return fault;
    if (Fault fault = check_pointer(name, "name")) return fault;
    const std::vector<std::string>& names = model->built->object_name;
    if (object >= names.size())
      return bad_argument("object " + std::to_string(object) + " of " + std::to_string(names.size()) +
                          " is none");
    *name = names[object].c_str();
    return {};
  });
}
