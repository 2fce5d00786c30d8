// Sweeps a loop over delays.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "delayed_loop.h"
#include "lumbrical/shapes.h"
#include "print.h"

namespace {
using namespace lumbrical;
using namespace lumbrical::bench;

Model grasp_model(double stiffness) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.stiffness = stiffness;
  scene.settings.rate = 1000;
  scene.objects.push_back({"mug", make_mug({})});
  Model model;
  Execution execution;
  if (!build_model(scene, execution, model).ok()) std::abort();
  return model;
}
}  // namespace

int main(int argc, char** argv) {
  DeviceProfile profile;
  if (!load_device_profile(argv[1], profile).ok()) return 2;
  profile.response_timeout = 0.2;
  profile.safety.answer_timeout = 0.5;
  const double length = argc > 2 ? atof(argv[2]) : 4;
  const Model model = grasp_model(argc > 3 ? atof(argv[3]) : 2e7);
  const Motion motion = make_grasp(model.hand, 0.037, 0.095, length);
  if (argc > 5) { DelayedLoop l; l.human = {atof(argv[5]), atof(argv[5])*0.02}; l.friction = atof(argv[6]); l.bus = {static_cast<Delays>(atoi(argv[7])), atof(argv[8]), 1000}; const LoopFelt f = run_delayed(model, motion, profile, l); printf("shakes %d given %.3f step %.2f torque %.2f factor %.3f share %.3f\n", int(f.shakes), 1e3*f.given, 1e3*f.step, 1e3*f.torque, f.factor, f.share); return 0; }
  const int variants = argc > 4 ? atoi(argv[4]) : 5;
  for (const HumanJoint& human : {HumanJoint{0.5, 0.01}, HumanJoint{0.2, 0.004}, HumanJoint{0.05, 0.001}, HumanJoint{0, 0}})
    for (const double friction : {1.0, 0.0})
      for (const double delay : {0.0, 0.005, 0.015, 0.05})
        for (const Delays kind : {Delays::constant, Delays::jittering, Delays::growing, Delays::stepping}) {
          if (delay == 0 && kind != Delays::constant) continue;
          for (int v = 0; v < variants; ++v) {
            DelayedLoop loop;
            loop.human = human;
            loop.friction = friction;
            loop.bus = {kind, delay, 1000};
            if (v == 1) loop.options.limiter = false;
            if (v == 2) loop.options.account = false;
            if (v == 3) loop.options.follow = false;
            if (v == 4) loop.options.limiter = loop.options.account = false;
            const clock_t t = clock();
            const LoopFelt f = run_delayed(model, motion, profile, loop);
            const char* names[] = {"all", "-limiter", "-account", "-follow", "none"};
            printf("h %.2f f %.0f d %4.1f %-9s %-8s shakes %3d given %8.3f taken %9.3f mJ step %7.2f mNm torque %7.3f factor %.3f share %.3f  %.2fs\n",
                   human.stiffness, friction, 1e3 * delay, kDelayNames[int(kind)], names[v], int(f.shakes), 1e3 * f.given,
                   1e3 * f.taken, 1e3 * f.step, 1e3 * f.torque, f.factor, f.share, double(clock() - t) / CLOCKS_PER_SEC);
            fflush(stdout);
          }
        }
}
