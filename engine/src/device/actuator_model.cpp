// Bounded least squares by principal pivoting: a guess which commands are at a bound, a linear solve for the
// others, and a new guess from the signs (Judice and Pires, Block pivoting for bounded least squares, 1994).
#include "lumbrical/actuator_model.h"

#include <cmath>

#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// Weight of small commands against torque errors, both relative to full scale: makes the answer unique where
// actuators are redundant, and is lost in any register.
constexpr double kPreferSmall = 1e-10;
// Full pivots are fast but may go round in circles; single ones of the least index can't.
constexpr int kFullPivots = 10;
constexpr int kMostPivots = 2000;
constexpr double kRestingSpeed = 1e-3;  // [rad/s]

using Matrix = std::array<ActuatorArray, kMaxActuators>;

// Minimise |A x - t|^2 over 0 <= x <= 1, where x is each command's share of its range.
struct Problem {
  int size = 0;
  Matrix hessian{};          // A'A and a little on the diagonal
  ActuatorArray gradient{};  // A't
};

enum class Place : std::uint8_t { inside, low, high };

// Solves for the commands that are inside, the others at their bounds: Cholesky in place.
void solve_inside(const Problem& problem, const std::array<Place, kMaxActuators>& place, ActuatorArray& x) {
  std::array<int, kMaxActuators> index{};
  int count = 0;
  for (int i = 0; i < problem.size; ++i) {
    x[i] = place[i] == Place::high ? 1 : 0;
    if (place[i] == Place::inside) index[count++] = i;
  }
  Matrix factor{};
  ActuatorArray y{};
  for (int a = 0; a < count; ++a) {
    double right = problem.gradient[index[a]];
    for (int i = 0; i < problem.size; ++i) {
      if (place[i] == Place::high) right -= problem.hessian[index[a]][i];
    }
    for (int b = 0; b <= a; ++b) {
      double sum = problem.hessian[index[a]][index[b]];
      for (int k = 0; k < b; ++k) sum -= factor[a][k] * factor[b][k];
      // The hessian is positive definite; rounding must not make a root imaginary.
      factor[a][b] = a == b ? std::sqrt(max(sum, 1e-30)) : sum / factor[b][b];
    }
    for (int k = 0; k < a; ++k) right -= factor[a][k] * y[k];
    y[a] = right / factor[a][a];
  }
  for (int a = count - 1; a >= 0; --a) {
    double sum = y[a];
    for (int k = a + 1; k < count; ++k) sum -= factor[k][a] * x[index[k]];
    x[index[a]] = sum / factor[a][a];
  }
}

// Where command i belongs, seen from the present answer.
Place place_of(const Problem& problem, const ActuatorArray& x, Place now, int i) {
  if (now == Place::inside) return x[i] < 0 ? Place::low : x[i] > 1 ? Place::high : Place::inside;
  double slope = -problem.gradient[i];
  for (int k = 0; k < problem.size; ++k) slope += problem.hessian[i][k] * x[k];
  const double tolerance = 1e-12 * problem.hessian[i][i];
  if (now == Place::low && slope < -tolerance) return Place::inside;
  if (now == Place::high && slope > tolerance) return Place::inside;
  return now;
}

void solve(const Problem& problem, ActuatorArray& x) {
  std::array<Place, kMaxActuators> place{};
  for (int pivot = 0; pivot < kMostPivots; ++pivot) {
    solve_inside(problem, place, x);
    bool settled = true;
    const std::array<Place, kMaxActuators> before = place;
    for (int i = problem.size - 1; i >= 0; --i) {
      const Place wanted = place_of(problem, x, before[i], i);
      if (wanted == before[i]) continue;
      settled = false;
      place[i] = wanted;
      if (pivot >= kFullPivots) break;
    }
    if (settled) break;
  }
  for (int i = 0; i < problem.size; ++i) x[i] = clamp(x[i], 0, 1);
}

