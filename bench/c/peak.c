/* This core's rate of multiplications and additions: a loop over registers that depend on nothing
 * else.  Prints operations per nanosecond: of vectors (WIDTH bytes) of doubles and of floats, of single doubles.
 * Where the processor has fused operations, compilers take them, and each counts as two. */

#include <stdio.h>
#include <time.h>

enum { REGISTERS = 12, TURNS = 200000, ROUNDS = 20 };

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9*(double)t.tv_sec + (double)t.tv_nsec;
}

/* All registers are kept; nothing is known of them. */
#define KEEP(a) __asm__ volatile("" : "+x"(a))

#define RATE(name, type, lanes) \
    static double name(void) \
    { \
        type a = (type){0} + 1, b = (type){0} + 1, r0 = a, r1 = a, r2 = a, r3 = a, r4 = a, r5 = a, \
             r6 = a, r7 = a, r8 = a, r9 = a, r10 = a, r11 = a; \
        double best = 1e300; \
        for (int round = 0; round < ROUNDS; ++round) { \
            const double start = now(); \
            for (int turn = 0; turn < TURNS; ++turn) { \
                r0 = r0*a + b; r1 = r1*a + b; r2 = r2*a + b; r3 = r3*a + b; r4 = r4*a + b; \
                r5 = r5*a + b; r6 = r6*a + b; r7 = r7*a + b; r8 = r8*a + b; r9 = r9*a + b; \
                r10 = r10*a + b; r11 = r11*a + b; \
                KEEP(r0); KEEP(r1); KEEP(r2); KEEP(r3); KEEP(r4); KEEP(r5); KEEP(r6); KEEP(r7); \
                KEEP(r8); KEEP(r9); KEEP(r10); KEEP(r11); \
            } \
            const double time = now() - start; \
            best = time < best ? time : best; \
        } \
        return 2.0*REGISTERS*TURNS*(lanes)/best; \
    }

/* Bytes of a vector register. */
#if defined __AVX512F__
#define WIDTH 64
#elif defined __AVX__
#define WIDTH 32
#else
#define WIDTH 16
#endif
typedef double doubles __attribute__((vector_size(WIDTH)));
typedef float floats __attribute__((vector_size(WIDTH)));
typedef double one;
RATE(of_doubles, doubles, WIDTH/8)
RATE(of_floats, floats, WIDTH/4)
RATE(of_one, one, 1)

int main(void)
{
    printf("double %.2f\nfloat %.2f\nscalar %.2f\n", of_doubles(), of_floats(), of_one());
    return 0;
}
