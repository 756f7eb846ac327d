/* One transmission: it learns from a row, and tells what it has learnt. */

#ifndef TRANSMISSION_H
#define TRANSMISSION_H

#include "evidence.h"

typedef struct {
    rows row;
    solver ls;
    evidence evidence;
} transmission;

/* What it tells: values, variances split in noise and the rest, status bits but for WIDE. */
typedef struct {
    double stiffness, torque, slope, fit;
    double noise2, wrong2, stiffness_std, torque_variance;
    int status;
} told;

static void start_transmission(const transmission_params *p, transmission *t)
{
    start_solver(p, &t->ls);
    t->evidence.inflation = 1.0;
}

static void take_row(const transmission_params *p, transmission *t, double scores[P],
                     double probes[PROBES], int settled)
{
    const double *now = t->row.operator.now;
    learn(p, &t->ls, now[Y], now + R);
    add_evidence(p, &t->evidence, &t->ls, now, scores, probes, settled);
    shrink(&t->ls);
}

static told tell(const joint_params *joint, const transmission_params *p, transmission *t,
                 int evaluated)
{
    const rows *row = &t->row;
    const double *x = row->operator.now + R, *alpha = t->ls.shrunk;
    evidence *s = &t->evidence;
    told r = {0};
    r.fit = x[0] * alpha[0];
    double prior = 0.0;
    for (int i = 0; i < TERMS; ++i) {
        r.stiffness += row->D[i] * alpha[i + 1];
        r.torque += row->F[i] * alpha[i + 1];
        r.slope += row->H[i] * alpha[i + 1];
        r.fit += x[i + 1] * alpha[i + 1];
        prior += row->D[i] * row->D[i];
    }
    if (!evaluated) {
        /* Not judged yet: the residuals so far, or anything while there is none. */
        s->scale = s->rows > 0.0 ? s->squares / s->rows : 1.0;
    }
    double bias2, torque_bias2, plain, unused;
    double sigma_spread = spread(&t->ls, row->D, &bias2, &plain);
    double torque_spread = spread(&t->ls, row->F, &torque_bias2, &unused);
    r.noise2 = s->scale * sigma_spread;
    r.wrong2 = r.stiffness * r.stiffness * s->relative2 + s->shift2 + bias2;
    r.stiffness_std = sqrt(r.noise2 + r.wrong2 + r.slope * r.slope * joint->read2);
    r.torque_variance = s->scale * torque_spread + r.torque * r.torque * s->relative2;
    r.torque_variance += torque_bias2 + r.stiffness * r.stiffness * joint->read2;
    r.status = row->status;
    if (!evaluated || plain > joint->c.left * p->c.prior * prior) {
        r.status |= PRIOR;
    }
    if (1.96 * r.stiffness_std > joint->c.starved * fabs(r.stiffness)
        && 1.96 * p->c.accuracy > joint->c.starved * s->deflection) {
        r.status |= DEFLECTION;
    }
    return r;
}

#endif
