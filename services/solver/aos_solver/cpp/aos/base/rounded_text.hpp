// Bounds as short texts that are bounds as well: a lower one is rounded down, an upper one up.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace aos {

// At most `number`, with four digits.
inline std::string rounded_down(double number) {
  if (!std::isfinite(number) || number == 0) return std::to_string(number);
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(number))) - 3);
  char text[32];
  for (double shown = std::floor(number / unit) * unit;; shown -= unit) {
    std::snprintf(text, sizeof text, "%.4g", shown);
    if (std::strtod(text, nullptr) <= number) return text;
  }
}

// At least `number`.
inline std::string rounded_up(double number) {
  const std::string text = rounded_down(-number);
  return text.front() == '-' ? text.substr(1) : number == 0 || !std::isfinite(number) ? text : "-" + text;
}

}  // namespace aos
