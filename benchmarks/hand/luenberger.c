/* The acceleration-based observer of one joint behind its guard: motor position, torque and link
 * acceleration in, full state out. */

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Sums of four numbers are slower as vectors. */
#pragma GCC optimize("no-tree-vectorize")

enum { THETA, TORQUE, ACCELERATION, RATE, COUPLING, CHANNELS };
enum { PATIENCE = 10 };
enum {
    NOT_FINITE = 1, REPEATED = 2, BACKWARDS = 4, BRIDGED = 8, GAP = 16, JUMP = 32, RESTARTED = 128,
    SETTLING = 256, UNSEEN = 4194304
};

static const double BEYOND = 1e12;

typedef struct {
    double time, channel[CHANNELS], stiffness, bias, rest;
    int64_t seen;
} joint_input;

typedef struct {
    double time, theta, q, dtheta, dq, deflection, torque, transmission_torque, stiffness;
    int64_t status;
} joint_reading;

/* What drives the state at one instant, and how each of it enters: by columns. */
typedef struct {
    double theta[4], torque[4], acceleration[4], jerk[4];
} columns;

typedef struct {
    double period, per_period, jump, wrap;
    int64_t missing, held, settle;
    double transition[4][4];
    columns before, after;
    double gyro, per_inertia, d, c, damping, coulomb, width, per_width, stiffness, softest, stiffest;
    double change;
} joint_params;

typedef struct {
    double theta, torque, acceleration, pull; /* pull: k (q'' + gyro q') */
} drive;

typedef struct {
    joint_input last;
    int started, fresh, past;
    long accepted, bridged, refused, restarts;
    double w[4], stiffness, k, per_k, bias;
    int64_t count;
} joint_state;

void joint_init(const joint_params *p, joint_state *s);
void joint_step(const joint_params *p, joint_state *s, const joint_input *u, joint_reading *out);

static void use(const joint_params *p, joint_state *s, double stiffness)
{
    s->stiffness = stiffness;
    s->k = stiffness * p->per_inertia;
    s->per_k = 1.0 / s->k;
}

void joint_init(const joint_params *p, joint_state *s)
{
    memset(s, 0, sizeof *s);
    s->fresh = 1;
    use(p, s, p->stiffness);
}

static int restart(joint_state *s, int reason)
{
    s->restarts += !s->fresh;
    s->fresh = 1;
    return reason;
}

static int refusal(joint_state *s, const joint_input *u, double elapsed)
{
    int finite = isfinite(u->time);
    for (int i = 0; i < CHANNELS; ++i) {
        finite &= fabs(u->channel[i]) <= BEYOND;
    }
    if (!finite) {
        return NOT_FINITE;
    }
    if (!s->started || elapsed >= 0.5) {
        return 0;
    }
    if (elapsed >= -0.5) {
        return REPEATED;
    }
    if (++s->past >= PATIENCE) {
        s->started = 0;
        s->past = 0;
        s->restarts++;
    }
    return BACKWARDS;
}

/* Status bits of the sample; `steps` is how many periods it advances, 0 when it is refused. */
static int judge(const joint_params *p, joint_state *s, joint_input *u, int *steps)
{
    double elapsed = (u->time - s->last.time) * p->per_period;
    int status = refusal(s, u, elapsed);
    *steps = 0;
    if (status != 0) {
        s->refused++;
        return status;
    }
    int n = 1;
    if (!s->started) {
        s->fresh = 1;
    } else {
        if (p->wrap > 0.0) {
            double turns = (s->last.channel[THETA] - u->channel[THETA]) / p->wrap;
            if (fabs(turns) > 0.5 && fabs(turns) < 1e9) {
                u->channel[THETA] += p->wrap * (double)(int64_t)(turns + (turns > 0 ? 0.5 : -0.5));
            }
        }
        if (elapsed >= (double)p->missing + 1.5) {
            status = restart(s, GAP);
        } else if (!s->fresh) {
            n = (int)(elapsed + 0.5);
            if (fabs(u->channel[THETA] - s->last.channel[THETA]) > p->jump * n) {
                status = restart(s, JUMP);
            } else if (n > 1) {
                status = BRIDGED;
                s->bridged += n - 1;
            }
        }
    }
    if (s->fresh) {
        n = 1;
        status |= RESTARTED;
    }
    s->started = 1;
    s->past = 0;
    s->accepted++;
    *steps = n;
    return status;
}

static double stiffness_for(const joint_params *p, const joint_state *s, double asked, int *status)
{
    double stiffness = s->stiffness;
    if (fabs(asked) <= BEYOND) {
        stiffness = asked > 0.0 ? asked : p->stiffness;
    } else {
        *status |= NOT_FINITE;
    }
    stiffness = stiffness < p->softest ? p->softest : stiffness;
    return stiffness > p->stiffest ? p->stiffest : stiffness;
}

