// From a scene to an immutable model.
#include "lumbrical/model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <new>
#include <utility>

#include "base/floating_point.h"
#include "base/parallel.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "model/apart_objects.h"
#include "model/corners.h"
#include "model/felt_surface.h"
#include "model/mesh_winding.h"
#include "model/model_parts.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

using ObjectList = std::vector<const SceneObject*>;

// All there is to refuse in them, before anything is built of any.
Status check_objects(const Scene& scene, std::size_t threads) {
  std::size_t apart = 0;
  for (const SceneObject& object : scene.objects) {
    if (Status status = check_material(object); !status.ok()) return status;
    if (Status status = check_object(object.name, object.mesh, threads); !status.ok()) return status;
    if (Status status = check_mechanism(object.mechanism); !status.ok())
      return Status::error("object \"" + object.name + "\": " + status.message());
    if (!is_apart(object)) {
      if (object.pose != Pose{})
        return Status::error("\"" + object.name +
                             "\": pose: what stands still and is plain has its mesh in the world frame; take "
                             "it there by place_mesh instead");
      continue;
    }
    if (Status status = check_apart(object); !status.ok()) return status;
    if (++apart > kMostObjects)
      return Status::error(
          "the scene has more than 32 objects that move, rub or have a surface; give the rest neither, or "
          "put only those near the hand into the scene");
  }
  return {};
}

// What is felt as one, as it stands.
ObjectList world_objects(const Scene& scene) {
  ObjectList objects;
  for (const SceneObject& object : scene.objects) {
    if (!is_apart(object)) objects.push_back(&object);
  }
  return objects;
}

void list_objects(const ObjectList& from, std::vector<World::Object>& objects) {
  std::uint32_t triangle = 0, vertex = 0;
  for (const SceneObject* const object : from) {
    const auto triangles = static_cast<std::uint32_t>(object->mesh.triangles.size());
    const auto vertices = static_cast<std::uint32_t>(object->mesh.vertices.size());
    objects.push_back({object->name, triangle, triangles, vertex, vertices});
    triangle += triangles;
    vertex += vertices;
  }
}

Broadphase suited_broadphase(const Box& extent) {
  const Vec3 size = extent.upper - extent.lower;
  return max(size.x, max(size.y, size.z)) > kGridExtent ? Broadphase::grid : Broadphase::tree;
}

Status build_index(Model& model) {
  Broadphase& broadphase = model.execution.broadphase;
  if (broadphase == Broadphase::automatic) broadphase = suited_broadphase(model.extent);
  if (broadphase == Broadphase::tree) {
    model.tree = build_tree(model.triangles, model.execution);
  } else if (broadphase == Broadphase::grid) {
    model.grid = build_grid(model.triangles, model.execution);
  } else if (broadphase == Broadphase::voxel) {
    if (Status status = build_voxels(model.triangles, model.execution, model.voxels); !status.ok())
      return status;
  }
  build_samples(model);
  model.layers = layers_of(model, model);
  return {};
}

Status take_objects(const ObjectList& objects, Model& model) {
  const std::size_t threads = model.execution.threads;
  std::size_t vertices = 0, triangles = 0;
  for (const SceneObject* const object : objects) {
    vertices += object->mesh.vertices.size();
    triangles += object->mesh.triangles.size();
  }
  if (Status status = check_counts(vertices, triangles); !status.ok()) return status;
  list_objects(objects, model.objects);
  std::vector<const Mesh*> meshes;
  std::vector<std::vector<bool>> turned;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    meshes.push_back(&objects[i]->mesh);
    turned.push_back(
        turned_triangles(objects[i]->mesh, objects[i]->winding, threads, model.objects[i].winding));
  }
  model.triangles = gather_triangles(meshes, turned, threads);
  model.extent = box_round(model.triangles, threads);
  find_solids(model);
  return build_index(model);
}

// A model of one object in its own frame.
Status build_shape(const SceneObject& object, const Model& model, std::shared_ptr<const Model>& shape) {
  auto built = std::make_shared<Model>(empty_model(model.hand, model.settings, model.execution));
  built->execution.broadphase = Broadphase::tree;  // whatever the world is searched with: objects are small
  if (Status status = take_objects({&object}, *built); !status.ok()) return status;
  shape = std::move(built);
  return {};
}

void build_feel(const Surface& surface, const Model& shape, std::shared_ptr<const FeltSurface>& felt) {
  if (is_plain(surface)) return;
  auto built = std::make_shared<FeltSurface>();
  feel_of(surface, mesh_of(shape, shape.objects[0]), *built);
  built->part = part_of(shape, built->triangle);
  built->part.settings = exactly(shape.settings);
  felt = std::move(built);
}

