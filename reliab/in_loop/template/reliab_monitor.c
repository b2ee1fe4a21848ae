/* The error of a hybrid test while it runs: see reliab_monitor.h. The equations are those of
 * reliab/assessment/rebuilt_error/: recursion.py, running_error.py, running_specimen.py, stability_indicator.py,
 * monitor.py, and of ../coupled_error/coupled_recursion.py. */
#include "reliab_monitor.h"

#include <math.h>

#define ACTUATORS RELIAB_ACTUATORS
#define RESPONSES (1u + 2u * ACTUATORS)
#define LAG_RING (RELIAB_LAG_STEPS + 4u)
#define PI 3.14159265358979323846
#define TINY 2.2250738585072014e-308
#define PLAIN 1e-3 /* determinant above which a matrix with ones on its diagonal is inverted plainly */

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
static double zero_or_more(double a) { return larger(a, 0.0); }

typedef struct {
    double projection[ACTUATORS]; /* of interface displacements on the mode */
    double ratio, factor, forgetting, samples, circular_frequency;
    uint64_t look;
} mode;

#define RELIAB_COEFFICIENTS
#include "reliab_monitor_config.h"

void reliab_monitor_init(reliab_monitor *monitor)
{
    const reliab_monitor empty = {0};
    unsigned i, row;
    *monitor = empty;
    monitor->at_rest = 1;
    for (i = 0u; i < ACTUATORS; i++) {
        monitor->energies[i].between[2] = 1.0;
        monitor->energies[i].net_damping = not_a_number();
        for (row = 0u; row < RELIAB_ORDER; row++) {
            monitor->states[1u + ACTUATORS + i][row] = EQUILIBRIUM[row][i];
        }
    }
}

void reliab_monitor_begin(reliab_monitor *monitor, const double *offset, const double *standing)
{
    unsigned i;
    monitor->at_rest = 0;
    for (i = 0u; i < ACTUATORS; i++) {
        monitor->sensors[i].offset = offset[i];
        monitor->sensors[i].standing = standing[i];
    }
}

static void advance(double state[RELIAB_ORDER], const double before[ACTUATORS], const double now[ACTUATORS])
{
    double moved[RELIAB_ORDER];
    unsigned row, column;
    for (row = 0u; row < RELIAB_ORDER; row++) {
        double total = 0.0;
        for (column = 0u; column < ACTUATORS; column++) {
            total += EARLY[row][column] * before[column] + LATE[row][column] * now[column];
        }
        for (column = 0u; column < RELIAB_ORDER; column++) {
            total += DECAY[row][column] * state[column];
        }
        moved[row] = total;
    }
    for (row = 0u; row < RELIAB_ORDER; row++) {
        state[row] = moved[row];
    }
}

/* Carry displacements from the sensors to the interface. */
static void carry(const double at_sensors[ACTUATORS], double at_interface[ACTUATORS])
{
    unsigned row, column;
    for (row = 0u; row < ACTUATORS; row++) {
        at_interface[row] = 0.0;
        for (column = 0u; column < ACTUATORS; column++) {
            at_interface[row] += CARRY[row][column] * at_sensors[column];
        }
    }
}

/* Responses of the interface to the fed-back difference, to a constant at each sensor, and from equilibrium. */
static void respond(reliab_monitor *monitor, const double fed_back[ACTUATORS], double responses[RESPONSES][ACTUATORS])
{
    unsigned which, row, column;
    for (which = 0u; which < RESPONSES; which++) {
        double inputs[ACTUATORS];
        for (row = 0u; row < ACTUATORS; row++) {
            inputs[row] = which == 0u ? fed_back[row] : which <= ACTUATORS ? CARRY[row][which - 1u] : 0.0;
        }
        if (monitor->samples > 0u) {
            advance(monitor->states[which], monitor->before[which], inputs);
        }
        for (row = 0u; row < ACTUATORS; row++) {
            double response = 0.0;
            for (column = 0u; column < ACTUATORS; column++) {
                response += FEED_THROUGH[row][column] * inputs[column];
            }
            for (column = 0u; column < RELIAB_ORDER; column++) {
                response += OUTPUT[row][column] * monitor->states[which][column];
            }
            responses[which][row] = response;
            monitor->before[which][row] = inputs[row];
        }
    }
}

