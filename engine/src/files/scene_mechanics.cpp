#include "files/scene_mechanics.h"

#include "model/apart_objects.h"

namespace lumbrical {
namespace {

namespace format = scene_format;

void read_direction(const flatbuffers::Vector<double>* values, const std::string& path, FieldReader& read,
                    Vec3& direction) {
  read.vector(values, path, {-1e3, 1e3}, direction);
  const double length = norm(direction);
  if (!(length > 1e-6)) {
    read.error(path, "has no direction; give three numbers that are not all zero");
  } else {
    direction = direction / length;
  }
}

void read_material(const format::Object& table, const std::string& at, FieldReader& read,
                   Material& material) {
  read.number(table.friction(), at + ".friction", range::friction, material.static_friction);
  material.kinetic_friction = material.static_friction;
  read.number(table.kinetic_friction(), at + ".kinetic_friction", {0, material.static_friction},
              material.kinetic_friction);
  read.number(table.viscosity(), at + ".viscosity", range::viscosity, material.viscosity);
  read.number(table.shear_stiffness(), at + ".shear_stiffness", range::shear_stiffness,
              material.shear_stiffness);
}

void read_joint(const format::Joint* table, const std::string& at, FieldReader& read, Mechanism& mechanism) {
  if (table == nullptr) return;
  read.vector(table->pivot(), at + ".pivot", range::place, mechanism.pivot);
  read_direction(table->axis(), at + ".axis", read, mechanism.axis);
  read.number(table->lower(), at + ".lower", range::joint_lower, mechanism.lower);
  read.number(table->upper(), at + ".upper", range::joint_upper, mechanism.upper);
  read.number(table->spring(), at + ".spring", range::joint_spring, mechanism.spring);
  read.number(table->rest(), at + ".rest", range::joint_rest, mechanism.rest);
  read.number(table->dry_friction(), at + ".dry_friction", range::joint_force, mechanism.dry_friction);
  read.number(table->detent_force(), at + ".detent_force", range::joint_force, mechanism.detent_force);
  read.number(table->detent_pitch(), at + ".detent_pitch", range::detent_pitch, mechanism.detent_pitch);
}

void read_path(const flatbuffers::Vector<flatbuffers::Offset<format::PathPoint>>& points,
               const std::string& at, FieldReader& read, ObjectPath& path) {
  for (flatbuffers::uoffset_t i = 0; i < points.size(); ++i) {
    const format::PathPoint& point = *points.Get(i);
    const std::string here = at + "[" + std::to_string(i) + "]";
    PathPoint& added = path.emplace_back();
    if (!point.time().has_value()) read.error(here, "has no time [s]");
    read.number(point.time(), here + ".time", {0, 1e6}, added.time);
    read.pose(point.position(), here + ".position", point.orientation(), here + ".orientation", added.pose);
    if (i > 0 && !(added.time > path[i - 1].time)) read.error(here + ".time", "is not after the one before");
  }
  if (path.empty()) read.error(at, "has no points");
}

// Of the solid inside the mesh, as far as the file does not say otherwise.
void read_body(const format::Object& table, const std::string& at, FieldReader& read,
               const SceneObject& object, MassProperties& body) {
  if (table.mass().has_value() == table.density().has_value())
    return read.error(at, "moves, so give its mass [kg] or the density [kg/m^3] of its solid: one of them");
  double density = 1000, mass = 0;
  read.number(table.density(), at + ".density", {1e-3, 1e5}, density);
  read.number(table.mass(), at + ".mass", range::mass, mass);
  const bool told = table.mass().has_value() && table.centre() != nullptr && table.inertia() != nullptr;
  if (!told) {
    Mesh solid = object.mesh;
    wind_outwards(solid, object.winding);
    if (Status status = mass_properties(solid, density, body); !status.ok())
      return read.error(at, status.message());
  }
  if (told) {
    body.mass = mass;
  } else if (table.mass().has_value() && mass > 0) {
    scale_to_mass(mass, body);
  }
  read.vector(table.centre(), at + ".centre", range::place, body.centre);
  read.numbers(table.inertia(), at + ".inertia", {-range::inertia.high, range::inertia.high}, body.inertia);
  if (read.ok() && !is_inertia(body.inertia))
    read.error(at + ".inertia", "is no body's: give " + inertia_rule());
}

void read_given(const format::Object& table, const std::string& at, FieldReader& read, SceneObject& object,
                ObjectPath& path) {
  const bool heavy = table.mass().has_value() || table.density().has_value();
  if (heavy && table.path() != nullptr) read.error(at + ".path", "stands beside a mass; keep one");
  if (heavy) read_body(table, at, read, object, object.mechanism.body);
  if (table.path() == nullptr) return;
  if (table.position() != nullptr || table.orientation() != nullptr)
    read.error(at + ".path", "stands beside a position or orientation; keep one");
  read_path(*table.path(), at + ".path", read, path);
  if (read.ok()) object.pose = path[0].pose;
}

}  // namespace

void read_mechanics(const format::Object& table, const std::string& at, FieldReader& read,
                    SceneObject& object, ObjectPath& path) {
  read_material(table, at, read, object.material);
  Mechanism& mechanism = object.mechanism;
  if (table.moves() != nullptr) {
    const auto mobility = parse_mobility(table.moves()->string_view());
    if (!mobility)
      return read.error(at + ".moves", R"(must be "fixed", "free", "hinge", "slider", "ball" or "given")");
    mechanism.mobility = *mobility;
  }
  if (table.joint() != nullptr && mechanism.mobility < Mobility::hinge)
    return read.error(at + ".joint", R"(needs "moves": "hinge", "slider" or "ball")");
  if (table.path() != nullptr && mechanism.mobility != Mobility::given)
    return read.error(at + ".path", R"(needs "moves": "given")");
  const bool heavy = table.mass().has_value() || table.density().has_value();
  if (heavy && mechanism.mobility == Mobility::fixed)
    return read.error(at + (table.mass() ? ".mass" : ".density"), R"(needs "moves": "free" or the like)");
  read.number(table.damping(), at + ".damping", range::damping, mechanism.damping);
  if (mechanism.mobility >= Mobility::free) mechanism.pivot = object.pose.position;
  read_joint(table.joint(), at + ".joint", read, mechanism);
  if (Status status = check_mechanism(mechanism); !status.ok()) return read.error(at, status.message());
  if (mechanism.mobility == Mobility::given) return read_given(table, at, read, object, path);
  if (mechanism.mobility < Mobility::free) return;
  if (read.ok()) read_body(table, at, read, object, mechanism.body);
}

void read_latches(const format::Scene& table, FieldReader& read, std::vector<SceneObject>& objects) {
  for (flatbuffers::uoffset_t i = 0; table.objects() != nullptr && i < table.objects()->size(); ++i) {
    const format::Joint* const joint = table.objects()->Get(i)->joint();
    const format::Latch* const latch = joint != nullptr ? joint->latch() : nullptr;
    if (latch == nullptr) continue;
    const std::string at = "objects[" + std::to_string(i) + "].joint.latch";
    if (!latch->opens().has_value())
      read.error(at, "does not say where it opens; give the handle's coordinate");
    Latch& own = objects[i].mechanism.latch;
    read.number(latch->opens(), at + ".opens", range::latch_opens, own.opens);
    int named = 0;
    for (std::uint32_t k = 0; k < objects.size() && latch->object() != nullptr; ++k) {
      if (objects[k].name != latch->object()->string_view()) continue;
      own.object = k;
      ++named;
    }
    if (named != 1)
      read.error(at + ".object", named == 0 ? "names no object of the scene" : "names more than one object");
    else if (own.object == i || !has_coordinate(objects[own.object].mechanism))
      read.error(at + ".object", "must be another hinge or slider");
    if (!has_coordinate(objects[i].mechanism)) read.error(at, "must be of a hinge or slider");
  }
}

void read_physics(const format::Scene& table, FieldReader& read, std::optional<PhysicsChoice>& physics) {
  if (table.physics() == nullptr) return;
  const format::Physics& own = *table.physics();
  physics.emplace();
  if (own.engine() == nullptr || own.engine()->string_view() != "bullet")
    read.error("physics.engine", "must be \"bullet\"");
  else
    physics->engine = own.engine()->str();
  read.number(own.friction(), "physics.friction", range::friction, physics->friction);
}

void read_surroundings(const format::Scene& table, FieldReader& read, Scene& scene) {
  read.vector(table.gravity(), "gravity", {-1e3, 1e3}, scene.gravity);
  if (table.ground() == nullptr) return;
  Ground& ground = scene.ground.emplace();
  read_direction(table.ground()->normal(), "ground.normal", read, ground.normal);
  read.number(table.ground()->height(), "ground.height", range::place, ground.offset);
  read.number(table.ground()->friction(), "ground.friction", range::friction, ground.friction);
}

}  // namespace lumbrical
