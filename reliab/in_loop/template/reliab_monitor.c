/* The error of a hybrid test while it runs: see reliab_monitor.h. The equations are those of
 * reliab/assessment/rebuilt_error/: recursion.py, running_error.py, stability_indicator.py, monitor.py. */
#include "reliab_monitor.h"

#include <math.h>

#define RELIAB_COEFFICIENTS
#include "reliab_monitor_config.h"

#define LAG_RING (RELIAB_LAG_STEPS + 4u)
#define PI 3.14159265358979323846
#define TINY 2.2250738585072014e-308

static double not_a_number(void) { return (double)NAN; }

/* The bits are asked, because -ffast-math takes every number for finite. */
static int is_finite(double value)
{
    union {
        double number;
        uint64_t bits;
    } seen;
    seen.number = value;
    return (seen.bits & UINT64_C(0x7ff0000000000000)) != UINT64_C(0x7ff0000000000000);
}

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

void reliab_monitor_init(reliab_monitor *monitor)
{
    const reliab_monitor empty = {0};
    unsigned i;
    *monitor = empty;
    monitor->at_rest = 1;
    monitor->between[2] = 1.0;
    monitor->net_damping = not_a_number();
    for (i = 0u; i < RELIAB_ORDER; i++) {
        monitor->states[2][i] = EQUILIBRIUM[i];
    }
}

void reliab_monitor_begin(reliab_monitor *monitor, double offset, double standing)
{
    monitor->at_rest = 0;
    monitor->offset = offset;
    monitor->standing = standing;
}

static void advance(double state[RELIAB_ORDER], double before, double now)
{
    double moved[RELIAB_ORDER];
    unsigned row, column;
    for (row = 0u; row < RELIAB_ORDER; row++) {
        double total = EARLY[row] * before + LATE[row] * now;
        for (column = 0u; column < RELIAB_ORDER; column++) {
            total += DECAY[row][column] * state[column];
        }
        moved[row] = total;
    }
    for (row = 0u; row < RELIAB_ORDER; row++) {
        state[row] = moved[row];
    }
}

/* Responses to the fed-back difference, to a constant, and from equilibrium. */
static void respond(reliab_monitor *monitor, double fed_back, double responses[3])
{
    const double inputs[3] = {fed_back, 1.0, 0.0};
    unsigned row, column;
    for (row = 0u; row < 3u; row++) {
        double response = FEED_THROUGH * inputs[row];
        if (monitor->samples > 0u) {
            advance(monitor->states[row], monitor->before[row], inputs[row]);
        }
        monitor->before[row] = inputs[row];
        for (column = 0u; column < RELIAB_ORDER; column++) {
            response += OUTPUT[column] * monitor->states[row][column];
        }
        responses[row] = response;
    }
}

/* The measured displacement whose force was fed back. */
static double felt(reliab_monitor *monitor, double measured)
{
    double total = 0.0;
    unsigned k;
    if (monitor->samples == 0u) {
        for (k = 0u; k < LAG_RING; k++) {
            monitor->felt[k] = measured;
        }
    }
    monitor->newest = (monitor->newest + 1u) % LAG_RING;
    monitor->felt[monitor->newest] = measured;
    for (k = 0u; k < 4u; k++) {
        total += LAG_WEIGHTS[k] * monitor->felt[(monitor->newest + LAG_RING - RELIAB_LAG_STEPS - k) % LAG_RING];
    }
    return total;
}

/* Products of command, its velocity, one and the actuator's error, with an exponential memory. */
static void remember(reliab_monitor *monitor, double command, double measured)
{
    double stepped[4];
    const double error = measured - command;
    const double error_before = monitor->last_measured - monitor->last_command;
    unsigned row, column;
    for (row = 0u; row < 4u; row++) {
        stepped[row] = -monitor->between[row];
    }
    monitor->between[0] = 0.5 * (command + monitor->last_command);
    monitor->between[1] = (command - monitor->last_command) / RELIAB_STEP;
    monitor->between[3] = 0.5 * (error + error_before);
    for (row = 0u; row < 4u; row++) {
        stepped[row] += monitor->between[row];
    }
    for (row = 0u; row < 4u; row++) {
        for (column = 0u; column < 4u; column++) {
            monitor->moments[0][row][column] = RELIAB_FORGETTING * monitor->moments[0][row][column]
                + monitor->between[row] * monitor->between[column];
            monitor->moments[1][row][column] = RELIAB_FORGETTING * monitor->moments[1][row][column]
                + stepped[row] * stepped[column];
        }
    }
    if (monitor->between[1] > 0.0 || monitor->between[1] < 0.0) {
        monitor->moved_samples += 1.0;
    }
    monitor->largest_power = larger(monitor->largest_power, monitor->moments[0][1][1]);
}

