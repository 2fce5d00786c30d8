// What a model is made of besides its triangles and their index.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// Known as one of its own, without a world.
Model empty_model(const Hand& hand, const Settings& settings, const Execution& execution);

/// Some of a model's triangles, ascending. One tree, whatever the whole is searched with: there are few of
/// them.
Model part_of(const Model& model, std::vector<std::uint32_t> members);

/// What depends on the hand: patches are cut by its radii. Those of a world file are cut where a hand comes
/// near (cut_patches.h).
void build_samples(Model& model);

/// The layers of a model's pads; what `from`, the same world, has of them is taken over as far as it fits.
std::vector<std::shared_ptr<const Model>> layers_of(const Model& model, const Model& from);

/// Those settings without samples and pads.
Settings exactly(Settings settings);

Mesh mesh_of(const Model& model, const World::Object& part);

/// The error where memory ends.
Status no_memory_for_model();

/// Tells which objects are solid, if there is a proxy to know it.
void find_solids(Model& model);

}  // namespace lumbrical
