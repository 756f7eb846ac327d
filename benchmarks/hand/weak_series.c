#include "weak_series.h"

#include <math.h>
#include <string.h>

enum {
    NOT_FINITE = 1, REPEATED = 2, BACKWARDS = 4, BRIDGED = 8, GAP = 16, JUMP = 32, SATURATED = 64,
    RESTARTED = 128, SETTLING = 256, DISABLED = 512, WIDE = 1024, PRIOR = 2048, DEFLECTION = 4096,
    LAG = 8192, INERTIA = 16384, OFFSET = 32768, DRIFT = 65536, NEGATIVE = 131072,
    VELOCITY = 262144
};
enum { STARVED, CONVERGING, INFORMATIVE, INCONSISTENT };
enum { MEAN, SHIFT, PULL, SCALE, DRAG };
enum { PATIENCE = 10, DUE = 8, STREAK = 3, SETTLED = 8 };

static const double ENOUGH = 8.0, CONFIDENT = 2.5, BEYOND = 1e12;

/* The basis and its derivatives at one deflection; the offset's are zero. */
typedef struct {
    double phi, F[TERMS], D[TERMS], H[TERMS];
} basis;

void weak_series_prepare(weak_series_params *p, const weak_series_config *c)
{
    p->c = *c;
    p->per_period = 1.0 / c->period;
    p->per_range = 1.0 / c->range;
    p->per_range2 = p->per_range * p->per_range;
    p->per_period2 = p->per_period * p->per_period;
    p->per_two_periods = 0.5 * p->per_period;
    p->gain = 1.0 - c->pole;
    p->per_forgetting = 1.0 / c->forgetting;
    p->share = c->forgetting < 1.0 ? c->prior / (P * (1.0 - c->forgetting)) : 0.0;
}

void weak_series_init(const weak_series_params *p, weak_series_state *s)
{
    memset(s, 0, sizeof *s);
    s->fresh = 1;
    s->inflation = 1.0;
    for (int i = 0; i < P; ++i) {
        s->d[i] = p->c.prior;
        s->U[i][i] = 1.0;
    }
}

/* ---- guard ---- */

static double unwrapped(double now, double last, double wrap)
{
    if (wrap > 0.0) {
        double turns = (last - now) / wrap;
        if (fabs(turns) > 0.5 && fabs(turns) < 1e9) {
            now += wrap * (double)(int64_t)(turns + (turns > 0.0 ? 0.5 : -0.5));
        }
    }
    return now;
}

/* Status bits of the sample; `steps` is how many periods it advances, 0 when it is refused. */
static int judge_sample(const weak_series_params *p, weak_series_state *s, weak_series_input *u,
                        int *steps)
{
    int status = 0;
    *steps = 0;
    if (!isfinite(u->time) || !(fabs(u->q) <= BEYOND) || !(fabs(u->theta) <= BEYOND)
        || !(fabs(u->tau) <= BEYOND)) {
        s->refused++;
        return NOT_FINITE;
    }
    if (p->c.torque_limit > 0.0 && fabs(u->tau) >= p->c.torque_limit) {
        s->refused++;
        s->restarts += !s->fresh;
        s->fresh = 1;
        return SATURATED;
    }
    int n = 1;
    if (s->started) {
        double elapsed = (u->time - s->last_time) * p->per_period;
        if (elapsed < -0.5) {
            s->refused++;
            if (++s->past >= PATIENCE) {
                s->started = 0;
                s->past = 0;
                s->restarts++;
            }
            return BACKWARDS;
        }
        if (elapsed < 0.5) {
            s->refused++;
            return REPEATED;
        }
        if (elapsed > (double)p->c.missing + 1.5) {
            status |= GAP;
            s->fresh = 1;
            s->restarts++;
        } else {
            n = (int)(elapsed + 0.5);
            u->q = unwrapped(u->q, s->last_q, p->c.wrap_q);
            u->theta = unwrapped(u->theta, s->last_theta, p->c.wrap_theta);
            double jump = p->c.jump * n;
            if (fabs(u->q - s->last_q) > jump || fabs(u->theta - s->last_theta) > jump) {
                status |= JUMP;
                s->fresh = 1;
                s->restarts++;
                n = 1;
            }
            if (n > 1) {
                status |= BRIDGED;
                s->bridged += n - 1;
            }
        }
    } else {
        s->fresh = 1;
    }
    if (s->fresh) {
        status |= RESTARTED;
        s->last_q = u->q;
        s->last_theta = u->theta;
        s->last_tau = u->tau;
    }
    s->started = 1;
    s->past = 0;
    s->accepted++;
    *steps = n;
    return status;
}

