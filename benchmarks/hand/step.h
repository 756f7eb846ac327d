/* One sample of a joint: through the guard, then one or more steps of `estimate` and a read-out,
 * both defined by the file that includes this. */

#ifndef STEP_H
#define STEP_H

#include "guard.h"

void joint_init(const joint_params *p, joint_state *s);
void joint_step(const joint_params *p, joint_state *s, const joint_input *u, joint_reading *out);

void joint_init(const joint_params *p, joint_state *s)
{
    memset(s, 0, sizeof *s);
    s->guard.fresh = 1;
    for (int i = 0; i < TRANSMISSIONS; ++i) {
        start_transmission(&p->transmission[i], &s->transmission[i]);
    }
}

static void one_step(const joint_params *p, joint_state *s, const joint_input *u, int fresh,
                     joint_reading *out)
{
    estimate(p, s, u, fresh);
    read_out(p, s, u->time, 1, out);
}

void joint_step(const joint_params *p, joint_state *s, const joint_input *u, joint_reading *out)
{
    joint_input now = *u;
    int steps, status = judge_sample(p, &s->guard, &now, &steps);
    for (int k = 0; k < steps - 1; ++k) {
        joint_input mix = between(p, &s->guard, &now, k, steps);
        one_step(p, s, &mix, 0, out);
    }
    if (steps > 0) {
        one_step(p, s, &now, s->guard.fresh, out);
        s->guard.last = now;
        s->guard.fresh = 0;
    } else {
        read_out(p, s, 0.0, 0, out);
    }
    out->time = u->time;
    out->status |= status;
}

#endif
