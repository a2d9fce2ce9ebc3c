/* Hostile states for every public function of a generated C model, single and batch.
 *
 * Usage: program STATES SEED THREADS.  Prints a line for each function; what breaks a promise of
 * the header is told on stderr and makes the exit code 1.  Single and batch are compared too:
 * where they differ is counted, not judged.
 *
 * interface.inc is written from the model's header (tests/hostile/interface.py). */

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__has_feature)
#if __has_feature(memory_sanitizer)
#include <sanitizer/msan_interface.h>
#define UNINITIALISED(x, size) __msan_poison(x, size)
#endif
#endif
#ifndef UNINITIALISED
#define UNINITIALISED(x, size) ((void)0)
#endif

enum { ARRAYS = 8, MOST = 19, GUARD = 4, CODES = 5, THREADS = 16, EVERY = 64, TOGETHER = 8, ORDINARY = 6, KINDS = 12 };

#include "interface.inc"

static const model_type *standard;
static int faults;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_barrier_t round_begins;

typedef struct {
    unsigned long states, code[CODES], status_ordinary, status_hostile, value_ordinary, value_hostile;
    double worst;  /* relative difference of an ordinary state, single from batch */
} tally;

typedef struct {
    uint64_t random;
    unsigned long rounds;
    tally counts[FUNCTIONS];
    real *in[ARRAYS], *copy[ARRAYS], *out[ARRAYS], *one[ARRAYS];
    int ordinary[MOST];
    model_type odd;
} worker;

static uint64_t draw(worker *w)
{
    w->random ^= w->random << 13;
    w->random ^= w->random >> 7;
    w->random ^= w->random << 17;
    return w->random*0x2545F4914F6CDD1DULL;
}

static size_t below(worker *w, size_t n)
{
    return n ? (size_t)((draw(w) >> 33)%n) : 0;
}

/* Between -1 and 1. */
static real part(worker *w)
{
    return (real)((double)(draw(w) >> 11)/4503599627370496.0 - 1);
}

static real random_bits(worker *w)
{
    union { uint64_t bits[2]; real value; } u;
    u.bits[0] = draw(w);
    u.bits[1] = 0;
    return u.value;
}

static real special(worker *w)
{
    static const double values[] = {
        NAN, INFINITY, -INFINITY, 1e200, -1e200, 1e-300, -1e-300, 0, -0.0, DBL_MAX, -DBL_MAX, DBL_MIN,
        4.9e-324, 1e68, 1e100, -1e154, 1.4e154, 1e-154, 1e-161, 1e-200, 1e30, 1e-30, 1e16, 1e-16, 1, -1
    };
    return (real)values[below(w, sizeof values/sizeof *values)];
}

/* Fill an input of one state; returns whether its numbers are ordinary. */
static int fill(worker *w, const array *a, int tame, real *x)
{
    const size_t kind = below(w, tame ? ORDINARY : KINDS);
    const int near = a->home != NULL;
    const real reach = near ? (real)(kind < ORDINARY - 1 ? 0.05 : 1) : (real)3;
    for (size_t e = 0; e < a->size; ++e) {
        x[e] = (near ? a->home[e] : a->positive ? (real)3.5 : 0) + reach*part(w);
    }
    if (kind == 6 && a->size) {
        x[below(w, a->size)] = special(w);
    } else if (kind == 7 && near && a->quaternion < a->size) {
        const real sizes[] = {0, (real)1e-161, (real)1e-20, (real)1e20, (real)1e155, (real)1e200};
        const real size = sizes[below(w, 6)];
        for (size_t e = 0; e < 4; ++e) {
            x[a->quaternion + e] *= size;
        }
    } else if (kind >= 7) {
        const real scale = (real)pow(10, 300*(double)part(w));
        for (size_t e = 0; e < a->size; ++e) {
            x[e] = kind == 7 ? 0 : kind == 8 ? special(w) : kind == 9 ? random_bits(w)
                : kind == 10 ? x[e]*scale : x[e]*(real)pow(10, 20*(double)part(w));
        }
    }
    return kind < ORDINARY;
}

static real *guarded(real *x)
{
    return x + GUARD;
}

