#include "model/texture_means.h"

#include <array>
#include <cmath>

namespace lumbrical {
namespace {

// A box, and a tent, as wide as a paraboloid of radius 1 in the mean square: 1 - r^2 on a disc has 1/6.
constexpr double kHalfBox = 0.70710678118654757, kHalfTent = 1;

// The integral from the image's corner to a point of it, in texels and greys.
double integral_to(const TextureMeans& means, double x, double y) {
  const auto i = static_cast<std::size_t>(min(std::floor(x), static_cast<double>(means.width - 1)));
  const auto k = static_cast<std::size_t>(min(std::floor(y), static_cast<double>(means.height - 1)));
  const double a = x - static_cast<double>(i), b = y - static_cast<double>(k);
  const std::uint64_t* const row = &means.sum[k * (means.width + 1) + i];
  const std::uint64_t* const next = row + means.width + 1;
  const auto at = [](std::uint64_t sum) { return static_cast<double>(sum); };
  return (1 - b) * ((1 - a) * at(row[0]) + a * at(row[1])) + b * ((1 - a) * at(next[0]) + a * at(next[1]));
}

/// So many whole images and a part of one.
struct Wrapped {
  double whole, part;
};
Wrapped wrapped(double x, double size) {
  const double whole = std::floor(x / size);
  return {whole, clamp(x - whole * size, 0, size)};
}

// The same over the endless plane of images.
double endless_integral(const TextureMeans& means, double x, double y) {
  const double width = static_cast<double>(means.width), height = static_cast<double>(means.height);
  const Wrapped u = wrapped(x, width), v = wrapped(y, height);
  return u.whole * v.whole * integral_to(means, width, height) + u.whole * integral_to(means, width, v.part) +
         v.whole * integral_to(means, u.part, height) + integral_to(means, u.part, v.part);
}

/// What one of the three planes is to the others.
struct Plane {
  Vec3 across, up;  ///< O, along the image's columns and against its rows
  double share = 0;
};

std::array<Plane, 3> planes_of(Vec3 n) {
  return {Plane{{0, 1, 0}, {0, 0, 1}, n.x * n.x}, Plane{{1, 0, 0}, {0, 0, 1}, n.y * n.y},
          Plane{{1, 0, 0}, {0, 1, 0}, n.z * n.z}};
}

}  // namespace

TextureMeans texture_means(const Texture& texture) {
  const GreyImage& image = texture.image;
  TextureMeans means;
  if (is_plain(texture)) return means;
  means.width = image.width;
  means.height = image.height;
  means.texel = texture.period / image.width;
  means.black = texture.black;
  means.step = (texture.white - texture.black) / 65535;
  const std::size_t row = means.width + 1;
  means.sum.resize(row * (means.height + 1));
  for (std::size_t k = 0; k < means.height; ++k) {
    const std::uint16_t* const grey = &image.grey[(means.height - 1 - k) * means.width];
    std::uint64_t of_row = 0;
    for (std::size_t i = 0; i < means.width; ++i) {
      of_row += grey[i];
      means.sum[(k + 1) * row + i + 1] = means.sum[k * row + i + 1] + of_row;
    }
  }
  return means;
}

double mean_over(const TextureMeans& means, double u, double v, double half_u, double half_v) {
  const double wide = 2 * half_u / means.texel, high = 2 * half_v / means.texel;
  const double x = wrapped((u - half_u) / means.texel, static_cast<double>(means.width)).part,
               y = wrapped((v - half_v) / means.texel, static_cast<double>(means.height)).part;
  const auto to = [&](double along, double above) { return endless_integral(means, along, above); };
  const double sum = (to(x + wide, y + high) - to(x, y + high)) - (to(x + wide, y) - to(x, y));
  return means.black + means.step * (sum / (wide * high));
}

double value_under(const TextureMeans& means, Vec3 point, Vec3 normal, double radius) {
  const double half = kHalfBox * radius;
  double value = 0;
  for (const auto& [across, up, share] : planes_of(normal)) {
    if (share > 0) value += share * mean_over(means, dot(across, point), dot(up, point), half, half);
  }
  return value;
}

Vec3 slope_under(const TextureMeans& means, Vec3 point, Vec3 normal, double radius) {
  const double box = kHalfBox * radius, tent = 0.5 * kHalfTent * radius;
  Vec3 slope;
  for (const auto& [across, up, share] : planes_of(normal)) {
    if (!(share > 0)) continue;
    const double u = dot(across, point), v = dot(up, point);
    const double along = mean_over(means, u + tent, v, tent, box) - mean_over(means, u - tent, v, tent, box);
    const double above = mean_over(means, u, v + tent, box, tent) - mean_over(means, u, v - tent, box, tent);
    slope += (share / (2 * tent)) * (along * across + above * up);
  }
  return slope - dot(normal, slope) * normal;
}

}  // namespace lumbrical
