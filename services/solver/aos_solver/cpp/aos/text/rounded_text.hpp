// Bounds as short texts that are bounds as well. A lower bound is rounded down, and an upper bound is rounded up.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace aos {

// A text of four digits whose value is at most `number`.
inline std::string rounded_down(double number) {
  if (!std::isfinite(number) || number == 0) return std::to_string(number);
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(number))) - 3);
  char text[32];
  for (double shown = std::floor(number / unit) * unit;; shown -= unit) {
    std::snprintf(text, sizeof text, "%.4g", shown);
    if (std::strtod(text, nullptr) <= number) return text;
  }
}

// A text of four digits whose value is at least `number`.
inline std::string rounded_up(double number) {
  const std::string text = rounded_down(-number);
  return text.front() == '-' ? text.substr(1) : number == 0 || !std::isfinite(number) ? text : "-" + text;
}

}
