/* The general 6-UPS platform as one writes it by hand, for speed: Newton's and Euler's equations of
 * a leg in the axes of its cylinder (s along the leg, y the cross's second axis, n across both),
 * where the angular velocity of a leg whose platform joint moves with u is
 *
 *     omega = (t u_y, -u_z, u_y)/L,   t = (s . k)/(n . k),   k the first axis of the cross.
 *
 * All arithmetic is on vectors (of GCC and clang).  For one state their lanes are legs; in batches
 * they are states, and a loop runs over the legs.  The solution of H tau = f is not pivoted. */

#include "hand_stewart.h"

#include <math.h>
#include <string.h>

typedef stewart_real real;
typedef hand_vec vec;
typedef struct { vec x, y, z; } vec3;

enum { LANES = HAND_LANES, LEGS = HAND_LEGS };

static inline vec all(real a) { return a - (vec){0}; }

static inline vec3 of(const vec *a) { return (vec3){a[0], a[1], a[2]}; }

static inline vec dot(vec3 a, vec3 b) { return a.x*b.x + a.y*b.y + a.z*b.z; }

static inline vec3 plus(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }

static inline vec3 minus(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }

static inline vec3 times(vec a, vec3 b) { return (vec3){a*b.x, a*b.y, a*b.z}; }

static inline vec3 cross(vec3 a, vec3 b)
{
    return (vec3){a.y*b.z - a.z*b.y, a.z*b.x - a.x*b.z, a.x*b.y - a.y*b.x};
}

static inline vec root(vec a)
{
    for (int k = 0; k < LANES; ++k) {
        a[k] = sizeof(real) == sizeof(float) ? (real)sqrtf((float)a[k]) : (real)sqrt((double)a[k]);
    }
    return a;
}

/* A symmetric matrix (xx xy xz yy yz zz) times a vector. */
static inline vec3 apply(const vec *J, vec3 a)
{
    return (vec3){J[0]*a.x + J[1]*a.y + J[2]*a.z, J[1]*a.x + J[3]*a.y + J[4]*a.z,
                  J[2]*a.x + J[4]*a.y + J[5]*a.z};
}

/* E Q E^T, where Q is symmetric and E has the columns s, y, n. */
static inline void turned(const vec *Q, vec3 s, vec3 y, vec3 n, vec *turned_Q)
{
    const vec3 a = plus(times(Q[0], s), plus(times(Q[1], y), times(Q[2], n)));
    const vec3 b = plus(times(Q[1], s), plus(times(Q[3], y), times(Q[4], n)));
    const vec3 c = plus(times(Q[2], s), plus(times(Q[4], y), times(Q[5], n)));
    turned_Q[0] = a.x*s.x + b.x*y.x + c.x*n.x;
    turned_Q[1] = a.x*s.y + b.x*y.y + c.x*n.y;
    turned_Q[2] = a.x*s.z + b.x*y.z + c.x*n.z;
    turned_Q[3] = a.y*s.y + b.y*y.y + c.y*n.y;
    turned_Q[4] = a.y*s.z + b.y*y.z + c.y*n.z;
    turned_Q[5] = a.z*s.z + b.z*y.z + c.z*n.z;
}

/* ---- a state ---- */

typedef struct {
    vec3 p, column_x, column_y, column_z, v, w, a, alpha;
} state;

static inline vec3 on_platform(const state *at, vec3 b)
{
    return plus(times(b.x, at->column_x), plus(times(b.y, at->column_y), times(b.z, at->column_z)));
}

static inline void orient(state *at, vec x, vec y, vec z, vec w)
{
    const vec two = 2/(x*x + y*y + z*z + w*w);
    const vec xs = two*x, ys = two*y, zs = two*z;
    at->column_x = (vec3){1 - ys*y - zs*z, xs*y + zs*w, xs*z - ys*w};
    at->column_y = (vec3){xs*y - zs*w, 1 - xs*x - zs*z, ys*z + xs*w};
    at->column_z = (vec3){xs*z + ys*w, ys*z - xs*w, 1 - xs*x - ys*y};
}