/* ---- rows ---- */

static double hat(double before, double middle, double after)
{
    return (before + 10.0 * middle + after) * (1.0 / 12.0);
}

/* 1 once the zero is known: the mean of the first samples' deflections. */
static int find_zero(const weak_series_params *p, weak_series_state *s, double raw)
{
    if (s->zero_count >= p->c.zero_samples) {
        return 1;
    }
    s->zero_total += raw;
    s->zero_count++;
    s->zero = s->zero_total / (double)s->zero_count;
    return 0;
}

static void evaluate(const weak_series_params *p, double phi, basis *b)
{
    double x = phi * p->per_range, x2 = x * x, x3 = x2 * x;
    b->phi = phi;
    b->F[0] = x;
    b->F[1] = x3;
    b->F[2] = x3 * x2;
    b->D[0] = p->per_range;
    b->D[1] = 3.0 * x2 * p->per_range;
    b->D[2] = 5.0 * x2 * x2 * p->per_range;
    b->H[0] = 0.0;
    b->H[1] = 6.0 * x * p->per_range2;
    b->H[2] = 20.0 * x3 * p->per_range2;
}

/* Put the balance, tested with hats, through the low-pass: s->y and s->R. */
static void filter_row(const weak_series_params *p, weak_series_state *s,
                       const weak_series_input *u, const basis *b)
{
    double raw[P];
    double tau = p->c.held ? 0.5 * (s->tau2 + s->tau1) : hat(s->tau2, s->tau1, u->tau);
    double acceleration = (u->theta - 2.0 * s->theta1 + s->theta2) * p->per_period2;
    double velocity = (u->theta - s->theta2) * p->per_two_periods;
    double y = p->c.inertia * acceleration + p->c.damping * velocity - tau;
    double drag = u->q - s->q2;
    for (int h = 0; h < TERMS; ++h) {
        raw[h] = hat(s->F2[h], s->F1[h], b->F[h]);
    }
    raw[TERMS] = 1.0;
    if (s->count == 2) {
        s->y_first = s->y = y;
        s->pull_first = s->pull = acceleration;
        s->drag_first = s->drag = drag;
        memcpy(s->R_first, raw, sizeof raw);
        memcpy(s->R, raw, sizeof raw);
    }
    s->y_first += p->gain * (y - s->y_first);
    s->y += p->gain * (s->y_first - s->y);
    s->pull_first += p->gain * (acceleration - s->pull_first);
    s->pull += p->gain * (s->pull_first - s->pull);
    s->drag_first += p->gain * (drag - s->drag_first);
    s->drag += p->gain * (s->drag_first - s->drag);
    for (int h = 0; h < P; ++h) {
        s->R_first[h] += p->gain * (raw[h] - s->R_first[h]);
        s->R[h] += p->gain * (s->R_first[h] - s->R[h]);
    }
}

static void remember(weak_series_state *s, const weak_series_input *u, const basis *b)
{
    s->q2 = s->q1;
    s->q1 = u->q;
    s->theta2 = s->theta1;
    s->theta1 = u->theta;
    s->tau2 = s->tau1;
    s->tau1 = u->tau;
    memcpy(s->F2, s->F1, sizeof s->F2);
    memcpy(s->F1, b->F, sizeof s->F1);
    s->count++;
}

/* ---- least squares ---- */

