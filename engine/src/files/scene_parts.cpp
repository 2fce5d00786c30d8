// Objects and hand of a scene file: see scene_parts.h.
#include "files/scene_parts.h"

#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include "files/scene_mechanics.h"
#include "files/scene_surface.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

namespace format = scene_format;

constexpr Range kLength{1e-6, 1e3};  // [m]

Mesh read_mug(const format::Mug& table, const std::string& at, FieldReader& read) {
  MugShape shape;
  read.number(table.radius(), at + ".radius", kLength, shape.radius);
  read.number(table.height(), at + ".height", kLength, shape.height);
  read.number(table.wall(), at + ".wall", kLength, shape.wall);
  read.number(table.handle_radius(), at + ".handle_radius", kLength, shape.handle_radius);
  read.number(table.handle_reach(), at + ".handle_reach", kLength, shape.handle_reach);
  read.count(table.segments(), at + ".segments", {8, 1024}, shape.segments);
  if (shape.wall > 0.5 * min(shape.radius, shape.height)) read.error(at, "has a wall too thick for its size");
  if (shape.handle_radius > 0.125 * shape.height || shape.handle_radius > 0.5 * shape.handle_reach) {
    read.error(at, "has a handle too thick for its height or reach");
  }
  if (!read.ok()) return {};
  Mesh mug = make_mug(shape);
  if (mug.triangles.empty()) {
    read.error(
        at,
        "can't be made: its handle must fit between bottom and rim, bend no tighter than its own radius and "
        "end within the wall; make the handle thinner, or use more segments");
  }
  return mug;
}

Mesh read_plane(const format::Plane& table, const std::string& at, FieldReader& read) {
  double extent = 0.3;
  double irregularity = 0;
  std::uint32_t cells = 32;
  read.number(table.extent(), at + ".extent", kLength, extent);
  read.number(table.irregularity(), at + ".irregularity", {0, 1}, irregularity);
  read.count(table.cells(), at + ".cells", {1, 2000}, cells);
  return make_plane(extent, cells, irregularity);
}

Mesh read_box(const format::Box& table, const std::string& at, FieldReader& read) {
  Vec3 size{0.1, 0.1, 0.1};
  std::uint32_t cells = 8;
  read.vector(table.size(), at + ".size", kLength, size);
  read.count(table.cells(), at + ".cells", {1, 1000}, cells);
  return make_box(size, cells);
}

Mesh read_sphere(const format::Sphere& table, const std::string& at, FieldReader& read) {
  double radius = 0.04;
  std::uint32_t cells = 24;
  read.number(table.radius(), at + ".radius", kLength, radius);
  read.count(table.cells(), at + ".cells", {1, 1000}, cells);
  return make_sphere(radius, cells);
}

Mesh read_height_field(const format::HeightField& table, const std::string& at, FieldReader& read) {
  double extent = 0.3;
  double amplitude = 0.003;
  double wavelength = 0.04;
  std::uint32_t cells = 69;
  read.number(table.extent(), at + ".extent", kLength, extent);
  read.number(table.amplitude(), at + ".amplitude", {0, 1e3}, amplitude);
  read.number(table.wavelength(), at + ".wavelength", kLength, wavelength);
  read.count(table.cells(), at + ".cells", {1, 2000}, cells);
  return make_height_field(extent, cells, amplitude, wavelength);
}

