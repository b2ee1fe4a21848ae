/* reliab_monitor as an FMU for co-simulation, FMI 2.0. The importer brings fmi2Functions.h; memory is asked for
 * once, where the unit is made. */
#include "fmi2Functions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reliab_monitor.h"

typedef struct {
    reliab_monitor monitor;
    double inputs[2];
} unit;

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    unit *made;
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || strcmp(guid, "@GUID@") != 0) {
        return NULL;
    }
    made = (unit *)calloc(1u, sizeof *made);
    if (made != NULL) {
        reliab_monitor_init(&made->monitor);
    }
    return made;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    unit *here = (unit *)c;
    reliab_monitor_init(&here->monitor);
    here->inputs[0] = here->inputs[1] = 0.0;
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Real values[])
{
    size_t i;
    for (i = 0u; i < n; i++) {
        if (at[i] > 1u) {
            return fmi2Error;
        }
        ((unit *)c)->inputs[at[i]] = values[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Real values[])
{
    const unit *here = (const unit *)c;
    size_t i;
    for (i = 0u; i < n; i++) {
        switch (at[i]) {
        case 0u:
        case 1u: values[i] = here->inputs[at[i]]; break;
        case 2u: values[i] = reliab_monitor_error(&here->monitor); break;
        case 3u: values[i] = reliab_monitor_rms(&here->monitor); break;
        case 4u: values[i] = reliab_monitor_mte(&here->monitor); break;
        case 5u: values[i] = reliab_monitor_net_damping(&here->monitor); break;
        default: return fmi2Error;
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Integer values[])
{
    size_t i;
    for (i = 0u; i < n; i++) {
        if (at[i] != 6u) {
            return fmi2Error;
        }
        values[i] = (fmi2Integer)((const unit *)c)->monitor.status;
    }
    return fmi2OK;
}

/* One sample: the step must be the one that was exported. A fault is an error of the unit. */
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean final)
{
    unit *here = (unit *)c;
    (void)now, (void)final;
    if (fabs(step - RELIAB_STEP) > 1e-6 * RELIAB_STEP) {
        return fmi2Error;
    }
    (void)reliab_monitor_step(&here->monitor, here->inputs[0], here->inputs[1]);
    return (here->monitor.status & RELIAB_FAULT) != 0u ? fmi2Warning : fmi2OK;
}

/* There is nothing else to set, get or store. */
#define REFUSED(name, ...) fmi2Status name(__VA_ARGS__)
REFUSED(fmi2GetBoolean, fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Boolean v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2GetString, fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2String v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2SetInteger, fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Integer v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2SetBoolean, fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Boolean v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2SetString, fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2String v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2GetFMUstate, fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2SetFMUstate, fmi2Component c, fmi2FMUstate s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2FreeFMUstate, fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n) { (void)c, (void)s, (void)n; return fmi2Error; }
REFUSED(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
{ (void)c, (void)s, (void)b, (void)n; return fmi2Error; }
REFUSED(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
{ (void)c, (void)b, (void)n, (void)s; return fmi2Error; }
REFUSED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
{ (void)c, (void)u, (void)nu, (void)k, (void)nk, (void)dk, (void)du; return fmi2Error; }
REFUSED(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference at[], size_t n,
        const fmi2Integer order[], const fmi2Real v[])
{ (void)c, (void)at, (void)n, (void)order, (void)v; return fmi2Error; }
REFUSED(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference at[], size_t n,
        const fmi2Integer order[], fmi2Real v[])
{ (void)c, (void)at, (void)n, (void)order, (void)v; return fmi2Error; }
REFUSED(fmi2CancelStep, fmi2Component c) { (void)c; return fmi2Error; }
REFUSED(fmi2GetStatus, fmi2Component c, const fmi2StatusKind k, fmi2Status *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind k, fmi2Real *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetBooleanStatus, fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind k, fmi2String *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