/* Guard words around an output of n states, uninitialised in between. */
static void lay(real *x, size_t size)
{
    memset(x, 0xA5, (size + 2*GUARD)*sizeof *x);
    UNINITIALISED(guarded(x), size*sizeof *x);
}

static int intact(const real *x, size_t size)
{
    const unsigned char *const before = (const unsigned char *)x;
    const unsigned char *const after = (const unsigned char *)(x + GUARD + size);
    int ok = 1;
    for (size_t b = 0; b < GUARD*sizeof *x; ++b) {
        ok &= before[b] == 0xA5 && after[b] == 0xA5;
    }
    return ok;
}

static void fault(const function *f, const char *what, int code)
{
    pthread_mutex_lock(&lock);
    if (++faults <= 10) {
        fprintf(stderr, "%s: %s (status %d)\n", f->name, what, code);
    }
    pthread_mutex_unlock(&lock);
}

/* NaN in every entry where the status is not OK, where it is finite numbers, or what has no end. */
static void judge_outputs(const function *f, real *const *out, size_t state, int code)
{
    if (code < 0 || code >= CODES) {
        fault(f, "no status code", code);
    }
    for (size_t a = 0; a < f->outputs; ++a) {
        const real *const x = out[a] + state*f->out[a].size;
        for (size_t e = 0; e < f->out[a].size; ++e) {
            if (code == 0 && !(x[e] - x[e] == 0) && !(f->endless && x[e] > 0)) {
                fault(f, "OK, but not finite", code);
            } else if (code != 0 && x[e] == x[e]) {
                fault(f, "impossible, but not NaN", code);
            }
        }
    }
}

static int call_one(worker *w, const function *f, const model_type *m, size_t state, unsigned none)
{
    const real *in[ARRAYS];
    real *out[ARRAYS];
    for (size_t a = 0; a < f->inputs; ++a) {
        in[a] = none >> a & 1 ? NULL : guarded(w->in[a]) + state*f->in[a].size;
    }
    for (size_t a = 0; a < f->outputs; ++a) {
        lay(w->one[a], f->out[a].size);
        out[a] = guarded(w->one[a]);
    }
    const int code = f->single(m, in, out);
    for (size_t a = 0; a < f->outputs; ++a) {
        if (!intact(w->one[a], f->out[a].size)) {
            fault(f, "single writes beyond its output", code);
        }
    }
    judge_outputs(f, out, 0, code);
    return code;
}

/* Put a state where the function's status changes on the way to a far pose, or just beside. */
static void approach_border(worker *w, const function *f, const model_type *m, size_t state)
{
    const array *const a = &f->in[0];
    real *const x = guarded(w->in[0]) + state*a->size;
    real low = 0, high = 1, way[64];
    if (!a->home || a->size > 64) {
        return;
    }
    for (size_t e = 0; e < a->size; ++e) {
        way[e] = 4*part(w);
    }
    for (int step = 0; step < 52; ++step) {
        const real middle = (low + high)/2;
        for (size_t e = 0; e < a->size; ++e) {
            x[e] = a->home[e] + middle*way[e];
        }
        *(call_one(w, f, m, state, 0) == 0 ? &low : &high) = middle;
    }
    low += (real)pow(10, -17 + 12*fabs((double)part(w)))*part(w);
    for (size_t e = 0; e < a->size; ++e) {
        x[e] = a->home[e] + low*way[e];
    }
}

static void prepare_states(worker *w, const function *f, const model_type *m, size_t n)
{
    int tame[MOST];
    for (size_t k = 0; k < n; ++k) {
        tame[k] = below(w, 3) == 0;
        w->ordinary[k] = m == standard;
    }
    for (size_t a = 0; a < f->inputs; ++a) {
        memset(w->in[a], 0xA5, (n*f->in[a].size + 2*GUARD)*sizeof(real));
        for (size_t k = 0; k < n; ++k) {
            w->ordinary[k] &= fill(w, &f->in[a], tame[k], guarded(w->in[a]) + k*f->in[a].size);
        }
    }
    if (below(w, EVERY) == 0) {
        const size_t state = below(w, n);
        approach_border(w, f, m, state);
    }
    for (size_t a = 0; a < f->inputs; ++a) {
        memcpy(w->copy[a], w->in[a], (n*f->in[a].size + 2*GUARD)*sizeof(real));
    }
}

