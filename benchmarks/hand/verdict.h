/* Verdict on a stiffness and its standard deviation. */

#ifndef VERDICT_H
#define VERDICT_H

#include "joint.h"

typedef struct {
    int64_t narrow;                           /* samples in a row with a narrow interval */
} interval;

typedef struct {
    int64_t good;
    int converged;
    double since, at;
} convergence;

/* Adds status bits; a read-out that is only repeated is not counted. */
static int decide(const joint_params *p, interval *s, double stiffness, double std, int wrong,
                  int counted, int *status)
{
    double half = 1.96 * std;
    if (!(*status & PRIOR) && stiffness + 3.0 * std < 0.0) {
        wrong |= NEGATIVE;
    }
    if (half > p->c.starved * fabs(stiffness)) {
        *status |= WIDE;
    }
    s->narrow = half >= p->c.informative * stiffness ? 0 : s->narrow + counted;
    int verdict = CONVERGING;
    if (*status & (PRIOR | WIDE)) {
        verdict = STARVED;
    } else if ((double)s->narrow * p->c.period >= p->c.hold) {
        verdict = INFORMATIVE;
    }
    *status |= wrong;
    return wrong ? INCONSISTENT : verdict;
}

static void note_convergence(const joint_params *p, convergence *s, int verdict, double time)
{
    if (verdict != INFORMATIVE) {
        s->good = 0;
        return;
    }
    if (s->good == 0) {
        s->since = time;
    }
    s->good++;
    if (!s->converged && (double)s->good * p->c.period >= p->c.hold) {
        s->converged = 1;
        s->at = s->since;
    }
}

#endif
