// Results and errors on their way to the first rank.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

void send_result(Ranks& ranks, std::span<const std::byte> result);

/// Sends the error that is being handled in place of a result. Interrupts are rethrown. To be called in a handler.
void send_error(Ranks& ranks);

/// @throws InputError, or std::runtime_error for other errors, if the rank has sent one.
std::vector<std::byte> receive_result(Ranks& ranks, int from);

}  // namespace cloudbow
