/* The error of a hybrid test while it runs, in C99. Written by `reliab monitor --export c`.
 *
 *     static reliab_monitor monitor;
 *     reliab_monitor_init(&monitor);
 *     ... in each step of the loop, with an array of displacements [m] for each channel:
 *     unsigned status = reliab_monitor_step(&monitor, command, measured);
 *     if ((status & (RELIAB_UNSTABLE | RELIAB_FAULT)) != 0u) { stop the test }
 *
 * Arrays have RELIAB_ACTUATORS numbers, one for each actuator; with one actuator &command and &measured will do.
 * Errors are those of the interface's degrees of freedom, of which there are as many.
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

/* Energy of the loop in the motion of a mode, in a band around its frequency. */
typedef struct {
    double first[2];       /* command and error of the mode at the first sample */
    double band[2][2];     /* states of the band-pass of both */
    double last[2];
    double between[3];
    double moments[2][3][3];
    double weight;         /* of the samples in the moments */
    double moved_samples;
    double largest_power;
    double net_damping;    /* NaN before enough motion, and where noise hides it */
    double play;           /* half width of the play that the smallest error shows */
    int has_play;
    unsigned following;
    double windows[2];     /* numbers of independent windows, and the standard errors that an alarm needs then */
    double needed[2];
} reliab_energy;

/* The error of an interface displacement so far. */
typedef struct {
    double error, square, half_first, peak, ideal, settled_ideal;
    uint64_t settled_sample;
    double before[2];      /* command minus measured of the last samples */
    double rough;          /* sum of squares of its second differences, for the noise */
} reliab_degree;

/* What is known of a sensor. */
typedef struct {
    double offset;         /* measured minus command at rest [m] */
    double standing;       /* command minus measured under which the test began in equilibrium [m] */
    double spread;         /* sum of squares about the offset while it is learned */
    double rest_motion;    /* of the command */
    double mean_command;
    double first_command;
    double last_command;
    double last_measured;
    double stuck_from;     /* command where the measured value began to repeat [m] */
    double stuck_travel;
    double largest_command;
    uint64_t stuck_samples;
    uint64_t longest_stuck; /* samples for which it stood still before */
    double changes;        /* samples in which it moved */
    double felt[RELIAB_LAG_STEPS + 4u]; /* measured displacements of the last steps, a ring */
} reliab_sensor;

#if RELIAB_EFFECTS > 0
/* The share of a nonlinear specimen in the error. */
typedef struct {
    double effects[2][RELIAB_EFFECTS][RELIAB_EFFECT_STATES]; /* under the measured and under the exact motion */
    double state[RELIAB_ORDER];
    double force;
    double past[3][3];     /* last commands, exact displacements, and command minus measured */
    double noise[3];       /* of command minus measured: sum of squares, number; largest step of the command */
    double path[3];        /* command minus measured, its velocity and acceleration, without noise */
    int begun;
} reliab_specimen;
#endif

typedef struct {
    uint64_t samples;
    unsigned status;
    reliab_fault fault;
    int at_rest;           /* offsets of the sensors are still being learned */
    unsigned newest;       /* place in the rings */
    double states[1u + 2u * RELIAB_ACTUATORS][RELIAB_ORDER];
    double before[1u + 2u * RELIAB_ACTUATORS][RELIAB_ACTUATORS];
    reliab_sensor sensors[RELIAB_ACTUATORS];
    reliab_degree degrees[RELIAB_ACTUATORS];
    reliab_energy energies[RELIAB_WATCHED];
    unsigned gaining;      /* the watched mode in which the loop gains energy */
#if RELIAB_EFFECTS > 0
    reliab_specimen specimen;
#endif
} reliab_monitor;

void reliab_monitor_init(reliab_monitor *monitor);
/* State the sensors' offsets and the differences in equilibrium [m] before the first step; otherwise offsets are
 * learned while the commands rest. */
void reliab_monitor_begin(reliab_monitor *monitor, const double *offset, const double *standing);
/* One step: displacements [m]; returns the status. */
unsigned reliab_monitor_step(reliab_monitor *monitor, const double *command, const double *measured);

/* Of an interface displacement, from 0: measured minus exact response now [m]; RMS^R and MTE^R so far [-], noise
 * included. */
double reliab_monitor_error(const reliab_monitor *monitor, unsigned degree);
double reliab_monitor_rms(const reliab_monitor *monitor, unsigned degree);
double reliab_monitor_mte(const reliab_monitor *monitor, unsigned degree);
unsigned reliab_monitor_governing(const reliab_monitor *monitor);  /* the one with the largest error so far */
double reliab_monitor_net_damping(const reliab_monitor *monitor);  /* smallest of the watched modes [-]; NaN before it is known */
const char *reliab_monitor_reason(const reliab_monitor *monitor);  /* a sentence for the status */

#ifdef __cplusplus
}
#endif
#endif
