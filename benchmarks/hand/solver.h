/* Least squares, P = U diag(d) U^T, and coefficients of high orders shrunk: alpha' = U (w zeta). */

#ifndef SOLVER_H
#define SOLVER_H

#include "blocks.h"

/* Thresholds of shrinking: of the first order, of one after a believed one, factor after one that
 * is not, largest. LARGEST: size of an order, in straight lines, that is nothing special. */
static const double FIRST = 0.5, NEXT = 3.0, STEEPER = 10.0, STEEPEST = 108.0, LARGEST = 3.0;

typedef struct {
    double alpha[P], U[P][P], d[P];           /* U[j]: column j, so that it is in one piece */
    double innovation, leverage;
    int64_t rows;
    int turn;
    double weight[P], lost2[P], zeta[P];      /* 1, 0 and unused before FIRST_SHRUNK */
    double shrunk[P];                         /* alpha' */
} solver;

static void start_solver(const transmission_params *p, solver *s)
{
    for (int i = 0; i < P; ++i) {
        s->d[i] = p->c.prior;
        s->U[i][i] = 1.0;
        s->weight[i] = i < FIRST_SHRUNK ? 1.0 : 0.0;
    }
}

/* Bierman's update for innovation e and f = U^T R; returns R^T P R. */
static double absorb(solver *s, const double f[P], double e, double variance)
{
    double g[P], a = variance, per_a = 1.0 / variance;
    for (int j = 0; j < P; ++j) {
        double v = s->d[j] * f[j], b = a, k = -f[j] * per_a;
        a += f[j] * v;
        per_a = 1.0 / a;
        s->d[j] *= b * per_a;
        g[j] = v;
        for (int i = 0; i < j; ++i) {
            double old = s->U[j][i];
            s->U[j][i] = old + g[i] * k;
            g[i] += v * old;
        }
    }
    for (int i = 0; i < P; ++i) {
        s->alpha[i] += g[i] * (e * per_a);
    }
    return a - variance;
}

static void forget(const transmission_params *p, solver *s)
{
    double f[P];
    int j = s->turn;
    for (int i = 0; i < P; ++i) {
        s->d[i] *= p->per_forgetting;
        f[i] = s->U[i][j];
    }
    absorb(s, f, -s->alpha[j], p->share);
    s->turn = j + 1 < P ? j + 1 : 0;
}

static void learn(const transmission_params *p, solver *s, double y, const double x[P])
{
    double f[P], e = y;
    for (int j = 0; j < P; ++j) {
        e -= x[j] * s->alpha[j];
        f[j] = x[j];
        for (int i = 0; i < j; ++i) {
            f[j] += s->U[j][i] * x[i];
        }
    }
    s->innovation = e;
    s->leverage = absorb(s, f, e, 1.0);
    s->rows++;
    if (p->c.forgetting < 1.0) {
        forget(p, s);
    }
}

/* zeta and alpha' = alpha - U ((1 - w) zeta). */
static void shrink(solver *s)
{
    double z[P];
    memcpy(z, s->alpha, sizeof z);
    memcpy(s->shrunk, s->alpha, sizeof z);
    for (int m = P - 1; m >= FIRST_SHRUNK; --m) {
        double taken = (1.0 - s->weight[m]) * z[m];
        for (int i = 0; i < m; ++i) {
            z[i] -= s->U[m][i] * z[m];
            s->shrunk[i] -= s->U[m][i] * taken;
        }
        s->shrunk[m] -= taken;
    }
    memcpy(s->zeta, z, sizeof z);
}

/* How much of each nested coefficient is kept; `at` is where the scores are. An order has to be
 * surer after one that is not believed. */
static void weigh(solver *s, double variance, const blocks *b, int at)
{
    shrink(s);
    double line = LARGEST * s->zeta[FIRST_SHRUNK - 1], line2 = line * line, threshold = FIRST;
    for (int m = FIRST_SHRUNK; m < P; ++m) {
        double v[P] = {0}, V = variance * s->d[m], z2 = s->zeta[m] * s->zeta[m], believed = 0.0;
        for (int i = 0; i <= m; ++i) {
            v[i] = s->d[m] * s->U[m][i];
        }
        double coloured = worst(b, at, P, v);
        V = coloured > V ? coloured : V;
        if (z2 > 0.0) {
            double r = threshold * V / z2;
            believed = 1.0 / (1.0 + r * r * r);
        }
        double w = believed * line2 / (line2 + V + 1e-300);
        s->weight[m] = w;
        s->lost2[m] = z2 > V ? (1.0 - w) * (1.0 - w) * (z2 - V) : 0.0;
        threshold = fmin(believed * NEXT + (1.0 - believed) * STEEPER * threshold, STEEPEST);
    }
    shrink(s);
}

/* c^T P c, P shrunk, for c without offset; `bias2` is the square of what shrinking may take,
 * `plain` the same without shrinking. */
static double spread(const solver *s, const double c[TERMS], double *bias2, double *plain)
{
    double total = 0.0, bias = 0.0, all = 0.0;
    for (int j = 1; j < P; ++j) {
        double x = c[j - 1];
        for (int i = 1; i < j; ++i) {
            x += s->U[j][i] * c[i - 1];
        }
        double own = s->d[j] * x * x;
        total += s->weight[j] * own;
        all += own;
        bias += s->lost2[j] * x * x;
    }
    *bias2 = bias;
    *plain = all;
    return total;
}

/* out = P c; c^T P c is returned. */
static double multiply(const solver *s, const double c[P], double out[P], double *bias2)
{
    double total = 0.0, bias = 0.0;
    for (int j = 0; j < P; ++j) {
        double x = c[j];
        for (int i = 0; i < j; ++i) {
            x += s->U[j][i] * c[i];
        }
        double kept = s->weight[j] * s->d[j] * x;
        for (int i = 0; i < j; ++i) {
            out[i] += s->U[j][i] * kept;
        }
        out[j] = kept;
        total += kept * x;
        bias += s->lost2[j] * x * x;
    }
    *bias2 = bias;
    return total;
}

#endif
