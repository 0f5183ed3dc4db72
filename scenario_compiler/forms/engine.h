/* What the translated engine is written with: Python's arithmetic, and failures that leave the entry they happened in.

   Define ENGINE_CHECKED for a build that also checks indices and overflows. AT and ITEM are the one way to an element
   of a column or of an array. */

#include <math.h>
#include <setjmp.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define COLD __attribute__((cold, noinline, noreturn))
#define SELDOM(condition) __builtin_expect(!!(condition), 0)

typedef struct {
    double *at;
    int64_t size;
} Reals;

typedef struct {
    int64_t *at;
    int64_t size;
} Ints;

/* What the interpreted form raises there; the numbers are those of compiled.FAILURES. */
enum { FAIL_DIVISION_BY_ZERO = 1, FAIL_DOMAIN, FAIL_OVERFLOW, FAIL_INDEX, FAIL_UNKNOWN_KIND };

/* Written where an entry fails; where names the function's Python file. */
typedef struct {
    int64_t kind;
    int64_t line;
    const char *file;
} Failure;

static _Thread_local jmp_buf *way_out;
static _Thread_local Failure *failed;

static COLD void fail(int64_t kind, const char *file, int64_t line)
{
    failed->kind = kind;
    failed->line = line;
    failed->file = file;
    longjmp(*way_out, 1);
}

#define PLACE_ARGUMENTS const char *file, int64_t line
#define HERE __FILE__, __LINE__

