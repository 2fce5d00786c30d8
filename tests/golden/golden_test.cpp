// The golden sessions: that they are as hard as they claim to be, and their bits in the plainest way to run.
// Every other way: tests/golden/golden_hashes.cpp.
#include <gtest/gtest.h>

#include "golden/golden_sessions.h"
#include "proxy/proxy_hand.h"

namespace lumbrical::test {
namespace {

struct Outcome {
  std::uint32_t contacts = 0, most_contacts = 0;
  std::uint32_t flags = 0;    // that any tick had
  std::uint32_t trusted = 0;  // ticks whose input was
  std::uint32_t held = 0;     // ticks in which a proxy was held back
  std::uint64_t hash = 0;
};

Outcome outcome_of(const GoldenSession& session) {
  const Model model = model_of(session.scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  Hasher hasher;
  Outcome outcome;
  for (const DeviceFrame& frame : session.frames) {
    const ActuatorFrame output = tick(model, state, scratch, frame);
    outcome.contacts += output.contact_count;
    outcome.most_contacts = std::max(outcome.most_contacts, output.contact_count);
    outcome.flags |= output.flags;
    constexpr std::uint32_t kUntrusted =
        kInputNotFinite | kInputImplausible | kInputLost | kCandidateOverflow;
    outcome.trusted += (output.flags & kUntrusted) == 0 ? 1 : 0;
    outcome.held += scratch.proxy && !scratch.proxy->pushing.empty() ? 1 : 0;
    for (const std::uint64_t hash : scratch.stage_hash) hasher.value(hash);
    hasher.value(hash_state(state));
  }
  outcome.hash = hasher.digest();
  return outcome;
}

// What makes a session a hard one.
void expect_hard(const std::string& name, const Outcome& outcome, std::size_t ticks) {
  std::uint32_t flags = 0;
  if (name == "lost") flags = kInputLost | kInputExtrapolated | kSegmentMissing | kFading;
  if (name == "not_finite") flags = kInputNotFinite | kInputImplausible | kFading;
  if (name == "objects") flags = kObjectMissing;
  if (name == "overflow") flags = kCandidateOverflow | kFading;
  EXPECT_EQ(outcome.flags & flags, flags) << name;
  EXPECT_GT(outcome.contacts, name == "overflow" ? 50u : 300u) << name;
  EXPECT_EQ(outcome.trusted == ticks, flags == 0 || name == "objects") << name;
  EXPECT_EQ(outcome.held > 1, name == "proxy") << name;
  EXPECT_GT(outcome.most_contacts, name == "crowd" ? 3000u : 3u) << name;
}

TEST(Golden, SessionsAreAsHardAsTheyClaimAndHaveTheirBits) {
  for (const GoldenSession& session : golden_sessions()) {
    const Outcome outcome = outcome_of(session);
    expect_hard(session.name, outcome, session.frames.size());
    EXPECT_EQ(outcome.hash, golden_hash(session.name)) << session.name << ": 0x" << std::hex << outcome.hash;
  }
}

// Also where a frame says nothing and the last one's pose still lies about.
TEST(Golden, SessionsDoNotDependOnWhatScratchHoldsFromBefore) {
  for (GoldenSession& session : golden_sessions()) {
    if (session.name != "lost" && session.name != "not_finite") continue;
    session.scene.settings.max_candidates = 1u << 12;  // cheap to make anew
    const Model model = model_of(session.scene);
    State state = make_state(model);
    Hasher hasher;
    for (const DeviceFrame& frame : session.frames) {
      Scratch scratch = make_scratch(model);
      tick(model, state, scratch, frame);
      for (const std::uint64_t hash : scratch.stage_hash) hasher.value(hash);
      hasher.value(hash_state(state));
    }
    EXPECT_EQ(hasher.digest(), golden_hash(session.name)) << session.name;
  }
}

}  // namespace
}  // namespace lumbrical::test
