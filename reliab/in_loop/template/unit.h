/* What an FMU of any version does: a command and a measured displacement of each actuator in turn, a step, the
 * read-outs of the monitor, and offsets that may be stated. Memory is asked for once, where the unit is made. */
#ifndef RELIAB_UNIT_H
#define RELIAB_UNIT_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reliab_monitor.h"

/* Numbers of the variables: errors, RMS^R and MTE^R of each displacement follow the inputs; the sensors' offsets and
 * the differences in equilibrium come last. */
#define UNIT_INPUTS (2u * RELIAB_ACTUATORS)
#define UNIT_DAMPING (5u * RELIAB_ACTUATORS)
#define UNIT_STATUS (UNIT_DAMPING + 1u)
#define UNIT_TIME (UNIT_DAMPING + 2u)
#define UNIT_GOVERNING (UNIT_DAMPING + 3u)
#define UNIT_OFFSETS (UNIT_DAMPING + 4u)
#define UNIT_STATED (UNIT_OFFSETS + 2u * RELIAB_ACTUATORS)

typedef struct {
    reliab_monitor monitor;
    double inputs[UNIT_INPUTS];
    double offsets[2u * RELIAB_ACTUATORS]; /* of the sensors, and differences in equilibrium [m] */
    int stated;                            /* whether these are used, and not learned */
    double time;                           /* of the last sample [s] */
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
    memset(here->inputs, 0, sizeof here->inputs);
    memset(here->offsets, 0, sizeof here->offsets);
    here->stated = 0;
    here->time = 0.0;
}

/* 0: done, 1: there is no such input or parameter, or the test has begun with another. */
static int unit_set(unit *here, unsigned at, double value)
{
    if (at < UNIT_INPUTS) {
        here->inputs[at] = value;
        return 0;
    }
    if (at < UNIT_OFFSETS || at >= UNIT_STATED || here->monitor.samples > 0u) {
        return 1;
    }
    here->offsets[at - UNIT_OFFSETS] = value;
    return 0;
}

/* 0: done, 1: there is no such parameter, or the test has begun with another. */
static int unit_set_yes_or_no(unit *here, unsigned at, int value)
{
    if (at != UNIT_STATED || here->monitor.samples > 0u) {
        return 1;
    }
    here->stated = value;
    return 0;
}

/* 0: done, 1: there is no such parameter. */
static int unit_get_yes_or_no(const unit *here, unsigned at, int *value)
{
    *value = here->stated;
    return at != UNIT_STATED;
}

/* 0: done, 1: there is no such number. */
static int unit_get(const unit *here, unsigned at, double *value)
{
    const unsigned degree = at % RELIAB_ACTUATORS;
    if (at >= UNIT_OFFSETS && at < UNIT_STATED) {
        *value = here->offsets[at - UNIT_OFFSETS];
        return 0;
    }
    switch (at / RELIAB_ACTUATORS) {
    case 0u:
    case 1u: *value = here->inputs[at]; return 0;
    case 2u: *value = reliab_monitor_error(&here->monitor, degree); return 0;
    case 3u: *value = reliab_monitor_rms(&here->monitor, degree); return 0;
    case 4u: *value = reliab_monitor_mte(&here->monitor, degree); return 0;
    default: break;
    }
    *value = at == UNIT_TIME ? here->time : reliab_monitor_net_damping(&here->monitor);
    return at != UNIT_TIME && at != UNIT_DAMPING;
}

/* 0: done, 1: there is no such whole number. */
static int unit_get_whole(const unit *here, unsigned at, int *value)
{
    *value = at == UNIT_STATUS ? (int)here->monitor.status : (int)reliab_monitor_governing(&here->monitor) + 1;
    return at != UNIT_STATUS && at != UNIT_GOVERNING;
}

/* One sample; 0: sound, 1: a fault of a channel, 2: the step is not the one that was exported. */
static int unit_step(unit *here, double step)
{
    double command[RELIAB_ACTUATORS], measured[RELIAB_ACTUATORS];
    unsigned i;
    if (fabs(step - RELIAB_STEP) > 1e-6 * RELIAB_STEP) {
        return 2;
    }
    for (i = 0u; i < RELIAB_ACTUATORS; i++) {
        command[i] = here->inputs[2u * i];
        measured[i] = here->inputs[2u * i + 1u];
    }
    if (here->stated != 0 && here->monitor.samples == 0u) {
        reliab_monitor_begin(&here->monitor, here->offsets, here->offsets + RELIAB_ACTUATORS);
    }
    (void)reliab_monitor_step(&here->monitor, command, measured);
    return (here->monitor.status & RELIAB_FAULT) != 0u ? 1 : 0;
}

#endif
