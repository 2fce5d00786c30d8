#include "model/apart_objects.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "base/floating_point.h"
#include "model/corner_normals.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

constexpr Range kUnitLength{1 - 1e-9, 1 + 1e-9};
bool is_unit(Vec3 v) { return kUnitLength.holds(norm(v)); }
bool is_place(Vec3 p) { return norm(p) <= kWorldReach; }

/// One field after the other; keeps the first that is out of range.
struct FieldCheck {
  const std::string& object;
  Status status{};
  void require(bool good, const std::string& field, const std::string& range) {
    if (status.ok() && !good)
      status = Status::error("object \"" + object + "\": " + field + " is out of range: give " + range);
  }
  void number(double value, const std::string& field, const Range& range) {
    if (!range.holds(value)) require(false, field, text_of(range));
  }
};

void check_body(const MassProperties& body, FieldCheck& check) {
  check.number(body.mass, "mass", range::mass);
  check.require(is_place(body.centre), "centre", "a place within 1e8 m");
  check.require(is_inertia(body.inertia), "inertia", inertia_rule());
}

void check_joint(const Mechanism& mechanism, FieldCheck& check) {
  check.require(is_place(mechanism.pivot), "pivot", "a place within 1e8 m");
  if (mechanism.mobility == Mobility::ball) return;
  check.require(is_unit(mechanism.axis), "axis", "a direction of length 1");
  check.number(mechanism.lower, "lower", range::joint_lower);
  check.number(mechanism.upper, "upper", range::joint_upper);
  check.number(mechanism.spring, "spring", range::joint_spring);
  check.number(mechanism.rest, "rest", range::joint_rest);
  check.number(mechanism.dry_friction, "dry_friction", range::joint_force);
  check.number(mechanism.detent_force, "detent_force", range::joint_force);
  check.number(mechanism.detent_pitch, "detent_pitch", range::detent_pitch);
}

constexpr const char* kOfJoints = "a hinge or slider";

// The numbers of a mechanism that only act on what moves so, whether that does, and what they are else.
template <class Visit>
void visit_acting(Mechanism& mechanism, const Visit& visit) {
  const Mechanism none;
  const bool joint = has_coordinate(mechanism);
  visit("damping", "what moves by itself", moves_by_itself(mechanism), mechanism.damping, none.damping);
  visit("axis", kOfJoints, joint, mechanism.axis, none.axis);
  visit("lower", kOfJoints, joint, mechanism.lower, none.lower);
  visit("upper", kOfJoints, joint, mechanism.upper, none.upper);
  visit("spring", kOfJoints, joint, mechanism.spring, none.spring);
  visit("rest", kOfJoints, joint, mechanism.rest, none.rest);
  visit("dry_friction", kOfJoints, joint, mechanism.dry_friction, none.dry_friction);
  visit("detent_force", kOfJoints, joint, mechanism.detent_force, none.detent_force);
  visit("detent_pitch", kOfJoints, joint, mechanism.detent_pitch, none.detent_pitch);
  visit("latch", kOfJoints, joint, mechanism.latch, none.latch);
}

void check_texture(const Texture& texture, const std::string& field, const Range& range, FieldCheck& check) {
  if (is_plain(texture)) return;
  const GreyImage& image = texture.image;
  const std::uint64_t texels = std::uint64_t{image.width} * image.height;
  check.require(texels == image.grey.size() && texels <= kMostTexels, field + ".image",
                "width times height texels, at most 4194304");
  check.number(texture.period, field + ".period", range::texture_period);
  check.number(texture.black, field + ".black", range);
  check.number(texture.white, field + ".white", range);
}

void check_surface(const SceneObject& object, FieldCheck& check) {
  const Surface& surface = object.surface;
  check.number(surface.crease_angle, "crease_angle", range::crease_angle);
  check.require(surface.crease_angle == 0 || object.mesh.triangles.size() <= kMostSmoothed, "crease_angle",
                "0, or a mesh of at most " + std::to_string(kMostSmoothed) + " triangles");
  const std::vector<double>& factor = surface.friction_factor;
  check.require(factor.empty() || factor.size() == object.mesh.triangles.size(),
                "the list of friction factors", "one number for each triangle of the mesh");
  for (const double one : factor) check.number(one, "a friction factor", range::grip);
  check_texture(surface.grip, "grip", range::grip, check);
  check_texture(surface.bumps, "bumps", range::bump, check);
  check.require(rubs(object.material) || (factor.empty() && is_plain(surface.grip)), "the friction",
                "more than 0, which friction factors and a grip are factors of");
}

}  // namespace

