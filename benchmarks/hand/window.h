/* The operator: a window of LENGTH terms, weighed every EVERY of them. */

#ifndef OPERATOR_H
#define OPERATOR_H

#include "signals.h"

enum { LENGTH = 199, EVERY = 20, WIDE_ROW = (SIGNALS + 3) / 4 * 4 };

typedef struct {
    double weight[LENGTH];                    /* oldest first */
} operator_config;

typedef struct {
    double weight[LENGTH];                    /* oldest first */
} operator_params;

typedef struct {
    int head, wait, count;
    double ring[LENGTH][WIDE_ROW];
    double now[WIDE_ROW];
} operator_state;

static void prepare_operator(operator_params *p, const operator_config *c)
{
    memcpy(p->weight, c->weight, sizeof p->weight);
}

static void start_operator(operator_state *s)
{
    s->head = 0;
    s->count = 0;
    s->wait = LENGTH;
}

static int settled(const operator_config *c, const operator_state *s)
{
    (void)c;
    return s->count >= LENGTH;
}

/* From the oldest to the newest, all signals side by side: enough of them for vectors. */
__attribute__((optimize("tree-vectorize")))
static void weigh_terms(const operator_params *p, operator_state *s)
{
    double sum[WIDE_ROW] = {0};
    const double *w = p->weight;
    for (int k = s->head; k < LENGTH; ++k, ++w) {
        for (int h = 0; h < WIDE_ROW; ++h) {
            sum[h] += *w * s->ring[k][h];
        }
    }
    for (int k = 0; k < s->head; ++k, ++w) {
        for (int h = 0; h < WIDE_ROW; ++h) {
            sum[h] += *w * s->ring[k][h];
        }
    }
    memcpy(s->now, sum, sizeof sum);
}

/* 1: `now` is a row. */
static int operate(const operator_config *c, const operator_params *p, operator_state *s,
                   const double raw[SIGNALS])
{
    (void)c;
    memcpy(s->ring[s->head], raw, SIGNALS * sizeof *raw);
    s->head = s->head + 1 < LENGTH ? s->head + 1 : 0;
    s->count += s->count < LENGTH;
    if (--s->wait > 0) {
        return 0;
    }
    s->wait = EVERY;
    weigh_terms(p, s);
    return 1;
}

#endif
