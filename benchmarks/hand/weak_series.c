/* A series joint with phi, phi^3, phi^5 and an offset, through two poles. */

/* Vectors of so few numbers are half as fast as numbers one by one. */
#pragma GCC optimize("no-tree-vectorize")

enum { TERMS = 3, TRANSMISSIONS = 1 };

#include "poles.h"
#include "series.h"
