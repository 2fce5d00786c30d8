// From a model back to its scene.
#include "model/model_parts.h"

namespace lumbrical {
namespace {

// Appends the objects of a model as they were felt: what there was to turn is turned.
void take_back(const Model& model, std::vector<SceneObject>& objects) {
  for (const World::Object& part : model.objects) {
    SceneObject object;
    object.name = part.name;
    object.winding = Winding::as_is;
    object.mesh = mesh_of(model, part);
    objects.push_back(std::move(object));
  }
}

}  // namespace

std::vector<World::Object> all_objects(const Model& model) {
  std::vector<World::Object> objects = model.objects;
  for (const ApartObject& apart : model.apart) {
    objects.push_back(apart.shape->objects[0]);
    objects.back().name = apart.name;
  }
  return objects;
}

Scene scene_of(const Model& model) {
  Scene scene;
  scene.hand = model.hand;
  scene.settings = model.settings;
  scene.world = model.world;
  scene.gravity = model.gravity;
  scene.ground = model.ground;
  if (!scene.world) take_back(model, scene.objects);
  for (const ApartObject& apart : model.apart) {
    std::vector<SceneObject> object;
    take_back(*apart.shape, object);
    object[0].name = apart.name;
    object[0].pose = apart.start;
    object[0].material = apart.material;
    object[0].mechanism = apart.mechanism;
    object[0].surface = apart.surface;
    const auto place = static_cast<std::ptrdiff_t>(apart.place);
    scene.objects.insert(scene.objects.begin() + place, std::move(object[0]));
  }
  return scene;
}

Mesh mesh_of(const Model& model, const World::Object& part) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < part.vertex_count; ++i)
    mesh.vertices.push_back(model.triangles.vertex(part.first_vertex + i));
  for (std::uint32_t i = part.first_triangle; i < part.first_triangle + part.triangle_count; ++i) {
    mesh.triangles.push_back({model.triangles.a[i] - part.first_vertex,
                              model.triangles.b[i] - part.first_vertex,
                              model.triangles.c[i] - part.first_vertex});
  }
  return mesh;
}

}  // namespace lumbrical
