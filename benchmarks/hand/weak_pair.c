/* The estimator of an antagonistic joint of two transmissions, written by hand for one
 * configuration: torques from both motors without Coulomb friction, method `weak`, odd powers of
 * each deflection up to the seventh and a torque offset, UD least squares, high orders shrunk, the
 * deviation of the sum with what the two errors have in common. Same algorithm and same results as
 * rotatum's stage for it. */

/* Vectors of three to five numbers are half as fast as numbers one by one. */
#pragma GCC optimize("no-tree-vectorize")

enum { TERMS = 4, TRANSMISSIONS = 2 };

#include "poles.h"

#include "guard.h"
#include "transmission.h"
#include "verdict.h"

static const double LEAST = -0.5;             /* correlation */

typedef struct {
    double time;
    double stiffness, stiffness_std, torque, torque_std, dstiffness;
    double deflection, row_torque, row_fit;
    double noise, inflation, informative_deflection, converged_at;
    int64_t converged, verdict, status, rows;
    double correlation;
    double coefficients[2 * P], coefficients_std[2 * P];
    double part_stiffness[2], part_stiffness_std[2], part_torque[2], part_dstiffness[2];
    double part_deflection[2], part_row_torque[2], part_row_fit[2];
    int64_t part_verdict[2], part_status[2];
} joint_reading;

typedef struct {
    guard guard;
    transmission transmission[2];
    blocks blocks;
    double correlation;                       /* of the errors of the two stiffnesses */
    double noise;
    interval interval, part_interval[2];
    convergence convergence;
} joint_state;

/* Errors that seem to cancel are believed no further than LEAST. */
static void relate(joint_state *s, const double v[2 * P])
{
    const evidence *a = &s->transmission[0].evidence, *b = &s->transmission[1].evidence;
    double V1 = a->scale * a->spread, V2 = b->scale * b->spread;
    double both = worst(&s->blocks, 0, 2 * P, v), r = 0.0;
    if (both > 0.0 && V1 > 0.0 && V2 > 0.0) {
        r = (both - V1 - V2) / (2.0 * sqrt(V1 * V2));
        r = fmax(fmin(r, 1.0), LEAST);
    }
    s->correlation = r;
    s->noise = sqrt(a->variance + b->variance);
}

static void evaluate(const joint_params *p, joint_state *s)
{
    double v[2 * P];
    for (int i = 0; i < 2; ++i) {
        transmission *t = &s->transmission[i];
        renew(p, &p->transmission[i], &t->evidence, &t->ls, &t->row, &s->blocks, i * P, i * PROBES,
              v + i * P);
    }
    relate(s, v);
}

static void estimate(const joint_params *p, joint_state *s, const joint_input *u, int fresh)
{
    transmission *t = s->transmission;
    blocks *b = &s->blocks;
    for (int i = 0; i < 2; ++i) {
        next_row(&p->transmission[i], &t[i].row, u->channel[Q], u->channel[THETA + i],
                 u->channel[TAU + i], u->enable != 0, fresh);
    }
    int status = t[0].row.status | t[1].row.status;
    t[0].row.status = t[1].row.status = status;
    if (t[0].row.count <= 1 || t[1].row.count <= 1) {
        clear_blocks(b);
        cut(&t[0].evidence);
        cut(&t[1].evidence);
    }
    if (status != 0) {
        return;
    }
    for (int i = 0; i < 2; ++i) {
        take_row(&p->transmission[i], &t[i], b->part + i * P, b->part + SCORES + i * PROBES,
                 b->evaluated >= SETTLED);
    }
    if (++b->filled >= p->c.block) {
        for (int i = 0; i < 2; ++i) {
            fold(&p->transmission[i], &t[i].evidence, b->part + SCORES + i * PROBES);
        }
        close_block(p, b);
        if (due(b)) {
            evaluate(p, s);
        }
    }
}

static void read_part(const joint_params *p, joint_state *s, int i, told *r, int counted,
                      joint_reading *out)
{
    transmission *t = &s->transmission[i];
    *r = tell(p, &p->transmission[i], t, s->blocks.evaluated != 0);
    int status = r->status;
    out->part_verdict[i] = decide(p, &s->part_interval[i], r->stiffness, r->stiffness_std,
                                  t->evidence.wrong, counted, &status);
    out->part_status[i] = status;
    r->status = status & ~WIDE;
    out->part_stiffness[i] = r->stiffness;
    out->part_stiffness_std[i] = r->stiffness_std;
    out->part_torque[i] = r->torque;
    out->part_dstiffness[i] = r->slope;
    out->part_deflection[i] = t->row.phi;
    out->part_row_torque[i] = t->row.operator.now[Y];
    out->part_row_fit[i] = r->fit;
    memcpy(out->coefficients + i * P, t->ls.shrunk, sizeof t->ls.shrunk);
    memcpy(out->coefficients_std + i * P, t->evidence.std, sizeof t->evidence.std);
}

/* Noise with its correlation, systematic errors as if they added up, where the laws are read: the
 * link's noise moves both deflections, each motor's its own. */
static double total_std(const joint_params *p, double r, const told *a, const told *b)
{
    double both = a->slope + b->slope, apart = a->slope * a->slope + b->slope * b->slope;
    double read2 = both * both * p->c.link2 + apart * p->c.motor2;
    double noise2 = a->noise2 + b->noise2 + 2.0 * r * sqrt(a->noise2 * b->noise2);
    double wrong2 = a->wrong2 + b->wrong2 + 2.0 * sqrt(a->wrong2 * b->wrong2);
    return sqrt(fmax(noise2 + wrong2 + read2, 0.0));
}

/* The sign of what torques share follows the deflections: the worse of both. */
static double total_torque_std(double r, double a, double b)
{
    return sqrt(a + b + 2.0 * fabs(r) * sqrt(a * b));
}

static void read_out(const joint_params *p, joint_state *s, double time, int counted,
                     joint_reading *out)
{
    told a, b;
    read_part(p, s, 0, &a, counted, out);
    read_part(p, s, 1, &b, counted, out);
    const evidence *e = &s->transmission[0].evidence, *f = &s->transmission[1].evidence;
    int status = a.status | b.status;
    out->stiffness = a.stiffness + b.stiffness;
    out->stiffness_std = total_std(p, s->correlation, &a, &b);
    out->torque = a.torque + b.torque;
    out->torque_std = total_torque_std(s->correlation, a.torque_variance, b.torque_variance);
    out->dstiffness = a.slope + b.slope;
    out->deflection = 0.5 * (out->part_deflection[0] + out->part_deflection[1]);
    out->row_torque = out->part_row_torque[0] + out->part_row_torque[1];
    out->row_fit = a.fit + b.fit;
    out->noise = s->noise;
    out->inflation = e->inflation > f->inflation ? e->inflation : f->inflation;
    out->informative_deflection = e->deflection < f->deflection ? e->deflection : f->deflection;
    out->rows = s->transmission[0].ls.rows;
    out->correlation = s->correlation;
    out->verdict = decide(p, &s->interval, out->stiffness, out->stiffness_std,
                          e->wrong | f->wrong, counted, &status);
    out->status = status;
    if (counted) {
        note_convergence(p, &s->convergence, (int)out->verdict, time);
    }
    out->converged_at = s->convergence.at;
    out->converged = s->convergence.converged;
}

#include "step.h"
