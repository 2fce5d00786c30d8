// What build_model asks of objects that are felt apart from the world.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

/// Of any object: frictions that make no sense would rub nothing, and leave it in the world. Names the field.
Status check_material(const SceneObject& object);

/// Of any object: a damper, a spring, limits and the like where nothing moves so that they could act. Names
/// the field, not the object.
Status check_mechanism(const Mechanism& mechanism);

/// The same but for what check_mechanism refuses: recordings from before it did hold some.
Mechanism without_meaningless(Mechanism mechanism);

/// Refuses masses, joints, surfaces and poses that make no sense, and names object and field.
Status check_apart(const SceneObject& object);

/// Of some body: in range and positive about every axis, and no axis above the sum of the others.
bool is_inertia(const std::array<double, 6>& inertia);
/// What to give in its place where it is not.
std::string inertia_rule();

/// Gravity and ground.
Status check_surroundings(const Scene& scene);

/// [m] O: up to kMostSupports points of a mesh that may rest on a plane: the corners of faces across its
/// axes, then what stands out most all round.
std::vector<Vec3> support_points(const Mesh& mesh);

/// Finds what each object's latch is opened by.
Status find_latches(std::vector<ApartObject>& objects);

}  // namespace lumbrical
