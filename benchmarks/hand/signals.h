/* What a row is made of: TERMS odd powers of the deflection and the torque's offset before them. */

#ifndef SIGNALS_H
#define SIGNALS_H

#include <stdint.h>
#include <string.h>

enum { P = TERMS + 1 };                       /* columns: offset, then the powers, low to high */
enum { Y, PULL, DRAG, R, SIGNALS = R + P };   /* what goes through the operator; R: the columns */

#endif
