// Points and directions of wide numbers, for kernels.
#pragma once

#include "simd/wide_functions.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
struct Wide2 {
  V x, y;
};
template <class V>
inline Wide2<V> operator+(Wide2<V> p, Wide2<V> q) {
  return {p.x + q.x, p.y + q.y};
}
template <class V>
inline Wide2<V> operator-(Wide2<V> p, Wide2<V> q) {
  return {p.x - q.x, p.y - q.y};
}
template <class V>
inline Wide2<V> operator*(V s, Wide2<V> p) {
  return {s * p.x, s * p.y};
}
template <class V>
inline V dot(Wide2<V> p, Wide2<V> q) {
  return p.x * q.x + p.y * q.y;
}
template <class V>
inline V cross(Wide2<V> p, Wide2<V> q) {
  return p.x * q.y - p.y * q.x;
}
template <class V, class M>
inline Wide2<V> select(M which, Wide2<V> yes, Wide2<V> no) {
  return {select(which, yes.x, no.x), select(which, yes.y, no.y)};
}

template <class V>
struct Wide3 {
  V x, y, z;
};
template <class V>
inline Wide3<V> operator+(Wide3<V> p, Wide3<V> q) {
  return {p.x + q.x, p.y + q.y, p.z + q.z};
}
template <class V>
inline Wide3<V> operator-(Wide3<V> p, Wide3<V> q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}
template <class V>
inline Wide3<V> operator*(V s, Wide3<V> p) {
  return {s * p.x, s * p.y, s * p.z};
}
template <class V>
inline V dot(Wide3<V> p, Wide3<V> q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
template <class V>
inline Wide3<V> cross(Wide3<V> p, Wide3<V> q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
template <class V, class M>
inline Wide3<V> select(M which, Wide3<V> yes, Wide3<V> no) {
  return {select(which, yes.x, no.x), select(which, yes.y, no.y), select(which, yes.z, no.z)};
}

// A structure of arrays' vectors, from number i on.
template <class V, std::size_t N>
inline Wide3<V> vector_at(const NumberOf<V> (&from)[3][N], std::size_t i) {
  return {get(from[0] + i, V{}), get(from[1] + i, V{}), get(from[2] + i, V{})};
}
template <class V, std::size_t N>
inline void put_vector(Wide3<V> v, std::size_t i, NumberOf<V> (&to)[3][N]) {
  put(to[0] + i, v.x);
  put(to[1] + i, v.y);
  put(to[2] + i, v.z);
}

// A vector in memory, the same in all lanes.
template <class V>
inline Wide3<V> in_all_lanes(const NumberOf<V>* vector) {
  return {V(vector[0]), V(vector[1]), V(vector[2])};
}

// 1 / value, or 1 where it is not positive. (xsimd has a `reciprocal` of its own, an estimate, which an
// unqualified call would find.)
template <class V>
inline V one_over(V value) {
  const V one = number<V>(1);
  return divide(one, select(value > number<V>(0), value, one));
}

}  // namespace lumbrical::LUMBRICAL_ISA
