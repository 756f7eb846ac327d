/* Sums over blocks of doubling length: how much a mean of coloured terms really varies. */

#ifndef BLOCKS_H
#define BLOCKS_H

#include "joint.h"

enum { DUE = 8, SETTLED = 8 };                /* blocks between evaluations; evaluations */

static const double ENOUGH = 8.0;

typedef struct {
    double part[SUMS];                        /* scores of all transmissions, then their probes */
    double carry[LEVELS][SUMS];
    double square[LEVELS][PRODUCTS], square_probe[LEVELS][SUMS - SCORES];
    double number[LEVELS], number_probe[LEVELS];
    double correction[LEVELS];                /* for few blocks, as of the last evaluation */
    int waiting[LEVELS], filled, levels;      /* levels: those with enough blocks */
    int64_t closed, evaluated;
} blocks;

static void clear_blocks(blocks *b)
{
    memset(b->part, 0, sizeof b->part);
    memset(b->waiting, 0, sizeof b->waiting);
    b->filled = 0;
}

static void square_block(const joint_params *p, blocks *b, int k)
{
    double fade = p->c.fade[k], *square = b->square[k];
    b->number[k] = fade * b->number[k] + 1.0;
    for (int i = 0; i < SCORES; ++i) {
        for (int j = i; j < SCORES; ++j, ++square) {
            *square = fade * *square + b->part[i] * b->part[j];
        }
    }
    fade = p->c.fade_probe[k];
    b->number_probe[k] = fade * b->number_probe[k] + 1.0;
    for (int i = 0; i < SUMS - SCORES; ++i) {
        double x = b->part[SCORES + i];
        b->square_probe[k][i] = fade * b->square_probe[k][i] + x * x;
    }
}

static void close_block(const joint_params *p, blocks *b)
{
    for (int k = 0; k < LEVELS; ++k) {
        square_block(p, b, k);
        b->waiting[k] = !b->waiting[k];
        if (b->waiting[k]) {
            memcpy(b->carry[k], b->part, sizeof b->part);
            break;
        }
        for (int i = 0; i < SUMS; ++i) {
            b->part[i] += b->carry[k][i];
        }
    }
    memset(b->part, 0, sizeof b->part);
    b->filled = 0;
    b->closed++;
}

/* 1 every DUE blocks, with what all questions of that evaluation share. */
static int due(blocks *b)
{
    if (b->closed < (b->evaluated + 1) * DUE) {
        return 0;
    }
    b->evaluated++;
    b->levels = 0;
    while (b->levels < LEVELS && b->number[b->levels] >= ENOUGH) {
        double n = b->number[b->levels], per = 1.0 / (n - 1.0), t = 1.0 + 1.42 * per;
        b->correction[b->levels++] = t * t * n * per;
    }
    return 1;
}

/* Variance of the sum of n scores from `at` on along a direction: the largest over levels. */
static inline double worst(const blocks *b, int at, int n, const double v[])
{
    double largest = 0.0;
    int first = at * SCORES - at * (at - 1) / 2;
    for (int k = 0; k < b->levels; ++k) {
        const double *square = b->square[k] + first;
        double total = 0.0;
        for (int i = 0; i < n; ++i) {
            double across = 0.0;
            for (int j = i + 1; j < n; ++j) {
                across += square[j - i] * v[j];
            }
            total += v[i] * (square[0] * v[i] + 2.0 * across);
            square += SCORES - at - i;
        }
        total *= b->correction[k];
        largest = total > largest ? total : largest;
    }
    return largest;
}

/* The same for a single probe, without correction. */
static double worst_probe(const blocks *b, int i)
{
    double largest = 0.0;
    for (int k = 0; k < LEVELS && b->number_probe[k] >= ENOUGH; ++k) {
        double square = b->square_probe[k][i];
        largest = square > largest ? square : largest;
    }
    return largest;
}

#endif
