// What the standard library of Debian's emscripten (libc++ 13) lacks of C++20; included first in every file
// that is compiled for WebAssembly.
#pragma once

#if defined(__cplusplus) && defined(__EMSCRIPTEN__)
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <type_traits>

#if _LIBCPP_VERSION < 14000
namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

}  // namespace std
#endif

#if _LIBCPP_VERSION < 16000
namespace std {

template <class Array>
unique_ptr<Array> make_unique_for_overwrite(size_t count) {
  return unique_ptr<Array>(new remove_extent_t<Array>[count]);
}

}  // namespace std
#endif

#if _LIBCPP_VERSION < 20000
namespace std {

/// strtod rounds correctly too; what it takes beyond from_chars (space, a sign, hexadecimal) is refused here.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* digits = first != last && *first == '-' ? first + 1 : first;
  const bool hexadecimal = last - digits > 1 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
  const bool starts =
      digits != last && (*digits == '.' || (*digits >= '0' && *digits <= '9') || *digits == 'i' ||
                         *digits == 'I' || *digits == 'n' || *digits == 'N');
  if (!starts) return {first, errc::invalid_argument};
  const string text(first, hexadecimal ? digits + 1 : last);
  char* end = nullptr;
  const double result = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  value = result;
  return {first + (end - text.c_str()), errc()};
}

}  // namespace std
#endif
#endif
