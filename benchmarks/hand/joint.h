/* What a joint's estimator is given and reads, and the codes it answers with. One program estimates
 * one kind of joint: its file says how many TRANSMISSIONS there are, how many odd powers of the
 * deflection, TERMS, each has, and includes the operator its rows go through. */

#ifndef JOINT_H
#define JOINT_H

#include <math.h>

#include "signals.h"

enum {
    FIRST_SHRUNK = 2,      /* offset and straight line are not */
    LEVELS = 20, RING = 64, PROBES = 5, MOMENTS = 8,
    SCORES = TRANSMISSIONS * P, SUMS = SCORES + TRANSMISSIONS * PROBES,
    PRODUCTS = SCORES * (SCORES + 1) / 2
};
enum { Q, THETA, TAU = THETA + TRANSMISSIONS, CHANNELS = TAU + TRANSMISSIONS, ANGLES = TAU };
enum {
    NOT_FINITE = 1, REPEATED = 2, BACKWARDS = 4, BRIDGED = 8, GAP = 16, JUMP = 32, SATURATED = 64,
    RESTARTED = 128, SETTLING = 256, DISABLED = 512, WIDE = 1024, PRIOR = 2048, DEFLECTION = 4096,
    LAG = 8192, INERTIA = 16384, OFFSET = 32768, DRIFT = 65536, NEGATIVE = 131072,
    VELOCITY = 262144
};
enum { STARVED, CONVERGING, INFORMATIVE, INCONSISTENT };

typedef struct {
    double time, channel[CHANNELS];           /* s; link, motors: rad; motor torques: N m */
    int64_t enable;
} joint_input;

/* Of a transmission and its motor. */
typedef struct {
    int64_t zero_samples, held, lag;
    double range;                             /* deflection at x = 1 */
    double inertia, damping;
    double forgetting, memory, prior;
    double common, accuracy, bias;
    double noise, shared;                     /* of the encoders, in the straight line's column */
    operator_config operator;
} transmission_config;

typedef struct {
    double period;
    int64_t missing;                          /* samples bridged in a row */
    double jump;                              /* rad per sample */
    double wrap[ANGLES];                      /* rad, 0: not modulo */
    double torque_limit[TRANSMISSIONS];       /* N m, 0: none */
    transmission_config transmission[TRANSMISSIONS];
    int64_t block;
    double fade[LEVELS], fade_probe[LEVELS];
    double starved, informative, hold, left;  /* of the verdict; left: of the prior's variance */
    double link2, motor2;                     /* variance of either position's noise */
} joint_config;

/* The same with everything that need not be computed at every sample. */
typedef struct {
    transmission_config c;
    double per_range, per_range2, per_period2, per_two_periods;
    double per_forgetting, share;
    operator_params operator;
} transmission_params;

typedef struct {
    joint_config c;
    double per_period, read2;                 /* read2: variance of the deflection's noise */
    transmission_params transmission[TRANSMISSIONS];
} joint_params;

void joint_prepare(joint_params *p, const joint_config *c);

void joint_prepare(joint_params *p, const joint_config *c)
{
    p->c = *c;
    p->per_period = 1.0 / c->period;
    p->read2 = c->link2 + c->motor2;
    for (int i = 0; i < TRANSMISSIONS; ++i) {
        transmission_params *t = &p->transmission[i];
        t->c = c->transmission[i];
        prepare_operator(&t->operator, &t->c.operator);
        t->per_range = 1.0 / t->c.range;
        t->per_range2 = t->per_range * t->per_range;
        t->per_period2 = p->per_period * p->per_period;
        t->per_two_periods = 0.5 * p->per_period;
        t->per_forgetting = 1.0 / t->c.forgetting;
        t->share = t->c.forgetting < 1.0 ? t->c.prior / (P * (1.0 - t->c.forgetting)) : 0.0;
    }
}

#endif
