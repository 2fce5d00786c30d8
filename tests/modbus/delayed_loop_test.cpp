// A few cells of bench/delay_sweep: whatever the bus does, no shake and next to no energy into the hand, and
// still something is felt; without the protections there is enough of both.
#include "delayed_loop.h"

#include <gtest/gtest.h>

#include "delay_cells.h"

namespace lumbrical {
namespace {

using namespace bench;

struct Sweep {
  DeviceProfile profile;
  Model model;
  Sweep() {
    const std::string path = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/exoskeleton.json";
    EXPECT_TRUE(load_patient_profile(path, profile).ok());
    EXPECT_TRUE(build_mug(2e7, model).ok());
  }
  LoopFelt run(const Bus& bus, const LoopOptions& options, double seconds) const {
    DelayedLoop loop;
    loop.bus = bus;
    loop.human = kHands[0].hold;
    loop.friction = 0;
    loop.options = options;
    return run_delayed(model, mug_grasp(model, seconds), profile, loop);
  }
};

TEST(DelayedLoop, DoesNotShakeAndGivesNoEnergyWhateverTheBusDoes) {
  const Sweep sweep;
  const LoopFelt felt = sweep.run({Delays::jittering, 0.015, 1000}, {}, 10);
  EXPECT_EQ(felt.shakes, 0u);
  EXPECT_LT(felt.given, 1e-3);
  EXPECT_GT(felt.torque, 5e-3) << "something is felt";
}

TEST(DelayedLoop, ShakesAndGivesEnergyWithoutProtection) {
  LoopOptions none;
  none.limiter = none.account = none.follow = none.gaps = false;
  const LoopFelt felt = Sweep().run({Delays::jittering, 0.05, 1000}, none, 4);
  EXPECT_GT(felt.given, 10e-3);
}

TEST(DelayedLoop, TheAccountsAloneBoundTheEnergy) {
  LoopOptions options;
  options.limiter = false;
  const LoopFelt felt = Sweep().run({Delays::jittering, 0.05, 1000}, options, 4);
  EXPECT_LT(felt.given, 10e-3);
}

TEST(DelayedLoop, GivesTheSameBitsEveryTime) {
  const Sweep sweep;
  const Bus bus = {Delays::growing, 0.015, 1000};
  DelayedLoop loop;
  loop.bus = bus;
  const Motion motion = mug_grasp(sweep.model, 0.5);
  const LoopFelt first = run_delayed(sweep.model, motion, sweep.profile, loop);
  const LoopFelt second = run_delayed(sweep.model, motion, sweep.profile, loop);
  EXPECT_EQ(first.torque, second.torque);
  EXPECT_EQ(first.taken, second.taken);
}

}  // namespace
}  // namespace lumbrical