bool is_inertia(const std::array<double, 6>& inertia) {
  const auto& [xx, yy, zz, xy, yz, zx] = inertia;
  for (const double moment : {xx, yy, zz})
    if (!range::inertia.holds(moment)) return false;
  const double least = 1e-15 * (xx + yy + zz);
  const double minor = xx * yy - xy * xy,
               whole = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
  return least > 0 && xx > least && minor > least * least && whole > least * least * least &&
         1.000001 * (xx + yy) >= zz && 1.000001 * (yy + zz) >= xx && 1.000001 * (zz + xx) >= yy;
}

std::string inertia_rule() {
  return "moments of " + text_of(range::inertia) +
         ", positive about every axis and none above the sum of the others; where they are the mesh's own, "
         "check the mesh's unit";
}

Status check_material(const SceneObject& object) {
  FieldCheck check{object.name};
  const Material& material = object.material;
  check.number(material.static_friction, "static friction", range::friction);
  check.require(material.kinetic_friction >= 0 && material.kinetic_friction <= material.static_friction,
                "kinetic_friction", "0 to the static friction");
  check.number(material.viscosity, "viscosity", range::viscosity);
  check.number(material.shear_stiffness, "shear_stiffness", range::shear_stiffness);
  return check.status;
}

Status check_mechanism(const Mechanism& mechanism) {
  Status status;
  Mechanism copy = mechanism;
  visit_acting(copy, [&](const char* field, const char* whose, bool acts, auto& value, const auto& none) {
    if (status.ok() && !acts && !(value == none))
      status = Status::error(std::string(field) + " acts on " + whose + " only, and this is \"" +
                             std::string(mobility_name(mechanism.mobility)) +
                             "\": leave it out, or let the object move so");
  });
  return status;
}

Mechanism without_meaningless(Mechanism mechanism) {
  visit_acting(mechanism, [](const char*, const char*, bool acts, auto& value, const auto& none) {
    if (!acts) value = none;
  });
  return mechanism;
}

Status check_apart(const SceneObject& object) {
  FieldCheck check{object.name};
  const double square = dot(object.pose.orientation, object.pose.orientation);
  check.require(is_place(object.pose.position) && square >= 0.25 && square <= 4, "pose",
                "a place within 1e8 m and a quaternion of length 1");
  check.require(!object.mesh.triangles.empty(), "mesh", "one with triangles");
  check_surface(object, check);
  const Mechanism& mechanism = object.mechanism;
  check.require(mobility_name(mechanism.mobility) != "unknown", "mobility", "one of the six");
  // A given object has a mass where a physics engine moves it.
  if (mechanism.mobility == Mobility::given && mechanism.body != MassProperties{})
    check_body(mechanism.body, check);
  if (moves_by_itself(mechanism)) {
    check_body(mechanism.body, check);
    check.number(mechanism.damping, "damping", range::damping);
  }
  if (mechanism.mobility >= Mobility::hinge) check_joint(mechanism, check);
  return check.status;
}

Status check_surroundings(const Scene& scene) {
  if (!(norm(scene.gravity) <= 1e3)) return Status::error("gravity is out of range: give at most 1000 m/s^2");
  if (!scene.ground) return {};
  if (!is_unit(scene.ground->normal)) return Status::error("ground.normal must have length 1");
  if (!range::place.holds(scene.ground->offset) || !range::friction.holds(scene.ground->friction))
    return Status::error(
        "ground.offset or ground.friction is out of range: give a place within 1e8 m, 0 to 10");
  return {};
}

Status find_latches(std::vector<ApartObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ApartObject& object = objects[i];
    const Latch& latch = object.mechanism.latch;
    object.latch = i;
    if (latch == Latch{}) continue;
    const auto opener = std::find_if(objects.begin(), objects.end(), [&](const ApartObject& other) {
      return other.place == latch.object && has_coordinate(other.mechanism);
    });
    if (opener == objects.end() || opener->place == object.place || !has_coordinate(object.mechanism))
      return Status::error("object \"" + object.name +
                           "\": latch must be of a hinge or slider, and opened by another one");
    if (!range::latch_opens.holds(latch.opens))
      return Status::error("object \"" + object.name + "\": latch.opens is out of range: give " +
                           text_of(range::latch_opens));
    object.latch = static_cast<std::size_t>(opener - objects.begin());
  }
  return {};
}

void place_mesh(const Pose& X_WO, Mesh& mesh) {
  const FloatingPointGuard guard;
  for (Vec3& v : mesh.vertices) v = transform(X_WO, v);
}

