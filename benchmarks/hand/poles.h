/* The operator: two equal poles. */

#ifndef OPERATOR_H
#define OPERATOR_H

#include "signals.h"

enum { EVERY = 1 };                           /* samples from one row to the next */

typedef struct {
    int64_t settle;
    double pole;
} operator_config;

typedef struct {
    double gain;
} operator_params;

typedef struct {
    int64_t count;                            /* sets of terms since a start */
    double first[SIGNALS], now[SIGNALS];      /* after one pole and after both */
} operator_state;

static void prepare_operator(operator_params *p, const operator_config *c)
{
    p->gain = 1.0 - c->pole;
}

static void start_operator(operator_state *s)
{
    s->count = 0;
}

static int settled(const operator_config *c, const operator_state *s)
{
    return s->count > c->settle;
}

/* 1: `now` is a row. */
static int operate(const operator_config *c, const operator_params *p, operator_state *s,
                   const double raw[SIGNALS])
{
    double g = p->gain;
    (void)c;
    if (s->count++ == 0) {
        memcpy(s->first, raw, sizeof s->first);
        memcpy(s->now, raw, sizeof s->now);
        return 1;
    }
    for (int h = 0; h < SIGNALS; ++h) {
        s->first[h] += g * (raw[h] - s->first[h]);
        s->now[h] += g * (s->first[h] - s->now[h]);
    }
    return 1;
}

#endif
