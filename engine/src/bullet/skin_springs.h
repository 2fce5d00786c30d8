// Hands' touches as Bullet's solver takes them: springs that give way within a step, linearly implicit as for
// what moves by itself (objects/body_motion.h), but solved together with what else touches the body.
#pragma once

#include <array>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include "lumbrical/math.h"

namespace lumbrical {

/// What holds a body back as its speed changes in a step: h^2 K per change, in the six ways that neither K
/// nor the mass couples, so that each row is solved by itself.
class SkinSprings : public btTypedConstraint {
 public:
  /// `fixed` stands still.
  SkinSprings(btRigidBody& body, btRigidBody& fixed);

  /// K [N/m, N, N m/rad] about the body's centre of mass, W, in a step of `dt` [s].
  void set(const Matrix6& stiffness, double dt);
  void clear() { setEnabled(false); }

  void getInfo1(btConstraintInfo1* info) override;
  void getInfo2(btConstraintInfo2* info) override;
  void setParam(int, btScalar, int) override {}
  [[nodiscard]] btScalar getParam(int, int) const override { return 0; }

 private:
  Matrix6 rows_{};  ///< of Bullet's speeds, each of mass 1
  std::array<double, 6> softness_{};
};

/// Bullet's solver with softness in rows of joints too, which its own counts without what it adds to their
/// mass.
class SoftSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertJoints(btTypedConstraint** constraints, int count, const btContactSolverInfo& info) override;
};

}  // namespace lumbrical
