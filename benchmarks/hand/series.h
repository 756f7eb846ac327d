/* The estimator of a series joint, for one configuration: torque from its motor without Coulomb
 * friction, method `weak`, odd powers of the deflection and a torque offset, UD least squares, high
 * orders shrunk. Same algorithm and same results as rotatum's stage for it. */

#ifndef SERIES_H
#define SERIES_H

#include "guard.h"
#include "transmission.h"
#include "verdict.h"

typedef struct {
    double time;
    double stiffness, stiffness_std, torque, torque_std, dstiffness;
    double deflection, row_torque, row_fit;
    double noise, inflation, informative_deflection, converged_at;
    int64_t converged, verdict, status, rows;
    double coefficients[P], coefficients_std[P];
} joint_reading;

typedef struct {
    guard guard;
    transmission transmission[TRANSMISSIONS];
    blocks blocks;
    interval interval;
    convergence convergence;
} joint_state;

static void estimate(const joint_params *p, joint_state *s, const joint_input *u, int fresh)
{
    const transmission_params *tp = p->transmission;
    transmission *t = s->transmission;
    blocks *b = &s->blocks;
    next_row(tp, &t->row, u->channel[Q], u->channel[THETA], u->channel[TAU], u->enable != 0, fresh);
    if (t->row.count <= 1) {
        clear_blocks(b);
        cut(&t->evidence);
    }
    if (!t->row.due) {
        return;
    }
    take_row(tp, t, b->part, b->part + SCORES, b->evaluated >= SETTLED);
    if (++b->filled >= p->c.block) {
        fold(tp, &t->evidence, b->part + SCORES);
        close_block(p, b);
        if (due(b)) {
            double v[P];
            renew(p, tp, &t->evidence, &t->ls, &t->row, b, 0, 0, v);
        }
    }
}

static void read_out(const joint_params *p, joint_state *s, double time, int counted,
                     joint_reading *out)
{
    transmission *t = s->transmission;
    const evidence *e = &t->evidence;
    told r = tell(p, p->transmission, t, s->blocks.evaluated != 0);
    int verdict = decide(p, &s->interval, r.stiffness, r.stiffness_std, e->wrong, counted,
                         &r.status);
    if (counted) {
        note_convergence(p, &s->convergence, verdict, time);
    }
    out->stiffness = r.stiffness;
    out->stiffness_std = r.stiffness_std;
    out->torque = r.torque;
    out->torque_std = sqrt(r.torque_variance);
    out->dstiffness = r.slope;
    out->deflection = t->row.phi;
    out->row_torque = t->row.operator.now[Y];
    out->row_fit = r.fit;
    out->noise = e->noise;
    out->inflation = e->inflation;
    out->informative_deflection = e->deflection;
    out->converged_at = s->convergence.at;
    out->converged = s->convergence.converged;
    out->verdict = verdict;
    out->status = r.status;
    out->rows = t->ls.rows;
    memcpy(out->coefficients, t->ls.shrunk, sizeof t->ls.shrunk);
    memcpy(out->coefficients_std, e->std, sizeof e->std);
}

#include "step.h"

#endif