/* Bierman's update for innovation e and f = U^T R; returns R^T P R. */
static double absorb(weak_series_state *s, const double f[P], double e, double variance)
{
    double g[P], a = variance, per_a = 1.0 / variance;
    for (int j = 0; j < P; ++j) {
        double v = s->d[j] * f[j], b = a, k = -f[j] * per_a;
        a += f[j] * v;
        per_a = 1.0 / a;
        s->d[j] *= b * per_a;
        g[j] = v;
        for (int i = 0; i < j; ++i) {
            double old = s->U[i][j];
            s->U[i][j] = old + g[i] * k;
            g[i] += v * old;
        }
    }
    for (int i = 0; i < P; ++i) {
        s->alpha[i] += g[i] * (e * per_a);
    }
    return a - variance;
}

static void forget(const weak_series_params *p, weak_series_state *s)
{
    double f[P];
    int j = s->turn;
    for (int i = 0; i < P; ++i) {
        s->d[i] *= p->per_forgetting;
        f[i] = s->U[j][i];
    }
    absorb(s, f, -s->alpha[j], p->share);
    s->turn = (j + 1) % P;
}

static void learn(const weak_series_params *p, weak_series_state *s)
{
    double f[P], e = s->y;
    for (int j = 0; j < P; ++j) {
        e -= s->R[j] * s->alpha[j];
        f[j] = s->R[j];
        for (int i = 0; i < j; ++i) {
            f[j] += s->U[i][j] * s->R[i];
        }
    }
    s->innovation = e;
    s->leverage = absorb(s, f, e, 1.0);
    s->rows++;
    if (p->c.forgetting < 1.0) {
        forget(p, s);
    }
}

/* c^T P c for a direction of basis terms. */
static double spread(const weak_series_state *s, const double c[TERMS])
{
    double total = 0.0;
    for (int j = 0; j < P; ++j) {
        double x = j < TERMS ? c[j] : 0.0;
        for (int i = 0; i < j; ++i) {
            x += s->U[i][j] * c[i];
        }
        total += s->d[j] * x * x;
    }
    return total;
}

static void multiply(const weak_series_state *s, const double c[P], double out[P])
{
    for (int j = 0; j < P; ++j) {
        double x = c[j];
        for (int i = 0; i < j; ++i) {
            x += s->U[i][j] * c[i];
        }
        x *= s->d[j];
        for (int i = 0; i < j; ++i) {
            out[i] += s->U[i][j] * x;
        }
        out[j] = x;
    }
}

/* ---- noise level and tests of the model ---- */

static void probe(const weak_series_params *p, weak_series_state *s, double after)
{
    int middle = (s->head - (int)p->c.lag) & (RING - 1);
    int first = (middle - (int)p->c.lag) & (RING - 1);
    double e = s->e[middle], f = s->f[middle], before = s->f[first];
    double shift = after - before, pull = s->pulls[middle], drag = s->drags[middle];
    double *open = s->open, *part = s->part + P;
    open[0] += 1.0;
    open[1] += f;
    open[2] += f * f;
    open[3] += pull * f;
    open[4] += shift * shift;
    open[5] += pull * pull;
    open[6] += drag * f;
    open[7] += drag * drag;
    part[MEAN] += e;
    part[SHIFT] += e * shift;
    part[PULL] += e * pull - p->c.common;
    part[SCALE] += e * f;
    part[DRAG] += e * drag;
}

/* Fade what the tests remember and add the open block's sums to it. */
static void fold(const weak_series_params *p, weak_series_state *s)
{
    double m = p->c.memory;
    for (int i = 0; i < PROBES; ++i) {
        s->probe[i] = m * s->probe[i] + s->part[P + i];
    }
    s->weight = m * s->weight + s->open[0];
    s->torque = m * s->torque + s->open[1];
    s->torque2 = m * s->torque2 + s->open[2];
    s->cross = m * s->cross + s->open[3];
    s->shift2 = m * s->shift2 + s->open[4];
    s->pull2 = m * s->pull2 + s->open[5];
    s->drag_cross = m * s->drag_cross + s->open[6];
    s->drag2 = m * s->drag2 + s->open[7];
    memset(s->open, 0, sizeof s->open);
}