// +1 or -1: the sense in which a brake acts now, as a factor of its arm; 0 where it can't help.
double brake_sense(const Actuator& actuator, const JointArray& wanted, const JointArray& speed) {
  double power = 0, torque = 0, motion = 0;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const double arm = std::fabs(actuator.arm[j]);
    torque += arm * wanted[j];
    power += arm * speed[j];
    motion = max(motion, arm != 0 ? std::fabs(speed[j]) : 0);
  }
  const double sense = torque > 0 ? 1 : torque < 0 ? -1 : 0;
  if (motion < kRestingSpeed) return sense;
  return sense * power > 0 ? sense : 0;  // an opening torque resists closing
}

JointArray finite_or_zero(JointArray values) {
  for (double& value : values) value = is_finite(value) ? value : 0;
  return values;
}

// What commands do: command = base + range * x, where x is each one's share of its range.
struct Effects {
  int size = 0;
  std::array<JointArray, kMaxActuators> torque{};  // of command i per unit
  ActuatorArray base{}, range{};
  JointArray rest{};  // what is left for x to do
};

Effects effects_of(const DeviceProfile& profile, const JointArray& wanted, const JointArray& speed) {
  Effects effects;
  effects.size = static_cast<int>(profile.actuators.size());
  effects.rest = wanted;
  auto& [size, torque, base, range, rest] = effects;
  for (int i = 0; i < size; ++i) {
    const Actuator& actuator = profile.actuators[i];
    const bool brake = actuator.drive == Drive::brake;
    const double sense = brake ? brake_sense(actuator, wanted, speed) : 1;
    base[i] = actuator.drive == Drive::wire ? actuator.preload : actuator.lower;
    range[i] = actuator.upper - base[i];
    for (std::size_t j = 0; j < kPhalanxCount; ++j) {
      torque[i][j] = sense * (brake ? std::fabs(actuator.arm[j]) : actuator.arm[j]);
      rest[j] -= torque[i][j] * base[i];
    }
  }
  return effects;
}

Problem normal_equations(const Effects& effects) {
  const auto& [size, torque, base, range, rest] = effects;
  Problem problem;
  problem.size = size;
  for (int i = 0; i < size; ++i) {
    for (int k = 0; k < size; ++k) {
      for (std::size_t j = 0; j < kPhalanxCount; ++j) {
        problem.hessian[i][k] += torque[i][j] * range[i] * torque[k][j] * range[k];
      }
    }
    for (std::size_t j = 0; j < kPhalanxCount; ++j) problem.gradient[i] += torque[i][j] * range[i] * rest[j];
    const double weight = kPreferSmall * problem.hessian[i][i] + 1e-24;
    problem.hessian[i][i] += weight;
    // A motor's smallest command is no torque, not its lower end: the little weight pulls it there.
    const double nothing = range[i] > 0 ? clamp(-base[i] / range[i], 0, 1) : 0;
    problem.gradient[i] += weight * nothing;
  }
  return problem;
}

ActuatorSolution solution_of(const DeviceProfile& profile, const JointArray& wanted, const Effects& effects,
                             const ActuatorArray& share) {
  ActuatorSolution solution;
  for (int i = 0; i < effects.size; ++i) {
    const Actuator& actuator = profile.actuators[i];
    const double base = effects.base[i];
    solution.command[i] = clamp(base + effects.range[i] * share[i], base, actuator.upper);
    const bool low_end = share[i] <= 0 && actuator.drive == Drive::motor;
    if (share[i] >= 1 || low_end) solution.saturated |= 1u << i;
    for (std::size_t j = 0; j < kPhalanxCount; ++j)
      solution.torque[j] += effects.torque[i][j] * solution.command[i];
  }
  double squares = 0;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    solution.lost[j] = wanted[j] - solution.torque[j];
    squares += solution.lost[j] * solution.lost[j];
  }
  solution.lost_norm = std::sqrt(squares);
  return solution;
}

}  // namespace

ActuatorSolution solve_actuators(const DeviceProfile& profile, const JointArray& wanted_any,
                                 const JointArray& speed_any) {
  const JointArray wanted = finite_or_zero(wanted_any), speed = finite_or_zero(speed_any);
  const Effects effects = effects_of(profile, wanted, speed);
  ActuatorArray share{};
  solve(normal_equations(effects), share);
  return solution_of(profile, wanted, effects, share);
}

}  // namespace lumbrical
