// Whether the program was built with a sanitizer, whose runtime some calls do not suit.
#pragma once

namespace cloudbow {

#if defined(__SANITIZE_ADDRESS__)  // GCC
inline constexpr bool has_address_sanitizer = true;
#elif defined(__has_feature)  // Clang
inline constexpr bool has_address_sanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool has_address_sanitizer = false;
#endif

#if defined(__SANITIZE_THREAD__)
inline constexpr bool has_thread_sanitizer = true;
#elif defined(__has_feature)
inline constexpr bool has_thread_sanitizer = __has_feature(thread_sanitizer);
#else
inline constexpr bool has_thread_sanitizer = false;
#endif

}  // namespace cloudbow