static void add_evidence(const weak_series_params *p, weak_series_state *s)
{
    double shrink = 1.0 / (1.0 + s->leverage), e = s->innovation * shrink, f = 0.0;
    s->squares = p->c.forgetting * s->squares + s->innovation * e;
    s->weight_rows = p->c.forgetting * s->weight_rows + 1.0;
    for (int i = 0; i < P; ++i) {
        s->part[i] += e * s->R[i];
    }
    for (int i = 0; i < TERMS; ++i) {
        f += s->R[i] * s->alpha[i];
    }
    s->e[s->head] = e;
    s->f[s->head] = f;
    s->pulls[s->head] = s->pull;
    s->drags[s->head] = s->drag;
    if (s->length <= 2 * p->c.lag) {
        s->length++;
    }
    if (s->length > 2 * p->c.lag && s->evaluated >= SETTLED) {
        probe(p, s, f);
    }
    s->head = (s->head + 1) & (RING - 1);
    s->filled++;
}

static void square_block(const weak_series_params *p, weak_series_state *s, int k)
{
    double fade = p->c.fade[k], *square = s->square[k];
    s->blocks[k] = fade * s->blocks[k] + 1.0;
    for (int i = 0; i < P; ++i) {
        for (int j = i; j < P; ++j, ++square) {
            *square = fade * *square + s->part[i] * s->part[j];
        }
    }
    fade = p->c.fade_probe[k];
    s->blocks_probe[k] = fade * s->blocks_probe[k] + 1.0;
    for (int i = P; i < P + PROBES; ++i, ++square) {
        *square = fade * *square + s->part[i] * s->part[i];
    }
}

static void close_block(const weak_series_params *p, weak_series_state *s)
{
    for (int k = 0; k < LEVELS; ++k) {
        square_block(p, s, k);
        s->waiting[k] = !s->waiting[k];
        if (s->waiting[k]) {
            memcpy(s->carry[k], s->part, sizeof s->part);
            break;
        }
        for (int i = 0; i < P + PROBES; ++i) {
            s->part[i] += s->carry[k][i];
        }
    }
    memset(s->part, 0, sizeof s->part);
    s->filled = 0;
    s->closed++;
}

/* What follows is not adjacent to what came before. */
static void start_afresh(weak_series_state *s)
{
    s->length = 0;
    memset(s->open, 0, sizeof s->open);
    memset(s->part, 0, sizeof s->part);
    memset(s->waiting, 0, sizeof s->waiting);
    s->filled = 0;
}

/* Variance of the scores' sum along a direction: the largest over levels with enough blocks. */
static double worst(const weak_series_state *s, const double v[P])
{
    double largest = 0.0;
    for (int k = 0; k < LEVELS && s->blocks[k] > 0.0; ++k) {
        if (s->blocks[k] >= ENOUGH) {
            const double *square = s->square[k];
            double n1 = s->blocks[k] - 1.0, t = 1.0 + 1.42 / n1, total = 0.0;
            for (int i = 0; i < P; ++i) {
                total += *square++ * v[i] * v[i];
                for (int j = i + 1; j < P; ++j) {
                    total += 2.0 * *square++ * v[i] * v[j];
                }
            }
            total *= t * t * s->blocks[k] / n1;
            largest = total > largest ? total : largest;
        }
    }
    return largest;
}

static double ratio(double top, double bottom)
{
    return bottom > 0.0 ? top / bottom : 0.0;
}

static void test_model(weak_series_state *s)
{
    const double *a = s->probe, n = s->weight, tiny = 1e-300;
    double power = s->torque2 - s->torque * s->torque / (n + tiny);
    double floor = 1e-12 * s->torque2 + tiny;
    power = power < floor ? floor : power;
    for (int i = 0; i < PROBES; ++i) {
        double largest = 0.0;
        for (int k = 0; k < LEVELS && s->blocks_probe[k] > 0.0; ++k) {
            double square = s->square[k][PRODUCTS + i];
            if (s->blocks_probe[k] >= ENOUGH && square > largest) {
                largest = square;
            }
        }
        s->doubt[i] = largest > 0.0 ? fabs(a[i]) / sqrt(largest) : 0.0;
    }
    double pull2 = s->pull2 - s->cross * s->cross / (s->torque2 + tiny);
    s->share[MEAN] = ratio(a[MEAN] * a[MEAN], (n + tiny) * power);
    s->share[SHIFT] = ratio(a[SHIFT] * a[SHIFT], s->shift2 * power);
    s->share[PULL] = ratio(fabs(a[PULL] * s->cross), pull2 * power);
    double drag2 = s->drag2 - s->drag_cross * s->drag_cross / (s->torque2 + tiny);
    s->share[DRAG] = ratio(fabs(a[DRAG] * s->drag_cross), drag2 * power);
    s->share[SCALE] = ratio(fabs(a[SCALE]), power);
}

