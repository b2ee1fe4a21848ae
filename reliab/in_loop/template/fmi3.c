/* reliab_monitor as an FMU for co-simulation, FMI 3.0. The importer brings fmi3Functions.h. */
#include "fmi3Functions.h"

#include "unit.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

typedef const fmi3ValueReference *places;

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                         fmi3Boolean early, places intermediate, size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    return n == 0u ? unit_made(token) : NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3Reset(fmi3Instance c)
{
    unit_rest((unit *)c);
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, places at, size_t n, const fmi3Float64 values[], size_t m)
{
    size_t i;
    int refused = n != m;
    for (i = 0u; i < n && !refused; i++) {
        refused = unit_set((unit *)c, at[i], values[i]);
    }
    return refused ? fmi3Error : fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, places at, size_t n, fmi3Float64 values[], size_t m)
{
    size_t i;
    int refused = n != m;
    for (i = 0u; i < n && !refused; i++) {
        refused = unit_get((const unit *)c, at[i], &values[i]);
    }
    return refused ? fmi3Error : fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance c, places at, size_t n, fmi3Int32 values[], size_t m)
{
    size_t i;
    int refused = n != m;
    for (i = 0u; i < n && !refused; i++) {
        int value;
        refused = unit_get_whole((const unit *)c, at[i], &value);
        values[i] = (fmi3Int32)value;
    }
    return refused ? fmi3Error : fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance c, places at, size_t n, const fmi3Boolean values[], size_t m)
{
    size_t i;
    int refused = n != m;
    for (i = 0u; i < n && !refused; i++) {
        refused = unit_set_yes_or_no((unit *)c, at[i], values[i]);
    }
    return refused ? fmi3Error : fmi3OK;
}

fmi3Status fmi3GetBoolean(fmi3Instance c, places at, size_t n, fmi3Boolean values[], size_t m)
{
    size_t i;
    int refused = n != m;
    for (i = 0u; i < n && !refused; i++) {
        int value;
        refused = unit_get_yes_or_no((const unit *)c, at[i], &value);
        values[i] = value != 0;
    }
    return refused ? fmi3Error : fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 now, fmi3Float64 step, fmi3Boolean final,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    static const fmi3Status answers[3] = {fmi3OK, fmi3Warning, fmi3Error};
    const int answer = unit_step((unit *)c, step);
    *event = *terminate = *early = fmi3False;
    *last = answer == 2 ? now : now + step;
    ((unit *)c)->time = *last;
    return answers[answer];
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    ((unit *)c)->time = start;
    return fmi3OK;
}

#define DONE(name, arguments) fmi3Status name arguments { return fmi3OK; }
DONE(fmi3ExitInitializationMode, (fmi3Instance c))
DONE(fmi3Terminate, (fmi3Instance c))
DONE(fmi3EnterConfigurationMode, (fmi3Instance c))
DONE(fmi3ExitConfigurationMode, (fmi3Instance c))
DONE(fmi3EnterStepMode, (fmi3Instance c))
DONE(fmi3SetDebugLogging, (fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String names[]))

/* There is nothing else to set, get, store or differentiate. */
#define REFUSED(name, arguments) fmi3Status name arguments { return fmi3Error; }
#define NO_OTHER(name, type) \
    fmi3Status name(fmi3Instance c, places at, size_t n, type v[], size_t m) \
    { \
        return n == 0u ? fmi3OK : fmi3Error; \
    }