/* The measured displacement whose force was fed back. */
static double felt(const reliab_monitor *monitor, reliab_sensor *sensor, double measured)
{
    double total = 0.0;
    unsigned k;
    if (monitor->samples == 0u) {
        for (k = 0u; k < LAG_RING; k++) {
            sensor->felt[k] = measured;
        }
    }
    sensor->felt[monitor->newest] = measured;
    for (k = 0u; k < 4u; k++) {
        total += LAG_WEIGHTS[k] * sensor->felt[(monitor->newest + LAG_RING - RELIAB_LAG_STEPS - k) % LAG_RING];
    }
    return total;
}

/* Products of command, its velocity, one and the actuators' error in a mode, with an exponential memory. */
static void remember(reliab_energy *energy, const mode *of, double command, double error, int first)
{
    double stepped[4];
    unsigned row, column;
    if (first == 0) {
        for (row = 0u; row < 4u; row++) {
            stepped[row] = -energy->between[row];
        }
        energy->between[0] = 0.5 * (command + energy->last[0]);
        energy->between[1] = (command - energy->last[0]) / RELIAB_STEP;
        energy->between[3] = 0.5 * (error + energy->last[1]);
        for (row = 0u; row < 4u; row++) {
            stepped[row] += energy->between[row];
        }
        for (row = 0u; row < 4u; row++) {
            for (column = 0u; column < 4u; column++) {
                energy->moments[0][row][column] = of->forgetting * energy->moments[0][row][column]
                    + energy->between[row] * energy->between[column];
                energy->moments[1][row][column] = of->forgetting * energy->moments[1][row][column]
                    + stepped[row] * stepped[column];
            }
        }
        if (energy->between[1] > 0.0 || energy->between[1] < 0.0) {
            energy->moved_samples += 1.0;
        }
        energy->largest_power = larger(energy->largest_power, energy->moments[0][1][1]);
    }
    energy->last[0] = command;
    energy->last[1] = error;
    energy->largest[0] = larger(energy->largest[0], fabs(command));
}