#ifdef ENGINE_CHECKED
static inline int64_t checked_index(int64_t index, int64_t size, PLACE_ARGUMENTS)
{
    if (SELDOM(index < -size || index >= size))
        fail(FAIL_INDEX, file, line);
    return index < 0 ? index + size : index;
}
#define AT(container, column, index) \
    ((container)->column[checked_index((index), (container)->column##_size, HERE)])
#define ITEM(array, index) ((array).at[checked_index((index), (array).size, HERE)])

static inline int64_t checked_add(int64_t a, int64_t b, PLACE_ARGUMENTS)
{
    int64_t sum;
    if (SELDOM(__builtin_add_overflow(a, b, &sum)))
        fail(FAIL_OVERFLOW, file, line);
    return sum;
}
static inline int64_t checked_subtract(int64_t a, int64_t b, PLACE_ARGUMENTS)
{
    int64_t difference;
    if (SELDOM(__builtin_sub_overflow(a, b, &difference)))
        fail(FAIL_OVERFLOW, file, line);
    return difference;
}
static inline int64_t checked_multiply(int64_t a, int64_t b, PLACE_ARGUMENTS)
{
    int64_t product;
    if (SELDOM(__builtin_mul_overflow(a, b, &product)))
        fail(FAIL_OVERFLOW, file, line);
    return product;
}
#define ADD(a, b) checked_add((a), (b), HERE)
#define SUBTRACT(a, b) checked_subtract((a), (b), HERE)
#define MULTIPLY(a, b) checked_multiply((a), (b), HERE)
#else
#define AT(container, column, index) ((container)->column[(index)])
#define ITEM(array, index) ((array).at[(index)])
#define ADD(a, b) ((a) + (b))
#define SUBTRACT(a, b) ((a) - (b))
#define MULTIPLY(a, b) ((a) * (b))
#endif

static inline double real_divide(double a, double b, PLACE_ARGUMENTS)
{
    if (SELDOM(b == 0.0))
        fail(FAIL_DIVISION_BY_ZERO, file, line);
    return a / b;
}

static inline int64_t int_floor_divide(int64_t a, int64_t b, PLACE_ARGUMENTS)
{
    if (SELDOM(b == 0))
        fail(FAIL_DIVISION_BY_ZERO, file, line);
    if (SELDOM(b == -1))
        return SUBTRACT(0, a);
    int64_t quotient = a / b;
    return (a % b != 0 && (a < 0) != (b < 0)) ? quotient - 1 : quotient;
}

/* Counters are not negative and fit into 32 bits, for which processors divide faster. */
static inline int64_t int_modulo(int64_t a, int64_t b, PLACE_ARGUMENTS)
{
    if (SELDOM(b == 0))
        fail(FAIL_DIVISION_BY_ZERO, file, line);
    if (((uint64_t)a | (uint64_t)b) >> 32 == 0)
        return (uint32_t)a % (uint32_t)b;
    if (SELDOM(b == -1))
        return 0;
    int64_t rest = a % b;
    return (rest != 0 && (rest < 0) != (b < 0)) ? rest + b : rest;
}

/* After CPython's float_rem: the sign of the divisor, and a zero that carries it. The remainder of a smaller number is
   the number itself, for which fmod need not be called; most are angles within one turn. */
static inline double real_modulo(double a, double b, PLACE_ARGUMENTS)
{
    if (SELDOM(b == 0.0))
        fail(FAIL_DIVISION_BY_ZERO, file, line);
    double rest = fabs(a) < fabs(b) ? a : fmod(a, b);
    if (rest == 0.0)
        return copysign(0.0, b);
    return (b < 0.0) != (rest < 0.0) ? rest + b : rest;
}

/* Python's min and max return the first of equal numbers, and the first one if either is NaN, as these instructions do.
   From C, gcc makes branches of them where the counts of typical sweeps are one-sided, and a step takes 1.05 of the
   time. */
#if defined(__x86_64__) && defined(__GNUC__)
static inline double real_min(double a, double b)
{
    __asm__("minsd %1, %0" : "+x"(b) : "xm"(a));
    return b;
}
static inline double real_max(double a, double b)
{
    __asm__("maxsd %1, %0" : "+x"(b) : "xm"(a));
    return b;
}
#else
static inline double real_min(double a, double b) { return b < a ? b : a; }
static inline double real_max(double a, double b) { return b > a ? b : a; }
#endif
static inline int64_t int_min(int64_t a, int64_t b) { return b < a ? b : a; }
static inline int64_t int_max(int64_t a, int64_t b) { return b > a ? b : a; }
static inline int64_t int_abs(int64_t a) { return a < 0 ? -a : a; }

/* 2 to the power of 63: no larger float has a whole number that fits. */
#define TOO_LARGE 9223372036854775808.0

static inline int64_t int_of(double value, PLACE_ARGUMENTS)
{
    if (SELDOM(!(value < TOO_LARGE && value >= -TOO_LARGE)))
        fail(FAIL_OVERFLOW, file, line);
    return (int64_t)value;
}

static inline double real_sqrt(double x, PLACE_ARGUMENTS)
{
    if (SELDOM(x < 0.0))
        fail(FAIL_DOMAIN, file, line);
    return sqrt(x);
}

static inline double real_log(double x, PLACE_ARGUMENTS)
{
    if (SELDOM(x <= 0.0))
        fail(FAIL_DOMAIN, file, line);
    return log(x);
}

/* sin, cos and tan have no value at infinity, acos and asin none beyond 1: NaN although the argument is not NaN. */
#define DEFINE_DOMAIN(function)                                                     \
    static inline double domain_of_##function(double x, PLACE_ARGUMENTS)            \
    {                                                                               \
        double result = function(x);                                                \
        if (SELDOM(result != result && x == x))                                     \
            fail(FAIL_DOMAIN, file, line);                                          \
        return result;                                                              \
    }
DEFINE_DOMAIN(sin)
DEFINE_DOMAIN(cos)
DEFINE_DOMAIN(tan)
DEFINE_DOMAIN(acos)
DEFINE_DOMAIN(asin)

/* exp, sinh and cosh leave the floats: infinity from a finite number. */
#define DEFINE_RANGE(function)                                                      \
    static inline double range_of_##function(double x, PLACE_ARGUMENTS)             \
    {                                                                               \
        double result = function(x);                                                \
        if (SELDOM(isinf(result) && !isinf(x)))                                     \
            fail(FAIL_OVERFLOW, file, line);                                        \
        return result;                                                              \
    }
DEFINE_RANGE(exp)
DEFINE_RANGE(sinh)
DEFINE_RANGE(cosh)

#define DIVIDE(a, b) real_divide((a), (b), HERE)
#define INT_FLOOR_DIVIDE(a, b) int_floor_divide((a), (b), HERE)
#define INT_MODULO(a, b) int_modulo((a), (b), HERE)
#define REAL_MODULO(a, b) real_modulo((a), (b), HERE)
#define INT(x) int_of((x), HERE)
#define FLOOR(x) int_of(floor(x), HERE)
#define CEIL(x) int_of(ceil(x), HERE)
#define IN_DOMAIN(function, x) domain_of_##function((x), HERE)
#define IN_RANGE(function, x) range_of_##function((x), HERE)
#define SQRT(x) real_sqrt((x), HERE)
#define LOG(x) real_log((x), HERE)
