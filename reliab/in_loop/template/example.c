/* Follow a CSV with one line of names and a command and a measured displacement [m] of each actuator in turn.
 *     cc -std=c99 -O2 reliab_monitor.c example.c -lm -o example && ./example test.csv
 * Prints the error of each interface displacement, RMS^R and MTE^R of the governing one, net damping and status of
 * each sample; stops at a fault. */
#include "reliab_monitor.h"

#include <stdio.h>

static int read_row(FILE *file, double command[RELIAB_ACTUATORS], double measured[RELIAB_ACTUATORS])
{
    unsigned i;
    int read = 1;
    for (i = 0u; i < RELIAB_ACTUATORS && read != 0; i++) {
        read = fscanf(file, i == 0u ? "%lf" : ",%lf", &command[i]) == 1 && fscanf(file, ",%lf", &measured[i]) == 1;
    }
    return read;
}

int main(int count, char **arguments)
{
    reliab_monitor monitor;
    double command[RELIAB_ACTUATORS], measured[RELIAB_ACTUATORS];
    char names[1024];
    FILE *file = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (file == NULL || fgets(names, (int)sizeof names, file) == NULL) {
        (void)fprintf(stderr, "usage: example FILE.csv\n");
        return 2;
    }
    reliab_monitor_init(&monitor);
    while (read_row(file, command, measured)) {
        const unsigned status = reliab_monitor_step(&monitor, command, measured);
        const unsigned governing = reliab_monitor_governing(&monitor);
        unsigned i;
        for (i = 0u; i < RELIAB_ACTUATORS; i++) {
            (void)printf("%.17g ", reliab_monitor_error(&monitor, i));
        }
        (void)printf("%.17g %.17g %.17g %u\n", reliab_monitor_rms(&monitor, governing),
                     reliab_monitor_mte(&monitor, governing), reliab_monitor_net_damping(&monitor), status);
        if ((status & RELIAB_FAULT) != 0u) {
            break;
        }
    }
    (void)fclose(file);
    (void)fprintf(stderr, "%s\n", reliab_monitor_reason(&monitor));
    return (int)monitor.status;
}
