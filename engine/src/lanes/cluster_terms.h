// Clusters and a primitive as the kernels see them (cluster_kinds.h, cluster_forces.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace lumbrical {

/// The a-priori bounds, shared by search and sums. The third derivative of a distance d over a step h is at
/// most 2 / sqrt(3) |h|^3 / d^2, and a sixth of it is the rest of the Taylor form.
inline constexpr double kTaylorRest = 0.19246;
/// Of b, the most phi can differ from its value at the centre: where the finger's surface runs through the
/// cluster the ramp's half width is at least kLeastRamp b, and phi's positive part then differs from a linear
/// function by at most b / (4 kLeastRamp), or what is left beyond the ramp.
inline constexpr double kLeastRamp = 0.45, kRampRest = 0.55;
/// A cluster is at most this share of its distance from the axis wide.
inline constexpr double kWidest = 0.5;
/// Of R: what single precision takes away from the moments.
inline constexpr double kMomentRounding = 5e-7;

/// A primitive's field, seen from its larger end.
template <class T>
struct FieldShape {
  bool flat = false;                       ///< a slab of the palm: phi is the height below `face`
  T axis[3] = {0, 0, 1};                   ///< unit, from the larger end
  T length = 0, radius1 = 0, radius2 = 0;  ///< [m]
  T sine = 0, cosine = 1;                  ///< of the cone's half angle
  T jointed = 0;                           ///< 1 where there is a side, 0 for spheres
  T face[4] = {};                          ///< of a slab's skin: unit normal and height [m]
  T size = 0;                              ///< [m] R
};

/// What a primitive ends at: a plane, or a border that is a cone (JointBorder). Beyond it are the points p,
/// seen from the primitive's larger end, where
///   normal p - height + bow sqrt((x p - x0)^2 + (y p - y0)^2) > 0.
template <class T>
struct CutShape {
  T normal[3] = {}, height = 1;  ///< unit; [m]
  T x[4] = {}, y[4] = {};        ///< the vector, then [m] what is taken away
  T bow = 0;                     ///< 0 for a plane, 1 or -1
  T slope = 0;                   ///< length of the longer one of x and y
  T steep = 1;                   ///< the sum changes by no more than this per metre
};

/// What a search for clusters asks, in single precision.
struct ClusterQuery {
  static constexpr int kCutCapacity = 18;
  FieldShape<float> shape;
  float x = 0, y = 0, z = 0;  ///< [m] the larger end from the origin of the clusters' tree
  float slack = 0;            ///< [m] what rounding may move a centre by, generously
  float allowed = 0;          ///< [m] the tolerance times R
  float twist = 0;            ///< [m^2] most of phi times thickness: what a line of force can not carry
  int cut_count = 0;          ///< besides a slab's skin
  CutShape<float> cut[kCutCapacity];
  float margin[kCutCapacity];  ///< [m] so near a cut the space may be a neighbour's, or not
};

/// What a search found among some blocks of clusters; each array holds four numbers per block. Leaves may be
/// `split`: one contact, whose triangles are looked at one by one.
struct ClusterHits {
  bool leaves = false;  ///< the blocks are of leaves
  std::uint32_t *use = nullptr, *split = nullptr, *open = nullptr;
  std::size_t use_count = 0, split_count = 0, open_count = 0;
};

/// One leaf, whose triangles are looked at one by one; lengths from the primitive's larger end.
struct LeafTerms {
  static constexpr std::size_t kCapacity = 8;
  static constexpr int kCutCapacity = 4;  ///< cuts that may run through it
  FieldShape<double> shape;
  double centre[3] = {};  ///< [m] of the leaf
  // The field's second derivative there is - field_bend (1 - across across - side axis axis).
  double field_bend = 0, side = 0;  ///< [1/m]
  double across[3] = {};
  int cut_count = 0;
  const CutShape<double>* cut[kCutCapacity];
  double bend[kCutCapacity];  ///< [1/m] the second derivative of a cut's function is no larger in the leaf
  alignas(64) double corner[3][3][kCapacity];  ///< [m] from that
  // Out, by triangle.
  enum Row : std::size_t {
    force = 0,       // integral of phi n
    couple = 3,      // of h x phi n
    area = 6,        // of 1
    area_first = 7,  // of h
    highest = 10,    // [m] largest phi of the corners
    doubtful = 11,   // [m^2] that may lie on the other side of a curved cut
    surface = 12,    // area of the whole triangle
    row_count
  };
  alignas(64) double result[row_count][kCapacity];
};

/// Clusters of one primitive on their way to contacts. Structure of arrays; lengths from the larger end.
struct ClusterTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;
  FieldShape<double> shape;
  alignas(64) double centre[3][kCapacity], mean_normal[3][kCapacity], box[3][kCapacity];
  alignas(64) double radius[kCapacity], thickness[kCapacity], surface[kCapacity];
  alignas(64) double normal[3][kCapacity], first[3][3][kCapacity], second[6][3][kCapacity];
  // Out: as in Contact.
  alignas(64) double depth[kCapacity], area[kCapacity], volume[kCapacity], error[kCapacity];
  alignas(64) double acting[3][kCapacity], direction[3][kCapacity];
};

}  // namespace lumbrical
