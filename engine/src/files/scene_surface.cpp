#include "files/scene_surface.h"

#include "files/scene_parts.h"
#include "lumbrical/surface_file.h"

namespace lumbrical {
namespace {

namespace format = scene_format;

Status read_texture(const format::Texture* table, const std::string& at, Range range, FieldReader& read,
                    std::vector<std::string>& files, Texture& texture) {
  if (table == nullptr) return {};
  if (table->image() == nullptr || !table->period().has_value() || !table->white().has_value()) {
    read.error(at, "needs an image (PGM), its period [m] and what white stands for");
    return read.status();
  }
  read.number(table->period(), at + ".period", range::texture_period, texture.period);
  read.number(table->black(), at + ".black", range, texture.black);
  read.number(table->white(), at + ".white", range, texture.white);
  if (!read.ok()) return read.status();
  const std::string path = beside(files[0], table->image()->string_view());
  if (Status status = load_grey_image(path, texture.image); !status.ok())
    return read.of_file(at + ".image", path, status);
  files.push_back(path);
  return {};
}

Status read_factors(const format::Surface& table, const std::string& at, FieldReader& read,
                    std::vector<std::string>& files, SceneObject& object) {
  if (table.friction_file() == nullptr) return {};
  const std::string path = beside(files[0], table.friction_file()->string_view());
  std::vector<double>& factors = object.surface.friction_factor;
  if (Status status = load_friction_factors(path, factors); !status.ok())
    return read.of_file(at + ".friction_file", path, status);
  files.push_back(path);
  const std::size_t triangles = object.mesh.triangles.size();
  if (factors.size() != triangles)
    read.error(at + ".friction_file", "has " + std::to_string(factors.size()) + " numbers for " +
                                          std::to_string(triangles) +
                                          " triangles; give one for each, in the order of the mesh");
  return read.status();
}

}  // namespace

Status read_surface(const format::Object& object_table, const std::string& object_at, FieldReader& read,
                    std::vector<std::string>& files, SceneObject& object) {
  const format::Surface* const table = object_table.surface();
  if (table == nullptr || !read.ok()) return read.status();
  const std::string at = object_at + ".surface";
  Surface& surface = object.surface;
  read.number(table->crease_angle(), at + ".crease_angle", range::crease_angle, surface.crease_angle);
  if (Status status = read_factors(*table, at, read, files, object); !status.ok()) return status;
  if (Status status = read_texture(table->grip(), at + ".grip", range::grip, read, files, surface.grip);
      !status.ok())
    return status;
  if (Status status = read_texture(table->bumps(), at + ".bumps", range::bump, read, files, surface.bumps);
      !status.ok())
    return status;
  if (!rubs(object.material) && (table->friction_file() != nullptr || table->grip() != nullptr))
    read.error(at, "has factors of friction, but the object has none; give it some");
  return read.status();
}

}  // namespace lumbrical
