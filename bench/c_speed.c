/* Time of the generated C per state; built by c_speed.py with MODEL, UPPER, LAMBDA, ITERATED defined.
 *
 * Arguments: number of rounds (the best counts), and optionally the one function to run once
 * over all states, for counting instructions. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define FN(name) JOIN(MODEL, name)
#define SIZE(name) JOIN(UPPER, name)
#define TEXT_(x) #x
#define TEXT(x) TEXT_(x.h)
#include TEXT(MODEL)

enum { STATES = 1024, NQ = SIZE(NQ), NV = SIZE(NV), NU = SIZE(NU), NC = SIZE(NC) };
typedef FN(real) real;

static real X[STATES][NQ], V[STATES][NV], A[STATES][NV], tau[STATES][NU], lambda[STATES][NC + 1];
static real M[STATES][NV*NV], Z[STATES][NV], H[STATES][NV*NU];
static FN(model) model;

#if LAMBDA
#define FORCES(k) tau[k], lambda[k]
#define MOTION(k) A[k], lambda[k]
#else
#define FORCES(k) tau[k]
#define MOTION(k) A[k]
#endif

#if ITERATED
#define POSE(k) X[k], NULL  /* displacements iterated from home */
#else
#define POSE(k) X[k]
#endif

static size_t inverse_dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < STATES; ++k) {
        failed += FN(inverse_dynamics)(&model, POSE(k), V[k], A[k], NULL, FORCES(k)) != 0;
    }
    return failed;
}

static size_t inverse_dynamics_batch(void)
{
    return FN(inverse_dynamics_batch)(&model, STATES, POSE(0), V[0], A[0], NULL, FORCES(0), NULL);
}

static size_t dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < STATES; ++k) {
        failed += FN(dynamics)(&model, POSE(k), V[k], M[k], Z[k], H[k]) != 0;
    }
    return failed;
}

static size_t dynamics_batch(void)
{
    return FN(dynamics_batch)(&model, STATES, POSE(0), V[0], M[0], Z[0], H[0], NULL);
}

static size_t forward_dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < STATES; ++k) {
        failed += FN(forward_dynamics)(&model, POSE(k), V[k], tau[k], NULL, MOTION(k)) != 0;
    }
    return failed;
}

static size_t forward_dynamics_batch(void)
{
    return FN(forward_dynamics_batch)(&model, STATES, POSE(0), V[0], tau[0], NULL, MOTION(0), NULL);
}

static const struct {
    const char *name;
    size_t (*run)(void);
} functions[] = {
    {"inverse_dynamics", inverse_dynamics}, {"inverse_dynamics_batch", inverse_dynamics_batch},
    {"dynamics", dynamics}, {"dynamics_batch", dynamics_batch},
    {"forward_dynamics", forward_dynamics}, {"forward_dynamics_batch", forward_dynamics_batch},
};

/* A random number between -1 and 1, the same in every run. */
static real random_number(void)
{
    static unsigned long state = 1;
    state = (1103515245UL*state + 12345UL) & 0x7fffffffUL;
    return (real)state/(real)0x40000000UL - 1;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9*(double)t.tv_sec + (double)t.tv_nsec;
}

int main(int count, char **arguments)
{
    const int rounds = count > 1 ? atoi(arguments[1]) : 200;
    FN(prepare)(&FN(default_params), &model);
    for (size_t k = 0; k < STATES; ++k) {
        for (size_t i = 0; i < NQ; ++i) {
            X[k][i] = FN(HOME_X)[i] + (real)0.02*random_number();
        }
        for (size_t i = 0; i < NV; ++i) {
            V[k][i] = random_number();
            A[k][i] = 5*random_number();
        }
    }
    for (size_t f = 0; f < sizeof functions/sizeof *functions; ++f) {
        double best = 1e30;
        size_t failed = 0;
        if (count > 2 && strcmp(arguments[2], functions[f].name) != 0) {
            continue;
        }
        for (int round = 0; round < rounds; ++round) {
            const double start = now();
            failed = functions[f].run();
            const double time = now() - start;
            best = time < best ? time : best;
        }
        printf("%s %.1f ns, %lu of %d states failed\n", functions[f].name, best/STATES,
            (unsigned long)failed, STATES);
    }
    return 0;
}
