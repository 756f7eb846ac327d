/* A transmission's rows: its motor's balance, tested with hats and put through the operator. */

#ifndef ROWS_H
#define ROWS_H

#include "joint.h"

typedef struct {
    double zero, zero_total;
    int64_t zero_count;
    int64_t count;                            /* samples since a start */
    int status, due;                          /* due: this sample has a row */
    double q1, q2, theta1, theta2, tau1, tau2, F1[TERMS], F2[TERMS];
    operator_state operator;                  /* operator.now: the row */
    double phi, F[TERMS], D[TERMS], H[TERMS]; /* the basis now; the offset's are zero */
} rows;

static double hat(double before, double middle, double after)
{
    return (before + 10.0 * middle + after) * (1.0 / 12.0);
}

/* 1 once the zero is known: the mean of the first samples' deflections. */
static int find_zero(const transmission_params *p, rows *s, double raw, int fresh)
{
    if (s->zero_count >= p->c.zero_samples) {
        return 1;
    }
    if (fresh) {
        s->zero_total = 0.0;
        s->zero_count = 0;
    }
    s->zero_total += raw;
    s->zero_count++;
    s->zero = s->zero_total / (double)s->zero_count;
    return 0;
}

static void evaluate_basis(const transmission_params *p, rows *s, double phi)
{
    double x = phi * p->per_range, x2 = x * x, odd = x, even = p->per_range;
    s->phi = phi;
    s->F[0] = x;
    s->D[0] = p->per_range;
    s->H[0] = 0.0;
    for (int h = 1; h < TERMS; ++h) {
        int n = 2 * h + 1;
        s->H[h] = n * (n - 1) * p->per_range2 * odd;
        odd *= x2;
        even *= x2;
        s->F[h] = odd;
        s->D[h] = n * even;
    }
}

static int make_row(const transmission_params *p, rows *s, double q, double theta, double tau)
{
    double raw[SIGNALS];
    double mean = p->c.held ? 0.5 * (s->tau2 + s->tau1) : hat(s->tau2, s->tau1, tau);
    double acceleration = (theta - 2.0 * s->theta1 + s->theta2) * p->per_period2;
    double velocity = (theta - s->theta2) * p->per_two_periods;
    raw[Y] = p->c.inertia * acceleration + p->c.damping * velocity - mean;
    raw[PULL] = acceleration;
    raw[DRAG] = q - s->q2;
    raw[R] = 1.0;
    for (int h = 0; h < TERMS; ++h) {
        raw[R + 1 + h] = hat(s->F2[h], s->F1[h], s->F[h]);
    }
    return operate(&p->c.operator, &p->operator, &s->operator, raw);
}

static void next_row(const transmission_params *p, rows *s, double q, double theta, double tau,
                     int enable, int fresh)
{
    double raw = q - theta;
    if (!find_zero(p, s, raw, fresh) || fresh) {
        s->count = 0;
        start_operator(&s->operator);
    }
    evaluate_basis(p, s, raw - s->zero);
    s->due = s->count >= 2 && make_row(p, s, q, theta, tau);
    s->q2 = s->q1;
    s->q1 = q;
    s->theta2 = s->theta1;
    s->theta1 = theta;
    s->tau2 = s->tau1;
    s->tau1 = tau;
    memcpy(s->F2, s->F1, sizeof s->F2);
    memcpy(s->F1, s->F, sizeof s->F1);
    s->count++;
    s->status = settled(&p->c.operator, &s->operator) ? 0 : SETTLING;
    s->status |= enable ? 0 : DISABLED;
    s->due &= s->status == 0;
}

#endif
