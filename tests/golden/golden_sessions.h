// The sessions whose bits are held in golden_hashes.h: every law, and the scenes in which bits are lost most
// easily. Made without a function of the C library whose last digit depends on the machine.
#pragma once

#include <string>
#include <vector>

#include "session.h"

namespace lumbrical::test {

struct GoldenSession {
  std::string name;
  Scene scene;
  std::vector<DeviceFrame> frames;
};

/// The mug grasped under each law, then the hard ones: thousands of contacts at once, thin sheets, lost
/// tracking and missing joints, input that is not finite, too many candidates, large triangles, a world far
/// from its origin, a law per segment, every rung of samples, fingers bent and folded, objects that rub and
/// move, a proxy.
std::vector<GoldenSession> golden_sessions();

/// Hash of the Jacobians along a grasp.
std::uint64_t hash_jacobians(const Execution& execution);

/// Hash of the integrals of single pairs, every rung of precision on pairs of every shape and size.
std::uint64_t hash_pairs(Isa isa);

/// The value in golden_hashes.h; 0 where there is none of that name.
std::uint64_t golden_hash(const std::string& name);

}  // namespace lumbrical::test