/* Bound of the bias along v = P c from the encoders' noise in the first column. */
static double bias_along(const weak_series_params *p, const weak_series_state *s, const double v[P])
{
    return fabs(v[0] * s->weight_rows * p->c.noise * s->alpha[0]);
}

static void renew_coefficient(const weak_series_params *p, weak_series_state *s)
{
    double unit[P] = {0}, v[P];
    int j = s->std_turn;
    unit[j] = 1.0;
    multiply(s, unit, v);
    double own = s->variance * v[j], coloured = worst(s, v);
    double shift = bias_along(p, s, v);
    s->std[j] = sqrt((coloured > own ? coloured : own) + shift * shift);
    s->std_turn = (j + 1) % P;
}

static double deviation(const weak_series_state *s, double spread_, double value, double shift)
{
    /* Not judged yet: the residuals so far, or anything while there is none. */
    double early = s->weight_rows > 0.0 ? s->squares / s->weight_rows : 1.0;
    double noise = s->inflation * (s->evaluated ? s->variance : early) * spread_;
    return sqrt(noise + value * value * s->relative + shift * shift);
}

static void set_wrong(const weak_series_params *p, weak_series_state *s, double relative)
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

/* Every DUE blocks: noise level, inflation, informative deflection, tests. */
static void renew(const weak_series_params *p, weak_series_state *s, const basis *b)
{
    double D[P] = {b->D[0], b->D[1], b->D[2], 0.0}, v[P], q = 0.0, stiffness = 0.0;
    s->evaluated++;
    if (s->weight_rows > P) {
        s->variance = s->squares / (s->weight_rows - P);
    }
    multiply(s, D, v);
    for (int i = 0; i < TERMS; ++i) {
        q += D[i] * v[i];
        stiffness += D[i] * s->alpha[i];
    }
    s->inflation = 1.0;
    if (q > 0.0 && s->variance > 0.0) {
        double own = s->variance * q, coloured = worst(s, v);
        s->inflation = coloured > own ? coloured / own : 1.0;
        s->deflection = sqrt(1.0 / (s->weight_rows * q));
    }
    s->shift = bias_along(p, s, v);
    test_model(s);
    renew_coefficient(p, s);
    s->noise = sqrt(s->variance);
    s->relative = 0.0;
    if (s->deflection > 0.0) {
        double accuracy = p->c.accuracy / s->deflection;
        s->relative = accuracy * accuracy;
    }
    set_wrong(p, s, 1.96 * deviation(s, q, stiffness, s->shift) / (fabs(stiffness) + 1e-300));
}

/* ---- read-out ---- */

static void decide(const weak_series_params *p, weak_series_state *s, const basis *b,
                   double sigma_spread, int status, weak_series_reading *r)
{
    double prior = 0.0, half = 1.96 * r->stiffness_std;
    int wrong = s->wrong, verdict = CONVERGING;
    for (int i = 0; i < TERMS; ++i) {
        prior += b->D[i] * b->D[i];
    }
    if (s->evaluated == 0 || sigma_spread > p->c.shrink * p->c.prior * prior) {
        status |= PRIOR;
    } else if (r->stiffness + 3.0 * r->stiffness_std < 0.0) {
        wrong |= NEGATIVE;
    }
    if (half > p->c.starved * fabs(r->stiffness)) {
        status |= WIDE;
        if (1.96 * p->c.accuracy > p->c.starved * s->deflection) {
            status |= DEFLECTION;
        }
    }
    s->narrow = half < p->c.informative * r->stiffness ? s->narrow + 1 : 0;
    if (status & (PRIOR | WIDE)) {
        verdict = STARVED;
    } else if ((double)s->narrow * p->c.period >= p->c.hold) {
        verdict = INFORMATIVE;
    }
    if (wrong) {
        verdict = INCONSISTENT;
    }
    r->verdict = verdict;
    r->status = status | wrong;
}

