// What build_model asks of objects that are felt apart from the world.
#pragma once

#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// Refuses frictions, masses, joints, surfaces and poses that make no sense, and names object and field.
Status check_apart(const SceneObject& object);

/// Gravity and ground.
Status check_surroundings(const Scene& scene);

/// [m] O: points of a mesh that may rest on a plane, those farthest out in 56 directions, most of them close
/// to an axis.
std::vector<Vec3> support_points(const Mesh& mesh);

/// Finds what each object's latch is opened by.
Status find_latches(std::vector<ApartObject>& objects);

}  // namespace lumbrical
