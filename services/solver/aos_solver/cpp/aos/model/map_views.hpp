// The views of a map's keys and values: those of std::views do not take a map of the state.
#pragma once

#include <ranges>

namespace aos {

inline constexpr auto keys = std::views::transform([](auto&& entry) -> const auto& { return entry.first; });
inline constexpr auto values = std::views::transform([](auto&& entry) -> auto& { return entry.second; });

}  // namespace aos