static void reschedule(const joint_params *p, joint_state *s, double stiffness)
{
    if (p->change > 0.0) {
        double most = s->stiffness * (1.0 + p->change), least = s->stiffness / (1.0 + p->change);
        stiffness = stiffness > most ? most : stiffness < least ? least : stiffness;
    }
    if (stiffness != s->stiffness) {
        double ratio = stiffness / s->stiffness, moving = p->d * s->w[3] * s->per_k;
        s->w[2] = ratio * (s->w[2] - moving) + moving;
        s->w[3] *= ratio;
        use(p, s, stiffness);
    }
}

static drive driven(const joint_params *p, const joint_state *s, const double *channel, double y,
                    double torque)
{
    double theta = channel[THETA];
    drive b = {theta, torque * p->per_inertia - s->k * theta, y, s->k * (y + p->gyro * channel[RATE])};
    return b;
}

static inline double pushed(const columns *c, const drive *b, int i)
{
    return c->theta[i] * b->theta + c->torque[i] * b->torque + c->acceleration[i] * b->acceleration
        + c->jerk[i] * b->pull;
}

static int one_step(const joint_params *p, joint_state *s, joint_input *u, int fresh)
{
    int status = 0;
    if (!u->seen) {
        u->channel[ACCELERATION] = 0.0;
        status = UNSEEN;
    }
    double stiffness = stiffness_for(p, s, u->stiffness, &status);
    int good = fabs(u->bias) <= BEYOND;
    status |= good && fabs(u->rest) <= BEYOND ? 0 : NOT_FINITE;
    s->bias = good ? u->bias : s->bias;
    if (fresh) {
        double theta = u->channel[THETA];
        use(p, s, stiffness);
        s->w[0] = theta;
        s->w[1] = p->c * theta;
        s->w[2] = s->k * (theta + (fabs(u->rest) <= BEYOND ? u->rest : 0.0));
        s->w[3] = 0.0;
        s->count = 0;
        return status | RESTARTED;
    }
    reschedule(p, s, stiffness);
    double known = s->bias;
    if (p->coulomb > 0.0) {
        double speed = s->w[1] - p->c * s->w[0];
        double share = fabs(speed) > p->width ? (speed > 0.0 ? 1.0 : -1.0) : speed * p->per_width;
        known -= p->coulomb * share;
    }
    const double *was = s->last.channel, *is = u->channel;
    double torque = p->held ? was[TORQUE] : is[TORQUE];
    drive b = driven(p, s, was, was[ACCELERATION], was[TORQUE] - was[COUPLING] + known);
    drive e = driven(p, s, is, is[ACCELERATION], torque - is[COUPLING] + known);
    double next[4];
    for (int i = 0; i < 4; ++i) {
        const double *a = p->transition[i];
        double free = a[0] * s->w[0] + a[1] * s->w[1] + a[2] * s->w[2] + a[3] * s->w[3];
        next[i] = free + (pushed(&p->before, &b, i) + pushed(&p->after, &e, i));
    }
    memcpy(s->w, next, sizeof next);
    s->count += s->count < p->settle;
    return status;
}

static void read_out(const joint_params *p, const joint_state *s, joint_reading *out)
{
    double dq = s->w[3] * s->per_k;
    out->theta = s->w[0];
    out->q = (s->w[2] - p->d * dq) * s->per_k;
    out->dtheta = s->w[1] - p->c * s->w[0];
    out->dq = dq;
    out->deflection = out->q - out->theta;
    out->torque = s->stiffness * out->deflection + s->bias;
    out->transmission_torque = out->torque + p->damping * (dq - out->dtheta);
    out->stiffness = s->stiffness;
}

void joint_step(const joint_params *p, joint_state *s, const joint_input *u, joint_reading *out)
{
    joint_input now = *u;
    int steps, status = judge(p, s, &now, &steps), told = 0;
    joint_input first = s->last;
    for (int n = 1; n <= steps; ++n) {
        joint_input mix = now;
        if (n < steps) {
            double part = (double)n / steps;
            for (int i = 0; i < CHANNELS; ++i) {
                mix.channel[i] = first.channel[i] + part * (now.channel[i] - first.channel[i]);
            }
        }
        told = one_step(p, s, &mix, s->fresh && n == 1);
        s->last = mix;
    }
    if (steps > 0) {
        s->fresh = 0;
    }
    read_out(p, s, out);
    out->time = u->time;
    out->status = told | status | (s->count < p->settle ? SETTLING : 0);
}
