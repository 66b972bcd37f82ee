// Exit codes of the program.
#pragma once

namespace cloudbow {

inline constexpr int exit_done = 0;
inline constexpr int exit_internal_error = 1;
inline constexpr int exit_input_error = 2;
inline constexpr int exit_not_converged = 3;
inline constexpr int exit_does_not_hold = 3;  ///< a check of `cloudbow verify` failed

}  // namespace cloudbow
