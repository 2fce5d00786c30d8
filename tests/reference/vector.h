// Vectors of any number type, for the reference alone.
#pragma once

#include <cmath>

namespace lumbrical::reference {

template <class T>
struct Vector {
  T x{}, y{}, z{};

  template <class Other>
  [[nodiscard]] Vector<Other> as() const {
    return {static_cast<Other>(x), static_cast<Other>(y), static_cast<Other>(z)};
  }
};

template <class T>
Vector<T> operator+(const Vector<T>& a, const Vector<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vector<T> operator*(const T& s, const Vector<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T norm(const Vector<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class T>
Vector<T> unit(const Vector<T>& a) {
  return (1 / norm(a)) * a;
}

}  // namespace lumbrical::reference
