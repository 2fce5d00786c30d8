// The device's side of a slow bus: a torque, its stiffness and how far both may be trusted, so that the
// device closes a fast loop of its own between two commands. Plain C99, no dependencies: copy it into a
// firmware.
//
// Angles [rad] close the joint, torques [N m] open it.
#ifndef LUMBRICAL_LOCAL_MODEL_H
#define LUMBRICAL_LOCAL_MODEL_H

#ifdef __cplusplus
extern "C" {
#endif

// What a command says of one joint.
typedef struct lumbrical_local_model {
  double torque;     // [N m] at `angle`
  double angle;      // [rad]
  double stiffness;  // [N m/rad] by which the torque grows as the joint closes; >= 0
  double radius;     // [rad] beyond angle -/+ radius the torque stays what it is there
} lumbrical_local_model;

// What the device itself will not exceed, whatever the commands say.
typedef struct lumbrical_local_limits {
  double torque;     // [N m] largest, either way
  double stiffness;  // [N m/rad] largest that its own loop renders without shaking: 2 damping / period
  double hold;       // [s] age of a command up to which it counts in full
  double fade;       // [s] in which it then fades to nothing
} lumbrical_local_limits;

// Torque for the joint at `angle`, `age` seconds after the command came. A touch only pushes: the torque
// never changes its sign away from that at the command's angle. Anything that is not a number gives 0.
static inline double lumbrical_local_torque(const lumbrical_local_model* model,
                                            const lumbrical_local_limits* limits, double angle, double age) {
  double moved = angle - model->angle;
  double stiffness = model->stiffness;
  double torque, share;
  const double all = model->torque + stiffness + moved + model->radius + limits->torque + limits->stiffness +
                     limits->hold + limits->fade + age;
  if (all != all) return 0;
  if (!(stiffness > 0)) stiffness = 0;
  if (stiffness > limits->stiffness) stiffness = limits->stiffness;
  if (moved > model->radius) moved = model->radius;
  if (moved < -model->radius) moved = -model->radius;
  torque = model->torque + stiffness * moved;
  if (model->torque >= 0 ? torque < 0 : torque > 0) torque = 0;
  if (torque > limits->torque) torque = limits->torque;
  if (torque < -limits->torque) torque = -limits->torque;
  share = 1;
  if (age > limits->hold) share = 1 - (age - limits->hold) / limits->fade;
  if (!(share > 0)) return 0;
  torque *= share;
  return torque == torque ? torque : 0;
}

#ifdef __cplusplus
}
#endif
#endif