static void note_convergence(const weak_series_params *p, weak_series_state *s, double time)
{
    weak_series_reading *r = &s->reading;
    if (r->verdict == INFORMATIVE) {
        if (s->good == 0) {
            s->since = time;
        }
        s->good++;
        if (!s->converged && (double)s->good * p->c.period >= p->c.hold) {
            s->converged = 1;
            s->converged_at = s->since;
        }
    } else {
        s->good = 0;
    }
    r->converged = s->converged;
    r->converged_at = s->converged_at;
}

static void read_out(const weak_series_params *p, weak_series_state *s, const basis *b, double time,
                     int status)
{
    weak_series_reading *r = &s->reading;
    double stiffness = 0.0, torque = 0.0, slope = 0.0, fit = s->R[TERMS] * s->alpha[TERMS];
    for (int i = 0; i < TERMS; ++i) {
        stiffness += b->D[i] * s->alpha[i];
        torque += b->F[i] * s->alpha[i];
        slope += b->H[i] * s->alpha[i];
        fit += s->R[i] * s->alpha[i];
    }
    double sigma_spread = spread(s, b->D);
    r->time = time;
    r->stiffness = stiffness;
    r->torque = torque;
    r->dstiffness = slope;
    r->stiffness_std = deviation(s, sigma_spread, stiffness, s->shift);
    r->torque_std = deviation(s, spread(s, b->F), torque, 0.0);
    r->deflection = b->phi;
    r->row_torque = s->y;
    r->row_fit = fit;
    r->noise = s->noise;
    r->inflation = s->inflation;
    r->informative_deflection = s->deflection;
    r->rows = s->rows;
    memcpy(r->coefficients, s->alpha, sizeof s->alpha);
    memcpy(r->coefficients_std, s->std, sizeof s->std);
    decide(p, s, b, sigma_spread, status, r);
    note_convergence(p, s, time);
}

/* ---- one sample ---- */

static void estimate(const weak_series_params *p, weak_series_state *s, const weak_series_input *u,
                     int fresh)
{
    basis b;
    double raw = u->q - u->theta;
    int status = 0;
    if (fresh) {
        s->count = 0;
    }
    if (!find_zero(p, s, raw)) {
        s->count = 0;
    }
    evaluate(p, raw - s->zero, &b);
    if (s->count >= 2) {
        filter_row(p, s, u, &b);
    }
    remember(s, u, &b);
    if (s->count <= 1) {
        start_afresh(s);
    }
    if (s->count <= p->c.settle) {
        status |= SETTLING;
    }
    if (!u->enable) {
        status |= DISABLED;
    }
    if (status == 0) {
        learn(p, s);
        add_evidence(p, s);
        if (s->filled >= p->c.block) {
            fold(p, s);
            close_block(p, s);
            if (s->closed >= (s->evaluated + 1) * DUE) {
                renew(p, s, &b);
            }
        }
    }
    read_out(p, s, &b, u->time, status);
}

void weak_series_step(const weak_series_params *p, weak_series_state *s,
                      const weak_series_input *u, weak_series_reading *out)
{
    weak_series_input now = *u;
    int steps, status = judge_sample(p, s, &now, &steps);
    for (int k = 0; k < steps - 1; ++k) {
        double part = (k + 1.0) / steps;
        weak_series_input mix = now;
        mix.time = now.time - (steps - 1.0 - k) * p->c.period;
        mix.q = s->last_q + part * (now.q - s->last_q);
        mix.theta = s->last_theta + part * (now.theta - s->last_theta);
        mix.tau = s->last_tau + part * (now.tau - s->last_tau);
        estimate(p, s, &mix, k == 0 && s->fresh);
    }
    if (steps > 0) {
        estimate(p, s, &now, steps == 1 && s->fresh);
        s->last_time = now.time;
        s->last_q = now.q;
        s->last_theta = now.theta;
        s->last_tau = now.tau;
        s->fresh = 0;
    }
    *out = s->reading;
    out->time = u->time;
    out->status = s->reading.status | status;
}
