/* Follow a CSV of two columns, command and measured displacement [m], with one line of names.
 *     cc -std=c99 -O2 reliab_monitor.c example.c -lm -o example && ./example test.csv
 * Prints the error, RMS^R, MTE^R, net damping and status of each sample; stops at a fault. */
#include "reliab_monitor.h"

#include <stdio.h>

int main(int count, char **arguments)
{
    reliab_monitor monitor;
    double command, measured;
    char names[256];
    FILE *file = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (file == NULL || fgets(names, (int)sizeof names, file) == NULL) {
        (void)fprintf(stderr, "usage: example FILE.csv\n");
        return 2;
    }
    reliab_monitor_init(&monitor);
    while (fscanf(file, "%lf,%lf", &command, &measured) == 2) {
        const unsigned status = reliab_monitor_step(&monitor, command, measured);
        (void)printf("%.17g %.17g %.17g %.17g %u\n", reliab_monitor_error(&monitor), reliab_monitor_rms(&monitor),
                     reliab_monitor_mte(&monitor), reliab_monitor_net_damping(&monitor), status);
        if ((status & RELIAB_FAULT) != 0u) {
            break;
        }
    }
    (void)fclose(file);
    (void)fprintf(stderr, "%s\n", reliab_monitor_reason(&monitor));
    return (int)monitor.status;
}
