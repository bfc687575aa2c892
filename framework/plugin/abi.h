// SPDX-License-Identifier: Apache-2.0
// The ABI tag: everything that must be equal for host and plugin to share C++ types.
#pragma once

#include <Eigen/Core>

#define LAPWING_ABI_NUMBER 4  // raised whenever a public header changes layout or meaning

#define LAPWING_TEXT_(x) #x
#define LAPWING_TEXT(x) LAPWING_TEXT_(x)

#if defined(NDEBUG)
#define LAPWING_ABI_ASSERTIONS "ndebug"
#else
#define LAPWING_ABI_ASSERTIONS "assertions"
#endif
#if defined(_GLIBCXX_ASSERTIONS)
#define LAPWING_ABI_GLIBCXX "glibcxx-assertions"
#else
#define LAPWING_ABI_GLIBCXX "glibcxx-plain"
#endif
#if defined(__SANITIZE_ADDRESS__)
#define LAPWING_ABI_SANITIZER "address"
#elif defined(__SANITIZE_THREAD__)
#define LAPWING_ABI_SANITIZER "thread"
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LAPWING_ABI_SANITIZER "address"
#elif __has_feature(thread_sanitizer)
#define LAPWING_ABI_SANITIZER "thread"
#else
#define LAPWING_ABI_SANITIZER "none"
#endif
#else
#define LAPWING_ABI_SANITIZER "none"
#endif
#if defined(__clang__)
#define LAPWING_ABI_COMPILER "clang " LAPWING_TEXT(__clang_major__)
#else
#define LAPWING_ABI_COMPILER "gcc " LAPWING_TEXT(__GNUC__)
#endif

namespace lapwing {

inline constexpr const char* kAbiTag =
    "lapwing " LAPWING_TEXT(LAPWING_ABI_NUMBER) "; " LAPWING_ABI_COMPILER
    "; cxx-abi " LAPWING_TEXT(__GXX_ABI_VERSION) " string " LAPWING_TEXT(_GLIBCXX_USE_CXX11_ABI)
    "; eigen " LAPWING_TEXT(EIGEN_WORLD_VERSION) "." LAPWING_TEXT(EIGEN_MAJOR_VERSION) "."
    LAPWING_TEXT(EIGEN_MINOR_VERSION) " align " LAPWING_TEXT(EIGEN_MAX_ALIGN_BYTES)
    "; " LAPWING_ABI_ASSERTIONS "; " LAPWING_ABI_GLIBCXX "; sanitizer " LAPWING_ABI_SANITIZER;

}  // namespace lapwing
