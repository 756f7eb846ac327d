/* What becomes of a sample before the estimator sees it: accepted, bridged, restarted, refused. */

#ifndef GUARD_H
#define GUARD_H

#include "joint.h"

enum { PATIENCE = 10 };

static const double BEYOND = 1e12;

typedef struct {
    joint_input last;
    int started, fresh, past;
    long accepted, bridged, refused, restarts;
} guard;

static double unwrapped(double now, double last, double wrap)
{
    double turns = (last - now) / wrap;
    if (fabs(turns) > 0.5 && fabs(turns) < 1e9) {
        now += wrap * (double)(int64_t)(turns + (turns > 0.0 ? 0.5 : -0.5));
    }
    return now;
}

static int refusal(const joint_params *p, guard *g, const joint_input *u, double elapsed)
{
    int finite = isfinite(u->time);
    for (int i = 0; i < CHANNELS; ++i) {
        finite &= fabs(u->channel[i]) <= BEYOND;
    }
    if (!finite) {
        return NOT_FINITE;
    }
    for (int i = 0; i < TRANSMISSIONS; ++i) {
        double limit = p->c.torque_limit[i];
        if (limit > 0.0 && fabs(u->channel[TAU + i]) >= limit) {
            g->restarts += !g->fresh;
            g->fresh = 1;
            return SATURATED;
        }
    }
    if (!g->started || elapsed >= 0.5) {
        return 0;
    }
    if (elapsed >= -0.5) {
        return REPEATED;
    }
    if (++g->past >= PATIENCE) {
        g->started = 0;
        g->past = 0;
        g->restarts++;
    }
    return BACKWARDS;
}

static int restart(guard *g, int reason)
{
    g->restarts += !g->fresh;
    g->fresh = 1;
    return reason;
}

/* Status bits of the sample; `steps` is how many periods it advances, 0 when it is refused. */
static int judge_sample(const joint_params *p, guard *g, joint_input *u, int *steps)
{
    double elapsed = (u->time - g->last.time) * p->per_period;
    int status = refusal(p, g, u, elapsed);
    *steps = 0;
    if (status != 0) {
        g->refused++;
        return status;
    }
    int n = 1;
    if (!g->started) {
        g->fresh = 1;
    } else {
        for (int i = 0; i < ANGLES; ++i) {
            if (p->c.wrap[i] > 0.0) {
                u->channel[i] = unwrapped(u->channel[i], g->last.channel[i], p->c.wrap[i]);
            }
        }
        if (elapsed >= (double)p->c.missing + 1.5) {
            status = restart(g, GAP);
        } else if (!g->fresh) {
            n = (int)(elapsed + 0.5);
            double jump = p->c.jump * n;
            int jumped = 0;
            for (int i = 0; i < ANGLES; ++i) {
                jumped |= fabs(u->channel[i] - g->last.channel[i]) > jump;
            }
            if (jumped) {
                status = restart(g, JUMP);
            } else if (n > 1) {
                status = BRIDGED;
                g->bridged += n - 1;
            }
        }
    }
    if (g->fresh) {
        n = 1;
        status |= RESTARTED;
    }
    g->started = 1;
    g->past = 0;
    g->accepted++;
    *steps = n;
    return status;
}

/* Step k of `steps` on the straight line from the last good sample to this one. */
static joint_input between(const joint_params *p, const guard *g, const joint_input *u, int k,
                           int steps)
{
    double part = (k + 1.0) / steps;
    joint_input mix = *u;
    mix.time = u->time - (steps - 1.0 - k) * p->c.period;
    for (int i = 0; i < CHANNELS; ++i) {
        mix.channel[i] = g->last.channel[i] + part * (u->channel[i] - g->last.channel[i]);
    }
    return mix;
}

#endif
