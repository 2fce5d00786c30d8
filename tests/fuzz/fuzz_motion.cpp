// Fuzzes the readers of hand motions; the format is told by the content.
#include <cmath>
#include <string_view>

#include "fuzz_input.h"
#include "lumbrical/motion.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  Motion motion;
  MotionOptions options;
  options.unit = 0.01;  // BVH doesn't say its own
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  if (!parse_motion(content, "fuzz.json", options, motion).ok()) return 0;
  if (motion.samples.empty()) __builtin_trap();
  for (const MotionSample& sample : motion.samples)
    if (!std::isfinite(sample.time)) __builtin_trap();
  return 0;
}
