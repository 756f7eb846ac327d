/* The estimator of the benchmark, written by hand for one configuration: a series joint, torque
 * from its motor without Coulomb friction, method `weak`, basis phi, phi^3, phi^5 and a torque
 * offset, UD least squares.
 * Same algorithm and same results as rotatum's stage for it. */

#ifndef WEAK_SERIES_H
#define WEAK_SERIES_H

#include <stdint.h>

enum { TERMS = 3, P = 4, LEVELS = 20, RING = 64, PROBES = 5, MOMENTS = 8, PRODUCTS = P * (P + 1) / 2 };

typedef struct {
    double time, q, theta, tau;
    int64_t enable;
} weak_series_input;

typedef struct {
    double time;
    double stiffness, stiffness_std, torque, torque_std, dstiffness;
    double deflection, row_torque, row_fit;
    double noise, inflation, informative_deflection, converged_at;
    int64_t converged, verdict, status, rows;
    double coefficients[P], coefficients_std[P];
} weak_series_reading;

/* What the caller gives. */
typedef struct {
    double period;
    int64_t missing;                          /* samples bridged in a row */
    double jump, torque_limit;                /* rad per sample; N m, 0: none */
    double wrap_q, wrap_theta;                /* rad, 0: not modulo */
    int64_t zero_samples, settle, held;
    double range;                             /* deflection at x = 1 */
    double pole, inertia, damping;
    double forgetting, memory, prior;
    int64_t lag, block;
    double common, accuracy, noise, bias;     /* noise: variance in the first column */
    double starved, informative, hold, shrink;
    double fade[LEVELS], fade_probe[LEVELS];
} weak_series_config;

/* The same with everything that need not be computed at every sample. */
typedef struct {
    weak_series_config c;
    double per_period, per_range, per_range2, per_period2, per_two_periods;
    double gain, per_forgetting, share;
} weak_series_params;

typedef struct {
    /* guard */
    double last_time, last_q, last_theta, last_tau;
    int started, fresh, past;
    long accepted, bridged, refused, restarts;
    /* zero of the deflection */
    double zero, zero_total;
    int64_t zero_count;
    /* rows */
    int64_t count;
    double q1, q2, theta1, theta2, tau1, tau2;
    double F1[TERMS], F2[TERMS];
    double y_first, y, pull_first, pull, drag_first, drag, R_first[P], R[P];
    /* least squares: P = U diag(d) U^T */
    double alpha[P], U[P][P], d[P];
    double innovation, leverage;
    int64_t rows;
    int turn;
    /* noise level and tests of the model */
    double weight_rows, squares, variance, inflation, deflection, relative, shift, noise;
    double std[P];
    int64_t evaluated;
    int std_turn, head, length, wrong, streak[PROBES];
    double e[RING], f[RING], pulls[RING], drags[RING], open[MOMENTS];
    double weight, torque, torque2, cross, drag_cross, drag2, probe[PROBES], shift2, pull2;
    double share[PROBES], doubt[PROBES];
    /* sums over blocks of doubling length */
    double part[P + PROBES], carry[LEVELS][P + PROBES];
    double square[LEVELS][PRODUCTS + PROBES], blocks[LEVELS], blocks_probe[LEVELS];
    int waiting[LEVELS], filled;
    int64_t closed;
    /* verdict */
    int64_t narrow, good;
    int converged;
    double since, converged_at;
    weak_series_reading reading;
} weak_series_state;

void weak_series_prepare(weak_series_params *p, const weak_series_config *c);
void weak_series_init(const weak_series_params *p, weak_series_state *s);
void weak_series_step(const weak_series_params *p, weak_series_state *s,
                      const weak_series_input *u, weak_series_reading *out);

#endif
