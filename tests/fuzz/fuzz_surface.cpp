// Fuzzes the files of a surface feel: grey images (PGM) and friction factors. What is taken is within range.
#include <string_view>

#include "fuzz_input.h"
#include "lumbrical/surface_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  GreyImage image;
  if (parse_grey_image(content, "fuzz.pgm", image).ok() &&
      (image.grey.empty() || image.grey.size() != std::size_t{image.width} * image.height ||
       image.grey.size() > kMostTexels))
    __builtin_trap();
  std::vector<double> factors;
  if (!parse_friction_factors(content, "fuzz.txt", factors).ok()) return 0;
  for (const double factor : factors)
    if (!(factor >= 0 && factor <= 10)) __builtin_trap();
  return 0;
}
