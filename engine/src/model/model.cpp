// From a scene to an immutable model, and back.
#include "lumbrical/model.h"
#include "base/floating_point.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <utility>

#include "base/parallel.h"
#include "index/patches.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "model/apart_objects.h"
#include "model/felt_surface.h"
#include "model/mesh_winding.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

constexpr std::array<std::pair<std::string_view, Law>, 5> kLawNames = {{
    {"field", Law::field},
    {"column", Law::column},
    {"max-depth", Law::max_depth},
    {"centroid", Law::centroid},
    {"point", Law::point},
}};
constexpr std::array<std::pair<std::string_view, Broadphase>, 5> kBroadphaseNames = {{
    {"auto", Broadphase::automatic},
    {"tree", Broadphase::tree},
    {"grid", Broadphase::grid},
    {"voxel", Broadphase::voxel},
    {"brute", Broadphase::brute},
}};
constexpr std::array<std::pair<std::string_view, Winding>, 3> kWindingNames = {{
    {"auto", Winding::automatic},
    {"as is", Winding::as_is},
    {"flip", Winding::flip},
}};
constexpr std::array<std::pair<std::string_view, Mobility>, 6> kMobilityNames = {{
    {"fixed", Mobility::fixed},
    {"given", Mobility::given},
    {"free", Mobility::free},
    {"hinge", Mobility::hinge},
    {"slider", Mobility::slider},
    {"ball", Mobility::ball},
}};
constexpr std::array<std::pair<std::string_view, Isa>, 7> kIsaNames = {{
    {"auto", Isa::automatic},
    {"scalar", Isa::scalar},
    {"sse2", Isa::sse2},
    {"avx2", Isa::avx2},
    {"avx512", Isa::avx512},
    {"neon", Isa::neon},
    {"simd128", Isa::simd128},
}};

template <class Names, class T = typename Names::value_type::second_type>
std::optional<T> value_named(const Names& names, std::string_view text) {
  for (const auto& [name, value] : names) {
    if (name == text) return value;
  }
  return std::nullopt;
}

template <class Names, class T>
std::string_view name_valued(const Names& names, T wanted) {
  for (const auto& [name, value] : names) {
    if (value == wanted) return name;
  }
  return "unknown";
}

using ObjectList = std::vector<const SceneObject*>;

// What is felt as one, as it stands.
ObjectList world_objects(const Scene& scene) {
  ObjectList objects;
  for (const SceneObject& object : scene.objects) {
    if (!is_apart(object)) objects.push_back(&object);
  }
  return objects;
}

// Each of the world's six arrays is written from end to end by one thread, whose memory it then is.
// `turned` tells for each object whose last two corners change places; empty: none of its.
Triangles gather_triangles(const ObjectList& objects, const std::vector<std::vector<bool>>& turned,
                           std::size_t vertex_count, std::size_t triangle_count, std::size_t threads) {
  constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};
  std::array<std::vector<double>, 3> numbers;
  std::array<std::vector<std::uint32_t>, 3> corners;
  parallel_chunks(6, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      if (k % 2 == 0) {
        numbers[k / 2].reserve(vertex_count);
        for (const SceneObject* const object : objects) {
          for (const Vec3& p : object->mesh.vertices) numbers[k / 2].push_back(p.*kAxis[k / 2]);
        }
        continue;
      }
      std::uint32_t first_vertex = 0;
      corners[k / 2].reserve(triangle_count);
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const Mesh& mesh = objects[i]->mesh;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const bool swap = k / 2 > 0 && !turned[i].empty() && turned[i][t];
          corners[k / 2].push_back(first_vertex + mesh.triangles[t][swap ? 3 - k / 2 : k / 2]);
        }
        first_vertex += static_cast<std::uint32_t>(mesh.vertices.size());
      }
    }
  });
  return {std::move(numbers[0]), std::move(numbers[1]), std::move(numbers[2]),
          std::move(corners[0]), std::move(corners[1]), std::move(corners[2])};
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

Box extent_of(const Triangles& world, std::size_t threads) {
  if (world.x.empty()) return {};
  constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};
  const std::array<const SharedArray<double>*, 3> numbers = {&world.x, &world.y, &world.z};
  Box box;
  parallel_chunks(3, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto [low, high] = std::minmax_element(numbers[k]->begin(), numbers[k]->end());
      box.lower.*kAxis[k] = *low;
      box.upper.*kAxis[k] = *high;
    }
  });
  return box;
}