/* Relative to the largest entry of the output. */
static double difference(const function *f, real *const *one, real *const *other, size_t state)
{
    double most = 0;
    for (size_t a = 0; a < f->outputs; ++a) {
        const real *const x = guarded(one[a]), *const y = guarded(other[a]) + state*f->out[a].size;
        double size = 0, gap = 0;
        for (size_t e = 0; e < f->out[a].size; ++e) {
            size = fmax(size, fabs((double)x[e]));
            gap = fmax(gap, fabs((double)x[e] - (double)y[e]));
        }
        most = fmax(most, gap > 0 ? gap/size : 0);
    }
    return most;
}

static void compare(worker *w, const function *f, size_t state, int single, int batch, tally *t)
{
    const int ordinary = w->ordinary[state];
    if (single != batch) {
        ++*(ordinary ? &t->status_ordinary : &t->status_hostile);
    } else if (single == 0) {
        const double gap = difference(f, w->one, w->out, state);
        t->worst = ordinary ? fmax(t->worst, gap) : t->worst;
        if (gap > (sizeof(real) == sizeof(float) ? 1e-3 : 1e-9)) {
            ++*(ordinary ? &t->value_ordinary : &t->value_hostile);
        }
    }
}

static void one_round(worker *w, size_t which, size_t n)
{
    const function *const f = &functions[which];
    const model_type *const m = below(w, 16) ? standard : &w->odd;
    const real *in[ARRAYS];
    real *out[ARRAYS];
    int status[MOST + 2];
    unsigned none = 0;
    size_t failed = 0;
    prepare_states(w, f, m, n);
    for (size_t a = 0; a < f->inputs; ++a) {
        none |= (unsigned)(f->in[a].optional && below(w, 4) == 0) << a;
        in[a] = none >> a & 1 ? NULL : guarded(w->in[a]);
    }
    for (size_t a = 0; a < f->outputs; ++a) {
        lay(w->out[a], n*f->out[a].size);
        out[a] = guarded(w->out[a]);
    }
    status[n] = status[n + 1] = -77;
    UNINITIALISED(status, n*sizeof *status);
    const size_t told = f->batch(m, n, in, out, status);
    for (size_t k = 0; k < n; ++k) {
        failed += status[k] != 0;
        judge_outputs(f, out, k, status[k]);
        const int code = call_one(w, f, m, k, none);
        ++w->counts[which].states;
        w->counts[which].code[code >= 0 && code < CODES ? code : 0] += 1;
        compare(w, f, k, code, status[k], &w->counts[which]);
    }
    if (told != failed || status[n] != -77) {
        fault(f, "count of failures or codes of the batch", (int)told);
    }
    for (size_t a = 0; a < f->outputs; ++a) {
        if (!intact(w->out[a], n*f->out[a].size)) {
            fault(f, "batch writes beyond its output", (int)told);
        }
    }
    for (size_t a = 0; a < f->inputs; ++a) {
        if (memcmp(w->copy[a], w->in[a], (n*f->in[a].size + 2*GUARD)*sizeof(real))) {
            fault(f, "an input was written", (int)told);
        }
    }
    if (below(w, EVERY) == 0 && f->batch(m, n, in, out, NULL) != told) {
        fault(f, "other failures without an array of codes", (int)told);
    }
}

/* Another model: parameters of which some are changed; NaN in all of it where they are refused. */
static void prepare_odd(worker *w)
{
    static const function self = {.name = "prepare"};
    params_type p = *default_params;
    real *const numbers = (real *)&p;
    const size_t size = sizeof p/sizeof *numbers, changes = below(w, 4);
    for (size_t c = 0; c < changes; ++c) {
        real *const x = &numbers[below(w, size)];
        *x = below(w, 2) ? special(w) : *x*(1 + part(w)/2);
    }
    UNINITIALISED(&w->odd, sizeof w->odd);
    const int code = prepare(&p, &w->odd);
    if (code != 0 && code != INVALID) {
        fault(&self, "neither OK nor INVALID", code);
    }
    for (size_t e = 0; e < sizeof w->odd/sizeof(real); ++e) {
        const real x = ((const real *)&w->odd)[e];
        if (code != 0 && x == x) {
            fault(&self, "refused, but not NaN", code);
        }
    }
}

