// What build_model and a world's writer refuse.
#pragma once

#include <cstddef>
#include <string>

#include "lumbrical/model.h"
#include "model/ranges.h"

namespace lumbrical {

/// A scene has fewer triangles than this and at most as many vertices as the other; pairs that are in doubt
/// take one bit more (near_pairs.h).
inline constexpr std::size_t kTriangleLimit = std::size_t{1} << 31, kVertexLimit = 0xfffffffe;

Status check_pad(const Pad& pad);
Status check_settings(const Settings& settings);
Status check_execution(const Execution& execution);

/// Names the first vertex that is no place in the world, or the first triangle without its vertices.
Status check_object(const std::string& name, const Mesh& mesh, std::size_t threads);

/// For sums over all objects.
Status check_counts(std::size_t vertices, std::size_t triangles);

}  // namespace lumbrical
