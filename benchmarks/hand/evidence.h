/* How far a transmission's estimate can be trusted: noise level, coloured residuals, tests. */

#ifndef EVIDENCE_H
#define EVIDENCE_H

#include "rows.h"
#include "solver.h"

enum { MEAN, SHIFT, PULL_OF_MOTOR, SCALE, DRAG_OF_LINK };
enum { STREAK = 3 };

static const double CONFIDENT = 2.5;

typedef struct {
    double rows, squares, variance, inflation, scale, spread, deflection, relative2, shift2, noise;
    double faint;                             /* how much of the straight line's column is noise */
    double std[P];
    int std_turn, head, length, wrong, streak[PROBES];
    double e[RING], f[RING], pulls[RING], drags[RING], open[MOMENTS];
    double weight, torque, torque2, cross, drag_cross, probe[PROBES], shift_2, pull2, drag2;
    double share[PROBES], doubt[PROBES];
} evidence;

/* What follows is not adjacent to what came before. */
static void cut(evidence *s)
{
    s->length = 0;
    memset(s->open, 0, sizeof s->open);
}

static void probe(const transmission_params *p, evidence *s, double probes[PROBES], double after)
{
    int middle = (s->head - (int)p->c.lag) & (RING - 1);
    int first = (middle - (int)p->c.lag) & (RING - 1);
    double e = s->e[middle], f = s->f[middle], before = s->f[first];
    double shift = after - before, pull = s->pulls[middle], drag = s->drags[middle];
    s->open[0] += 1.0;
    s->open[1] += f;
    s->open[2] += f * f;
    s->open[3] += pull * f;
    s->open[4] += shift * shift;
    s->open[5] += pull * pull;
    s->open[6] += drag * f;
    s->open[7] += drag * drag;
    probes[MEAN] += e;
    probes[SHIFT] += e * shift;
    probes[PULL_OF_MOTOR] += e * pull - p->c.common;
    probes[SCALE] += e * f;
    probes[DRAG_OF_LINK] += e * drag;
}

static void add_evidence(const transmission_params *p, evidence *s, const solver *ls,
                         const double now[SIGNALS], double scores[P], double probes[PROBES],
                         int settled)
{
    const double *x = now + R;
    double e = ls->innovation / (1.0 + ls->leverage), f = 0.0;
    s->squares = p->c.forgetting * s->squares + ls->innovation * e;
    s->rows = p->c.forgetting * s->rows + 1.0;
    for (int i = 0; i < P; ++i) {
        scores[i] += e * x[i];
    }
    for (int i = 1; i < P; ++i) {
        f += x[i] * ls->alpha[i];
    }
    s->e[s->head] = e;
    s->f[s->head] = f;
    s->pulls[s->head] = now[PULL];
    s->drags[s->head] = now[DRAG];
    s->length += s->length <= 2 * p->c.lag;
    if (settled && s->length > 2 * p->c.lag) {
        probe(p, s, probes, f);
    }
    s->head = (s->head + 1) & (RING - 1);
}

/* Fade what the tests remember and add the open block's sums to it. */
static void fold(const transmission_params *p, evidence *s, const double probes[PROBES])
{
    double m = p->c.memory;
    for (int i = 0; i < PROBES; ++i) {
        s->probe[i] = m * s->probe[i] + probes[i];
    }
    s->weight = m * s->weight + s->open[0];
    s->torque = m * s->torque + s->open[1];
    s->torque2 = m * s->torque2 + s->open[2];
    s->cross = m * s->cross + s->open[3];
    s->shift_2 = m * s->shift_2 + s->open[4];
    s->pull2 = m * s->pull2 + s->open[5];
    s->drag_cross = m * s->drag_cross + s->open[6];
    s->drag2 = m * s->drag2 + s->open[7];
    memset(s->open, 0, sizeof s->open);
}

static double ratio(double top, double bottom)
{
    return bottom > 0.0 ? top / bottom : 0.0;
}