// The object's mesh in its own frame. Which of the six ways it is given decides its default name.
Status read_mesh(const format::Object& table, const std::string& at, FieldReader& read,
                 std::vector<std::string>& files, SceneObject& object) {
  const int given = (table.mesh() != nullptr) + (table.mug() != nullptr) + (table.plane() != nullptr) +
                    (table.box() != nullptr) + (table.sphere() != nullptr) +
                    (table.height_field() != nullptr);
  if (given != 1) {
    read.error(at, "must be exactly one of mesh, mug, plane, box, sphere and height_field");
  } else if (table.mesh() == nullptr && table.winding() != nullptr) {
    read.error(at + ".winding", "has no meaning for a built-in shape, which faces outwards");
  } else if (table.mesh() == nullptr && table.unit() != nullptr) {
    read.error(at + ".unit", "has no meaning for a built-in shape, which is in metres");
  } else if (table.mug() != nullptr) {
    object = {"mug", read_mug(*table.mug(), at + ".mug", read)};
  } else if (table.plane() != nullptr) {
    object = {"plane", read_plane(*table.plane(), at + ".plane", read)};
  } else if (table.box() != nullptr) {
    object = {"box", read_box(*table.box(), at + ".box", read)};
  } else if (table.sphere() != nullptr) {
    object = {"sphere", read_sphere(*table.sphere(), at + ".sphere", read)};
  } else if (table.height_field() != nullptr) {
    object = {"height_field", read_height_field(*table.height_field(), at + ".height_field", read)};
  } else {
    Unit unit = Unit::metre;
    if (table.unit() != nullptr) {
      unit = read_unit(table.unit(), at + ".unit", read);
    } else if (table.fit() == nullptr) {
      read.error(at, R"(has no unit; add "unit": "m", "cm" or "mm", or "fit": {"size": metres})");
    }
    if (!read.ok()) return read.status();
    const std::string path = beside(files[0], table.mesh()->string_view());
    if (Status status = load_mesh(path, unit, object.mesh); !status.ok())
      return read.of_file(at + ".mesh", path, status);
    files.push_back(path);
    if (table.winding() != nullptr) {
      const auto winding = parse_winding(table.winding()->string_view());
      if (!winding) read.error(at + ".winding", R"(must be "auto", "as is" or "flip")");
      object.winding = winding.value_or(Winding::automatic);
    }
    object.name = std::filesystem::path(path).stem().string();
  }
  return read.status();
}

// Scaled, and told where it stands.
void size_object(const format::Object& table, const std::string& at, FieldReader& read, SceneObject& object) {
  Mesh& mesh = object.mesh;
  double scale = 1;
  Vec3 centre;
  if (table.fit() != nullptr) {
    double size = 0;
    if (!table.fit()->size().has_value()) read.error(at + ".fit", "has no size [m]");
    if (table.scale().has_value()) read.error(at + ".scale", "stands beside fit; keep one");
    read.number(table.fit()->size(), at + ".fit.size", kLength, size);
    const lumbrical::Box box = bounding_box(mesh);
    const Vec3 extent = box.upper - box.lower;
    const double largest = max(extent.x, max(extent.y, extent.z));
    if (!(largest > 1e-12)) read.error(at, "has no extent that could be fitted to a size");
    scale = size / largest;
    centre = 0.5 * (box.lower + box.upper);
  } else {
    read.number(table.scale(), at + ".scale", {1e-9, 1e9}, scale);
  }
  read.pose(table.position(), at + ".position", table.orientation(), at + ".orientation", object.pose);
  if (!read.ok()) return;
  for (Vec3& v : mesh.vertices) v = scale * (v - centre);
}

// What stands still lies in the world for good.
void place_object(SceneObject& object) {
  if (is_apart(object)) return;
  place_mesh(object.pose, object.mesh);
  object.pose = {};
}

void read_fingers(const format::Hand& table, const std::string& at, FieldReader& read, Hand& hand) {
  if (table.fingers() == nullptr) return;
  constexpr Range kAngle{-6.3, 6.3};
  std::array<bool, kFingerCount> told{};
  for (flatbuffers::uoffset_t i = 0; i < table.fingers()->size(); ++i) {
    const format::Finger& entry = *table.fingers()->Get(i);
    const std::string path = at + "fingers[" + std::to_string(i) + "]";
    const std::optional<int> number = parse_finger(text_of(entry.name()));
    if (!number) {
      read.error(path + ".name", R"(must be "thumb", "index", "middle", "ring" or "little")");
      return;
    }
    if (std::exchange(told[static_cast<std::size_t>(*number)], true)) {
      read.error(path + ".name", "is told a second time; keep one entry of each finger");
      return;
    }
    Finger& finger = hand.finger[static_cast<std::size_t>(*number)];
    read.pose(entry.base_position(), path + ".base_position", entry.base_orientation(),
              path + ".base_orientation", finger.base);
    read.numbers(entry.bone_length(), path + ".bone_length", {0, 1}, finger.bone_length);
    std::array<double, 4> lower{};
    std::array<double, 4> upper{};
    for (std::size_t a = 0; a < 4; ++a) {
      lower[a] = finger.limit[a].lower;
      upper[a] = finger.limit[a].upper;
    }
    read.numbers(entry.lower(), path + ".lower", kAngle, lower);
    read.numbers(entry.upper(), path + ".upper", kAngle, upper);
    for (std::size_t a = 0; a < 4; ++a) finger.limit[a] = {lower[a], upper[a]};
  }
}

}  // namespace