/* Pseudo-inverse of a symmetric matrix of at most three rows, by Jacobi rotations. */
static void invert(double a[3][3], unsigned size, double inverse[3][3])
{
    double vectors[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    double largest = 0.0;
    unsigned sweep, p, q, k;
    for (sweep = 0u; sweep < 12u; sweep++) {
        for (p = 0u; p + 1u < size; p++) {
            for (q = p + 1u; q < size; q++) {
                double turn, t, c, s;
                if (fabs(a[p][q]) <= TINY) {
                    continue;
                }
                turn = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                t = (turn >= 0.0 ? 1.0 : -1.0) / (fabs(turn) + sqrt(turn * turn + 1.0));
                c = 1.0 / sqrt(t * t + 1.0);
                s = t * c;
                for (k = 0u; k < size; k++) {
                    const double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (k = 0u; k < size; k++) {
                    const double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
                for (k = 0u; k < size; k++) {
                    const double x = vectors[k][p], y = vectors[k][q];
                    vectors[k][p] = c * x - s * y;
                    vectors[k][q] = s * x + c * y;
                }
            }
        }
    }
    for (k = 0u; k < size; k++) {
        largest = larger(largest, fabs(a[k][k]));
    }
    for (p = 0u; p < size; p++) {
        for (q = 0u; q < size; q++) {
            inverse[p][q] = 0.0;
            for (k = 0u; k < size; k++) {
                if (fabs(a[k][k]) > 1e-12 * largest) {
                    inverse[p][q] += vectors[p][k] * vectors[q][k] / a[k][k];
                }
            }
        }
    }
}

/* Standard deviations that a normal variable exceeds with a small probability. */
static double exceeded(double probability)
{
    const double t = sqrt(-2.0 * log(probability));
    double z = t - (2.515517 + t * (0.802853 + t * 0.010328))
        / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    unsigned k;
    for (k = 0u; k < 4u; k++) {
        const double density = exp(-0.5 * z * z) / sqrt(2.0 * PI);
        z += (0.5 * erfc(z / sqrt(2.0)) - probability) / density;
    }
    return z;
}

static double quadratic(double matrix[4][4], const double vector[4])
{
    double total = 0.0;
    unsigned row, column;
    for (row = 0u; row < 4u; row++) {
        for (column = 0u; column < 4u; column++) {
            total += vector[row] * matrix[row][column] * vector[column];
        }
    }
    return total;
}

/* Net damping of the loop with its actuator; whether it may diverge. */
static int gains_energy(reliab_monitor *monitor)
{
    double scale[4], joint[4][4], steps[4][4], copy[3][3] = {{0.0}}, inverse[3][3] = {{0.0}};
    double residual[4], rough, independent, units, deviation, needed, window, error, amplitude, by_play;
    double left, first_deviation;
    const double power = monitor->moments[0][1][1];
    const double count = monitor->moments[0][2][2];
    unsigned row, column;
    if (monitor->moved_samples < RELIAB_SAMPLES_IN_PERIOD || !(power > 0.0)) {
        return 0;
    }
    for (row = 0u; row < 4u; row++) {
        scale[row] = sqrt(larger(monitor->moments[0][row][row], TINY));
    }
    for (row = 0u; row < 4u; row++) {
        for (column = 0u; column < 4u; column++) {
            joint[row][column] = monitor->moments[0][row][column] / (scale[row] * scale[column]);
            steps[row][column] = monitor->moments[1][row][column] / (scale[row] * scale[column]);
            if (row < 3u && column < 3u) {
                copy[row][column] = joint[row][column];
            }
        }
    }
    invert(copy, 3u, inverse);
    for (row = 0u; row < 3u; row++) {
        residual[row] = 0.0;
        for (column = 0u; column < 3u; column++) {
            residual[row] -= inverse[row][column] * joint[column][3];
        }
    }
    residual[3] = 1.0;
    left = larger(quadratic(joint, residual), 0.0);
    rough = left > 0.0 ? smaller(quadratic(steps, residual) / left, 1.0) : 0.0;
    independent = larger(count * larger(rough / (4.0 - rough), RELIAB_INDEPENDENT / RELIAB_SAMPLES_IN_PERIOD), 1.0);
    units = RELIAB_DAMPING_FACTOR * scale[3] / scale[1];
    monitor->net_damping = RELIAB_DAMPING_RATIO - units * residual[1];
    deviation = units * sqrt(larger(inverse[1][1], 0.0) * left / independent);
    first_deviation = sqrt(larger(inverse[0][0], 0.0) * left / independent);
    window = ceil(monitor->moved_samples / (RELIAB_MEMORY * RELIAB_SAMPLES_IN_PERIOD));
    needed = exceeded(RELIAB_FALSE_ALARMS / (window * (window + 1.0)));
    copy[0][0] = joint[0][0];
    copy[0][1] = joint[0][2];
    copy[1][0] = joint[2][0];
    copy[1][1] = joint[2][2];
    {
        double known[3][3] = {{0.0}};
        const double follows[2] = {joint[0][3], joint[2][3]};
        invert(copy, 2u, known);
        error = follows[0] * (known[0][0] * follows[0] + known[0][1] * follows[1])
            + follows[1] * (known[1][0] * follows[0] + known[1][1] * follows[1]);
    }
    error = sqrt(larger((1.0 - error) * monitor->moments[0][3][3] / count, 0.0));
    amplitude = sqrt(2.0 / count) * scale[0];
    by_play = 4.0 / PI * RELIAB_DAMPING_FACTOR / (RELIAB_CIRCULAR_FREQUENCY * amplitude);
    if (-(residual[0] + needed * first_deviation) * scale[3] > RELIAB_FOLLOWS * scale[0]) {
        monitor->following = monitor->following < 2u ? monitor->following + 1u : 2u;
    } else {
        monitor->following = 0u;
    }
    if (monitor->following > 1u) {
        monitor->smallest_error = monitor->has_smallest != 0 ? smaller(monitor->smallest_error, error) : error;
        monitor->has_smallest = 1;
    }
    return power > RELIAB_LARGE_MOTION * monitor->largest_power && monitor->has_smallest != 0
        && monitor->net_damping + needed * deviation + by_play * RELIAB_LARGEST_PLAY * monitor->smallest_error < 0.0;
}

/* Learn the sensor's offset while the command rests; forget the peaks of the rest when it moves. */
static void learn(reliab_monitor *monitor, double command, double measured, const double responses[3])
{
    const double difference = measured - command;
    const double moved = fabs(command - monitor->first_command);
    const double count = (double)monitor->samples;
    if (moved > RELIAB_REST_M) {
        const double spread = sqrt(larger(monitor->rest[4] / larger(count, 1.0), 0.0) / larger(count, 1.0));
        if (count < 4.0 || fabs(monitor->offset) <= 4.0 * spread + monitor->rest_motion) {
            monitor->offset = 0.0;
        }
        monitor->at_rest = 0;
        monitor->square = monitor->rest[0] + monitor->offset * (2.0 * monitor->rest[1]
            + monitor->offset * monitor->rest[2]);
        monitor->half_first = monitor->rest[3] + monitor->offset * -1.0;
        monitor->half_first = 0.5 * monitor->half_first * monitor->half_first;
        monitor->peak = 0.0;
        monitor->ideal = 0.0;
        monitor->settled_ideal = 0.0;
        return;
    }
    if (monitor->samples == 0u) {
        monitor->rest[3] = responses[0];
    }
    monitor->rest_motion = larger(monitor->rest_motion, moved);
    {
        const double from_mean = difference - monitor->offset;
        monitor->offset += from_mean / (count + 1.0);
        monitor->rest[4] += from_mean * (difference - monitor->offset);
    }
    monitor->rest[0] += responses[0] * responses[0];
    monitor->rest[1] += responses[0] * responses[1];
    monitor->rest[2] += responses[1] * responses[1];
}

static void add(reliab_monitor *monitor, double measured, const double responses[3])
{
    const double error = responses[0] + monitor->offset * responses[1] + monitor->standing * responses[2];
    monitor->error = error;
    if (monitor->at_rest != 0) {
        return;
    }
    if (monitor->samples == 0u) {
        monitor->half_first = 0.5 * error * error;
    }
    monitor->square += error * error;
    monitor->peak = larger(monitor->peak, fabs(error));
    monitor->ideal = larger(monitor->ideal, fabs(measured - monitor->offset - error));
    if (monitor->ideal > 2.0 * monitor->settled_ideal) {
        monitor->settled_ideal = monitor->ideal;
        monitor->settled_sample = monitor->samples;
    }
}

static reliab_fault fault_of(reliab_monitor *monitor, double command, double measured)
{
    if (!is_finite(command) || !is_finite(measured)) {
        return RELIAB_NOT_FINITE;
    }
    if (fabs(command) >= RELIAB_LARGEST_READING || fabs(measured) >= RELIAB_LARGEST_READING) {
        return RELIAB_TOO_LARGE;
    }
    monitor->largest_command = larger(monitor->largest_command, fabs(command - monitor->first_command));
    if (monitor->samples > 0u && measured >= monitor->last_measured && measured <= monitor->last_measured) {
        monitor->stuck_samples++;
        monitor->stuck_travel = larger(monitor->stuck_travel, fabs(command - monitor->stuck_from));
    } else {
        monitor->stuck_samples = 0u;
        monitor->stuck_travel = 0.0;
        monitor->stuck_from = command;
    }
    if (monitor->stuck_samples >= 8u && monitor->stuck_travel > RELIAB_STUCK_M
        && monitor->stuck_travel > 0.5 * monitor->largest_command) {
        return RELIAB_STUCK;
    }
    return RELIAB_NO_FAULT;
}

static void raise_alarms(reliab_monitor *monitor)
{
    const double calm = ((double)(monitor->samples - 1u) - (double)monitor->settled_sample) * RELIAB_STEP;
    if (monitor->samples % RELIAB_LOOK == 0u && gains_energy(monitor)) {
        monitor->status |= RELIAB_UNSTABLE;
    }
    if (monitor->at_rest == 0 && calm >= RELIAB_CALM) {
        const double error = RELIAB_METRIC_IS_RMS != 0 ? reliab_monitor_rms(monitor) : reliab_monitor_mte(monitor);
        if (RELIAB_SHRINKS * error > RELIAB_THRESHOLD) {
            monitor->status |= RELIAB_ERROR;
        }
    }
}

unsigned reliab_monitor_step(reliab_monitor *monitor, double command, double read)
{
    double responses[3], measured;
    if ((monitor->status & RELIAB_FAULT) != 0u) {
        return monitor->status;
    }
    measured = read / RELIAB_SENSOR_SCALE;
    if (monitor->samples == 0u) {
        monitor->first_command = command;
    }
    monitor->fault = fault_of(monitor, command, measured);
    if (monitor->fault != RELIAB_NO_FAULT) {
        monitor->status |= RELIAB_FAULT;
        return monitor->status;
    }
    respond(monitor, command - felt(monitor, measured), responses);
    responses[0] -= command - measured;
    responses[1] -= 1.0;
    if (monitor->samples > 0u) {
        remember(monitor, command, measured);
    }
    if (monitor->at_rest != 0) {
        learn(monitor, command, measured, responses);
    }
    add(monitor, measured, responses);
    monitor->last_command = command;
    monitor->last_measured = measured;
    monitor->samples++;
    raise_alarms(monitor);
    return monitor->status;
}

static int is_faulty(const reliab_monitor *monitor) { return (monitor->status & RELIAB_FAULT) != 0u; }

double reliab_monitor_error(const reliab_monitor *monitor)
{
    return is_faulty(monitor) ? not_a_number() : monitor->error;
}

double reliab_monitor_rms(const reliab_monitor *monitor)
{
    double inner, steps;
    if (is_faulty(monitor)) {
        return not_a_number();
    }
    inner = monitor->square - monitor->half_first - 0.5 * monitor->error * monitor->error;
    steps = monitor->samples > 1u ? (double)(monitor->samples - 1u) : 1.0;
    return monitor->ideal > 0.0 ? sqrt(larger(inner, 0.0) / steps) / monitor->ideal : 0.0;
}

double reliab_monitor_mte(const reliab_monitor *monitor)
{
    if (is_faulty(monitor)) {
        return not_a_number();
    }
    return monitor->ideal > 0.0 ? monitor->peak / monitor->ideal : 0.0;
}

double reliab_monitor_net_damping(const reliab_monitor *monitor)
{
    return is_faulty(monitor) ? not_a_number() : monitor->net_damping;
}

const char *reliab_monitor_reason(const reliab_monitor *monitor)
{
    if (is_faulty(monitor)) {
        switch (monitor->fault) {
        case RELIAB_NOT_FINITE: return "fault: a displacement is not a number";
        case RELIAB_TOO_LARGE: return "fault: a displacement is too large to be one in metres";
        case RELIAB_STUCK: return "fault: the measured displacement stands still while the command moves";
        case RELIAB_NO_FAULT: break;
        default: break;
        }
    }
    if ((monitor->status & RELIAB_UNSTABLE) != 0u) {
        return "the loop gains energy and may diverge";
    }
    if ((monitor->status & RELIAB_ERROR) != 0u) {
        return "the error is above twice the threshold";
    }
    return "no alarm";
}
