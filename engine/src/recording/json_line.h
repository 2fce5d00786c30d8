// One line of JSON from numbers, texts and whatever has a list of its fields.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include "recording/record_fields.h"

namespace lumbrical {

/// Written front to back; texts must need no escape.
class JsonLine {
 public:
  JsonLine& open(std::string_view key, char bracket) {
    name(key);
    text_ += bracket;
    return *this;
  }
  JsonLine& close(char bracket) {
    text_ += bracket;
    return *this;
  }
  /// Numbers that JSON has not (infinities, NaNs) become strings.
  template <class Number>
  JsonLine& number(std::string_view key, Number value) {
    std::string text;
    if constexpr (std::is_integral_v<Number>)
      text = std::to_string(value);
    else
      text = exact_text(value);
    const bool in_json = text.find_first_of("in") == std::string::npos;  // of "inf" and "nan"
    return in_json ? raw(key, text) : string(key, text);
  }
  JsonLine& string(std::string_view key, std::string_view value) {
    return raw(key, '"' + std::string(value) + '"');
  }
  JsonLine& null(std::string_view key) { return raw(key, "null"); }
  /// Numbers, arrays and structs by the lists of their fields; vectors and rotations as arrays.
  template <class T>
  JsonLine& value(std::string_view key, const T& value) {
    if constexpr (std::is_same_v<T, InputKind>) {
      return string(key, kind_name(value));
    } else if constexpr (Number<T>) {
      return number(key, value);
    } else if constexpr (Array<T>) {
      open(key, '[');
      for (const auto& element : value) this->value("", element);
      return close(']');
    } else {
      constexpr bool kNamed = !std::is_same_v<T, Vec3> && !std::is_same_v<T, Quat>;
      open(key, kNamed ? '{' : '[');
      list_fields(value, [this](const char* name, const char*, const auto& field) {
        this->value(kNamed ? name : "", field);
      });
      return close(kNamed ? '}' : ']');
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  JsonLine& raw(std::string_view key, std::string_view value) {
    name(key);
    text_ += value;
    return *this;
  }
  void name(std::string_view key) {
    if (!text_.empty() && text_.back() != '{' && text_.back() != '[') text_ += ',';
    if (!key.empty()) text_ += '"' + std::string(key) + "\":";
  }

  std::string text_;
};

}  // namespace lumbrical
