#define _GNU_SOURCE
#include "reliab_monitor.h"
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#define MOST 10000000
static unsigned once[MOST + 1], least[MOST + 1];  /* steps by nanoseconds */
static long median(const unsigned *counts, long steps)
{
    long sum = 0, k;
    for (k = 0; k < MOST && 2 * (sum += counts[k]) < steps; k++) { }
    return k;
}
static long timed(reliab_monitor *monitor, const double *x, const double *y)
{
    struct timespec a, b;
    clock_gettime(CLOCK_MONOTONIC, &a);
    (void)reliab_monitor_step(monitor, x, y);
    clock_gettime(CLOCK_MONOTONIC, &b);
    {
        const long spent = (b.tv_sec - a.tv_sec) * 1000000000L + b.tv_nsec - a.tv_nsec;
        return spent < MOST ? spent : MOST;
    }
}
static void say(const unsigned *counts, long steps)
{
    long sum = 0, k, half = -1, most = -1, worst = 0, beyond = 0;
    for (k = 0; k <= MOST; k++) {
        sum += counts[k];
        if (half < 0 && 2 * sum >= steps) { half = k; }
        if (most < 0 && 10000.0 * (double)sum >= 9999.0 * (double)steps) { most = k; }
        if (counts[k] > 0) { worst = k; }
        if (half >= 0 && k > 10 * half) { beyond += counts[k]; }
    }
    printf("%ld %ld %ld %ld ", half, most, worst, beyond);
}
int main(int n, char **words)
{
    static reliab_monitor monitor, before, repeated;
    const long steps = n > 1 ? atol(words[1]) : 1000000L;
    const int locked = mlockall(MCL_CURRENT) == 0;
    struct rusage use;
    cpu_set_t one;
    long i, switches, taken = 0, typical = 0, again = 0;
    int alone;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    alone = sched_setaffinity(0, sizeof one, &one) == 0;
    memset(once, 0, sizeof once);
    memset(least, 0, sizeof least);
    reliab_monitor_init(&monitor);
    for (i = 0; i < steps; i++) {
        double x[RELIAB_ACTUATORS], y[RELIAB_ACTUATORS];
        long spent, smallest, r;
        unsigned k;
        for (k = 0u; k < RELIAB_ACTUATORS; k++) {
            x[k] = 0.01 * sin((6.0 + k) * RELIAB_STEP * (double)i);
            y[k] = 0.99 * x[k] + 1e-6 * sin(0.7 * (double)i);
        }
        if (i == 10000) { typical = median(least, i); }
        memcpy(&before, &monitor, sizeof monitor);
        getrusage(RUSAGE_THREAD, &use);
        switches = use.ru_nivcsw;
        smallest = timed(&monitor, x, y);
        once[smallest]++;
        /* the same step from the same state, where it took long */
        for (r = 1; smallest > 2 * typical && (r < 3 || smallest > 5 * typical) && r < REPEATED; r++) {
            memcpy(&repeated, &before, sizeof monitor);
            spent = timed(&repeated, x, y);
            smallest = spent < smallest ? spent : smallest;
        }
        again += r > 1;
        least[smallest]++;
        getrusage(RUSAGE_THREAD, &use);
        taken += use.ru_nivcsw > switches;
    }
    say(once, steps);
    say(least, steps);
    printf("%ld %ld %d %d\n", again, taken, alone, locked);
    return (int)(monitor.status & RELIAB_FAULT);
}