/* The legs: what they ask of the platform at their joints when these have the acceleration c. */
typedef struct {
    vec3 s, y, n, r;  /* axes of the leg; platform point from the platform's origin */
    vec over_L, t;
    vec3 force;
} leg;

static inline leg leg_at(const hand_leg *l, const state *at, vec3 gravity, vec3 c_extra)
{
    leg it;
    it.r = on_platform(at, of(l->point));
    const vec3 d = minus(plus(at->p, it.r), of(l->base)), k = of(l->first_axis);
    const vec3 across = cross(k, d);  /* both roots at once: neither waits for the other */
    const vec length = root(dot(d, d)), width = root(dot(across, across));
    const vec over_width = 1/width;
    it.over_L = 1/length;
    it.s = times(it.over_L, d);
    it.y = times(over_width, across);
    it.n = cross(it.s, it.y);
    const vec sine = dot(it.s, k), cosine = width*it.over_L, over_cosine = length*over_width;
    it.t = sine*over_cosine;

    const vec3 u = plus(at->v, cross(at->w, it.r));
    const vec3 c = plus(c_extra, plus(cross(at->w, cross(at->w, it.r)), cross(at->alpha, it.r)));
    const vec rate = dot(u, it.s), w_z = dot(u, it.y)*it.over_L;
    const vec3 w = {it.t*w_z, -dot(u, it.n)*it.over_L, w_z};
    const vec3 b = {dot(c, it.s), dot(c, it.y), dot(c, it.n)};
    const vec turn = w_z*over_cosine*w.y;  /* rates of both angles of the cross */
    const vec alpha_z = (b.y - 2*rate*w.z)*it.over_L - w.x*w.y;
    const vec alpha_y = w.x*w.z - (b.z + 2*rate*w.y)*it.over_L;
    const vec3 alpha = {it.t*(alpha_z - turn*sine) - turn*cosine, alpha_y, alpha_z};

    const vec3 g = {dot(gravity, it.s), dot(gravity, it.y), dot(gravity, it.n)};
    const vec3 h3 = of(l->h3), free = minus(b, g);
    const vec3 swing = plus(apply(l->J, alpha), cross(w, apply(l->J, w)));
    const vec3 moment = plus(swing, minus(cross(h3, free), cross(of(l->h2), g)));
    const vec3 inertial = plus(cross(alpha, h3), cross(w, cross(w, h3)));
    const vec3 force = {l->m3*free.x + inertial.x,
        l->m3*free.y + inertial.y + (it.t*moment.x + moment.z)*it.over_L,
        l->m3*free.z + inertial.z - moment.y*it.over_L};
    it.force = plus(times(force.x, it.s), plus(times(force.y, it.y), times(force.z, it.n)));
    return it;
}

/* What a leg adds to M where its joint accelerates: Q in base axes. */
static inline void leg_inertia(const hand_leg *l, const leg *it, vec *Q)
{
    const vec o = it->over_L, t = it->t, *J = l->J, *h = l->h3;
    const vec inner[6] = {l->m3, -h[1]*o, -h[2]*o,
        l->m3 + (t*t*J[0] + 2*t*J[2] + J[5])*o*o + 2*(h[0] - t*h[2])*o,
        t*h[1]*o - (t*J[1] + J[4])*o*o,
        l->m3 + J[3]*o*o + 2*h[0]*o};
    turned(inner, it->s, it->y, it->n, Q);
}

