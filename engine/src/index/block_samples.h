// Blocks of patches as one (patches.h).
#pragma once

#include <span>

#include "index/patches.h"
#include "model/corners.h"

namespace lumbrical {

/// At least one patch, all with an area.
BlockSamples samples_of(std::span<const Corners> patches);

}  // namespace lumbrical