/*
 * First all threads call each function in the same rounds, whatever else the machine does: a barrier
 * orders rounds, so that what two threads touch within one is a race for the sanitizer even if it
 * happens to run one of them after the other.  A free run of all could hide it: of a thread
 * that ended long ago the sanitizer may have forgotten where it was.
 */
static void *run(void *given)
{
    worker *const w = given;
    prepare_odd(w);
    for (unsigned long r = 0; r < TOGETHER*FUNCTIONS; ++r) {
        pthread_barrier_wait(&round_begins);
        one_round(w, r%FUNCTIONS, 1);
    }
    for (unsigned long done = 0, r = 0; done < w->rounds; ++r) {
        const size_t n = 1 + below(w, MOST);
        one_round(w, r%FUNCTIONS, n);
        done += n;
        if (r%EVERY == 0) {
            prepare_odd(w);
        }
    }
    return NULL;
}

static worker *begin(uint64_t seed, unsigned long states)
{
    worker *const w = calloc(1, sizeof *w);
    if (!w) {
        exit(3);
    }
    w->random = (seed + 1)*0x9E3779B97F4A7C15ULL;
    w->rounds = states;
    for (size_t a = 0; a < ARRAYS; ++a) {
        real **const places[] = {&w->in[a], &w->copy[a], &w->out[a], &w->one[a]};
        for (size_t k = 0; k < 4; ++k) {
            *places[k] = calloc(MOST*LARGEST + 2*GUARD, sizeof(real));
            if (!*places[k]) {
                exit(3);
            }
        }
    }
    return w;
}

static void print(worker *const *workers, size_t threads)
{
    for (size_t f = 0; f < FUNCTIONS; ++f) {
        tally sum = {0};
        for (size_t t = 0; t < threads; ++t) {
            const tally *const c = &workers[t]->counts[f];
            sum.states += c->states;
            for (size_t k = 0; k < CODES; ++k) {
                sum.code[k] += c->code[k];
            }
            sum.status_ordinary += c->status_ordinary;
            sum.status_hostile += c->status_hostile;
            sum.value_ordinary += c->value_ordinary;
            sum.value_hostile += c->value_hostile;
            sum.worst = fmax(sum.worst, c->worst);
        }
        printf("%s %lu", functions[f].name, sum.states);
        for (size_t k = 0; k < CODES; ++k) {
            printf(" %lu", sum.code[k]);
        }
        printf(" %lu %lu %lu %lu %.3g\n", sum.status_ordinary, sum.status_hostile,
            sum.value_ordinary, sum.value_hostile, sum.worst);
    }
}

int main(int count, char **arguments)
{
    static model_type model;
    model_type before;
    worker *workers[THREADS];
    pthread_t threads[THREADS];
    if (count != 4) {
        return 2;
    }
    const unsigned long states = strtoul(arguments[1], NULL, 10);
    const uint64_t seed = strtoull(arguments[2], NULL, 10);
    const size_t several = strtoul(arguments[3], NULL, 10);
    if (several < 1 || several > THREADS || prepare(default_params, &model) != 0) {
        return 2;
    }
    memcpy(&before, &model, sizeof model);
    standard = &model;
    find_home();
    if (pthread_barrier_init(&round_begins, NULL, (unsigned)several)) {
        return 3;
    }
    for (size_t t = 0; t < several; ++t) {
        workers[t] = begin(seed*THREADS + t, states/several);
        if (pthread_create(&threads[t], NULL, run, workers[t])) {
            return 3;
        }
    }
    for (size_t t = 0; t < several; ++t) {
        pthread_join(threads[t], NULL);
    }
    print(workers, several);
    if (memcmp(&before, &model, sizeof model)) {
        fprintf(stderr, "the model was written\n");
        ++faults;
    }
    return faults > 0;
}