/* Newton and Euler of the platform; c and alpha are accelerations of its origin. */
static inline void platform(const hand_stewart_model *m, const state *at, vec3 gravity, vec3 *force,
                            vec3 *moment, vec *inertia, vec3 *h)
{
    const vec3 r = on_platform(at, of(m->centre));
    turned(m->inertia, at->column_x, at->column_y, at->column_z, inertia);
    const vec3 c = plus(at->a, plus(cross(at->alpha, r), cross(at->w, cross(at->w, r))));
    *force = times(m->mass, minus(c, gravity));
    const vec3 euler = plus(apply(inertia, at->alpha), cross(at->w, apply(inertia, at->w)));
    *moment = plus(cross(r, *force), euler);
    *h = times(m->mass, r);
}

/* M of a body that is Q at r: rows of 21 entries, the upper triangle. */
static inline void add_inertia(const vec *Q, vec3 r, vec *M)
{
    const vec B[3][3] = {  /* -Q r~ = Q^T times the columns of r~^T */
        {Q[2]*r.y - Q[1]*r.z, Q[0]*r.z - Q[2]*r.x, Q[1]*r.x - Q[0]*r.y},
        {Q[4]*r.y - Q[3]*r.z, Q[1]*r.z - Q[4]*r.x, Q[3]*r.x - Q[1]*r.y},
        {Q[5]*r.y - Q[4]*r.z, Q[2]*r.z - Q[5]*r.x, Q[4]*r.x - Q[2]*r.y}};
    M[0] += Q[0];  M[1] += Q[1];  M[2] += Q[2];  M[3] += B[0][0];  M[4] += B[0][1];  M[5] += B[0][2];
    M[6] += Q[3];  M[7] += Q[4];  M[8] += B[1][0];  M[9] += B[1][1];  M[10] += B[1][2];
    M[11] += Q[5];  M[12] += B[2][0];  M[13] += B[2][1];  M[14] += B[2][2];
    M[15] += r.y*B[2][0] - r.z*B[1][0];
    M[16] += r.y*B[2][1] - r.z*B[1][1];
    M[17] += r.y*B[2][2] - r.z*B[1][2];
    M[18] += r.z*B[0][1] - r.x*B[2][1];
    M[19] += r.z*B[0][2] - r.x*B[2][2];
    M[20] += r.x*B[1][2] - r.y*B[0][2];
}

static inline void set_platform_M(vec mass, vec3 h, vec3 r, const vec *I, vec *M)
{
    const vec zero = {0}, rr = dot(h, r);
    M[0] = mass;  M[1] = zero;  M[2] = zero;  M[3] = zero;  M[4] = h.z;  M[5] = -h.y;
    M[6] = mass;  M[7] = zero;  M[8] = -h.z;  M[9] = zero;  M[10] = h.x;
    M[11] = mass;  M[12] = h.y;  M[13] = -h.x;  M[14] = zero;
    M[15] = I[0] + rr - h.x*r.x;  M[16] = I[1] - h.x*r.y;  M[17] = I[2] - h.x*r.z;
    M[18] = I[3] + rr - h.y*r.y;  M[19] = I[4] - h.y*r.z;
    M[20] = I[5] + rr - h.z*r.z;
}

/* ---- one state ---- */

static inline state at_all(const real *X, const real *V, const real *A)
{
    state at = {.p = {all(X[0]), all(X[1]), all(X[2])}, .v = {all(V[0]), all(V[1]), all(V[2])},
                .w = {all(V[3]), all(V[4]), all(V[5])}};
    if (A) {
        at.a = (vec3){all(A[0]), all(A[1]), all(A[2])};
        at.alpha = (vec3){all(A[3]), all(A[4]), all(A[5])};
    }
    orient(&at, all(X[3]), all(X[4]), all(X[5]), all(X[6]));
    return at;
}

/* Sums over the lanes of eight vectors at a time, in the lanes of one. */
#define FOLD(a, b, ...) (__builtin_shufflevector(a, b, __VA_ARGS__))
#define HALVES(a, b) \
    (FOLD(a, b, 0, 1, 2, 3, 8, 9, 10, 11) + FOLD(a, b, 4, 5, 6, 7, 12, 13, 14, 15))
