// What a tick asks of an object's surface: the few triangles that are not felt as they are, and the means of
// its textures.
#pragma once

#include <array>
#include <vector>

#include "lumbrical/model.h"
#include "model/texture_means.h"

namespace lumbrical {

struct FeltSurface {
  /// Of the object's triangles those that something below says otherwise of, for the exact rung alone.
  Model part;
  std::vector<std::uint32_t> triangle;    ///< which they are, ascending; and of each:
  std::vector<std::array<Vec3, 3>> turn;  ///< normals at its corners minus its own
  std::vector<double> rub;                ///< factor of friction minus 1
  double least_rub = 0, most_rub = 0;     ///< of all, 0 included
  TextureMeans grip, bumps;
};

/// Fills all but `part`. A triangle whose middle lies less than 50 um below the round surface it stands for
/// is felt as it is: facets much finer than a finger cost nothing.
void feel_of(const Surface& surface, const Mesh& mesh, FeltSurface& felt);

}  // namespace lumbrical