// Equal meshes are built once.
const ApartObject* find_instance(const Scene& scene, const SceneObject& object, const Model& model) {
  for (const ApartObject& other : model.apart) {
    const SceneObject& of = scene.objects[other.place];
    if (of.winding == object.winding && of.mesh.triangles == object.mesh.triangles &&
        of.mesh.vertices == object.mesh.vertices)
      return &other;
  }
  return nullptr;
}

// What was normalized once keeps its bits: else what is built of a recorded scene would stand elsewhere, by
// rounding, than what was recorded.
Quat unit_once(Quat q) {
  constexpr double kOff = 1.4e-15;  // |q / |q||^2 differs from 1 by less
  return std::fabs(dot(q, q) - 1) <= kOff ? q : normalized(q);
}

Status take_apart_objects(const Scene& scene, Model& model) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (!is_apart(object)) continue;
    ApartObject apart;
    apart.name = object.name;
    apart.place = i;
    apart.start = {object.pose.position, unit_once(object.pose.orientation)};
    apart.material = object.material;
    apart.mechanism = object.mechanism;
    const ApartObject* const instance = find_instance(scene, object, model);
    if (instance != nullptr) {
      apart.shape = instance->shape;
    } else if (Status status = build_shape(object, model, apart.shape); !status.ok()) {
      return status;
    }
    apart.surface = object.surface;
    if (instance != nullptr && instance->surface == object.surface) {
      apart.felt = instance->felt;
    } else {
      build_feel(object.surface, *apart.shape, apart.felt);
    }
    const Box& extent = apart.shape->extent;
    apart.middle = extent.middle();
    apart.radius = 1.000001 * norm(extent.upper - apart.middle);
    if (model.ground && object.mechanism.mobility == Mobility::free)
      apart.supports = instance != nullptr && !instance->supports.empty() ? instance->supports
                                                                          : support_points(object.mesh);
    model.apart.push_back(std::move(apart));
  }
  return find_latches(model.apart);
}

Status take_world(const Scene& scene, Model& model) {
  const World& world = *scene.world;
  if (!world.bytes)
    return Status::error("the world file " + world.path + " is only named; open it (replay: --world FILE)");
  if (!world_objects(scene).empty())
    return Status::error(
        "the scene has a world file and objects that stand still; put the objects into the world");
  Execution& execution = model.execution;
  if (execution.broadphase == Broadphase::automatic) execution.broadphase = Broadphase::grid;
  if (execution.broadphase != Broadphase::grid && execution.broadphase != Broadphase::brute) {
    return Status::error("execution.broadphase: a world file holds a grid, and a " +
                         std::string(broadphase_name(execution.broadphase)) +
                         " would have to be in memory as a whole; use auto or grid (or brute, to check)");
  }
  execution.cell_size = world.cell_size;
  execution.leaf_size = world.leaf_size;
  execution.tree_levels = world.tree_levels;
  model.triangles = world.triangles;
  model.extent = world.extent;
  model.objects = world.objects;
  if (execution.broadphase == Broadphase::grid) model.grid = world.grid;
  model.world = scene.world;
  build_samples(model);
  model.layers = layers_of(model, model);
  return {};
}

}  // namespace

bool available(Broadphase broadphase) { return broadphase != Broadphase::voxel || has_openvdb(); }

Status build_model(const Scene& scene, const Execution& execution, Model& model) try {
  const FloatingPointGuard guard;
  if (Status status = check_settings(scene.settings); !status.ok()) return status;
  if (Status status = check_execution(execution); !status.ok()) return status;
  if (Status status = check_hand(scene.hand); !status.ok()) return status;
  Model built = empty_model(scene.hand, scene.settings, execution);
  if (execution.isa == Isa::automatic) built.execution.isa = widest_isa();
  if (scene.objects.size() > kMostSceneObjects)
    return Status::error("the scene has more than 32768 objects; join meshes that stand still");
  if (Status status = check_objects(scene, execution.threads); !status.ok()) return status;
  if (Status status = check_surroundings(scene); !status.ok()) return status;
  built.gravity = scene.gravity;
  built.ground = scene.ground;
  Status status = scene.world ? take_world(scene, built) : take_objects(world_objects(scene), built);
  if (status.ok()) status = take_apart_objects(scene, built);
  if (!status.ok()) return status;
  model = std::move(built);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory_for_model();
}

std::size_t object_of(const Model& model, std::uint32_t triangle) {
  assert(triangle < model.triangles.size());
  const auto begins_after = [](std::uint32_t number, const World::Object& object) {
    return number < object.first_triangle;
  };
  const auto next = std::upper_bound(model.objects.begin(), model.objects.end(), triangle, begins_after);
  return static_cast<std::size_t>(next - model.objects.begin()) - 1;
}

}  // namespace lumbrical
