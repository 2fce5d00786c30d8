// The rates of serial lines that the system has codes for.
#pragma once

#include <termios.h>

#include <cstdint>

namespace lumbrical {

struct LineRate {
  std::uint32_t baud;
  speed_t code;
};
inline constexpr LineRate kLineRates[] = {
    {1200, B1200},       {2400, B2400},       {4800, B4800},       {9600, B9600},       {19200, B19200},
    {38400, B38400},     {57600, B57600},     {115200, B115200},   {230400, B230400},   {460800, B460800},
    {500000, B500000},   {576000, B576000},   {921600, B921600},   {1000000, B1000000}, {1152000, B1152000},
    {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000},
    {4000000, B4000000}};

/// 0 where there is none; so for the other way round.
constexpr speed_t code_of(std::uint32_t baud) {
  for (const LineRate& rate : kLineRates)
    if (rate.baud == baud) return rate.code;
  return 0;
}
constexpr std::uint32_t baud_of(speed_t code) {
  for (const LineRate& rate : kLineRates)
    if (rate.code == code) return rate.baud;
  return 0;
}

}  // namespace lumbrical
