// Files of a surface's feel: grey images, and numbers by triangle.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/status.h"
#include "lumbrical/surface.h"

namespace lumbrical {

/// Reads a PGM image, plain (P2) or raw (P5), of 1 .. 65535 as its brightest grey and of at most kMostTexels;
/// of several in a file the first. At most 16 MiB. On error `image` is unchanged and the message starts with
/// "path:line:column:", or with "path:" alone where the fault has no place in the text.
Status load_grey_image(const std::string& path, GreyImage& image);

/// The same of a file already in memory; `name` stands in for its path in messages.
Status parse_grey_image(std::string_view content, const std::string& name, GreyImage& image);

/// Reads numbers of 0 .. 10 with blanks or line ends between them; '#' hides the rest of a line. At most
/// 16 MiB and kMostTexels of them. Errors as above.
Status load_friction_factors(const std::string& path, std::vector<double>& factors);
Status parse_friction_factors(std::string_view content, const std::string& name,
                              std::vector<double>& factors);

}  // namespace lumbrical
