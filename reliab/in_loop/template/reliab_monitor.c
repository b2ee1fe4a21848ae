/* The error of a hybrid test while it runs: see reliab_monitor.h. The equations are those of
 * reliab/assessment/rebuilt_error/: recursion.py, running_error.py, running_specimen.py, loop_energy.py, and
 * of ../rebuild.py. */
#include "reliab_monitor.h"

#include <math.h>

#define ACTUATORS RELIAB_ACTUATORS
#define RESPONSES (1u + 2u * ACTUATORS)
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
static double zero_or_more(double a) { return larger(a, 0.0); }

typedef struct {
    double projection[ACTUATORS]; /* of interface displacements on the mode */
    double band[3];               /* coefficients of its band-pass */
    double exchange[RELIAB_MODES]; /* by which the other modes take its energy over */
    double ratio, forgetting, samples, circular_frequency;
    uint64_t look;
    unsigned place;               /* among all modes */
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
        for (row = 0u; row < RELIAB_ORDER; row++) {
            monitor->states[1u + ACTUATORS + i][row] = EQUILIBRIUM[row][i];
        }
    }
    for (i = 0u; i < RELIAB_WATCHED; i++) {
        monitor->energies[i].net_damping = not_a_number();
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

/* A value through the band-pass of a mode. */
static double passed(double state[2], const mode *of, double change)
{
    const double value = of->band[0] * change + state[0];
    state[0] = state[1] - of->band[1] * value;
    state[1] = -of->band[0] * change - of->band[2] * value;
    return value;
}

/* Products of command, its velocity and the actuators' error in the band of a mode, with an exponential memory. */
static void remember(reliab_energy *energy, const mode *of, double command, double error, int first)
{
    double now[2], stepped[3];
    unsigned row, column;
    if (first != 0) {
        energy->first[0] = command;
        energy->first[1] = error;
    }
    now[0] = passed(energy->band[0], of, command - energy->first[0]);
    now[1] = passed(energy->band[1], of, error - energy->first[1]);
    if (first == 0) {
        for (row = 0u; row < 3u; row++) {
            stepped[row] = -energy->between[row];
        }
        energy->between[0] = 0.5 * (now[0] + energy->last[0]);
        energy->between[1] = (now[0] - energy->last[0]) / RELIAB_STEP;
        energy->between[2] = 0.5 * (now[1] + energy->last[1]);
        for (row = 0u; row < 3u; row++) {
            stepped[row] += energy->between[row];
        }
        for (row = 0u; row < 3u; row++) {
            for (column = 0u; column < 3u; column++) {
                energy->moments[0][row][column] = of->forgetting * energy->moments[0][row][column]
                    + energy->between[row] * energy->between[column];
                energy->moments[1][row][column] = of->forgetting * energy->moments[1][row][column]
                    + stepped[row] * stepped[column];
            }
        }
        energy->weight = of->forgetting * energy->weight + 1.0;
        if (energy->between[1] > 0.0 || energy->between[1] < 0.0) {
            energy->moved_samples += 1.0;
        }
        energy->largest_power = larger(energy->largest_power, energy->moments[0][1][1]);
    }
    energy->last[0] = now[0];
    energy->last[1] = now[1];
}

typedef struct {
    double real, imaginary;
} number;

static number plus(number a, number b)
{
    const number sum = {a.real + b.real, a.imaginary + b.imaginary};
    return sum;
}

static number times(number a, number b)
{
    const number product = {a.real * b.real - a.imaginary * b.imaginary, a.real * b.imaginary + a.imaginary * b.real};
    return product;
}

static number multiple(double factor, number a)
{
    const number product = {factor * a.real, factor * a.imaginary};
    return product;
}

static number over(number a, number b)
{
    const double size = b.real * b.real + b.imaginary * b.imaginary;
    const number quotient = {(a.real * b.real + a.imaginary * b.imaginary) / size,
                             (a.imaginary * b.real - a.real * b.imaginary) / size};
    return quotient;
}

/* Modal force of the error per displacement, and its derivatives by a + b s and by s. */
static void force_of(const mode *of, const double law[2], number pole, number force[3])
{
    const number one = {1.0, 0.0}, none = {0.0, 0.0};
    number error = multiple(law[1], pole), squared, through = none, by_error = none, by_pole = none;
    unsigned j;
    error.real += law[0];
    squared = times(error, error);
    for (j = 0u; j < RELIAB_MODES; j++) {
        if (j != of->place && of->exchange[j] != 0.0) { /* uncoupled modes may have one pole */
            number dynamic = plus(times(pole, pole), plus(multiple(TWICE[j], pole), multiple(STIFFNESSES[j], error)));
            number share, turned, slope = multiple(2.0, pole);
            dynamic.real += SQUARES[j];
            share = over(multiple(of->exchange[j], one), dynamic);
            turned = times(squared, over(share, dynamic));
            slope.real += TWICE[j];
            through = plus(through, share);
            by_error = plus(by_error, multiple(STIFFNESSES[j], turned));
            by_pole = plus(by_pole, times(turned, slope));
        }
    }
    force[0] = plus(multiple(STIFFNESSES[of->place], error), multiple(-1.0, times(squared, through)));
    force[1] = plus(plus(multiple(STIFFNESSES[of->place], one), multiple(-2.0, times(error, through))), by_error);
    force[2] = by_pole;
}

/* Damping ratio of the pole under x_m - x_c = a x_c + b x_c', and its standard error. */
static void pole_of(const mode *of, const double law[2], const double chance[2], double damping[2])
{
    const double omega = of->circular_frequency, twice = 2.0 * of->ratio * omega;
    const number minus_one = {-1.0, 0.0};
    number pole, force[3], below, moves;
    double by_gain, by_delay;
    unsigned turn;
    pole.real = -of->ratio * omega;
    pole.imaginary = omega;
    for (turn = 0u; turn < RELIAB_TURNS; turn++) {
        double slope, square, half;
        force_of(of, law, pole, force);
        slope = force[0].imaginary / pole.imaginary;
        square = omega * omega + force[0].real - slope * pole.real;
        half = -0.5 * (twice + slope);
        pole.real = half;
        pole.imaginary = sqrt(larger(square - half * half, RELIAB_SLOWEST * omega * RELIAB_SLOWEST * omega));
    }
    force_of(of, law, pole, force);
    below = plus(multiple(2.0, pole), plus(force[2], multiple(law[1], force[1])));
    below.real += twice;
    moves = over(times(minus_one, force[1]), below);
    by_gain = moves.real * chance[0];
    by_delay = times(moves, pole).real * chance[1];
    damping[0] = -pole.real / omega;
    damping[1] = sqrt(by_gain * by_gain + by_delay * by_delay) / omega;
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
    return exceeded(RELIAB_FALSE_ALARMS / (double)RELIAB_WATCHED / (window * (window + 1.0)));
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

static double quadratic(double matrix[3][3], const double vector[3])
{
    double total = 0.0;
    unsigned row, column;
    for (row = 0u; row < 3u; row++) {
        for (column = 0u; column < 3u; column++) {
            total += vector[row] * matrix[row][column] * vector[column];
        }
    }
    return total;
}

/* The error of a mode as a law of its command, x_m - x_c = a x_c + b x_c'. */
typedef struct {
    double scale[3];
    double residual[3];
    double chance; /* standard error of the scaled law */
    double across; /* scaled error that is not in phase */
} fitted;

static fitted fit(const reliab_energy *energy, const mode *of)
{
    fitted found;
    double joint[3][3], steps[3][3], determinant, left, rough, independent;
    unsigned row, column;
    for (row = 0u; row < 3u; row++) {
        found.scale[row] = sqrt(larger(energy->moments[0][row][row], TINY));
    }
    for (row = 0u; row < 3u; row++) {
        for (column = 0u; column < 3u; column++) {
            joint[row][column] = energy->moments[0][row][column] / (found.scale[row] * found.scale[column]);
            steps[row][column] = energy->moments[1][row][column] / (found.scale[row] * found.scale[column]);
        }
    }
    determinant = larger(1.0 - joint[0][1] * joint[0][1], RELIAB_SINGULAR);
    found.residual[0] = -(joint[0][2] - joint[0][1] * joint[1][2]) / determinant;
    found.residual[1] = -(joint[1][2] - joint[0][1] * joint[0][2]) / determinant;
    found.residual[2] = 1.0;
    left = larger(quadratic(joint, found.residual), 0.0);
    rough = left > 0.0 ? smaller(quadratic(steps, found.residual) / left, 1.0) : 0.0;
    independent = larger(energy->weight * larger(rough / (4.0 - rough), RELIAB_INDEPENDENT / of->samples), 1.0);
    found.chance = sqrt(left / independent / determinant);
    found.across = sqrt(larger(1.0 - joint[0][2] * joint[0][2], 0.0));
    return found;
}

/* Whether the piston follows its command, and does not rest within some play. */
static int follows(const fitted *error, double needed)
{
    const double *scale = error->scale;
    const double chance = needed * error->chance;
    const double in_phase = larger(fabs(scale[0] - error->residual[0] * scale[2]) - chance * scale[2], 0.0);
    const double late = larger((fabs(error->residual[1]) - chance) * scale[2], 0.0);
    return sqrt(in_phase * in_phase + late * late) > RELIAB_FOLLOWS * scale[0];
}

/* Damping ratio that play takes away at most at an amplitude. */
static double granted(const reliab_energy *energy, const mode *of, double amplitude)
{
    const double share = smaller(RELIAB_GRANTED * energy->play / amplitude, 0.5);
    const double of_play = STIFFNESSES[of->place] / (2.0 * PI * of->circular_frequency * of->circular_frequency);
    return RELIAB_GRANTED * 4.0 * of_play * share * (1.0 - share);
}

/* Whether the loop gains energy in a mode and may diverge. */
static int gains_energy(reliab_energy *energy, const mode *of)
{
    const double power = energy->moments[0][1][1];
    double law[2], chance[2], damping[2], needed, amplitude, error, play;
    fitted found;
    int is_known;
    unsigned row;
    energy->net_damping = not_a_number();
    if (energy->moved_samples < of->samples || !(power > 0.0)) {
        return 0;
    }
    found = fit(energy, of);
    for (row = 0u; row < 2u; row++) {
        const double unit = found.scale[2] / found.scale[row];
        law[row] = -found.residual[row] * unit;
        chance[row] = found.chance * unit;
    }
    pole_of(of, law, chance, damping);
    needed = needed_in(energy, window_of(energy, of));
    is_known = needed * chance[0] < RELIAB_UNSURE;
    if (is_known != 0) {
        energy->net_damping = damping[0];
    }
    amplitude = sqrt(2.0 / energy->weight) * found.scale[0];
    error = found.across * found.scale[2] / found.scale[0];
    energy->following = follows(&found, needed) != 0 ? (energy->following < 2u ? energy->following + 1u : 2u) : 0u;
    if (energy->following > 1u) { /* not while it only begins to move */
        play = 0.5 * amplitude * (1.0 - sqrt(zero_or_more(1.0 - PI * error)));
        energy->play = energy->has_play != 0 ? smaller(energy->play, play) : play;
        energy->has_play = 1;
    }
    return power > RELIAB_LARGE_MOTION * energy->largest_power && is_known != 0 && energy->has_play != 0
        && damping[0] + needed * damping[1] + granted(energy, of, amplitude) < 0.0;
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
            moved[row] = PUSHED_EARLY[row] * specimen->force;
            for (column = 0u; column < RELIAB_ORDER; column++) {
                moved[row] += DECAY[row][column] * specimen->state[column];
            }
        }
        specimen->path[0] += RELIAB_STEP * (specimen->path[1] + 0.5 * RELIAB_STEP * specimen->path[2]);
        specimen->path[1] += RELIAB_STEP * specimen->path[2];
        gain = PUSHED_LATE[0];
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
        specimen->state[row] = moved[row] + (specimen->begun != 0 ? PUSHED_LATE[row] * specimen->force : 0.0);
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
        add(monitor, &monitor->degrees[row], response - apart, command[row] - response, apart);
    }
}