/* Inverse of a symmetric matrix of three rows with ones on its diagonal; 0 where it is nearly singular. */
static int invert_plainly(double a[3][3], double inverse[3][3])
{
    const double x = a[0][1], y = a[0][2], z = a[1][2];
    const double determinant = 1.0 + 2.0 * x * y * z - x * x - y * y - z * z;
    if (!(determinant > PLAIN)) {
        return 0;
    }
    inverse[0][0] = (1.0 - z * z) / determinant;
    inverse[1][1] = (1.0 - y * y) / determinant;
    inverse[2][2] = (1.0 - x * x) / determinant;
    inverse[0][1] = inverse[1][0] = (y * z - x) / determinant;
    inverse[0][2] = inverse[2][0] = (x * z - y) / determinant;
    inverse[1][2] = inverse[2][1] = (x * y - z) / determinant;
    return 1;
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

static double window_of(const reliab_energy *energy, const mode *of)
{
    return ceil(energy->moved_samples / (RELIAB_MEMORY * of->samples));
}

/* Standard errors that an alarm needs in a window. */
static double allowed_in(double window)
{
    return exceeded(RELIAB_FALSE_ALARMS / (double)ACTUATORS / (window * (window + 1.0)));
}

static int is_window(double a, double b) { return fabs(a - b) < 0.5; }

/* Between two looks, prepare what the next one needs, in this window or the one that follows: one number in a step. */
static void prepare(reliab_energy *energy, const mode *of)
{
    const double window = larger(window_of(energy, of), 1.0);
    if (!is_window(energy->windows[0], window)) {
        const int follows = is_window(energy->windows[1], window);
        energy->needed[0] = follows != 0 ? energy->needed[1] : allowed_in(window);
        energy->windows[0] = window;
    } else if (!is_window(energy->windows[1], window + 1.0)) {
        energy->needed[1] = allowed_in(window + 1.0);
        energy->windows[1] = window + 1.0;
    } else {
        /* both are known */
    }
}

static double needed_in(const reliab_energy *energy, double window)
{
    if (is_window(energy->windows[0], window)) {
        return energy->needed[0];
    }
    return is_window(energy->windows[1], window) ? energy->needed[1] : allowed_in(window);
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

/* Net damping of the loop in a mode; whether it may diverge. */
static int gains_energy(reliab_energy *energy, const mode *of)
{
    double scale[4], joint[4][4], steps[4][4], copy[3][3] = {{0.0}}, inverse[3][3] = {{0.0}};
    double residual[4], rough, independent, units, deviation, needed, window, error, amplitude, by_play;
    double left, deviations[2], in_phase, across, play;
    const int strays = larger(energy->largest[0], energy->largest[1]) > RELIAB_STRAYS * energy->ideal;
    const double power = energy->moments[0][1][1];
    const double count = energy->moments[0][2][2];
    unsigned row, column;
    energy->largest[1] = energy->largest[0];
    energy->largest[0] = 0.0;
    if (energy->moved_samples < of->samples || !(power > 0.0)) {
        return 0;
    }
    for (row = 0u; row < 4u; row++) {
        scale[row] = sqrt(larger(energy->moments[0][row][row], TINY));
    }
    for (row = 0u; row < 4u; row++) {
        for (column = 0u; column < 4u; column++) {
            joint[row][column] = energy->moments[0][row][column] / (scale[row] * scale[column]);
            steps[row][column] = energy->moments[1][row][column] / (scale[row] * scale[column]);
            if (row < 3u && column < 3u) {
                copy[row][column] = joint[row][column];
            }
        }
    }
    if (!invert_plainly(copy, inverse)) {
        invert(copy, 3u, inverse);
    }
    for (row = 0u; row < 3u; row++) {
        residual[row] = 0.0;
        for (column = 0u; column < 3u; column++) {
            residual[row] -= inverse[row][column] * joint[column][3];
        }
    }
    residual[3] = 1.0;
    left = larger(quadratic(joint, residual), 0.0);
    rough = left > 0.0 ? smaller(quadratic(steps, residual) / left, 1.0) : 0.0;
    independent = larger(count * larger(rough / (4.0 - rough), RELIAB_INDEPENDENT / of->samples), 1.0);
    units = of->factor * scale[3] / scale[1];
    energy->net_damping = of->ratio - units * residual[1];
    for (row = 0u; row < 2u; row++) {
        deviations[row] = sqrt(larger(inverse[row][row], 0.0) * left / independent);
    }
    deviation = units * deviations[1];
    window = window_of(energy, of);
    needed = needed_in(energy, window);
    copy[0][0] = copy[1][1] = copy[2][2] = 1.0;
    copy[0][1] = copy[1][0] = joint[0][2];
    copy[0][2] = copy[2][0] = copy[1][2] = copy[2][1] = 0.0;
    {
        double known[3][3] = {{0.0}};
        const double follows[2] = {joint[0][3], joint[2][3]};
        if (!invert_plainly(copy, known)) {
            invert(copy, 2u, known);
        }
        error = follows[0] * (known[0][0] * follows[0] + known[0][1] * follows[1])
            + follows[1] * (known[1][0] * follows[0] + known[1][1] * follows[1]);
    }
    error = sqrt(larger((1.0 - error) * energy->moments[0][3][3] / count, 0.0));
    amplitude = sqrt(2.0 / count) * scale[0];
    by_play = 4.0 / PI * of->factor / (of->circular_frequency * amplitude);
    in_phase = larger(fabs(scale[0] - residual[0] * scale[3]) - needed * deviations[0] * scale[3], 0.0);
    across = larger((fabs(residual[1]) - needed * deviations[1]) * scale[3], 0.0);
    if (sqrt(in_phase * in_phase + across * across) > RELIAB_FOLLOWS * scale[0]) {
        energy->following = energy->following < 2u ? energy->following + 1u : 2u;
    } else {
        energy->following = 0u;
    }
    if (energy->following > 1u) {
        energy->smallest_error = energy->has_smallest != 0 ? smaller(energy->smallest_error, error) : error;
        energy->has_smallest = 1;
    }
    play = (strays != 0 ? RELIAB_PLAY_OF_STRAYING : RELIAB_LARGEST_PLAY) * energy->smallest_error;
    return power > RELIAB_LARGE_MOTION * energy->largest_power && energy->has_smallest != 0
        && energy->net_damping + needed * deviation + by_play * play < 0.0;
}

/* Learn the sensors' offsets while the commands rest. Where the commands begin to move, an offset that may be
 * chance is none, and one by which the command stands off zero as the loop would is felt by the loop. */
static void learn(reliab_monitor *monitor, const double command[ACTUATORS], const double measured[ACTUATORS])
{
    const double count = (double)monitor->samples;
    unsigned i;
    int moves = 0;
    for (i = 0u; i < ACTUATORS; i++) {
        moves |= fabs(command[i] - monitor->sensors[i].first_command) > RELIAB_REST_M;
    }
    for (i = 0u; i < ACTUATORS; i++) {
        reliab_sensor *sensor = &monitor->sensors[i];
        if (moves == 0) {
            const double from_mean = measured[i] - command[i] - sensor->offset;
            sensor->rest_motion = larger(sensor->rest_motion, fabs(command[i] - sensor->first_command));
            sensor->offset += from_mean / (count + 1.0);
            sensor->spread += from_mean * (measured[i] - command[i] - sensor->offset);
            sensor->mean_command += (command[i] - sensor->mean_command) / (count + 1.0);
        } else {
            const double deviation = sqrt(zero_or_more(sensor->spread)) / larger(count, 1.0);
            const double moved = SHARE[i] * sensor->offset;
            if (count < RELIAB_FEWEST || fabs(sensor->offset) <= RELIAB_SIGNIFICANT * deviation) {
                sensor->offset = 0.0;
            } else if (fabs(sensor->mean_command + moved) <= RELIAB_STANDS * fabs(moved)) {
                sensor->standing = -sensor->offset;
                sensor->offset = 0.0;
            } else if (fabs(sensor->offset) <= RELIAB_SIGNIFICANT * deviation + sensor->rest_motion) {
                sensor->offset = 0.0;
            } else {
                /* taken away, as it is */
            }
        }
    }
    monitor->at_rest = moves == 0;
}

#if RELIAB_EFFECTS > 0
/* Displacement, velocity and acceleration through the latest samples, the newest of the past first. */
static void motion_of(double now, const double past[3], double motion[3])
{
    const double last = now - past[0], before = past[0] - past[1], first = past[1] - past[2];
    motion[0] = now;
    motion[1] = (3.0 * last - before) / (2.0 * RELIAB_STEP);
    motion[2] = (2.0 * last - 3.0 * before + first) / (RELIAB_STEP * RELIAB_STEP);
}

static void push(double now, double past[3])
{
    past[2] = past[1];
    past[1] = past[0];
    past[0] = now;
}

/* Weight that a step leaves of the past of command minus measured, as the noise needs, which third differences show. */
static double memory(reliab_specimen *specimen, double now, double travel)
{
    const double *past = specimen->past[2];
    const double bend = now - 3.0 * past[0] + 3.0 * past[1] - past[2];
    double deviation, needed;
    specimen->noise[0] += bend * bend;
    specimen->noise[1] += 1.0;
    specimen->noise[2] = larger(specimen->noise[2], travel);
    deviation = sqrt(specimen->noise[0] / (20.0 * specimen->noise[1]));
    needed = deviation * sqrt(RELIAB_STEP)
        / larger(RELIAB_NOISE_OF_SPEED * specimen->noise[2] / RELIAB_STEP, RELIAB_TINY);
    return exp(-RELIAB_STEP / larger(smaller(pow(needed, 2.0 / 3.0), RELIAB_LONGEST_MEMORY), RELIAB_TINY));
}

static void copy(double from[RELIAB_EFFECTS][RELIAB_EFFECT_STATES], double to[RELIAB_EFFECTS][RELIAB_EFFECT_STATES])
{
    unsigned row, column;
    for (row = 0u; row < RELIAB_EFFECTS; row++) {
        for (column = 0u; column < RELIAB_EFFECT_STATES; column++) {
            to[row][column] = from[row][column];
        }
    }
}

/* Share of the nonlinear specimen in e, for the exact displacement of a linear one; the equation of the exact
 * displacement is solved by secants inside a bracket. */
static double nonlinear_share(reliab_monitor *monitor, double command, double linear, double fed_back)
{
    reliab_specimen *specimen = &monitor->specimen;
    double moved[RELIAB_ORDER] = {0.0}, saved[RELIAB_EFFECTS][RELIAB_EFFECT_STATES], motion[3];
    double measured_force, unforced, ideal, gain = 0.0, before = 0.0, error_before = 0.0, low = 0.0, high = 0.0;
    const double time = (double)monitor->samples * RELIAB_STEP;
    unsigned row, column, attempt;
    int has_low = 0, has_high = 0;
    if (specimen->begun == 0) {
        for (row = 0u; row < 3u; row++) {
            specimen->past[0][row] = command;
            specimen->past[1][row] = linear;
            specimen->past[2][row] = fed_back;
        }
        specimen->path[0] = fed_back;
    } else {
        for (row = 0u; row < RELIAB_ORDER; row++) {
            moved[row] = EARLY[row][0] * specimen->force;
            for (column = 0u; column < RELIAB_ORDER; column++) {
                moved[row] += DECAY[row][column] * specimen->state[column];
            }
        }
        specimen->path[0] += RELIAB_STEP * (specimen->path[1] + 0.5 * RELIAB_STEP * specimen->path[2]);
        specimen->path[1] += RELIAB_STEP * specimen->path[2];
        gain = LATE[0][0];
    }
    {
        const double kept = memory(specimen, fed_back, fabs(command - specimen->past[0][0]));
        const double left = 1.0 - kept, strayed = fed_back - specimen->path[0];
        motion_of(command, specimen->past[0], motion);
        specimen->path[0] += (1.0 - kept * kept * kept) * strayed;
        specimen->path[1] += 1.5 * left * left * (1.0 + kept) / RELIAB_STEP * strayed;
        specimen->path[2] += left * left * left / (RELIAB_STEP * RELIAB_STEP) * strayed;
        for (row = 0u; row < 3u; row++) {
            motion[row] -= specimen->path[row];
        }
    }
    measured_force = nonlinear_force(motion, time, specimen->effects[0]);
    copy(specimen->effects[1], saved);
    unforced = linear - moved[0];
    ideal = unforced - gain * specimen->force;
    for (attempt = 0u; attempt < RELIAB_TRIES; attempt++) {
        double error, slope = 1.0, better;
        copy(saved, specimen->effects[1]);
        motion_of(ideal, specimen->past[1], motion);
        specimen->force = (nonlinear_force(motion, time, specimen->effects[1]) - measured_force) / RELIAB_MASS;
        error = ideal - unforced + gain * specimen->force;
        if (error > 0.0) {
            high = ideal;
            has_high = 1;
        } else {
            low = ideal;
            has_low = 1;
        }
        if (attempt > 0u && (ideal > before || ideal < before)) {
            slope = larger((error - error_before) / (ideal - before), RELIAB_FLATTEST);
        }
        better = ideal - error / slope;
        if (fabs(better - ideal) <= RELIAB_CLOSE * fabs(unforced)) {
            break;
        }
        if (has_low != 0 && has_high != 0 && !(low < better && better < high)) {
            better = 0.5 * (low + high);
        }
        before = ideal;
        error_before = error;
        ideal = better;
    }
    for (row = 0u; row < RELIAB_ORDER; row++) {
        specimen->state[row] = moved[row] + (specimen->begun != 0 ? LATE[row][0] * specimen->force : 0.0);
    }
    specimen->begun = 1;
    push(command, specimen->past[0]);
    push(linear - specimen->state[0], specimen->past[1]);
    push(fed_back, specimen->past[2]);
    return specimen->state[0];
}
#endif

/* The error of an interface displacement; `difference` is command minus measured there, without offsets. */
static void add(const reliab_monitor *monitor, reliab_degree *degree, double error, double ideal, double difference)
{
    const double bend = difference - 2.0 * degree->before[0] + degree->before[1];
    degree->error = error;
    if (monitor->samples > 1u) {
        degree->rough += bend * bend;
    }
    degree->before[1] = degree->before[0];
    degree->before[0] = difference;
    if (monitor->at_rest != 0) {
        return;
    }
    if (monitor->samples == 0u) {
        degree->half_first = 0.5 * error * error;
    }
    degree->square += error * error;
    degree->peak = larger(degree->peak, fabs(error));
    degree->ideal = larger(degree->ideal, fabs(ideal));
    if (degree->ideal > 2.0 * degree->settled_ideal) {
        degree->settled_ideal = degree->ideal;
        degree->settled_sample = monitor->samples;
    }
}

static void add_all(reliab_monitor *monitor, const double command[ACTUATORS], const double difference[ACTUATORS],
                    const double fed_back[ACTUATORS], double responses[RESPONSES][ACTUATORS])
{
    double ideal[ACTUATORS];
    unsigned row, i;
    for (row = 0u; row < ACTUATORS; row++) {
        double response = responses[0][row], apart = difference[row];
        for (i = 0u; i < ACTUATORS; i++) {
            const reliab_sensor *sensor = &monitor->sensors[i];
            response += sensor->offset * responses[1u + i][row] + sensor->standing * responses[1u + ACTUATORS + i][row];
            apart += CARRY[row][i] * sensor->offset;
        }
#if RELIAB_EFFECTS > 0
        if (monitor->at_rest == 0) {
            response += nonlinear_share(monitor, command[0], command[0] - response,
                                        fed_back[0] + monitor->sensors[0].offset);
        }
#else
        (void)fed_back;
#endif
        ideal[row] = command[row] - response;
        add(monitor, &monitor->degrees[row], response - apart, ideal[row], apart);
    }
    for (i = 0u; i < ACTUATORS && monitor->at_rest == 0; i++) {
        double of_mode = 0.0;
        for (row = 0u; row < ACTUATORS; row++) {
            of_mode += MODES[i].projection[row] * ideal[row];
        }
        monitor->energies[i].ideal = larger(monitor->energies[i].ideal, fabs(of_mode));
    }
}

static reliab_fault fault_of(const reliab_monitor *monitor, reliab_sensor *sensor, double command, double measured)
{
    if (!is_finite(command) || !is_finite(measured)) {
        return RELIAB_NOT_FINITE;
    }
    if (fabs(command) >= RELIAB_LARGEST_READING || fabs(measured) >= RELIAB_LARGEST_READING) {
        return RELIAB_TOO_LARGE;
    }
    if (monitor->samples == 0u) {
        sensor->first_command = command;
    }
    sensor->largest_command = larger(sensor->largest_command, fabs(command - sensor->first_command));
    if (monitor->samples > 0u && measured >= sensor->last_measured && measured <= sensor->last_measured) {
        sensor->stuck_samples++;
        sensor->stuck_travel = larger(sensor->stuck_travel, fabs(command - sensor->stuck_from));
    } else {
        sensor->stuck_samples = 0u;
        sensor->stuck_travel = 0.0;
        sensor->stuck_from = command;
    }
    sensor->last_measured = measured;
    if (sensor->stuck_samples >= 8u && sensor->stuck_travel > RELIAB_STUCK_M
        && sensor->stuck_travel > 0.5 * sensor->largest_command) {
        return RELIAB_STUCK;
    }
    return RELIAB_NO_FAULT;
}

static double error_so_far(const reliab_monitor *monitor, unsigned degree)
{
    return RELIAB_METRIC_IS_RMS != 0 ? reliab_monitor_rms(monitor, degree) : reliab_monitor_mte(monitor, degree);
}

/* Whether the displacement moves enough for its noise, which the second differences show. */
static int is_judged(const reliab_monitor *monitor, unsigned degree)
{
    const reliab_degree *of = &monitor->degrees[degree];
    const double steps = larger((double)monitor->samples - 2.0, 1.0);
    return sqrt(of->rough / (6.0 * steps)) < RELIAB_LOST_IN_NOISE * of->ideal;
}

static void raise_alarms(reliab_monitor *monitor)
{
    unsigned i;
    for (i = 0u; i < ACTUATORS; i++) {
        const double calm = ((double)(monitor->samples - 1u) - (double)monitor->degrees[i].settled_sample) * RELIAB_STEP;
        const uint64_t since = monitor->samples % MODES[i].look;
        if (since == 0u && gains_energy(&monitor->energies[i], &MODES[i])) {
            monitor->status |= RELIAB_UNSTABLE;
        }
        if (since == 1u || since == 2u) {
            prepare(&monitor->energies[i], &MODES[i]);
        }
        if (monitor->at_rest == 0 && calm >= RELIAB_CALM && is_judged(monitor, i)
            && RELIAB_SHRINKS * error_so_far(monitor, i) > RELIAB_THRESHOLD) {
            monitor->status |= RELIAB_ERROR;
        }
    }
}

unsigned reliab_monitor_step(reliab_monitor *monitor, const double *command, const double *read)
{
    double responses[RESPONSES][ACTUATORS], measured[ACTUATORS], at_sensors[2][ACTUATORS];
    double moved[ACTUATORS], difference[ACTUATORS], fed_back[ACTUATORS];
    unsigned i, k;
    if ((monitor->status & RELIAB_FAULT) != 0u) {
        return monitor->status;
    }
    for (i = 0u; i < ACTUATORS; i++) {
        measured[i] = read[i] / RELIAB_SENSOR_SCALE;
        monitor->fault = fault_of(monitor, &monitor->sensors[i], command[i], measured[i]);
        if (monitor->fault != RELIAB_NO_FAULT) {
            monitor->status |= RELIAB_FAULT;
            return monitor->status;
        }
    }
    monitor->newest = (monitor->newest + 1u) % LAG_RING;
    for (i = 0u; i < ACTUATORS; i++) {
        at_sensors[0][i] = command[i] - measured[i];
        at_sensors[1][i] = command[i] - felt(monitor, &monitor->sensors[i], measured[i]);
    }
    carry(command, moved);
    carry(at_sensors[0], difference);
    carry(at_sensors[1], fed_back);
    respond(monitor, fed_back, responses);
    for (i = 0u; i < ACTUATORS; i++) {
        double commanded = 0.0, error = 0.0;
        for (k = 0u; k < ACTUATORS; k++) {
            commanded += MODES[i].projection[k] * moved[k];
            error -= MODES[i].projection[k] * difference[k];
        }
        remember(&monitor->energies[i], &MODES[i], commanded, error, monitor->samples == 0u);
    }
    if (monitor->at_rest != 0) {
        learn(monitor, command, measured);
    }
    add_all(monitor, moved, difference, fed_back, responses);
    monitor->samples++;
    raise_alarms(monitor);
    return monitor->status;
}

static int is_faulty(const reliab_monitor *monitor) { return (monitor->status & RELIAB_FAULT) != 0u; }

double reliab_monitor_error(const reliab_monitor *monitor, unsigned degree)
{
    return is_faulty(monitor) ? not_a_number() : monitor->degrees[degree].error;
}

double reliab_monitor_rms(const reliab_monitor *monitor, unsigned degree)
{
    const reliab_degree *of = &monitor->degrees[degree];
    double inner, steps;
    if (is_faulty(monitor)) {
        return not_a_number();
    }
    inner = of->square - of->half_first - 0.5 * of->error * of->error;
    steps = monitor->samples > 1u ? (double)(monitor->samples - 1u) : 1.0;
    return of->ideal > 0.0 ? sqrt(zero_or_more(inner) / steps) / of->ideal : 0.0;
}

double reliab_monitor_mte(const reliab_monitor *monitor, unsigned degree)
{
    const reliab_degree *of = &monitor->degrees[degree];
    if (is_faulty(monitor)) {
        return not_a_number();
    }
    return of->ideal > 0.0 ? of->peak / of->ideal : 0.0;
}

unsigned reliab_monitor_governing(const reliab_monitor *monitor)
{
    unsigned i, governing = 0u;
    double largest = -1.0;
    for (i = 0u; i < ACTUATORS; i++) {
        const double error = is_judged(monitor, i) ? error_so_far(monitor, i) : -1.0;
        if (error > largest) {
            largest = error;
            governing = i;
        }
    }
    return governing;
}

double reliab_monitor_net_damping(const reliab_monitor *monitor)
{
    double smallest = not_a_number();
    unsigned i;
    for (i = 0u; i < ACTUATORS && !is_faulty(monitor); i++) {
        const double damping = monitor->energies[i].net_damping;
        if (is_finite(damping) && (!is_finite(smallest) || damping < smallest)) {
            smallest = damping;
        }
    }
    return smallest;
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
