/* What an FMU of any version does: two inputs, a step, six outputs. Memory is asked for once, where the unit
 * is made. */
#ifndef RELIAB_UNIT_H
#define RELIAB_UNIT_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reliab_monitor.h"

typedef struct {
    reliab_monitor monitor;
    double inputs[2];
    double time; /* Of the last sample [s] */
} unit;

/* A unit at rest; NULL where it is asked for under another name, or there is no memory. */
static unit *unit_made(const char *name)
{
    unit *made = strcmp(name, "@GUID@") == 0 ? (unit *)calloc(1u, sizeof *made) : NULL;
    if (made != NULL) {
        reliab_monitor_init(&made->monitor);
    }
    return made;
}

static void unit_rest(unit *here)
{
    reliab_monitor_init(&here->monitor);
    here->inputs[0] = here->inputs[1] = here->time = 0.0;
}

/* 0: done, 1: there is no such input. */
static int unit_set(unit *here, unsigned at, double value)
{
    if (at > 1u) {
        return 1;
    }
    here->inputs[at] = value;
    return 0;
}

/* 0: done, 1: there is no such number. */
static int unit_get(const unit *here, unsigned at, double *value)
{
    switch (at) {
    case 0u:
    case 1u: *value = here->inputs[at]; return 0;
    case 2u: *value = reliab_monitor_error(&here->monitor); return 0;
    case 3u: *value = reliab_monitor_rms(&here->monitor); return 0;
    case 4u: *value = reliab_monitor_mte(&here->monitor); return 0;
    case 5u: *value = reliab_monitor_net_damping(&here->monitor); return 0;
    default: return 1;
    }
}

/* One sample; 0: sound, 1: a fault of a channel, 2: the step is not the one that was exported. */
static int unit_step(unit *here, double step)
{
    if (fabs(step - RELIAB_STEP) > 1e-6 * RELIAB_STEP) {
        return 2;
    }
    (void)reliab_monitor_step(&here->monitor, here->inputs[0], here->inputs[1]);
    return (here->monitor.status & RELIAB_FAULT) != 0u ? 1 : 0;
}

#endif
