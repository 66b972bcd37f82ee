// Memory for plans of tests.
#pragma once

#include <cstdint>

namespace cloudbow {

inline constexpr std::uint64_t memory = std::uint64_t{1} << 30;  // bytes

}  // namespace cloudbow