static void test_model(evidence *s, const blocks *b, int probes)
{
    const double *a = s->probe, n = s->weight, tiny = 1e-300;
    double power = s->torque2 - s->torque * s->torque / (n + tiny);
    double least = 1e-12 * s->torque2 + tiny;
    power = power < least ? least : power;
    for (int i = 0; i < PROBES; ++i) {
        double largest = worst_probe(b, probes + i);
        s->doubt[i] = largest > 0.0 ? fabs(a[i]) / sqrt(largest) : 0.0;
    }
    double pull2 = s->pull2 - s->cross * s->cross / (s->torque2 + tiny);
    double drag2 = s->drag2 - s->drag_cross * s->drag_cross / (s->torque2 + tiny);
    s->share[MEAN] = ratio(a[MEAN] * a[MEAN], (n + tiny) * power);
    s->share[SHIFT] = ratio(a[SHIFT] * a[SHIFT], s->shift_2 * power);
    s->share[PULL_OF_MOTOR] = ratio(fabs(a[PULL_OF_MOTOR] * s->cross), pull2 * power);
    s->share[SCALE] = ratio(fabs(a[SCALE]), power);
    s->share[DRAG_OF_LINK] = ratio(fabs(a[DRAG_OF_LINK] * s->drag_cross), drag2 * power);
}

/* Bias along v = P c from the noise in the straight line's column, less its share in y. What
 * is seen of the coefficient is attenuated by as much of the column as is noise. */
static double bias_along(const transmission_params *p, const evidence *s, const solver *ls,
                         const double v[P])
{
    return v[1] * s->rows * (p->c.noise * ls->shrunk[1] / (1.0 - s->faint) - p->c.shared);
}

static void renew_coefficient(const transmission_params *p, evidence *s, const solver *ls,
                              const blocks *b, int at)
{
    double unit[P] = {0}, v[P], bias2;
    int j = s->std_turn;
    unit[j] = 1.0;
    multiply(ls, unit, v, &bias2);
    double own = s->variance * v[j], coloured = worst(b, at, P, v);
    if (j == 1) {
        s->faint = fmin(s->rows * p->c.noise * v[1], 0.99);
    }
    double shift = bias_along(p, s, ls, v);
    s->std[j] = sqrt((coloured > own ? coloured : own) + shift * shift + bias2);
    s->std_turn = j + 1 < P ? j + 1 : 0;
}

static void set_wrong(const transmission_params *p, evidence *s, double relative)
{
    static const int bits[PROBES] = {OFFSET, LAG, INERTIA, DRIFT, VELOCITY};
    double limit = relative > p->c.bias ? relative : p->c.bias;
    for (int i = 0; i < PROBES; ++i) {
        int speaks = s->share[i] > limit && s->doubt[i] > CONFIDENT;
        s->streak[i] = speaks ? s->streak[i] + 1 : 0;
        if (s->streak[i] >= STREAK) {
            s->wrong |= bits[i];
        } else if (s->share[i] < 0.5 * limit || s->doubt[i] < 0.6 * CONFIDENT) {
            s->wrong &= ~bits[i];
        }
    }
}

/* At every evaluation: noise level, shrinking, inflation, informative deflection, tests. Writes the
 * direction P D to v. */
static void renew(const joint_params *joint, const transmission_params *p, evidence *s, solver *ls,
                  const rows *row, const blocks *b, int at, int probes, double v[P])
{
    double D[P] = {0}, stiffness = 0.0, slope = 0.0, bias2;
    if (s->rows > P) {
        s->variance = s->squares / (s->rows - P);
    }
    weigh(ls, s->variance, b, at);
    for (int i = 1; i < P; ++i) {
        D[i] = row->D[i - 1];
        stiffness += D[i] * ls->shrunk[i];
        slope += row->H[i - 1] * ls->shrunk[i];
    }
    double q = multiply(ls, D, v, &bias2);
    s->spread = q;
    s->inflation = 1.0;
    if (q > 0.0 && s->variance > 0.0) {
        double own = s->variance * q, coloured = worst(b, at, P, v);
        s->inflation = coloured > own ? coloured / own : 1.0;
        s->deflection = sqrt(1.0 / (s->rows * q));
        double accuracy = p->c.accuracy / s->deflection;
        s->relative2 = accuracy * accuracy;
    }
    s->scale = s->inflation * s->variance;
    s->noise = sqrt(s->variance);
    double shift = bias_along(p, s, ls, v);
    s->shift2 = shift * shift;
    test_model(s, b, probes);
    renew_coefficient(p, s, ls, b, at);
    double variance = s->scale * q + stiffness * stiffness * s->relative2 + s->shift2 + bias2;
    variance += slope * slope * joint->read2;
    set_wrong(p, s, 1.96 * sqrt(variance) / (fabs(stiffness) + 1e-300));
}

#endif
