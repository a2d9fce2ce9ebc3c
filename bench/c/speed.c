/* Time per state of functions of a model, and what they compute; built by bench/c_programs.py.
 *
 *     speed STATES ROUNDS [RESULTS]
 *
 * STATES: six int64 (states, NQ, NV, NU, NC, prepared), then doubles: X, V, A, tau, and the
 * prepared parameters of code that takes them so.  Prints of every function the least time of a
 * state in nanoseconds over the rounds and how many states failed; functions take turns.  RESULTS
 * receives all results as doubles, in the order of what is printed.
 *
 * MODEL and UPPER name the model; LAMBDA: functions give multipliers.  CODE is the prefix of the
 * functions and HEADER their header; CASADI: they are CasADi's. */

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define FN(name) JOIN(CODE, name)
#define SIZE(name) JOIN(UPPER, name)
#include HEADER

enum { NQ = SIZE(NQ), NV = SIZE(NV), NU = SIZE(NU), NC = SIZE(NC) };
typedef JOIN(MODEL, real) real;

static size_t states;
static real *X, *V, *A, *tau, *prepared;  /* given */
static real *force, *multiplier, *acceleration, *M, *Z, *H;  /* found */

static real *array(size_t size)
{
    void *a = NULL;
    if (posix_memalign(&a, 64, (states*size + 8)*sizeof(real)) != 0) {
        exit(3);
    }
    return a;
}

#ifdef CASADI
static double *work;

static size_t inverse_dynamics(void)
{
    for (size_t k = 0; k < states; ++k) {
        const double *arg[] = {X + NQ*k, V + NV*k, A + NV*k, prepared, NULL, NULL};
        double *res[] = {force + NU*k, multiplier + NC*k, NULL, NULL, NULL, NULL};
        FN(inverse_dynamics)(arg, res, NULL, work, 0);
    }
    return 0;
}

static size_t dynamics(void)
{
    for (size_t k = 0; k < states; ++k) {
        const double *arg[] = {X + NQ*k, V + NV*k, prepared, NULL, NULL, NULL};
        double *res[] = {M + NV*NV*k, Z + NV*k, H + NV*NU*k, NULL, NULL, NULL};
        FN(dynamics)(arg, res, NULL, work, 0);
    }
    return 0;
}

static void prepare(void)
{
    work = array(1 << 16);
}
#else
static FN(model) model;

#if LAMBDA
#define FORCES(k) force + NU*(k), multiplier + NC*(k)
#define MOTION(k) acceleration + NV*(k), multiplier + NC*(k)
#else
#define FORCES(k) force + NU*(k)
#define MOTION(k) acceleration + NV*(k)
#endif

static size_t inverse_dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < states; ++k) {
        failed += FN(inverse_dynamics)(&model, X + NQ*k, V + NV*k, A + NV*k, NULL, FORCES(k)) != 0;
    }
    return failed;
}

static size_t inverse_dynamics_batch(void)
{
    return FN(inverse_dynamics_batch)(&model, states, X, V, A, NULL, FORCES(0), NULL);
}

static size_t dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < states; ++k) {
        failed += FN(dynamics)(&model, X + NQ*k, V + NV*k, M + NV*NV*k, Z + NV*k, H + NV*NU*k) != 0;
    }
    return failed;
}

static size_t dynamics_batch(void)
{
    return FN(dynamics_batch)(&model, states, X, V, M, Z, H, NULL);
}

#ifndef BY_HAND
static size_t forward_dynamics(void)
{
    size_t failed = 0;
    for (size_t k = 0; k < states; ++k) {
        failed += FN(forward_dynamics)(&model, X + NQ*k, V + NV*k, tau + NU*k, NULL, MOTION(k)) != 0;
    }
    return failed;
}

static size_t forward_dynamics_batch(void)
{
    return FN(forward_dynamics_batch)(&model, states, X, V, tau, NULL, MOTION(0), NULL);
}
#endif

static void prepare(void)
{
    if (FN(prepare)(&JOIN(MODEL, default_params), &model) != 0) {
        exit(4);
    }
}
#endif

static const struct {
    const char *name;
    size_t (*run)(void);
} functions[] = {
    {"inverse_dynamics", inverse_dynamics}, {"dynamics", dynamics},
#ifndef CASADI
    {"inverse_dynamics_batch", inverse_dynamics_batch}, {"dynamics_batch", dynamics_batch},
#ifndef BY_HAND
    {"forward_dynamics", forward_dynamics}, {"forward_dynamics_batch", forward_dynamics_batch},
#endif
#endif
};
enum { FUNCTIONS = sizeof functions/sizeof *functions };

static real *given(FILE *file, size_t count)
{
    real *a = array(count/(states ? states : 1) + 1);
    for (size_t k = 0; k < count; ++k) {
        double x;
        if (fread(&x, sizeof x, 1, file) != 1) {
            exit(5);
        }
        a[k] = (real)x;
    }
    return a;
}

static void read_states(const char *path)
{
    int64_t sizes[6];
    FILE *file = fopen(path, "rb");
    if (file == NULL || fread(sizes, sizeof sizes, 1, file) != 1) {
        exit(6);
    }
    states = (size_t)sizes[0];
    X = given(file, states*NQ);
    V = given(file, states*NV);
    A = given(file, states*NV);
    tau = given(file, states*NU);
    prepared = given(file, (size_t)sizes[5]);
    fclose(file);
    force = array(NU);
    multiplier = array(NC + 1);
    acceleration = array(NV);
    M = array(NV*NV);
    Z = array(NV);
    H = array(NV*NU);
}

static void write_array(FILE *file, const real *a, size_t size)
{
    for (size_t k = 0; k < states*size; ++k) {
        const double x = (double)a[k];
        fwrite(&x, sizeof x, 1, file);
    }
}

/* What the function at `f` has left; NaN before the next one runs. */
static void write_results(FILE *file, size_t f)
{
    const char kind = *functions[f].name;
    if (kind == 'i') {
        write_array(file, force, NU);
    } else if (kind == 'd') {
        write_array(file, M, NV*NV);
        write_array(file, Z, NV);
        write_array(file, H, NV*NU);
    } else {
        write_array(file, acceleration, NV);
    }
}

static void forget(real *a, size_t size)
{
    for (size_t k = 0; k < states*size; ++k) {
        a[k] = (real)NAN;
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9*(double)t.tv_sec + (double)t.tv_nsec;
}

int main(int count, char **arguments)
{
    size_t failed[FUNCTIONS];
    double best[FUNCTIONS];
    if (count < 3) {
        return 2;
    }
    read_states(arguments[1]);
    prepare();
    FILE *results = count > 3 ? fopen(arguments[3], "wb") : NULL;
    for (size_t f = 0; f < FUNCTIONS; ++f) {
        forget(force, NU);
        forget(M, NV*NV);
        forget(Z, NV);
        forget(H, NV*NU);
        forget(acceleration, NV);
        failed[f] = functions[f].run();
        best[f] = INFINITY;
        if (results != NULL) {
            write_results(results, f);
        }
    }
    if (results != NULL) {
        fclose(results);
    }
    for (int round = 0; round < atoi(arguments[2]); ++round) {
        for (size_t f = 0; f < FUNCTIONS; ++f) {
            const double start = now();
            failed[f] += functions[f].run();
            const double time = now() - start;
            best[f] = time < best[f] ? time : best[f];
        }
    }
    for (size_t f = 0; f < FUNCTIONS; ++f) {
        printf("%s %.2f %lu\n", functions[f].name, best[f]/(double)states, (unsigned long)failed[f]);
    }
    return 0;
}
