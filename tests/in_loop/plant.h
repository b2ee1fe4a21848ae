/* A late loop in the place of the monitor's unit, so that the same wrapper makes an FMU of it: outputs 0 and 1 are
 * the command and the measured displacement of a structure of 1 Hz and 2 % whose actuator is @DELAY@ steps late. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LATE @DELAY@
#define STEP @STEP@
#define CIRCULAR 6.283185307179586

typedef struct {
    struct { unsigned status; } monitor;
    double x, v, past[LATE + 1], time;
    unsigned long random, count;
} unit;

static unit *unit_made(const char *name) { return (unit *)calloc(1u, sizeof(unit)); }
static void unit_rest(unit *here) { memset(here, 0, sizeof *here); }
static int unit_set(unit *here, unsigned at, double value) { return 1; }

static int unit_get(const unit *here, unsigned at, double *value)
{
    *value = at == 0u ? here->x : here->past[here->count % (LATE + 1u)];
    return at > 1u;
}

static int unit_get_whole(const unit *here, unsigned at, int *value)
{
    *value = 0;
    return 1;
}

static int unit_set_yes_or_no(unit *here, unsigned at, int value) { return 1; }

static int unit_get_yes_or_no(const unit *here, unsigned at, int *value)
{
    *value = 0;
    return 1;
}

static int unit_step(unit *here, double step)
{
    const double measured = here->past[here->count % (LATE + 1u)];
    double shaken;
    here->random = (here->random * 1103515245u + 12345u) % 2147483648u;
    shaken = (double)here->random / 1073741824.0 - 1.0;
    here->v += STEP * (-shaken - 0.04 * CIRCULAR * here->v - CIRCULAR * CIRCULAR * measured);
    here->x += STEP * here->v;
    here->past[here->count % (LATE + 1u)] = here->x;
    here->count++;
    return 0;
}
