// Bodies that touch each other, moved by Bullet: the library lumbrical::bullet, where Bullet is found.
//
// All contact with the hand is the tick's. What the hand does to given objects (Mobility::given) goes into a
// physics engine as a wrench, and where the engine has moved them goes into the next tick as ObjectFrame:
//
//   BulletWorld world;  make_bullet_world(model, {}, world)
//   std::vector<ObjectFrame> given = start_frames(model);  // shared_objects.h
//   for every tick:
//     output = tick(model, state, scratch, frame, given);
//     push_bodies(world, model, scratch);
//     move_bodies(world, model, given);
//
// The last two functions are the whole seam: whoever has another engine writes these two for it, in the
// simplest case with the wrenches of Scratch::object_output. Poses are input of a tick and recorded with it,
// so a replay needs no physics engine.
#pragma once

#include <memory>
#include <span>

#include "lumbrical/model.h"
#include "lumbrical/tick.h"

namespace lumbrical {

struct BulletOptions {
  double friction = 0.5;  ///< 0 .. 10 between bodies, and between them and the world
};

struct BulletBodies;  // Bullet's objects; bullet_world.cpp

/// A model in Bullet: given objects with a mass are moved by it, those without go where they are told and
/// push them: what is no pose is not taken, and one farther away than a hand's tick takes for a motion pushes
/// nothing away. What stands still holds them up, and so does the ground. Objects that move by themselves are
/// not in it. Each part of a given object's mesh (triangles that share corners, or where such are flat,
/// places) is taken by its convex hull.
struct BulletWorld {
  std::shared_ptr<BulletBodies> bodies;  ///< null: none
};

/// Refuses options out of range, a world in a file, and a part of a mesh with a mass that is flat.
Status make_bullet_world(const Model& model, const BulletOptions& options, BulletWorld& world);

/// Pushes the bodies in the next step by what a hand has done to them in a tick of `model`, which has the
/// world's objects: once for each hand, in the same order every time.
void push_bodies(BulletWorld& world, const Model& model, Scratch& scratch);

/// Moves everything by a tick of the world's model. Touches give way like springs within Bullet's own step,
/// so light things in a firm grip are stable; hands feel that a tick later. `given` has the poses for the
/// next tick, of the given objects in their order: it tells where those without a mass are to be, and is told
/// where the others are. What Bullet has lost is told as it is, not finite: tick flags it and lets forces
/// fade.
void move_bodies(BulletWorld& world, const Model& model, std::span<ObjectFrame> given);

}  // namespace lumbrical