#define QUARTERS(a, b) \
    (FOLD(a, b, 0, 1, 4, 5, 8, 9, 12, 13) + FOLD(a, b, 2, 3, 6, 7, 10, 11, 14, 15))
#define EIGHTHS(a, b) \
    (FOLD(a, b, 0, 2, 4, 6, 8, 10, 12, 14) + FOLD(a, b, 1, 3, 5, 7, 9, 11, 13, 15))

static inline vec sums(const vec *a)
{
    const vec ab = HALVES(a[0], a[1]), cd = HALVES(a[2], a[3]);
    const vec ef = HALVES(a[4], a[5]), gh = HALVES(a[6], a[7]);
    const vec first = QUARTERS(ab, cd), second = QUARTERS(ef, gh);
    return EIGHTHS(first, second);
}

static inline void rows_of_H(const leg *it, vec *rows)
{
    const vec3 m = cross(it->r, it->s);
    const vec given[6] = {it->s.x, it->s.y, it->s.z, m.x, m.y, m.z};
    memcpy(rows, given, sizeof given);
}

int hand_stewart_inverse_dynamics(const hand_stewart_model *m, const real *X, const real *V,
                                  const real *A, const real *wrench, real *tau)
{
    const state at = at_all(X, V, A);
    const vec3 gravity = of(m->gravity);
    vec3 force, moment, h;
    vec inertia[6], row[6];
    real pivot[6];
    platform(m, &at, gravity, &force, &moment, inertia, &h);
    const leg it = leg_at(&m->legs, &at, gravity, at.a);
    const vec3 turn = cross(it.r, it.force);
    const vec of_legs[8] = {it.force.x, it.force.y, it.force.z, turn.x, turn.y, turn.z};
    const vec of_platform = {force.x[0], force.y[0], force.z[0], moment.x[0], moment.y[0],
                             moment.z[0]};
    const vec f = sums(of_legs) + of_platform;
    rows_of_H(&it, row);
    for (int i = 0; i < 6; ++i) {  /* the right-hand side stands behind the columns */
        row[i][6] = f[i] - (wrench ? wrench[i] : 0);
    }
    for (int i = 0; i < 6; ++i) {
        const real inverse = 1/row[i][i];
        for (int j = 0; j < 6; ++j) {
            if (j != i) {
                row[j] -= all(row[j][i]*inverse)*row[i];
            }
        }
        pivot[i] = inverse;
    }
    for (int i = 0; i < 6; ++i) {
        tau[i] = row[i][6]*pivot[i];
    }
    return 0;
}

int hand_stewart_dynamics(const hand_stewart_model *m, const real *X, const real *V, real *M,
                          real *Z, real *H)
{
    const state at = at_all(X, V, NULL);
    const vec3 gravity = of(m->gravity), zero = {{0}, {0}, {0}};
    vec3 force, moment, h;
    vec inertia[6], row[6], Q[6], own[21], of_legs[32] = {{0}};
    real total[32];
    platform(m, &at, gravity, &force, &moment, inertia, &h);
    set_platform_M(m->mass, h, on_platform(&at, of(m->centre)), inertia, own);
    const leg it = leg_at(&m->legs, &at, gravity, zero);
    const vec3 turn = cross(it.r, it.force);
    const vec of_force[6] = {it.force.x, it.force.y, it.force.z, turn.x, turn.y, turn.z};
    leg_inertia(&m->legs, &it, Q);
    add_inertia(Q, it.r, of_legs);
    memcpy(of_legs + 21, of_force, sizeof of_force);
    for (int k = 0; k < 32; k += LANES) {
        const vec eight = sums(of_legs + k);
        memcpy(total + k, &eight, sizeof eight);
    }
    const vec of_platform[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
    rows_of_H(&it, row);
    for (int i = 0, e = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j, ++e) {
            M[6*i + j] = M[6*j + i] = own[e][0] + total[e];
        }
        Z[i] = of_platform[i][0] + total[21 + i];
        memcpy(H + 6*i, &row[i], 6*sizeof(real));
    }
    return 0;
}

