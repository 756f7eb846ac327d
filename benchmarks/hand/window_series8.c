/* A series joint with seven odd powers and an offset, through a window. */

/* Vectors of so few numbers are slower than numbers one by one. */
#pragma GCC optimize("no-tree-vectorize")

enum { TERMS = 7, TRANSMISSIONS = 1 };

#include "window.h"
#include "series.h"
