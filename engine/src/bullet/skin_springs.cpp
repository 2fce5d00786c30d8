#include "bullet/skin_springs.h"

#include <cmath>

#include "base/vector6.h"
#include "bullet/hull_shape.h"

namespace lumbrical {
namespace {

// Of what is softer a row would be as good as none.
constexpr double kLeast = 1e-9;

constexpr int kMostSweeps = 20;

/// Eigenvectors in columns.
struct Eigen6 {
  Matrix6 vectors{};
  std::array<double, 6> values{};
};

// Turns rows and columns i and j so that their element becomes 0.
void turn(std::size_t i, std::size_t j, Matrix6& a, Matrix6& vectors) {
  if (a[i][j] == 0) return;
  const double slope = (a[j][j] - a[i][i]) / (2 * a[i][j]);
  const double t = std::copysign(1, slope) / (std::fabs(slope) + std::sqrt(slope * slope + 1));
  const double cosine = 1 / std::sqrt(t * t + 1), sine = t * cosine;
  const auto mix = [&](double& first, double& second) {
    const double before = first;
    first = cosine * before - sine * second;
    second = sine * before + cosine * second;
  };
  for (std::size_t k = 0; k < 6; ++k) mix(a[k][i], a[k][j]);
  for (std::size_t k = 0; k < 6; ++k) mix(a[i][k], a[j][k]);
  for (std::size_t k = 0; k < 6; ++k) mix(vectors[k][i], vectors[k][j]);
}

// Jacobi's method.
Eigen6 eigen_of(Matrix6 a) {
  Eigen6 eigen;
  for (std::size_t k = 0; k < 6; ++k) eigen.vectors[k][k] = 1;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double off = 0, on = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      on += a[i][i] * a[i][i];
      for (std::size_t j = 0; j < i; ++j) off += a[i][j] * a[i][j];
    }
    if (!(off > 1e-24 * on)) break;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = i + 1; j < 6; ++j) turn(i, j, a, eigen.vectors);
  }
  for (std::size_t k = 0; k < 6; ++k) eigen.values[k] = a[k][k];
  return eigen;
}

// A body's main axes, to move along and to turn about, W; and the roots of its mass for each, in SI units.
struct MainWays {
  Matrix6 way{};
  Vector6 root{};
};

MainWays main_ways(const btRigidBody& body) {
  const btMatrix3x3& axes = body.getWorldTransform().getBasis();
  MainWays ways;
  for (int k = 0; k < 3; ++k) {
    const auto moving = static_cast<std::size_t>(k), turning = moving + 3;
    ways.root[moving] = 1 / std::sqrt(body.getInvMass());
    ways.root[turning] = 1 / (kUnitsPerMetre * std::sqrt(body.getInvInertiaDiagLocal()[k]));
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      ways.way[moving][at] = ways.way[turning][at + 3] = axes[i][k];
    }
  }
  return ways;
}

// Along the main ways, of unit mass each.
Matrix6 per_mass(const Matrix6& stiffness, const MainWays& ways) {
  Matrix6 result;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector6 force = times(stiffness, ways.way[i]);
    for (std::size_t j = 0; j < 6; ++j)
      result[j][i] = dot6(ways.way[j], force) / (ways.root[i] * ways.root[j]);
  }
  return result;
}

}  // namespace

SkinSprings::SkinSprings(btRigidBody& body, btRigidBody& fixed)
    : btTypedConstraint(MAX_CONSTRAINT_TYPE, body, fixed) {
  setEnabled(false);
}

void SkinSprings::set(const Matrix6& stiffness, double dt) {
  const MainWays ways = main_ways(m_rbA);
  const Eigen6 eigen = eigen_of(per_mass(stiffness, ways));
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t i = 0; i < 6; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < 6; ++k) sum += eigen.vectors[k][r] * ways.root[k] * ways.way[k][i];
      rows_[r][i] = i < 3 ? sum : kUnitsPerMetre * sum;
    }
    softness_[r] = 1 / max(kLeast, dt * dt * eigen.values[r]);
  }
  setEnabled(true);
}

void SkinSprings::getInfo1(btConstraintInfo1* info) {
  info->m_numConstraintRows = 6;
  info->nub = 0;
}

// A row is slack at the speed that the body has.
void SkinSprings::getInfo2(btConstraintInfo2* info) {
  const btVector3 &velocity = m_rbA.getLinearVelocity(), &spin = m_rbA.getAngularVelocity();
  for (int r = 0; r < 6; ++r) {
    const Vector6& row = rows_[static_cast<std::size_t>(r)];
    const int at = r * info->rowskip;
    for (int k = 0; k < 3; ++k) {
      const auto moving = static_cast<std::size_t>(k), turning = moving + 3;
      info->m_J1linearAxis[at + k] = row[moving];
      info->m_J1angularAxis[at + k] = row[turning];
      info->m_constraintError[at] += row[moving] * velocity[k] + row[turning] * spin[k];
    }
    info->cfm[at] = softness_[static_cast<std::size_t>(r)];
  }
  info->m_damping = 1;
}

void SoftSolver::convertJoints(btTypedConstraint** constraints, int count, const btContactSolverInfo& info) {
  btSequentialImpulseConstraintSolver::convertJoints(constraints, count, info);
  for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverNonContactConstraintPool[i];
    const btScalar share = 1 / (1 + row.m_cfm * row.m_jacDiagABInv);
    row.m_rhs *= share;
    row.m_cfm *= row.m_jacDiagABInv * share;
    row.m_jacDiagABInv *= share;
  }
}

}  // namespace lumbrical