/* ---- batches ---- */

/* Entry `entry` of up to LANES states; the last state fills up. */
static inline vec gather(const real *x, size_t size, size_t entry, size_t states)
{
    vec a;
    for (size_t k = 0; k < LANES; ++k) {
        a[k] = x[size*(k < states ? k : states - 1) + entry];
    }
    return a;
}

static inline void scatter(vec a, real *x, size_t size, size_t entry, size_t states)
{
    for (size_t k = 0; k < LANES && k < states; ++k) {
        x[size*k + entry] = a[k];
    }
}

static inline vec3 gather3(const real *x, size_t size, size_t entry, size_t n)
{
    return (vec3){gather(x, size, entry, n), gather(x, size, entry + 1, n),
                  gather(x, size, entry + 2, n)};
}

static inline state states_at(const real *X, const real *V, const real *A, size_t n)
{
    state at = {.p = gather3(X, 7, 0, n), .v = gather3(V, 6, 0, n), .w = gather3(V, 6, 3, n)};
    if (A) {
        at.a = gather3(A, 6, 0, n);
        at.alpha = gather3(A, 6, 3, n);
    }
    orient(&at, gather(X, 7, 3, n), gather(X, 7, 4, n), gather(X, 7, 5, n), gather(X, 7, 6, n));
    return at;
}

