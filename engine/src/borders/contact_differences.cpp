// A hand that moves as a whole takes its borders along: the same as a triangle that moves the other way, seen
// from the hand.
#include "borders/contact_differences.h"

#include "base/small_turn.h"
#include "base/vector6.h"
#include "base/wrench.h"
#include "borders/general_contact.h"

namespace lumbrical {
namespace {

// So far to either side, translations as a share of the radius. Quadrature leaves 1e-12 R^3 of a contact.
constexpr double kStep = 1e-5;

// What a contact may be off by as a share of R^3: a hundredth of R^2 in its differences.
constexpr double kMostError = 1e-2 * kStep;

// A wrench over K_s and what it may be off by [m^3].
struct MovedContact {
  Wrench wrench;
  double error = 0;
};

// Of the contact as it is when the hand has moved by `shift` and turned by a small angle about the joint.
MovedContact contact_of_moved(const ExactKernels& kernels, const Primitives& hand, Contact contact,
                              Vec3 joint, const Corners& at, Vec3 shift, Vec3 angle) {
  const Quat turn = normalized(small_rotation(angle));
  const auto seen = [&](Vec3 p) { return joint + rotate(conjugate(turn), p - joint - shift); };
  hand_contact(hand, kernels, 0, {seen(at.a), seen(at.b), seen(at.c)}, contact);
  if (!(contact.area > 0)) return {};
  const Vec3 force = contact.volume * contact.normal;
  return {{rotate(turn, force), rotate(turn, cross(contact.centre - joint, force))}, contact.error};
}

}  // namespace

bool add_contact_differences(const ExactKernels& kernels, const Primitives& hand, const Contact& contact,
                             Vec3 joint, const Corners& at, Matrix6& sum) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  const double radius = max(primitive.radius1, primitive.radius2);
  const double most_error = kMostError * radius * radius * radius;
  if (contact.error > most_error) return false;
  Matrix6 value{};
  for (std::size_t column = 0; column < 6; ++column) {
    const bool shifts = column < 3;
    const double step = shifts ? kStep * radius : kStep;
    const auto moved = [&](double by) {
      const Vec3 axis = along_axis(column % 3, by);
      return contact_of_moved(kernels, hand, contact, joint, at, shifts ? axis : Vec3{},
                              shifts ? Vec3{} : axis);
    };
    const MovedContact ahead = moved(step), behind = moved(-step);
    if (max(ahead.error, behind.error) > most_error) return false;
    const Vector6 change = vector_of((0.5 / step) * (ahead.wrench - behind.wrench));
    for (std::size_t row = 0; row < 6; ++row) value[row][column] = change[row];
  }
  add_matrix(value, sum);
  return true;
}

}  // namespace lumbrical
