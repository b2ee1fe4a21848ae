/* The error of a hybrid test while it runs, in C99. Written by `reliab monitor --export c`.
 *
 *     static reliab_monitor monitor;
 *     reliab_monitor_init(&monitor);
 *     ... in each step of the loop:
 *     unsigned status = reliab_monitor_step(&monitor, command_m, measured_m);
 *     if ((status & (RELIAB_UNSTABLE | RELIAB_FAULT)) != 0u) { stop the test }
 *
 * Nothing is allocated, there are no globals, and each step does a bounded amount of work. */
#ifndef RELIAB_MONITOR_H
#define RELIAB_MONITOR_H

#include <stdint.h>
#include "reliab_monitor_config.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Bits of a status; one that was set stays set. */
#define RELIAB_UNSTABLE 1u /* the loop gains energy and may diverge */
#define RELIAB_ERROR 2u    /* the error is above twice the threshold, and the peak has settled */
#define RELIAB_FAULT 4u    /* a channel cannot be used; every number is NaN from then on */

typedef enum {
    RELIAB_NO_FAULT = 0,
    RELIAB_NOT_FINITE = 1, /* a value is NaN or infinite */
    RELIAB_TOO_LARGE = 2,  /* a value is no displacement in metres */
    RELIAB_STUCK = 3       /* the measured value stands still while the command moves */
} reliab_fault;

typedef struct {
    uint64_t samples;
    unsigned status;
    reliab_fault fault;
    int at_rest;           /* the sensor's offset is still being learned */
    double offset;         /* of the sensor, measured minus command at rest [m] */
    double standing;       /* command minus measured under which the test began in equilibrium [m] */
    double states[3][RELIAB_ORDER];
    double before[3];
    double between[4];
    double moments[2][4][4];
    double moved_samples;
    double largest_power;
    double rest[5];        /* sums of the rest: error, its products with the response to a constant, ... */
    double rest_motion;
    double first_command;
    double last_command;
    double last_measured;
    double square, half_first, peak, ideal, error, settled_ideal;
    uint64_t settled_sample;
    double felt[RELIAB_LAG_STEPS + 4u]; /* measured displacements of the last steps, a ring */
    unsigned newest;
    double net_damping;    /* NaN before enough motion */
    double smallest_error;
    int has_smallest;
    unsigned following;
    double stuck_from;     /* command where the measured value began to repeat [m] */
    double stuck_travel;
    double largest_command;
    uint64_t stuck_samples;
} reliab_monitor;

void reliab_monitor_init(reliab_monitor *monitor);
/* State the sensor's offset and the difference in equilibrium [m] before the first step; otherwise the
 * offset is learned while the command rests. */
void reliab_monitor_begin(reliab_monitor *monitor, double offset, double standing);
/* One step: displacements [m]; returns the status. */
unsigned reliab_monitor_step(reliab_monitor *monitor, double command, double measured);

double reliab_monitor_error(const reliab_monitor *monitor);       /* measured minus exact response now [m] */
double reliab_monitor_rms(const reliab_monitor *monitor);         /* RMS^R so far [-], noise included */
double reliab_monitor_mte(const reliab_monitor *monitor);         /* MTE^R so far [-], noise included */
double reliab_monitor_net_damping(const reliab_monitor *monitor); /* of the loop [-]; NaN before it is known */
const char *reliab_monitor_reason(const reliab_monitor *monitor); /* a sentence for the status */

#ifdef __cplusplus
}
#endif
#endif
