// Walks the numbers of a struct, by the one list of its fields that stands in field_lists.h: hashes, traces,
// names, comparisons and exports are all made here.
//
//   constexpr void list_fields(Is<Wrench> auto& wrench, auto&& field) {
//     field("force", "N", wrench.force);  // name, unit, the field itself: a number, array or listed struct
//     field("torque", "N m", wrench.torque);
//   }
//
// A unit goes down to the numbers inside, unless they name their own. A field that may be absent follows one
// that says whether it is there: a list is read from front to back.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/hash.h"
#include "lumbrical/device.h"
#include "lumbrical/model.h"

namespace lumbrical {

template <class T, class Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;
template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept Array = requires(T& array) {
  array.size();
  array[0];
};

enum class NumberType : std::uint8_t { whole, kind, law, real, real32 };
constexpr bool is_real(NumberType type) { return type >= NumberType::real; }
template <Number T>
inline constexpr NumberType kNumberType = std::is_same_v<T, double>      ? NumberType::real
                                          : std::is_same_v<T, float>     ? NumberType::real32
                                          : std::is_same_v<T, InputKind> ? NumberType::kind
                                          : std::is_same_v<T, Law>       ? NumberType::law
                                                                         : NumberType::whole;

template <Number T>
constexpr std::uint64_t bits_of(T number) {
  if constexpr (std::is_same_v<T, double>) return std::bit_cast<std::uint64_t>(number);
  if constexpr (std::is_same_v<T, float>) return std::bit_cast<std::uint32_t>(number);
  if constexpr (!std::is_floating_point_v<T>) return static_cast<std::uint64_t>(number);
}

/// A number's name and unit, as links from the number outwards.
struct FieldName {
  const FieldName* outer = nullptr;
  const char* name = nullptr;  ///< null: an element of an array
  const char* unit = "";
  std::size_t index = 0;

  /// "joint[7].position[1]"
  [[nodiscard]] std::string text() const {
    if (outer == nullptr) return {};
    const std::string before = outer->text();
    if (name == nullptr) return before + '[' + std::to_string(index) + ']';
    return before.empty() ? name : before + '.' + name;
  }
};

/// visit(FieldName, number) for every number in `value`, in the order of its list.
template <class T, class Visit>
constexpr void walk(T& value, Visit&& visit, const FieldName& at = {}) {
  if constexpr (Number<std::remove_const_t<T>>) {
    visit(at, value);
  } else if constexpr (Array<T>) {
    for (std::size_t i = 0; i < value.size(); ++i) walk(value[i], visit, {&at, nullptr, at.unit, i});
  } else {
    list_fields(value, [&](const char* name, const char* unit, auto&& field) {
      walk(field, visit, {&at, name, *unit == 0 ? at.unit : unit});
    });
  }
}

template <class T>
constexpr std::size_t listed_bytes() {
  T value{};
  std::size_t bytes = 0;
  walk(value, [&bytes](const FieldName&, const auto& number) { bytes += sizeof(number); });
  return bytes;
}

/// The list leaves nothing out and there is no padding: numbers, arrays and structs like that are hashed as
/// they stand in memory.
template <class T>
inline constexpr bool kIsRow = listed_bytes<T>() == sizeof(T);

// The listed numbers of a struct, one behind the other. No list names more than the struct has room for.
template <class T>
void append_row(const T& value, unsigned char*& end) {
  if constexpr (kIsRow<T>) {
    std::memcpy(end, &value, sizeof(T));
    end += sizeof(T);
  } else if constexpr (Array<T>) {
    for (const auto& element : value) append_row(element, end);
  } else {
    list_fields(value, [&end](const char*, const char*, const auto& field) { append_row(field, end); });
  }
}

template <class T>
std::uint64_t hash_fields(const T& value) {
  Hasher hasher;
  if constexpr (kIsRow<T>) {
    hasher.bytes(&value, sizeof(T));
  } else {
    std::array<unsigned char, sizeof(T)> row;
    unsigned char* end = row.data();
    append_row(value, end);
    assert(end <= row.data() + row.size());
    hasher.bytes(row.data(), static_cast<std::size_t>(end - row.data()));
  }
  return hasher.digest();
}

template <class T>
requires kIsRow<T> std::uint64_t hash_rows(std::span<const T> rows) {
  Hasher hasher;
  hasher.array(rows);
  return hasher.digest();
}

// Structs that always have the same numbers:

template <class T>
constexpr std::size_t count_numbers() {
  T value{};
  std::size_t count = 0;
  walk(value, [&count](const FieldName&, const auto&) { ++count; });
  return count;
}
template <class T>
inline constexpr std::size_t kNumberCount = count_numbers<T>();

/// The bits of every number.
template <class T>
using Numbers = std::array<std::uint64_t, kNumberCount<T>>;
template <class T>
Numbers<T> numbers_of(const T& value) {
  Numbers<T> numbers;
  std::size_t next = 0;
  walk(value, [&](const FieldName&, auto number) { numbers[next++] = bits_of(number); });
  return numbers;
}

/// What each of them is.
struct NumberField {
  std::string name;
  std::string_view unit;
  NumberType type;
};
template <class T>
const std::vector<NumberField>& fields_of() {
  static const std::vector<NumberField> fields = [] {
    std::vector<NumberField> result;
    const T value{};
    walk(value, [&result]<class N>(const FieldName& at, const N&) {
      result.push_back({at.text(), at.unit, kNumberType<N>});
    });
    return result;
  }();
  return fields;
}

}  // namespace lumbrical
