// Values that files, options and messages know by names: tables of them, and looks into these both ways.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace lumbrical {

template <class T>
struct Named {
  std::string_view name;
  T value;
};

template <class T, std::size_t N>
std::optional<T> value_named(const Named<T> (&all)[N], std::string_view text) {
  for (const Named<T>& one : all) {
    if (one.name == text) return one.value;
  }
  return std::nullopt;
}

template <class T, std::size_t N>
std::string_view name_valued(const Named<T> (&all)[N], T wanted) {
  for (const Named<T>& one : all) {
    if (one.value == wanted) return one.name;
  }
  return "unknown";
}

}  // namespace lumbrical