static void inverse_dynamics_lanes(const hand_stewart_model *m, size_t n, const real *X,
                                   const real *V, const real *A, const real *wrench, real *tau)
{
    const state at = states_at(X, V, A, n);
    const vec3 gravity = of(m->gravity);
    vec3 force, moment, h;
    vec inertia[6], H[6][7];
    platform(m, &at, gravity, &force, &moment, inertia, &h);
    for (int i = 0; i < LEGS; ++i) {
        const leg it = leg_at(&m->leg[i], &at, gravity, at.a);
        vec row[6];
        force = plus(force, it.force);
        moment = plus(moment, cross(it.r, it.force));
        rows_of_H(&it, row);
        for (int j = 0; j < 6; ++j) {
            H[j][i] = row[j];
        }
    }
    const vec f[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
    for (size_t i = 0; i < 6; ++i) {
        H[i][6] = wrench ? f[i] - gather(wrench, 6, i, n) : f[i];
    }
    for (int i = 0; i < 6; ++i) {
        const vec inverse = 1/H[i][i];
        for (int k = i + 1; k < 7; ++k) {
            H[i][k] *= inverse;
        }
        for (int j = i + 1; j < 6; ++j) {
            for (int k = i + 1; k < 7; ++k) {
                H[j][k] -= H[j][i]*H[i][k];
            }
        }
    }
    for (int i = 5; i >= 0; --i) {
        for (int k = i + 1; k < 6; ++k) {
            H[i][6] -= H[i][k]*H[k][6];
        }
        scatter(H[i][6], tau, 6, (size_t)i, n);
    }
}

size_t hand_stewart_inverse_dynamics_batch(const hand_stewart_model *m, size_t n, const real *X,
    const real *V, const real *A, const real *wrench, real *tau, int *status)
{
    for (size_t k = 0; k < n; k += LANES) {
        inverse_dynamics_lanes(m, n - k < LANES ? n - k : LANES, X + 7*k, V + 6*k, A + 6*k,
                               wrench ? wrench + 6*k : NULL, tau + 6*k);
    }
    if (status) {
        memset(status, 0, n*sizeof *status);
    }
    return 0;
}

static void dynamics_lanes(const hand_stewart_model *m, size_t n, const real *X, const real *V,
                           real *M, real *Z, real *H)
{
    const state at = states_at(X, V, NULL, n);
    const vec3 gravity = of(m->gravity), zero = {{0}, {0}, {0}};
    vec3 force, moment, h;
    vec inertia[6], Q[6], inertias[21];
    platform(m, &at, gravity, &force, &moment, inertia, &h);
    set_platform_M(m->mass, h, on_platform(&at, of(m->centre)), inertia, inertias);
    for (size_t i = 0; i < LEGS; ++i) {
        const leg it = leg_at(&m->leg[i], &at, gravity, zero);
        vec row[6];
        force = plus(force, it.force);
        moment = plus(moment, cross(it.r, it.force));
        leg_inertia(&m->leg[i], &it, Q);
        add_inertia(Q, it.r, inertias);
        rows_of_H(&it, row);
        for (size_t j = 0; j < 6; ++j) {
            scatter(row[j], H, 36, 6*j + i, n);
        }
    }
    const vec f[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
    for (size_t i = 0, e = 0; i < 6; ++i) {
        scatter(f[i], Z, 6, i, n);
        for (size_t j = i; j < 6; ++j, ++e) {
            scatter(inertias[e], M, 36, 6*i + j, n);
            scatter(inertias[e], M, 36, 6*j + i, n);
        }
    }
}

size_t hand_stewart_dynamics_batch(const hand_stewart_model *m, size_t n, const real *X,
    const real *V, real *M, real *Z, real *H, int *status)
{
    for (size_t k = 0; k < n; k += LANES) {
        dynamics_lanes(m, n - k < LANES ? n - k : LANES, X + 7*k, V + 6*k, M + 36*k, Z + 6*k,
                       H + 36*k);
    }
    if (status) {
        memset(status, 0, n*sizeof *status);
    }
    return 0;
}

/* ---- parameters ---- */

static const int PLACES[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

/* An inertia tensor about a point at -c from the centre of mass, entry (i, j). */
static real about(const real (*I)[3], real mass, const real *c, int i, int j)
{
    const real square = i == j ? c[0]*c[0] + c[1]*c[1] + c[2]*c[2] : 0;
    return I[i][j] + mass*(square - c[i]*c[j]);
}

static void set_leg(const stewart_params *p, int i, int lane, int massive, hand_leg *l)
{
    for (int k = 0; k < 3; ++k) {
        l->base[k][lane] = p->ups_base_point[i][k];
        l->first_axis[k][lane] = p->ups_base_frame[i][k][2];
        l->point[k][lane] = p->ups_platform_point[i][k];
        l->h2[k][lane] = massive*p->ups_link2_mass[i]*p->ups_link2_centre_of_mass[i][k];
        l->h3[k][lane] = massive*p->ups_link3_mass[i]*p->ups_link3_centre_of_mass[i][k];
    }
    l->m3[lane] = massive*p->ups_link3_mass[i];
    for (int e = 0; e < 6; ++e) {
        const int a = PLACES[e][0], b = PLACES[e][1];
        l->J[e][lane] = massive*(
            about(p->ups_link2_inertia[i], p->ups_link2_mass[i], p->ups_link2_centre_of_mass[i], a, b)
            + about(p->ups_link3_inertia[i], p->ups_link3_mass[i], p->ups_link3_centre_of_mass[i], a, b));
    }
}

int hand_stewart_prepare(const stewart_params *p, hand_stewart_model *m)
{
    memset(m, 0, sizeof *m);
    for (int lane = 0; lane < LANES; ++lane) {
        set_leg(p, lane < LEGS ? lane : 0, lane, lane < LEGS, &m->legs);
        for (int i = 0; i < LEGS; ++i) {
            set_leg(p, i, lane, 1, &m->leg[i]);
        }
    }
    m->mass = all(p->platform_mass);
    for (int k = 0; k < 3; ++k) {
        m->gravity[k] = all(p->gravity[k]);
        m->centre[k] = all(p->platform_centre_of_mass[k]);
    }
    for (int e = 0; e < 6; ++e) {
        m->inertia[e] = all(p->platform_inertia[PLACES[e][0]][PLACES[e][1]]);
    }
    return 0;
}
