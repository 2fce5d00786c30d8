// Values out of JSON that others wrote. What is missing or of another kind throws std::runtime_error with its
// place.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "output.h"

namespace lumbrical::tool {

inline std::string place(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

[[noreturn]] inline void refuse(const std::string& where, const char* key, const char* what) {
  throw std::runtime_error(where + (where.empty() ? "" : ".") + key + ": " + what);
}

/// The member `key` of the object at `where`.
inline const Json& member_at(const Json& object, const char* key, const std::string& where) {
  if (!object.is_object() || !object.contains(key)) refuse(where, key, "is missing");
  return object[key];
}

inline std::string text_at(const Json& object, const char* key, const std::string& where) {
  const Json& member = member_at(object, key, where);
  if (!member.is_string()) refuse(where, key, "is not a text");
  return member.get<std::string>();
}

/// From 0 to 1e100. What is below 1e-100 counts as 0: logarithmic axes stay within what a double can hold.
inline double amount_at(const Json& object, const char* key, const std::string& where) {
  const Json& member = member_at(object, key, where);
  const double value = member.is_number() ? member.get<double>() : -1;
  if (!(value >= 0 && value <= 1e100)) refuse(where, key, "is not a number from 0 to 1e100");
  return value < 1e-100 ? 0 : value;
}

/// From 1e-100 to 1e100.
inline double positive_at(const Json& object, const char* key, const std::string& where) {
  const double value = amount_at(object, key, where);
  if (value <= 0) refuse(where, key, "is not a positive number");
  return value;
}

inline const Json& array_at(const Json& object, const char* key) {
  const Json& member = member_at(object, key, "");
  if (!member.is_array()) refuse("", key, "is not a list");
  return member;
}

inline const Json& object_at(const Json& object, const char* key, const std::string& where) {
  const Json& member = member_at(object, key, where);
  if (!member.is_object()) refuse(where, key, "is not an object");
  return member;
}

/// "3.5e-12"; zero is "0".
inline std::string scientific(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value == 0 ? "0" : "%.1e", value);
  return text.data();
}

/// "1,234"; a count that no benchmark can have is cut to 1e15.
inline std::string count_text(double count) {
  return grouped(static_cast<std::uint64_t>(count < 1e15 ? count : 1e15));
}

}  // namespace lumbrical::tool