Broadphase suited_broadphase(const Box& extent) {
  const Vec3 size = extent.upper - extent.lower;
  return max(size.x, max(size.y, size.z)) > kGridExtent ? Broadphase::grid : Broadphase::tree;
}

// Of the models made in this process.
std::uint64_t next_build() {
  static std::atomic<std::uint64_t> builds{0};
  return ++builds;
}

Model empty_model(const Hand& hand, const Settings& settings, const Execution& execution) {
  Model model;
  model.build = next_build();
  model.hand = hand;
  model.settings = settings;
  model.execution = execution;
  return model;
}

// Some of a model's triangles, ascending. One tree, whatever the whole is searched with: there are few of
// them.
Model part_of(const Model& model, std::vector<std::uint32_t> members) {
  Model part = empty_model(model.hand, model.settings, model.execution);
  part.execution.broadphase = Broadphase::tree;
  part.triangles = model.triangles;
  part.extent = model.extent;
  part.tree = build_tree(part.triangles, members, part.execution);
  return part;
}

// What depends on the hand: patches are cut by its radii.
void build_samples(Model& model) {
  model.patches = build_patches(model.hand, model.settings, model.triangles, model.extent, model.execution);
  if (model.patches && !model.patches->exact.empty())
    model.rest = std::make_shared<const Model>(part_of(model, model.patches->exact));
}

// The hand within the hand that a pad's layer is felt by: its axes, and the palm's core, are the same.
Hand inner_hand(const Hand& hand, double from) {
  Hand inner = hand;
  for (double& radius : inner.radius) radius *= 1 - from;
  inner.palm.height -= 0.5 * from * hand.palm.thickness;
  inner.palm.thickness *= 1 - from;
  return inner;
}

Model remade(const Model& from, const Hand& hand, const Settings& settings, std::uint32_t threads);

// The layers of a model's pads; what `from`, the same world, has of them is taken over as far as it fits.
std::vector<std::shared_ptr<const Model>> layers_of(const Model& model, const Model& from) {
  std::vector<std::shared_ptr<const Model>> layers;
  for (const PadLayer& layer : model.settings.pad.layer) {
    if (layer.stiffness == 0) continue;
    Settings settings = model.settings;
    settings.pad = {};
    settings.stiffness *= layer.stiffness;
    Model base = layers.size() < from.layers.size() ? *from.layers[layers.size()] : model;
    base.apart.clear();
    base.layers.clear();
    layers.push_back(std::make_shared<const Model>(
        remade(base, inner_hand(model.hand, layer.from), settings, model.execution.threads)));
  }
  return layers;
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
    if (Status status = check_object(object->name, object->mesh, threads); !status.ok()) return status;
    vertices += object->mesh.vertices.size();
    triangles += object->mesh.triangles.size();
  }
  if (Status status = check_counts(vertices, triangles); !status.ok()) return status;
  list_objects(objects, model.objects);
  std::vector<std::vector<bool>> turned;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    turned.push_back(
        turned_triangles(objects[i]->mesh, objects[i]->winding, threads, model.objects[i].winding));
  }
  model.triangles = gather_triangles(objects, turned, vertices, triangles, threads);
  model.extent = extent_of(model.triangles, threads);
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

Settings exactly(Settings settings) {
  settings.precision.fill(0);
  settings.pad = {};
  return settings;
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

Status take_apart(const Scene& scene, Model& model) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (!is_apart(object)) continue;
    if (Status status = check_apart(object); !status.ok()) return status;
    if (model.apart.size() == kMostObjects)
      return Status::error(
          "the scene has more than 32 objects that move, rub or have a surface; give the rest neither, or "
          "put only those near the hand into the scene");
    ApartObject apart;
    apart.name = object.name;
    apart.place = i;
    apart.start = {object.pose.position, normalized(object.pose.orientation)};
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
    if (object.mechanism.mobility == Mobility::free) apart.supports = support_points(object.mesh);
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
  model.layers = layers_of(model, model);
  return {};
}

}  // namespace

