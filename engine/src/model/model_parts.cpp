// What a model is made of besides its triangles and their index, and the same again for another hand or
// other settings.
#include "model/model_parts.h"

#include <atomic>
#include <cassert>
#include <new>
#include <utility>

#include "base/floating_point.h"
#include "index/patches.h"
#include "index/sphere_tree.h"
#include "model/corners.h"
#include "model/felt_surface.h"
#include "model/mesh_winding.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

// Of the models made in this process.
std::uint64_t next_build() {
  static std::atomic<std::uint64_t> builds{0};
  return ++builds;
}

// The hand within the hand that a pad's layer is felt by: its axes, and the palm's core, are the same.
Hand inner_hand(const Hand& hand, double from) {
  Hand inner = hand;
  for (double& radius : inner.radius) radius *= 1 - from;
  inner.palm.height -= 0.5 * from * hand.palm.thickness;
  inner.palm.thickness *= 1 - from;
  return inner;
}

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
    build_samples(built);
  }
  if (from.settings.proxy_stiffness == 0) find_solids(built);
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

Model empty_model(const Hand& hand, const Settings& settings, const Execution& execution) {
  Model model;
  model.build = next_build();
  model.hand = hand;
  model.settings = settings;
  model.execution = execution;
  return model;
}

Model part_of(const Model& model, std::vector<std::uint32_t> members) {
  Model part = empty_model(model.hand, model.settings, model.execution);
  part.execution.broadphase = Broadphase::tree;
  part.triangles = model.triangles;
  for (const std::uint32_t member : members) {
    const Corners at = corners_of(part.triangles, member);
    for (const Vec3 corner : {at.a, at.b, at.c}) part.extent.add(corner);
  }
  part.tree = build_tree(part.triangles, members, part.execution);
  return part;
}

void build_samples(Model& model) {
  const Triangles& cut_now = model.world ? Triangles() : model.triangles;
  model.patches = build_patches(model.hand, model.settings, cut_now, model.extent, model.execution);
}

// As meshes stand, turned or not: so a replay, which takes them as they are, finds the same.
void find_solids(Model& model) {
  if (model.settings.proxy_stiffness == 0 || model.world) return;
  for (World::Object& object : model.objects)
    object.solid = is_solid(mesh_of(model, object), model.execution.threads);
}

std::vector<std::shared_ptr<const Model>> layers_of(const Model& model, const Model& from) {
  std::vector<std::shared_ptr<const Model>> layers;
  for (const PadLayer& layer : model.settings.pad.layer) {
    if (layer.stiffness == 0) continue;
    Settings settings = model.settings;
    settings.pad = {};
    settings.proxy_stiffness = 0;  // the hand has one, layers feel where it is
    settings.stiffness *= layer.stiffness;
    Model base = layers.size() < from.layers.size() ? *from.layers[layers.size()] : model;
    base.apart.clear();
    base.layers.clear();
    layers.push_back(std::make_shared<const Model>(
        remade(base, inner_hand(model.hand, layer.from), settings, model.execution.threads)));
  }
  return layers;
}

Settings exactly(Settings settings) {
  settings.precision.fill(0);
  settings.pad = {};
  return settings;
}

Status no_memory_for_model() {
  return Status::error(
      "there is not enough memory for the model; simplify meshes, or put them into a world file");
}

Status share_world(const Model& world, const Hand& hand, Model& model) try {
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
} catch (const std::bad_alloc&) {
  return no_memory_for_model();
}

Status change_settings(const Model& model, const Settings& settings, std::uint32_t threads,
                       Model& changed) try {
  assert(model.build != 0 && "build_model first");
  const FloatingPointGuard guard;
  Execution execution = model.execution;
  execution.threads = threads;
  if (Status status = check_settings(settings); !status.ok()) return status;
  if (Status status = check_execution(execution); !status.ok()) return status;
  changed = remade(model, model.hand, settings, threads);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory_for_model();
}

}  // namespace lumbrical
