/* The general 6-UPS platform written by hand, behind the interface of the generated stewart.h.
 *
 * Parameters and argument conventions are those of stewart.h; there are no checks and no statuses:
 * a state that is impossible gives nonsense.  See hand_stewart.c. */
#ifndef HAND_STEWART_H_INCLUDED
#define HAND_STEWART_H_INCLUDED

#include "stewart.h"

enum { HAND_LANES = 8, HAND_LEGS = 6 };

/* One number for each leg, or for each of as many states. */
typedef stewart_real hand_vec __attribute__((vector_size(8*sizeof(stewart_real))));

typedef struct {
    hand_vec base[3], first_axis[3], point[3];  /* base frame; base frame; platform frame */
    hand_vec J[6];  /* both links about base and platform joint, link axes: xx xy xz yy yz zz */
    hand_vec h2[3], h3[3], m3;  /* first moments of cylinder and rod, mass of the rod */
} hand_leg;

typedef struct {
    hand_leg legs;             /* a leg in each lane; the last two lanes have no mass */
    hand_leg leg[HAND_LEGS];   /* a leg in all lanes */
    hand_vec gravity[3], mass, centre[3], inertia[6];
} hand_stewart_model;

int hand_stewart_prepare(const stewart_params *params, hand_stewart_model *model);

int hand_stewart_inverse_dynamics(const hand_stewart_model *model, const stewart_real *X,
    const stewart_real *V, const stewart_real *A, const stewart_real *wrench, stewart_real *tau);
size_t hand_stewart_inverse_dynamics_batch(const hand_stewart_model *model, size_t n,
    const stewart_real *X, const stewart_real *V, const stewart_real *A,
    const stewart_real *wrench, stewart_real *tau, int *status);

int hand_stewart_dynamics(const hand_stewart_model *model, const stewart_real *X,
    const stewart_real *V, stewart_real *M, stewart_real *Z, stewart_real *H);
size_t hand_stewart_dynamics_batch(const hand_stewart_model *model, size_t n,
    const stewart_real *X, const stewart_real *V, stewart_real *M, stewart_real *Z,
    stewart_real *H, int *status);

#endif