namespace {

// Eight round each of the six axes, axis by axis, so little off it that all of a flat face's rim is found and
// nothing behind a rounded edge.
constexpr std::size_t kRound = 8;
std::vector<Vec3> rim_directions() {
  constexpr double kOff = 0.02;
  std::vector<Vec3> directions;
  for (std::size_t side = 0; side < 6; ++side) {
    const std::size_t axis = side / 2;
    for (int code = 0; code < 9; ++code) {
      if (code == 4) continue;
      std::array<double, 3> d{};
      d[axis] = side % 2 == 0 ? -1 : 1;
      d[(axis + 1) % 3] = kOff * (code % 3 - 1);
      d[(axis + 2) % 3] = kOff * (code / 3 - 1);
      directions.push_back({d[0], d[1], d[2]});
    }
  }
  return directions;
}

// All over the sphere, some 12 degrees apart.
std::vector<Vec3> spread_directions() {
  constexpr int kReach = 4;
  std::vector<Vec3> directions;
  for (int x = -kReach; x <= kReach; ++x)
    for (int y = -kReach; y <= kReach; ++y)
      for (int z = -kReach; z <= kReach; ++z)
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == kReach)
          directions.push_back({double(x), double(y), double(z)});
  for (Vec3& d : directions) d = (1 / norm(d)) * d;
  return directions;
}

// [m] Of the box round them, from corner to corner.
double size_of(const std::vector<Vec3>& vertices) {
  Box box;
  for (const Vec3 v : vertices) box.add(v);
  return norm(box.upper - box.lower);
}

Vec3 farthest_along(Vec3 direction, const std::vector<Vec3>& vertices) {
  return *std::max_element(vertices.begin(), vertices.end(),
                           [&](Vec3 a, Vec3 b) { return dot(direction, a) < dot(direction, b); });
}

// Corners of faces that lie across an axis. Where there is no face, its place is taken by one point.
std::vector<Vec3> rim_points(const std::vector<Vec3>& vertices, double size) {
  constexpr double kFace = 0.025;  // of the size: what is smaller is none to rest on
  const std::vector<Vec3> directions = rim_directions();
  std::vector<Vec3> points;
  for (std::size_t first = 0, i = 0; i < directions.size(); ++i) {
    if (i % kRound == 0) first = points.size();
    const Vec3 point = farthest_along(directions[i], vertices);
    const auto is_near = [&](Vec3 other) { return norm(point - other) < kFace * size; };
    if (std::none_of(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(), is_near) &&
        std::find(points.begin(), points.end(), point) == points.end())
      points.push_back(point);
  }
  return points;
}

// Adds, one by one, what stands out most of all that is there already.
void add_outermost(const std::vector<Vec3>& vertices, double size, std::vector<Vec3>& points) {
  constexpr double kUnseen = 1e-3;  // of the size
  struct Way {
    Vec3 direction, farthest;
    double gap = 0;
  };
  std::vector<Way> ways;
  const auto out_of = [](const Way& way, Vec3 point) { return dot(way.direction, way.farthest - point); };
  for (const Vec3 direction : spread_directions()) {
    Way& way = ways.emplace_back(Way{direction, farthest_along(direction, vertices), 2 * size});
    for (const Vec3 point : points) way.gap = min(way.gap, out_of(way, point));
  }
  while (points.size() < kMostSupports) {
    const Way& widest =
        *std::max_element(ways.begin(), ways.end(), [](const Way& a, const Way& b) { return a.gap < b.gap; });
    if (!(widest.gap > kUnseen * size)) return;
    const Vec3 point = widest.farthest;
    points.push_back(point);
    for (Way& way : ways) way.gap = min(way.gap, out_of(way, point));
  }
}

// Those that triangles name: of others nothing is felt or seen, and scans carry some.
std::vector<Vec3> named_vertices(const Mesh& mesh) {
  std::vector<bool> named(mesh.vertices.size());
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) named[corner] = true;
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < named.size(); ++i)
    if (named[i]) vertices.push_back(mesh.vertices[i]);
  return vertices;
}

}  // namespace

std::vector<Vec3> support_points(const Mesh& mesh) {
  const std::vector<Vec3> vertices = named_vertices(mesh);
  if (vertices.empty()) return {};
  const double size = size_of(vertices);
  std::vector<Vec3> points = rim_points(vertices, size);
  add_outermost(vertices, size, points);
  return points;
}

}  // namespace lumbrical
