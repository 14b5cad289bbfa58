/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The same text is C and C++. What C lets go without a cast passes through any_pointer(); numbers have the types that C
 * gives them, where <math.h> of C++ has others; attributes and keywords that C++ lacks have other names.
 */
#ifdef __cplusplus
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wc++11-narrowing"
#pragma clang diagnostic ignored "-Wc99-designator"
#else
#pragma GCC diagnostic ignored "-Wnarrowing"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wuninitialized" /* gcc 12 finds it in its own <immintrin.h> */
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#if __cplusplus > 201703L
#pragma GCC diagnostic ignored "-Wdeprecated-enum-enum-conversion"
#pragma GCC diagnostic ignored "-Wdeprecated-enum-float-conversion"
#endif
#endif
namespace
{
struct pointer_to_any {
    const volatile void *at;
    pointer_to_any(const volatile void *to) : at(to) {}
    template <class item> operator item *() const { return (item *)at; }
    explicit operator bool() const { return at; }
};
}
#define any_type(type) pointer_to_any
#define any_pointer(pointer) pointer_to_any(pointer)
#define restrict __restrict
#define malloc(bytes) pointer_to_any(malloc(bytes))
#define calloc(count, bytes) pointer_to_any(calloc(count, bytes))
#define realloc(block, bytes) pointer_to_any(realloc(block, bytes))
#define memchr(bytes, byte, count) pointer_to_any(memchr(bytes, byte, count))
#define bsearch(key, items, count, bytes, compare) pointer_to_any(bsearch(key, items, count, bytes, compare))
#define sqrt(x) __builtin_sqrt(x)
#define fabs(x) __builtin_fabs(x)
#define floor(x) __builtin_floor(x)
#define ceil(x) __builtin_ceil(x)
#define round(x) __builtin_round(x)
#define fmax(x, y) __builtin_fmax(x, y)
#define exp(x) __builtin_exp(x)
#define sin(x) __builtin_sin(x)
#define cos(x) __builtin_cos(x)
#define asin(x) __builtin_asin(x)
#define ldexp(x, power) __builtin_ldexp(x, power)
#define frexp(x, power) __builtin_frexp(x, power)
#else
#define any_type(type) type
#define any_pointer(pointer) (pointer)
#endif
