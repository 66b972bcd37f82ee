// Exit codes of the program.
#pragma once

namespace cloudbow {

inline constexpr int kExitDone = 0;
inline constexpr int kExitInternalError = 1;
inline constexpr int kExitInputError = 2;
inline constexpr int kExitNotConverged = 3;
inline constexpr int kExitDoesNotHold = 3;  ///< a check of `cloudbow verify` failed

}  // namespace cloudbow
