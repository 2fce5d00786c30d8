// What is said of meshes that were turned outside out, or could not be.
#pragma once

#include <string>
#include <vector>

#include "lumbrical/model.h"
#include "output.h"

namespace lumbrical::tool {

Json to_json(const WindingReport& report);

/// Of every object by itself: several may have the same name.
Json windings_json(const std::vector<World::Object>& objects);

/// A sentence on what was turned and one on what the user has to decide; empty where there is neither.
std::vector<std::string> winding_sentences(const WindingReport& report);

/// The same for every object that there is something to say of, its name before it.
void add_windings(const std::vector<World::Object>& objects, Table& table);

}  // namespace lumbrical::tool