/* Whether the measured value has stood still for too long: while the command made half of its largest motion, or, of a
 * sensor that has moved for a period and never stood still for so long, a hundredth. */
static int is_stuck(const reliab_sensor *sensor)
{
    const double travel = sensor->stuck_travel, largest = sensor->largest_command;
    const int is_new = sensor->stuck_samples >= RELIAB_LONGER * sensor->longest_stuck
        && sensor->changes > WATCHED[0].samples;
    if (sensor->stuck_samples < RELIAB_FEWEST_STUCK || largest <= RELIAB_STUCK_M) {
        return 0;
    }
    return (travel > RELIAB_STUCK_M && travel > 0.5 * largest) || (is_new != 0 && travel > RELIAB_STUCK_SHARE * largest);
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
        if (sensor->stuck_samples > sensor->longest_stuck) {
            sensor->longest_stuck = sensor->stuck_samples;
        }
        sensor->changes += 1.0;
        sensor->stuck_samples = 0u;
        sensor->stuck_travel = 0.0;
        sensor->stuck_from = command;
    }
    sensor->last_measured = measured;
    return is_stuck(sensor) != 0 ? RELIAB_STUCK : RELIAB_NO_FAULT;
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
    for (i = 0u; i < RELIAB_WATCHED; i++) {
        const uint64_t since = monitor->samples % WATCHED[i].look;
        if (since == 0u && gains_energy(&monitor->energies[i], &WATCHED[i]) != 0
            && (monitor->status & RELIAB_UNSTABLE) == 0u) {
            monitor->status |= RELIAB_UNSTABLE;
            monitor->gaining = i;
        }
        if (since == 1u || since == 2u) {
            prepare(&monitor->energies[i], &WATCHED[i]);
        }
    }
    for (i = 0u; i < ACTUATORS; i++) {
        const double calm = ((double)(monitor->samples - 1u) - (double)monitor->degrees[i].settled_sample) * RELIAB_STEP;
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
    for (i = 0u; i < RELIAB_WATCHED; i++) {
        double commanded = 0.0, error = 0.0;
        for (k = 0u; k < ACTUATORS; k++) {
            commanded += WATCHED[i].projection[k] * moved[k];
            error -= WATCHED[i].projection[k] * difference[k];
        }
        remember(&monitor->energies[i], &WATCHED[i], commanded, error, monitor->samples == 0u);
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
    for (i = 0u; i < RELIAB_WATCHED && !is_faulty(monitor); i++) {
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
        return REASONS[monitor->gaining];
    }
    if ((monitor->status & RELIAB_ERROR) != 0u) {
        return "the error is above twice the threshold";
    }
    return "no alarm";
}