#define NEITHER(kind) \
    NO_OTHER(fmi3Get##kind, fmi3##kind) \
    NO_OTHER(fmi3Set##kind, const fmi3##kind)
NEITHER(Float32)
NEITHER(Int8)
NEITHER(UInt8)
NEITHER(Int16)
NEITHER(UInt16)
NO_OTHER(fmi3SetInt32, const fmi3Int32)
NEITHER(UInt32)
NEITHER(Int64)
NEITHER(UInt64)
NEITHER(String)
REFUSED(fmi3GetBinary, (fmi3Instance c, places at, size_t n, size_t sizes[], fmi3Binary v[], size_t m))
REFUSED(fmi3SetBinary, (fmi3Instance c, places at, size_t n, const size_t sizes[], const fmi3Binary v[], size_t m))
REFUSED(fmi3GetClock, (fmi3Instance c, places at, size_t n, fmi3Clock v[]))
REFUSED(fmi3SetClock, (fmi3Instance c, places at, size_t n, const fmi3Clock v[]))
REFUSED(fmi3GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference at, size_t *n))
REFUSED(fmi3GetVariableDependencies, (fmi3Instance c, fmi3ValueReference at, size_t e[], fmi3ValueReference i[],
                                      size_t j[], fmi3DependencyKind k[], size_t n))
REFUSED(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *s))
REFUSED(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState s))
REFUSED(fmi3FreeFMUState, (fmi3Instance c, fmi3FMUState *s))
REFUSED(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState s, size_t *n))
REFUSED(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState s, fmi3Byte b[], size_t n))
REFUSED(fmi3DeserializeFMUState, (fmi3Instance c, const fmi3Byte b[], size_t n, fmi3FMUState *s))
REFUSED(fmi3GetDirectionalDerivative, (fmi3Instance c, places u, size_t nu, places k, size_t nk,
                                       const fmi3Float64 seed[], size_t ns, fmi3Float64 d[], size_t nd))
REFUSED(fmi3GetAdjointDerivative, (fmi3Instance c, places u, size_t nu, places k, size_t nk,
                                   const fmi3Float64 seed[], size_t ns, fmi3Float64 d[], size_t nd))
REFUSED(fmi3GetIntervalDecimal, (fmi3Instance c, places at, size_t n, fmi3Float64 v[], fmi3IntervalQualifier q[]))
REFUSED(fmi3GetIntervalFraction, (fmi3Instance c, places at, size_t n, fmi3UInt64 v[], fmi3UInt64 r[],
                                  fmi3IntervalQualifier q[]))
REFUSED(fmi3GetShiftDecimal, (fmi3Instance c, places at, size_t n, fmi3Float64 v[]))
REFUSED(fmi3GetShiftFraction, (fmi3Instance c, places at, size_t n, fmi3UInt64 v[], fmi3UInt64 r[]))
REFUSED(fmi3SetIntervalDecimal, (fmi3Instance c, places at, size_t n, const fmi3Float64 v[]))
REFUSED(fmi3SetIntervalFraction, (fmi3Instance c, places at, size_t n, const fmi3UInt64 v[], const fmi3UInt64 r[]))
REFUSED(fmi3SetShiftDecimal, (fmi3Instance c, places at, size_t n, const fmi3Float64 v[]))
REFUSED(fmi3SetShiftFraction, (fmi3Instance c, places at, size_t n, const fmi3UInt64 v[], const fmi3UInt64 r[]))
REFUSED(fmi3EvaluateDiscreteStates, (fmi3Instance c))
REFUSED(fmi3UpdateDiscreteStates, (fmi3Instance c, fmi3Boolean *a, fmi3Boolean *b, fmi3Boolean *d,
                                   fmi3Boolean *e, fmi3Boolean *f, fmi3Float64 *t))
REFUSED(fmi3EnterEventMode, (fmi3Instance c))
REFUSED(fmi3EnterContinuousTimeMode, (fmi3Instance c))
REFUSED(fmi3CompletedIntegratorStep, (fmi3Instance c, fmi3Boolean a, fmi3Boolean *b, fmi3Boolean *d))
REFUSED(fmi3SetTime, (fmi3Instance c, fmi3Float64 time))
REFUSED(fmi3SetContinuousStates, (fmi3Instance c, const fmi3Float64 v[], size_t n))
REFUSED(fmi3GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 v[], size_t n))
REFUSED(fmi3GetEventIndicators, (fmi3Instance c, fmi3Float64 v[], size_t n))
REFUSED(fmi3GetContinuousStates, (fmi3Instance c, fmi3Float64 v[], size_t n))
REFUSED(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 v[], size_t n))
REFUSED(fmi3GetNumberOfEventIndicators, (fmi3Instance c, size_t *n))
REFUSED(fmi3GetNumberOfContinuousStates, (fmi3Instance c, size_t *n))
REFUSED(fmi3GetOutputDerivatives, (fmi3Instance c, places at, size_t n, const fmi3Int32 order[], fmi3Float64 v[],
                                   size_t m))
REFUSED(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))
