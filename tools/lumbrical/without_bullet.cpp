// In the place of lumbrical::bullet, in a build without it.
#include "lumbrical/bullet.h"

namespace lumbrical {

Status make_bullet_world(const Model&, const BulletOptions&, BulletWorld&) {
  return Status::error(
      "the scene's bodies are moved by Bullet, which this build has not; install libbullet-dev and build "
      "again");
}
void push_bodies(BulletWorld&, const Model&, Scratch&) {}
void move_bodies(BulletWorld&, const Model&, std::span<ObjectFrame>) {}

}  // namespace lumbrical
