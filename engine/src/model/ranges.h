// What the numbers of a scene may be: readers of files and checks of models go by this list.
#pragma once

#include <numbers>
#include <string>

namespace lumbrical {

/// NaN lies in none.
struct Range {
  double low, high;
  const char* unit = "";
  [[nodiscard]] constexpr bool holds(double value) const { return value >= low && value <= high; }
};

/// Fifteen digits at most: 100000 rather than 1e+05.
std::string text_of(double number);
/// "0 to 60 s"
std::string text_of(const Range& range);

// Larger coordinates square to infinity or leave no digits for a finger.
inline constexpr double kWorldReach = 1e8;  ///< [m]

namespace range {

inline constexpr Range rate{1, 100000, " Hz"}, stiffness{1e-3, 1e15, " N/m^3"}, point_area{1e-12, 1, " m^2"},
    precision{1e-6, 0.1},  // or exact; below, rounding in single precision would show
    max_force{0, 1e6, " N"}, fade_time{0, 60, " s"}, proxy_stiffness{10, 1e5, " N/m"},  // or none
    effort{0, 1e9}, max_candidates{1, 1 << 24};
inline constexpr Range layer_from{0.01, 0.99}, layer_stiffness{-1000, 1000}, pad_damping{0, 1000, " s/m"};
inline constexpr Range leaf_size{1, 64}, threads{1, 64}, cell_size{1e-3, 1e6, " m"}, tree_levels{0, 32},
    voxel_size{1e-9, 1e6, " m"}, voxel_memory{1e6, 1e12, " bytes"};
inline constexpr Range friction{0, 10}, viscosity{0, 100, " s/m"}, shear_stiffness{1, 1e6, " N/m"};
inline constexpr Range texture_period{1e-6, 10, " m"}, grip{0, 10}, bump{-1, 1, " m"},
    crease_angle{0, std::numbers::pi, " rad"};
inline constexpr Range hand_length{0.05, 0.5, " m"};
inline constexpr Range mass{1e-6, 1e6, " kg"}, damping{0, 1e6, " N s/m or N m s/rad"};
inline constexpr Range joint_lower{-1e3, 0, " m or rad"}, joint_upper{0, 1e3, " m or rad"},
    joint_spring{0, 1e9, " N/m or N m/rad"}, joint_rest{-1e3, 1e3, " m or rad"},
    joint_force{0, 1e6, " N or N m"}, detent_pitch{1e-6, 1e3, " m or rad"},
    latch_opens{1e-9, 1e3, " m or rad"};
inline constexpr Range place{-kWorldReach, kWorldReach, " m"};
// Of the lightest body 1 um wide, and of the heaviest as wide as the world: cubes of these are still numbers.
inline constexpr Range inertia{1e-18, 1e22, " kg m^2"};

}  // namespace range
}  // namespace lumbrical
