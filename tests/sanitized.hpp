// What a sanitizer leaves no sense to: it has the memory, and most of the time, for itself.
#pragma once
#include <gtest/gtest.h>

namespace rt {

#ifdef RT_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#ifdef __has_feature // clang, which sanitized builds need
inline constexpr bool kThreadSanitized = __has_feature(thread_sanitizer);
#else
inline constexpr bool kThreadSanitized = false;
#endif

} // namespace rt

/// Skips the test in a sanitized build; `reason` is a clause.
#define RT_NOT_SANITIZED(reason)                                                                   \
    if (rt::kSanitized) GTEST_SKIP() << "under a sanitizer: " << reason
