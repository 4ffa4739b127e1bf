#pragma once
// Whether a sanitizer watches this build. Malloc belongs to it then, and what takes a moment
// takes seven times as long.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MJDIAG_SANITIZED 1
#else
#define MJDIAG_SANITIZED 0
#endif

namespace mjdiag::test {
inline constexpr bool kSanitized = MJDIAG_SANITIZED;
}