std::string beside(const std::string& file, std::string_view path) {
  return (std::filesystem::path(file).parent_path() / path).string();
}

Side read_side(const flatbuffers::String* text, const std::string& path, FieldReader& read) {
  if (text->string_view() != "left" && text->string_view() != "right") {
    read.error(path, R"(must be "left" or "right")");
  }
  return text->string_view() == "left" ? Side::left : Side::right;
}

Unit read_unit(const flatbuffers::String* text, const std::string& path, FieldReader& read) {
  const auto unit = parse_unit(text->string_view());
  if (!unit) read.error(path, R"(must be "m", "cm" or "mm")");
  return unit.value_or(Unit::metre);
}

Status read_objects(const format::Scene& scene, FieldReader& read, std::vector<std::string>& files,
                    const std::function<Status(SceneObject&&, ObjectPath&&)>& take) {
  if (scene.objects() == nullptr || scene.objects()->size() == 0) {
    read.error("objects", "is missing or empty; name at least one mesh or shape to touch");
    return read.status();
  }
  std::size_t apart_count = 0;
  for (flatbuffers::uoffset_t i = 0; i < scene.objects()->size(); ++i) {
    const format::Object& table = *scene.objects()->Get(i);
    const std::string at = "objects[" + std::to_string(i) + "]";
    SceneObject object;
    if (Status status = read_mesh(table, at, read, files, object); !status.ok()) return status;
    if (table.mesh() == nullptr) object.winding = Winding::as_is;  // shapes face outwards
    size_object(table, at, read, object);
    ObjectPath path;
    if (read.ok()) read_mechanics(table, at, read, object, path);
    if (Status status = read_surface(table, at, read, files, object); !status.ok()) return status;
    apart_count += is_apart(object) ? 1 : 0;
    if (apart_count > kMostObjects)  // told before all of their images fill the memory
      read.error(at,
                 "is one more than the 32 that may move, rub or have a surface; put only those near the hand "
                 "into the scene");
    place_object(object);
    if (table.name() != nullptr) object.name = table.name()->str();
    if (!read.ok()) return read.status();
    if (Status status = take(std::move(object), std::move(path)); !status.ok()) {
      read.error(at, status.message());
      return read.status();
    }
  }
  return {};
}

Hand read_hand(const format::Hand* table, const std::string& at, Side side, FieldReader& read) {
  double length = 0.19;
  if (table != nullptr) read.number(table->length(), at + "length", range::hand_length, length);
  Hand hand = default_hand(side, length);
  if (table != nullptr) read_fingers(*table, at, read, hand);
  read_flesh(table, at, read, hand);
  return hand;
}

void read_flesh(const format::Hand* table, const std::string& at, FieldReader& read, Hand& hand) {
  if (table == nullptr) return;
  std::array<bool, kJointCount> told{};
  for (flatbuffers::uoffset_t i = 0; table->radii() != nullptr && i < table->radii()->size(); ++i) {
    const format::JointRadius& entry = *table->radii()->Get(i);
    const std::string path = at + "radii[" + std::to_string(i) + "]";
    const std::optional<int> joint = parse_joint(text_of(entry.joint()));
    if (!joint) {
      return read.error(path + ".joint", "is not a joint; use \"index tip\", \"wrist\" or the like");
    }
    if (!entry.radius().has_value()) return read.error(path, "has no radius");
    if (std::exchange(told[static_cast<std::size_t>(*joint)], true))
      return read.error(path + ".joint", "is told a second time; keep one entry of each joint");
    read.number(entry.radius(), path + ".radius", {1e-4, 0.2}, hand.radius[static_cast<std::size_t>(*joint)]);
  }
  const format::Palm* const palm = table->palm();
  if (palm == nullptr) return;
  read.number(palm->height(), at + "palm.height", {0, 0.2}, hand.palm.height);
  read.number(palm->thickness(), at + "palm.thickness", {1e-4, 0.2}, hand.palm.thickness);
  if (palm->polygon() == nullptr) return;
  hand.palm.polygon.clear();
  for (const format::Corner* const corner : *palm->polygon()) {
    hand.palm.polygon.push_back({corner->x(), 0, corner->z()});
  }
}

}  // namespace lumbrical