std::optional<Law> parse_law(std::string_view text) { return value_named(kLawNames, text); }
std::optional<Broadphase> parse_broadphase(std::string_view text) {
  return value_named(kBroadphaseNames, text);
}
std::optional<Winding> parse_winding(std::string_view text) { return value_named(kWindingNames, text); }
std::optional<Mobility> parse_mobility(std::string_view text) { return value_named(kMobilityNames, text); }
std::string_view mobility_name(Mobility mobility) { return name_valued(kMobilityNames, mobility); }
std::optional<Isa> parse_isa(std::string_view text) { return value_named(kIsaNames, text); }
bool available(Broadphase broadphase) { return broadphase != Broadphase::voxel || has_openvdb(); }
std::string_view winding_name(Winding winding) { return name_valued(kWindingNames, winding); }
std::string_view isa_name(Isa isa) { return name_valued(kIsaNames, isa); }
std::string_view law_name(Law law) { return name_valued(kLawNames, law); }
std::string_view broadphase_name(Broadphase broadphase) { return name_valued(kBroadphaseNames, broadphase); }

Status build_model(const Scene& scene, const Execution& execution, Model& model) {
  const FloatingPointGuard guard;
  if (Status status = check_settings(scene.settings); !status.ok()) return status;
  if (Status status = check_execution(execution); !status.ok()) return status;
  if (Status status = check_hand(scene.hand); !status.ok()) return status;
  Model built = empty_model(scene.hand, scene.settings, execution);
  if (execution.isa == Isa::automatic) built.execution.isa = widest_isa();
  if (scene.objects.size() > kMostSceneObjects)
    return Status::error("the scene has more than 32768 objects; join meshes that stand still");
  if (Status status = check_surroundings(scene); !status.ok()) return status;
  built.gravity = scene.gravity;
  built.ground = scene.ground;
  Status status = scene.world ? take_world(scene, built) : take_objects(world_objects(scene), built);
  if (status.ok()) status = take_apart(scene, built);
  if (!status.ok()) return status;
  model = std::move(built);
  return {};
}

std::size_t object_of(const Model& model, std::uint32_t triangle) {
  assert(triangle < model.triangles.size());
  const auto begins_after = [](std::uint32_t number, const World::Object& object) {
    return number < object.first_triangle;
  };
  const auto next = std::upper_bound(model.objects.begin(), model.objects.end(), triangle, begins_after);
  return static_cast<std::size_t>(next - model.objects.begin()) - 1;
}

namespace {

// The same world, its shapes included, felt by another hand or otherwise. Patches are cut by the hand's radii
// and as finely as law and precision ask for.
Model remade(const Model& from, const Hand& hand, const Settings& settings, std::uint32_t threads) {
  Model built = from;
  built.build = next_build();
  built.hand = hand;
  built.settings = settings;
  built.execution.threads = threads;
  const bool cut_so = hand.radius == from.hand.radius && hand.palm.thickness == from.hand.palm.thickness &&
                      settings.law == from.settings.law && settings.precision == from.settings.precision;
  if (!cut_so) {
    built.patches.reset();
    built.rest.reset();
    if (!built.world) build_samples(built);
  } else if (from.rest) {
    built.rest = std::make_shared<const Model>(remade(*from.rest, hand, settings, threads));
  }
  built.layers = layers_of(built, from);
  for (std::size_t i = 0; i < built.apart.size(); ++i) {
    std::size_t first = 0;  // equal meshes share one
    while (from.apart[first].shape != from.apart[i].shape) ++first;
    std::shared_ptr<const Model>& shape = built.apart[i].shape;
    shape = first < i ? built.apart[first].shape
                      : std::make_shared<const Model>(remade(*from.apart[i].shape, hand, settings, threads));
    if (!from.apart[i].felt) continue;
    auto felt = std::make_shared<FeltSurface>(*from.apart[i].felt);
    felt->part = remade(felt->part, hand, exactly(settings), threads);
    built.apart[i].felt = std::move(felt);
  }
  return built;
}

}  // namespace

Status share_world(const Model& world, const Hand& hand, Model& model) {
  assert(world.build != 0 && "build_model first");
  const FloatingPointGuard guard;
  if (Status status = check_hand(hand); !status.ok()) return status;
  for (const ApartObject& object : world.apart)
    if (moves_by_itself(object.mechanism))
      return Status::error(
          "object \"" + object.name +
          "\" moves by itself and can't be shared by hands; move it from outside (shared_objects.h)");
  model = remade(world, hand, world.settings, world.execution.threads);
  return {};
}

Status change_settings(const Model& model, const Settings& settings, std::uint32_t threads, Model& changed) {
  assert(model.build != 0 && "build_model first");
  const FloatingPointGuard guard;
  Execution execution = model.execution;
  execution.threads = threads;
  if (Status status = check_settings(settings); !status.ok()) return status;
  if (Status status = check_execution(execution); !status.ok()) return status;
  changed = remade(model, model.hand, settings, threads);
  return {};
}

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

}  // namespace lumbrical
