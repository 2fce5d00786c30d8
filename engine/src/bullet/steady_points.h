// The points at which a body in Bullet touches a mesh, chosen so that those a body stands on stay.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace lumbrical {

/// For btCollisionDispatcher::setNearCallback. Bullet keeps four points of a body and a mesh, and where it
/// has them every further one takes the place of one, even in the midst of them: over the many triangles of a
/// finely cut surface all four are others in each step, and a pressed body wanders. Here a further one does
/// only where it carries more than what it replaces. Other pairs, whose points are few, are left to Bullet.
void find_steady_points(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                        const btDispatcherInfo& info);

}  // namespace lumbrical
