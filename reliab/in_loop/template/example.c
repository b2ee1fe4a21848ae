/* Follow a CSV with one line of names and a command and a measured displacement [m] of each actuator in turn.
 *     cc -std=c99 -O2 reliab_monitor.c example.c -lm -o example && ./example test.csv
 * Prints the error of each interface displacement, RMS^R and MTE^R of the governing one, net damping and status of
 * each sample; stops at a fault. Returns the last status, or 8 where the file cannot be followed. */
#include "reliab_monitor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOT_FOLLOWED 8
#define LONGEST_LINE 8192

static int is_blank(const char *line) { return line[strspn(line, " \t\r\n")] == '\0'; }

/* The numbers of a line, with commas between them; 0 where there are more, fewer or others. */
static int read_row(const char *line, double command[RELIAB_ACTUATORS], double measured[RELIAB_ACTUATORS])
{
    unsigned i;
    for (i = 0u; i < 2u * RELIAB_ACTUATORS; i++) {
        char *end;
        const double value = strtod(line, &end);
        if (end == line) {
            return 0;
        }
        *(i % 2u == 0u ? &command[i / 2u] : &measured[i / 2u]) = value;
        line = end + strspn(end, " \t");
        if (i + 1u < 2u * RELIAB_ACTUATORS && *line++ != ',') {
            return 0;
        }
    }
    return is_blank(line);
}

static void print_sample(const reliab_monitor *monitor, unsigned status)
{
    const unsigned governing = reliab_monitor_governing(monitor);
    unsigned i;
    for (i = 0u; i < RELIAB_ACTUATORS; i++) {
        (void)printf("%.17g ", reliab_monitor_error(monitor, i));
    }
    (void)printf("%.17g %.17g %.17g %u\n", reliab_monitor_rms(monitor, governing),
                 reliab_monitor_mte(monitor, governing), reliab_monitor_net_damping(monitor), status);
}

int main(int count, char **arguments)
{
    static reliab_monitor monitor;
    static char line[LONGEST_LINE];
    double command[RELIAB_ACTUATORS], measured[RELIAB_ACTUATORS];
    unsigned long number = 1u;
    FILE *file = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (file == NULL || fgets(line, LONGEST_LINE, file) == NULL) {
        (void)fprintf(stderr, "usage: example FILE.csv, which must be readable\n");
        return NOT_FOLLOWED;
    }
    if (read_row(line, command, measured)) {
        (void)fprintf(stderr, "line 1 must hold names; it holds numbers\n");
        (void)fclose(file);
        return NOT_FOLLOWED;
    }
    reliab_monitor_init(&monitor);
    while ((monitor.status & RELIAB_FAULT) == 0u && fgets(line, LONGEST_LINE, file) != NULL) {
        number++;
        if (is_blank(line)) {
            continue;
        }
        if (!read_row(line, command, measured)) {
            (void)fprintf(stderr, "line %lu must hold %u numbers: a command and a measured displacement [m] of each "
                          "actuator\n", number, 2u * RELIAB_ACTUATORS);
            (void)fclose(file);
            return NOT_FOLLOWED;
        }
        print_sample(&monitor, reliab_monitor_step(&monitor, command, measured));
    }
    (void)fclose(file);
    (void)fprintf(stderr, "%s\n", reliab_monitor_reason(&monitor));
    return (int)monitor.status;
}
